//! What stands in the table is what a run of the same scene finds.

use hertzscope::experiment::outcome::{Reading, Summary};
use hertzscope::experiment::{Integration, run};
use hertzscope::scene::Scene;

use super::{column, done, folder, numbers, read};

/// Accuracy of the sweep, and of what it is held against (1).
const ACCURACY: f64 = 1e-3;
const TIGHT: f64 = 1e-9;

fn reference(text: &str) -> Summary {
    let folder = folder(text);
    let file = folder.path().join("grid.toml");
    let scene = Scene::load(file.display().to_string()).expect("a scene");
    run(&scene, Integration::Accuracy(TIGHT), 1, &mut |_| ()).expect("a run").summary
}

/// Holds a line of the table against a run.
fn agrees(csv: &str, line: usize, summary: &Summary) {
    let cell = |name: &str| numbers(csv, name)[line];
    let near = |name: String, expected: f64, tolerance: f64| {
        let error = (cell(&name) / expected - 1.0).abs();
        assert!(error < tolerance, "{name} in line {line}: off by {error:e}");
    };
    let readings: Vec<&Reading> = summary.sensors.iter().chain(&summary.wall).collect();
    for reading in &readings {
        let (name, peak) = (&reading.name, reading.first_peak.expect("a pulse"));
        near(format!("{name}.static (N)"), reading.static_n, 1e-12);
        near(format!("{name}.peak (N)"), peak.dynamic_n, ACCURACY);
        near(format!("{name}.peak_time (s)"), peak.time_s, ACCURACY);
        near(format!("{name}.half_rise (s)"), reading.half_rise_s.expect("a rise"), ACCURACY);
    }
    let half_rise = summary.speeds.iter().find(|s| s.from == 14 && s.estimator == "half_rise");
    // A speed is a distance over a difference of two arrivals: their errors add, over a difference
    // of half of the later.
    let speed = half_rise.expect("a speed").m_per_s;
    near("p14-p27.half_rise (m/s)".to_owned(), speed, 4.0 * ACCURACY);
}

#[test]
fn the_table_holds_what_runs_find() {
    let folder = folder(
        r#"
        scene = "magnet-0.61g"
        accuracy = 1e-3
        [grid]
        striker.speed = ["0.3 m/s", "0.6 m/s"]
        effects.magnet_preload.force = ["1 N", "4 N"]
        "#,
    );
    done(folder.path(), &["sweep", "grid.toml"]);
    let csv = read(folder.path(), "grid.csv");
    assert_eq!(numbers(&csv, "effects.magnet_preload.force (N)"), [1.0, 1.0, 4.0, 4.0]);
    assert_eq!(numbers(&csv, "striker.speed (m/s)"), [0.3, 0.6, 0.3, 0.6]);
    for (line, (force, speed)) in [(1, 0.3), (1, 0.6), (4, 0.3), (4, 0.6)].into_iter().enumerate() {
        let text = format!(
            "base = \"magnet-0.61g\"\n[effects.magnet_preload]\nforce = \"{force} N\"\n[striker]\nspeed = \"{speed} m/s\"\n"
        );
        agrees(&csv, line, &reference(&text));
    }
}

/// Whatever a scene says can be varied: models, lengths of chains, losses that the scene does not
/// have, constants in other files.
#[test]
fn anything_can_be_varied() {
    let folder = folder(
        r#"
        scene = "magnet-0.61g"
        accuracy = 1e-3
        [grid]
        chain.segments.2.repeat = [15, 18]
        effects.dashpot.gamma = ["0 N*s/m", "0.5 N*s/m"]
        effects.dashpot.end_of_contact = "zero_force"
        materials.ptfe.youngs_modulus = "1.6 GPa"
        striker.model = ["alumina-0.61g", "alumina-2.75g"]
        "#,
    );
    done(folder.path(), &["sweep", "grid.toml"]);
    let csv = read(folder.path(), "grid.csv");
    assert_eq!(column(&csv, "error"), [""; 8]);
    assert_eq!(column(&csv, "striker.model")[..2], ["alumina-0.61g", "alumina-2.75g"]);
    assert_eq!(numbers(&csv, "materials.ptfe.youngs_modulus (Pa)"), [1.6e9; 8]);
    let text = r#"
        base = "magnet-0.61g"
        [materials.ptfe]
        youngs_modulus = "1.6 GPa"
        poissons_ratio = 0.46
        yield_strength = "11 MPa"
        [striker]
        model = "alumina-2.75g"
        [effects.dashpot]
        gamma = "0.5 N*s/m"
        end_of_contact = "zero_force"
    "#;
    // Last of all: 18 cells, the loss, the heavy striker.
    agrees(&csv, 7, &reference(text));
    let short: Vec<f64> = numbers(&csv, "wall.peak_time (s)");
    assert!(short[0] < short[4], "a shorter chain is crossed sooner: {short:?}");
}

/// The seed decides the striker's speed where the scene spreads it, and each run has its own.
#[test]
fn every_run_has_a_seed_of_its_own() {
    let folder = folder(
        r#"
        scene = "magnet-0.61g"
        accuracy = 1e-2
        repeat = 20
        watch = ["p2"]
        [grid]
        duration = "0.1 ms"
        effects.striker_speed_spread.relative = "1 %"
        "#,
    );
    done(folder.path(), &["sweep", "grid.toml"]);
    let csv = read(folder.path(), "grid.csv");
    let distinct = |name: &str| {
        let mut cells = column(&csv, name);
        cells.sort();
        cells.dedup();
        cells.len()
    };
    assert_eq!((distinct("seed"), distinct("p2.peak (N)")), (20, 20));
    assert!(numbers(&csv, "seed").iter().all(|seed| *seed < 9_007_199_254_740_992.0));
}
