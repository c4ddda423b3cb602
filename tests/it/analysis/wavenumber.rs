//! Waves in the plane of frequency and wavenumber: made up, of the linear chain on its dispersion
//! relation, and the command.

use std::f64::consts::{PI, TAU};

use assert_cmd::Command;
use hertzscope::analysis::wavenumber::{WavenumberError, spectral_lines};
use hertzscope::experiment::bench::{Bench, Grid};
use hertzscope::measurement::metadata;
use hertzscope::motion::Method;
use hertzscope::scene::{Scene, Site};
use serde_json::Value;

use crate::chains::NEVER;

/// Two waves of known frequency and phase, one each way: both are found where they are.
#[test]
fn plane_waves_are_found() {
    let (cells, samples, interval) = (40, 500, 10e-6);
    let (on, back) = ((4e3, 1.1, 1.0), (12e3, 2.3, 0.4));
    let rows: Vec<Vec<f64>> = (0..cells)
        .map(|n| {
            let wave = |(f, phase, height): (f64, f64, f64), t: f64, sign: f64| {
                height * (TAU * f * t - sign * phase * f64::from(n) + 0.3).cos()
            };
            let at = |i: u32| f64::from(i) * interval;
            (0..samples).map(|i| wave(on, at(i), 1.0) + wave(back, at(i), -1.0)).collect()
        })
        .collect();
    let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
    let found = spectral_lines(&rows, interval, (20e3, 0.2)).expect("waves");
    assert!((found.frequency_resolution - 200.0).abs() < 1e-9);
    for (onward, (frequency, phase, height)) in [(true, on), (false, back)] {
        let lines = found.lines.iter().filter(|line| line.onward == onward);
        let best = lines.max_by(|a, b| a.height.total_cmp(&b.height)).expect("a wave");
        println!("{best:?}");
        assert!((best.frequency - frequency).abs() < 1e-6, "{best:?}");
        // The parabola through a padded Hann line is off by less than a hundredth of the
        // resolution.
        assert!((best.phase - phase).abs() < 0.01 * TAU / f64::from(cells), "{best:?}");
        assert!((best.height - height).abs() < 0.02, "{best:?}");
    }
    // Hann's main lobe is four bins wide: no frequency further off is a wave.
    let near = |f: f64| [on.0, back.0].iter().any(|g| (f - g).abs() <= 400.0 + 1e-6);
    assert!(found.lines.iter().all(|line| near(line.frequency)), "{:?}", found.lines);
}

/// The linear chain of 300 cells before anything comes back from its end: every wave lies on one of
/// the branches to what window and length can tell, both branches have some, and the gap has none.
#[test]
fn the_linear_chain_lies_on_its_branches() {
    let scene = Scene::load("linear-300-cells").expect("a scene");
    let chain = metadata::cell(&scene, Site::Particle(2)).expect("a cell");
    let contacts = metadata::cells(&scene, 2, 2).expect("cells");
    assert!(contacts.len() >= 299, "{}", contacts.len());
    let film = Grid { start: 0.0, interval: 20e-6 };
    let method = Method::DormandElMikkawyPrince86 { tolerance: 1e-9 };
    let velocities = &scene.initial_velocities;
    let mut bench = Bench::new(&scene.chain, velocities, method, &[], NEVER, film);
    bench.run_until(5e-3, false, &mut |_| ()).expect("a run");
    // The source's own mode stays in the first cells: leave them out. The optical waves are slow,
    // and do not go far.
    let row = |j: &usize| {
        let forces = &bench.film().contact_forces[*j];
        forces.iter().map(|force| force - forces[0]).collect::<Vec<f64>>()
    };
    let rows: Vec<Vec<f64>> = contacts.iter().skip(8).take(60).map(row).collect();
    let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
    // What leaks past the window is a hundredth.
    let found = spectral_lines(&rows, film.interval, (20e3, 0.03)).expect("waves");
    let (mut acoustic, mut optical) = (0, 0);
    for line in &found.lines {
        // Over what the phase may be off, the branch passes the frequency.
        let spread = |branch: &dyn Fn(f64) -> f64| {
            let ends = [-1.0, 1.0]
                .map(|s| branch((line.phase + s * found.phase_resolution).clamp(0.0, PI)));
            (
                ends[0].min(ends[1]) - found.frequency_resolution,
                ends[0].max(ends[1]) + found.frequency_resolution,
            )
        };
        let within = |(low, high): (f64, f64)| (low..=high).contains(&line.frequency);
        let on = [within(spread(&|p| chain.acoustic(p))), within(spread(&|p| chain.optical(p)))];
        assert!(on[0] || on[1], "{line:?}");
        // Energy runs onward everywhere; on the optical branch, folded into the first zone, phases
        // run against it.
        assert_eq!(line.onward, on[0], "{line:?}");
        acoustic += u32::from(on[0]);
        optical += u32::from(on[1]);
        let (low, high) = (
            chain.gap_bottom() + found.frequency_resolution,
            chain.gap_top() - found.frequency_resolution,
        );
        assert!(!(low..high).contains(&line.frequency), "{line:?}");
    }
    println!("{acoustic} acoustic, {optical} optical");
    assert!(acoustic > 20 && optical > 0, "{acoustic} {optical}");
}

#[test]
fn what_is_no_field_is_refused() {
    let row = vec![0.0; 100];
    let few = vec![&row[..]; 4];
    assert_eq!(
        spectral_lines(&few, 1e-6, (1e5, 0.1)),
        Err(WavenumberError::TooFewCells { cells: 4 })
    );
    let short = vec![&row[..10]; 20];
    assert_eq!(
        spectral_lines(&short, 1e-6, (1e5, 0.1)),
        Err(WavenumberError::TooShort { samples: 10 })
    );
    let silent = vec![&row[..]; 20];
    assert!(spectral_lines(&silent, 1e-6, (1e5, 0.1)).expect("nothing").lines.is_empty());
    let bad = vec![f64::NAN; 100];
    assert_eq!(
        spectral_lines(&vec![&bad[..]; 20], 1e-6, (1e5, 0.1)),
        Err(WavenumberError::NotFinite)
    );
}

