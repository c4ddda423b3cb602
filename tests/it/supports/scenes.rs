//! Drives, rods and plates in scenes.

use hertzscope::experiment::accuracy::run_to_accuracy;
use hertzscope::experiment::facts;
use hertzscope::experiment::outcome::Summary;
use hertzscope::scene::Scene;

fn driven(more: &str) -> Scene {
    let text = format!("base = \"driven-dimer\"\neffects.scope_noise = false\n{more}");
    Scene::from_text("driven", "driven.toml", &text).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn run(scene: &Scene) -> Summary {
    run_to_accuracy(scene, 1e-5, 1, &mut |_| ()).expect("a run").summary
}

/// The scope triggers on the rise of the sync, where the signal starts, and shows the generator's
/// signal: five cycles under a Hann window, highest a quarter of a cycle beside the middle, where
/// the window is `cos^2(0.05 pi) = 0.9755`, to one level of 40 mV.
#[test]
fn the_scope_triggers_on_the_sync() {
    let outcome = run_to_accuracy(&driven(""), 1e-5, 1, &mut |_| ()).expect("a run");
    let trigger = outcome.summary.trigger;
    assert!(trigger.crossed, "{trigger:?}");
    assert!(trigger.time_s.is_some_and(|time| time.abs() < 1.5e-6), "{trigger:?}");
    let generator = &outcome.shot.captures[0].waveform;
    let volts = (0..generator.codes.len()).filter_map(|i| generator.volts(i));
    let highest = volts.fold(0.0_f64, f64::max);
    assert!((highest - 0.9755).abs() < 0.04, "{highest}");
    assert!(outcome.summary.energy.dissipated_by_kind.work_of_drive.is_some_and(|w| w > 0.0));
}

/// A file of a generator's samples is its signal; the scene that travels in a recording has the
/// samples themselves.
#[test]
fn a_file_of_samples_is_the_signal() {
    let folder = tempfile::tempdir().expect("a folder");
    let (interval, frequency) = (1e-6, 5e3);
    let lines = (0..1000).map(|i| {
        let time = f64::from(i) * interval;
        let window = 0.5 * (1.0 - (std::f64::consts::TAU * time / 1e-3).cos());
        format!("{time:e}, {:.9}\n", window * (std::f64::consts::TAU * frequency * time).sin())
    });
    let lines = format!("time, volts\n{}", lines.collect::<String>());
    std::fs::write(folder.path().join("burst.csv"), lines).expect("a file");
    let file = folder.path().join("own.toml");
    let text = "base = \"driven-dimer\"\n[drive]\nsignal = { file = \"burst.csv\" }\n";
    std::fs::write(&file, text).expect("a scene");
    let scene = Scene::load(&file).unwrap_or_else(|error| panic!("{error}"));
    let (sampled, plain) = (run(&scene), run(&driven("")));
    for (sampled, plain) in sampled.sensors.iter().zip(&plain.sensors) {
        let [sampled, plain] = [sampled, plain].map(|s| s.first_peak.expect("a peak"));
        assert!((sampled.dynamic_n / plain.dynamic_n - 1.0).abs() < 1e-4, "{sampled:?} {plain:?}");
    }
    let merged = scene.texts.merged().expect("a text").to_owned();
    let again = Scene::from_text("again", "again.toml", &merged).expect("a scene");
    assert_eq!(again.spec.effects.supports, scene.spec.effects.supports);
    std::fs::write(folder.path().join("burst.csv"), "1\n2, 3\n").expect("a file");
    let told = Scene::load(&file).expect_err("a mistake").to_string();
    assert!(told.contains("drive.signal.file") && told.contains("with and without"), "{told}");
}

/// Noise is that of the seed.
#[test]
fn noise_follows_from_the_seed() {
    let noise = |seed: u32| {
        driven(&format!(
            "seed = {seed}\n[drive]\nsignal = {{ noise = [\"3 kHz\", \"7 kHz\"], length = \"2 ms\" }}\n"
        ))
        .spec
        .effects
        .supports
    };
    assert_eq!(noise(1), noise(1));
    assert_ne!(noise(1), noise(2));
}

/// What is wrong with a drive, a rod or a plate is said at its place.
#[test]
fn mistakes_in_walls_that_move_are_told() {
    let told = |base: &str, more: &str| {
        let text = format!("base = \"{base}\"\n{more}");
        Scene::from_text("s", "s.toml", &text).expect_err("a mistake").to_string()
    };
    let drive = "[drive]\ndisplacement = \"1 nm\"\nsignal = { sine = \"1 kHz\" }\n";
    for (base, more, words) in [
        ("magnet-0.61g", drive, "needs a wall"),
        (
            "driven-dimer",
            "[drive]\ndisplacement = \"1 nm\"\nstack = { stroke = \"1 nm\" }\n",
            "beside a stack",
        ),
        ("driven-dimer", "[drive]\nsignal = { sine = \"1 kHz\", cycles = 3 }\n", "`cycles`"),
        ("driven-dimer", "[drive]\nsignal = { burst = \"1 kHz\" }\n", "cycles"),
        ("driven-dimer", "[drive]\nsignal = { file = \"nowhere.csv\" }\n", "nowhere.csv"),
        ("hopkinson-bar", "[chain]\nbottom = { rod = \"steel_440c\" }\n", "diameter"),
        (
            "hopkinson-bar",
            "[chain]\nbottom = { plate = \"steel_440c\", diameter = \"1 mm\" }\n",
            "`diameter` beside `plate`",
        ),
    ] {
        let told = told(base, more);
        assert!(told.contains(words), "{more}: {told}");
    }
}

/// A displacement over a base with a stack takes its place; a stack's stroke alone changes that.
#[test]
fn a_drive_over_that_of_a_base_says_what_it_is() {
    let shown = |more: &str| {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("s.toml");
        std::fs::write(&file, format!("base = \"driven-dimer\"\n{more}")).expect("a scene");
        Scene::resolved(&file).unwrap_or_else(|error| panic!("{error}"))
    };
    let moved = shown("[drive]\ndisplacement = \"1 nm\"\n");
    assert!(moved.contains("displacement = \"1 nm\"") && !moved.contains("stiffness"), "{moved}");
    let stack = shown("drive.stack.stroke = \"2 nm\"\n");
    assert!(stack.contains("stroke = \"2 nm\"") && stack.contains("stiffness"), "{stack}");
}

/// A rod's echo within the record is noted, one after it is not.
#[test]
fn an_echo_within_the_record_is_noted() {
    let noted = |length: &str| {
        let text = format!(
            "base = \"hopkinson-bar\"\n[chain]\nbottom = {{ rod = \"steel_440c\", diameter = \"12.7 mm\"{length} }}\n"
        );
        let scene = Scene::from_text("s", "s.toml", &text).expect("a scene");
        run(&scene).notes.iter().any(|note| note.code == "echo_within_record")
    };
    assert!(noted(", length = \"1 m\""));
    assert!(!noted(", length = \"10 m\""));
    assert!(!noted(""));
}

/// Five touching balls, one of which comes: by a plain solver with small steps, and by momentum and
/// energy.
#[test]
fn a_cradle_without_scope_tells_its_velocities() {
    let scene = Scene::load("cradle").expect("a scene");
    let outcome = run_to_accuracy(&scene, 1e-8, 1, &mut |_| ()).expect("a run");
    let found = &outcome.summary.final_velocities_m_per_s;
    assert!(outcome.summary.notes.is_empty(), "{:?}", outcome.summary.notes);
    assert!(outcome.shot.captures.is_empty());
    // F = A d^1.5 between equal balls: A = E/(3 (1 - nu^2)) sqrt(2 R).
    let radius = 12.7e-3_f64;
    let stiffness = 210e9 / (3.0 * (1.0 - 0.09)) * (2.0 * radius).sqrt();
    let mass = 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3) * 7810.0;
    let mut y = [0.0; 10];
    y[5] = 0.1;
    let rates = |y: &[f64; 10]| {
        let force = |j: usize| {
            let overlap = if j == 0 || j == 5 { 0.0 } else { y[j - 1] - y[j] };
            stiffness * overlap.max(0.0).powf(1.5)
        };
        std::array::from_fn::<f64, 10, _>(|i| {
            if i < 5 { y[i + 5] } else { (force(i - 5) - force(i - 4)) / mass }
        })
    };
    let h = 2e-9;
    for _ in 0..500_000 {
        let add = |k: &[f64; 10], by: f64| std::array::from_fn(|i| y[i] + by * k[i]);
        let a = rates(&y);
        let b = rates(&add(&a, 0.5 * h));
        let c = rates(&add(&b, 0.5 * h));
        let d = rates(&add(&c, h));
        y = std::array::from_fn(|i| y[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
    }
    for (found, exact) in found.iter().zip(&y[5..]) {
        assert!((found - exact).abs() < 1e-7 * 0.1, "{found} {exact}");
    }
    assert!(found[0] < 0.0 && found[4] < 0.1, "{found:?}");
    let (momentum, square) = found.iter().fold((0.0, 0.0), |(p, e), v| (p + v, e + v * v));
    assert!((momentum - 0.1).abs() < 1e-12 && (square - 0.01).abs() < 1e-9, "{found:?}");
}

/// The ledger in a recording closes: work of the drive, losses by each kind and energies by kind.
#[test]
fn the_ledger_in_a_recording_has_drive_rod_and_yielding() {
    let text = "base = \"driven-dimer\"\nduration = \"1 ms\"\nmaterials.ptfe.yield_strength = \"15 MPa\"\nchain.bottom = { rod = \"stainless_steel\", diameter = \"4.76 mm\" }\ndrive.stack.stroke = \"2 um\"\neffects.plasticity = { model = \"thornton\" }\n";
    let scene = Scene::from_text("ledger", "ledger.toml", text);
    let scene = scene.unwrap_or_else(|error| panic!("{error}"));
    let outcome = run_to_accuracy(&scene, 1e-7, 1, &mut |_| ()).expect("a run");
    let energy = facts::shot_notes(&scene, &outcome).energy.expect("a ledger");
    let lost = energy.plasticity_j
        + energy.bottom_wall_j
        + energy.dashpot_j
        + energy.kuwabara_kono_j
        + energy.power_law_loss_j
        + energy.left_in_contacts_j;
    println!("{energy:?}");
    // The rod gives back what pressing it took, as the chain that yields loses its preload.
    assert!(energy.plasticity_j > 0.0 && energy.bottom_wall_j < 0.0 && energy.top_wall_j == 0.0);
    let work = energy.work_of_drive_j;
    assert!((lost - energy.dissipated_j).abs() < 1e-12 * work, "{lost:e}");
    let by_kind = energy.kinetic_j
        + energy.elastic_j
        + energy.gravity_j
        + energy.magnet_j
        + energy.end_forces_j;
    // Two differences of some 1e-7 of the work, at this accuracy.
    let missing = by_kind + lost - work - energy.initial_j;
    assert!(missing.abs() < 1e-6 * work, "{missing:e} of {work:e}");
}