fn hertzscope(arguments: &[&str]) -> assert_cmd::assert::Assert {
    Command::cargo_bin("hertzscope").expect("the program").args(arguments).assert()
}

#[test]
fn the_command_draws_waves_on_branches() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    let (recording, picture) = (path("r.mcap"), path("d.svg"));
    hertzscope(&["run", "magnet-0.61g", "-o", &recording]).success();
    let told =
        hertzscope(&["dispersion", &recording, "--to", "800us", "--json", "--plot", &picture])
            .success();
    let told: Value = serde_json::from_slice(&told.get_output().stdout).expect("JSON");
    let lines = told["lines"].as_array().expect("a list");
    assert!(lines.len() >= 3, "{lines:?}");
    // A wave larger than the preload: faster than small ones, so above the acoustic branch, and
    // within half of it.
    for line in
        lines.iter().filter(|line| line["onward"] == true && line["height"].as_f64() > Some(0.3))
    {
        let (found, theory) =
            (line["frequency_hz"].as_f64().unwrap(), line["theory_hz"].as_f64().unwrap());
        println!("{line}");
        assert!((0.8..1.6).contains(&(found / theory)), "{line}");
    }
    let drawn = std::fs::read_to_string(&picture).expect("a picture");
    assert!(drawn.contains("<circle") && drawn.contains("k a (rad)"));
    let page = hertzscope(&["dispersion", &recording]).success();
    let page = String::from_utf8_lossy(&page.get_output().stdout).into_owned();
    assert!(page.contains("gap from f1 7.125 kHz") && page.contains("forward"), "{page}");
    hertzscope(&["dispersion", &recording, "--particle", "1"]).code(2);
    hertzscope(&["dispersion", &recording, "--min-amplitude", "0"]).code(2);
    hertzscope(&["dispersion", "no-such.mcap"]).code(2);
    let csv = concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml");
    hertzscope(&["dispersion", csv]).code(2);
}

/// Sixty equal steel balls under 20 N, struck softly: `f = sqrt(k/m)/pi sin(k a/2)` from bead to
/// bead (L. Brillouin, "Wave Propagation in Periodic Structures"), `k = 3/2 F/delta` of Hertz's law
/// with the numbers of this scene, by hand.
#[test]
fn equal_beads_have_one_branch() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    let scene = "title = \"equal\"\nduration = \"2 ms\"\nseed = 1\n\
        [materials.steel]\ndensity = \"7800 kg/m^3\"\nyoungs_modulus = \"200 GPa\"\n\
        poissons_ratio = 0.3\n\
        [particles.ball]\nmaterial = \"steel\"\ndiameter = \"10 mm\"\n\
        [chain]\norientation = \"lying\"\ntop = { force = \"20 N\" }\nbottom = { wall = \"steel\" }\n\
        segments = [{ particles = [\"ball\"], repeat = 60 }]\n\
        [striker]\nmaterial = \"steel\"\ndiameter = \"10 mm\"\nspeed = \"5 mm/s\"\n";
    std::fs::write(path("equal.toml"), scene).expect("a scene");
    let (recording, picture) = (path("equal.mcap"), path("equal.svg"));
    hertzscope(&["run", &path("equal.toml"), "-q", "-o", &recording]).success();
    let told = hertzscope(&["dispersion", &recording, "--json", "--plot", &picture]).success();
    let told: Value = serde_json::from_slice(&told.get_output().stdout).expect("JSON");
    let (radius, force): (f64, f64) = (5e-3, 20.0);
    let mass = 7800.0 * 4.0 / 3.0 * PI * radius.powi(3);
    // F = 4/3 E* sqrt(R/2) delta^1.5 with E* = E/(2 (1 - nu^2)).
    let stiffness = 4.0 / 3.0 * 200e9 / (2.0 * (1.0 - 0.09)) * (0.5 * radius).sqrt();
    let overlap = (force / stiffness).powf(2.0 / 3.0);
    let highest = (1.5 * force / overlap / mass).sqrt() / PI;
    println!("highest by hand {highest}, found {}", told["f3_hz"]);
    assert!((told["f3_hz"].as_f64().expect("f3") / highest - 1.0).abs() < 1e-6);
    assert_eq!(told["beads_per_cell"], 1);
    let cell = told["cell_m"].as_f64().expect("a length");
    assert!((cell - (2.0 * radius - overlap)).abs() < 1e-9, "{cell}");
    // Resolutions of 500 Hz and 2 pi/59; a strong line lies within a fifth of the first.
    let lines = told["lines"].as_array().expect("lines").iter();
    let number = |line: &Value, key: &str| line[key].as_f64().expect("a number");
    let strong = lines.filter(|line| number(line, "height") > 0.3 && line["onward"] == true);
    let strong: Vec<&Value> = strong.filter(|line| number(line, "phase_rad") > 0.3).collect();
    assert!(strong.len() > 10, "{strong:?}");
    for line in strong {
        let theory = highest * (0.5 * number(line, "phase_rad")).sin();
        assert!((number(line, "theory_hz") / theory - 1.0).abs() < 1e-6, "{line}");
        assert!((number(line, "frequency_hz") - theory).abs() < 100.0, "{line} of {theory}");
    }
    let drawn = std::fs::read_to_string(&picture).expect("a picture");
    assert!(drawn.contains("theory, equal beads") && !drawn.contains("optical"));
}
