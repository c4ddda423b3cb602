//! Sensors in scenes: stacks, measured circuits, hosts, and plates that are not as their data say.

use hertzscope::experiment::facts::facts;
use hertzscope::experiment::{Integration, run};
use hertzscope::scene::Scene;

fn scene(text: &str) -> Scene {
    let text = format!("base = \"magnet-0.61g\"\n{text}");
    Scene::from_text("test", "test.toml", &text).expect("a scene without problems")
}

fn problems(text: &str) -> String {
    let text = format!("base = \"magnet-0.61g\"\n{text}");
    Scene::from_text("test", "test.toml", &text).expect_err("problems").to_string()
}

fn circuit(scene: &Scene, index: usize) -> (f64, f64) {
    let channel = scene.scope.channels[index].as_ref().expect("a channel that is on");
    let circuit = scene.circuit(index, channel).expect("a sensor");
    (circuit.sensitivity, circuit.time_constant)
}

/// 0.15938 pF times 1800 and 710 pF of cable and 20 pF of input make 1.0169 nF; d33 over it is
/// 0.39336 V/N.
#[test]
fn the_circuit_follows_from_plate_cable_and_input() {
    let capacitance = 0.159_375_380_33e-12 * 1800.0 + 730e-12;
    let (s, tau) = circuit(&scene(""), 0);
    assert!(
        (tau / (1e6 * capacitance) - 1.0).abs() < 1e-9
            && (s / (400e-12 / capacitance) - 1.0).abs() < 1e-9
    );
    // Through a 10x probe: 10 MOhm and 16 pF.
    let (s, tau) = circuit(&scene("[scope.ch1]\nprobe = 10\n"), 0);
    let capacitance = capacitance - 4e-12;
    assert!(
        (tau / (1e7 * capacitance) - 1.0).abs() < 1e-9
            && (s / (400e-12 / capacitance) - 1.0).abs() < 1e-9
    );
    // Two plates in parallel: S tau = 2 d33 R.
    let (s, tau) = circuit(&scene("[sensors.p2]\nplates = 2\n"), 0);
    assert!((s * tau / (2.0 * 400e-12 * 1e6) - 1.0).abs() < 1e-12);
    let (s, tau) = circuit(&scene("[sensors.p2]\nplates = 2\nwiring = \"series\"\n"), 0);
    assert!((s * tau / (400e-12 * 1e6) - 1.0).abs() < 1e-12);
}

/// A measured time constant takes the cable's place; what it was measured with is exchanged for
/// what is there.
#[test]
fn a_measured_sensor_needs_no_data_sheet() {
    let sensor = "[sensors.p2]\nmodel = \"SENSOR\"\nparticle = 2\n";
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("mine.toml");
    let text = "sensitivity = \"0.41 V/N\"\nsensitivity_u = 0.004\ntau = \"1.1 ms\"\ntau_u = \"0.5 %\"\n\
                input_resistance = \"1 MOhm\"\ninput_capacitance = \"20 pF\"\n";
    std::fs::write(&file, text).expect("a file");
    let wired = sensor.replace("SENSOR", &file.display().to_string());
    let (s, tau) = circuit(&scene(&wired), 0);
    assert!((s / 0.41 - 1.0).abs() < 1e-12 && (tau / 1.1e-3 - 1.0).abs() < 1e-12);
    let (s, tau) = circuit(&scene(&format!("{wired}[scope.ch1]\nprobe = 10\n")), 0);
    let capacitance = 1.1e-9 - 4e-12;
    assert!((tau / (1e7 * capacitance) - 1.0).abs() < 1e-12);
    assert!((s / (0.41 * 1.1e-9 / capacitance) - 1.0).abs() < 1e-12);
    let facts = facts(&scene(&wired), Integration::Accuracy(1e-6)).expect("facts");
    assert_eq!(facts["hertzscope:sensor/1"]["sensitivity_u_relative"], "0.004");
    // Only tau: S tau = d33 R. In the scene it replaces the capacitance of the sensor's file; both
    // in one place contradict each other.
    let plate = "[sensors.p2]\nmodel = \"pzt-5a-710pf\"\ntau = \"1 ms\"\n";
    let (s, tau) = circuit(&scene(plate), 0);
    assert!((tau - 1e-3).abs() < 1e-15 && (s / 0.4 - 1.0).abs() < 1e-12);
    let both = format!("{plate}cable_capacitance = \"1 nF\"\n");
    assert!(problems(&both).contains("both `cable_capacitance` and `tau`"));
    std::fs::write(&file, "d33 = \"400 pC/N\"\nrelative_permittivity = 1800\nside = \"3 mm\"\nthickness = \"0.5 mm\"\ntau = \"1 ms\"\n").expect("a file");
    let (s, tau) = circuit(&scene(&wired), 0);
    assert!((tau - 1e-3).abs() < 1e-15 && (s / 0.4 - 1.0).abs() < 1e-12);
    std::fs::write(
        &file,
        "sensitivity = \"0.4 V\"\ntau = \"1 ms\"\ninput_resistance = \"1 MOhm\"\n",
    )
    .expect("a file");
    let told = problems(&wired);
    assert!(told.contains("mine.toml:1:") && told.contains("input_capacitance"), "{told}");
}

/// A heavier host is a heavier particle, and only that one.
#[test]
fn a_host_may_weigh_more_than_its_kind() {
    let (plain, heavier) = (scene(""), scene("[sensors.p14]\nhost_mass = \"0.13 g\"\n"));
    let masses = |scene: &Scene| scene.chain.bodies().iter().map(|b| b.mass).collect::<Vec<_>>();
    let differing: Vec<usize> = masses(&plain)
        .iter()
        .zip(&masses(&heavier))
        .enumerate()
        .filter_map(|(i, (a, b))| (a != b).then_some(i))
        .collect();
    assert_eq!(differing, [plain.chain.body_of(14)]);
    assert!((masses(&heavier)[differing[0]] / 0.13e-3 - 1.0).abs() < 1e-15);
    assert!(
        problems("[sensors.wall]\nhost_mass = \"1 g\"\n")
            .contains("only a sensor in a particle has a host")
    );
}

/// Off by default; drawn from the seed; even within the tolerance; the recording keeps what the
/// data say beside what is there.
#[test]
fn plates_differ_from_their_data_if_asked() {
    assert_eq!(scene("").sensor_tolerance, None);
    let text = "[effects.sensor_tolerance]\nspread = \"20 %\"\n";
    let mut varied = scene(text);
    let data = circuit(&scene(""), 0);
    let mut ratios = Vec::new();
    for seed in 0..1000 {
        varied.seed = seed;
        let found = circuit(&varied, 0);
        // S tau = d33 R: the permittivity's part goes.
        ratios.push(found.0 * found.1 / (data.0 * data.1));
    }
    let mean = ratios.iter().sum::<f64>() / 1000.0;
    let spread = (ratios.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / 999.0).sqrt();
    assert!(ratios.iter().all(|r| (0.8..=1.2).contains(r)));
    // Even within 0.2: a standard deviation of 0.2/sqrt(3), from 1000 draws to 1.4 %; the mean to
    // 0.0037.
    assert!((spread / (0.2 / 3f64.sqrt()) - 1.0).abs() < 0.05 && (mean - 1.0).abs() < 0.012);
    varied.seed = 5;
    let again = circuit(&varied, 0);
    assert_eq!(circuit(&varied, 0), again);
    assert_ne!(circuit(&varied, 1), again, "each plate for itself");
    let facts = facts(&varied, Integration::Accuracy(1e-6)).expect("facts");
    let sensor = &facts["hertzscope:sensor/1"];
    assert_eq!(sensor["sensitivity_v_per_n"], data.0.to_string());
    assert_eq!(sensor["true_sensitivity_v_per_n"], again.0.to_string());
    // The bench uses the plate that is there: the trace is that much higher.
    let peak = |scene: &Scene| {
        let shot = run(scene, Integration::Accuracy(1e-3), 1, &mut |_| ()).expect("a run").shot;
        let volts = shot.captures[1].trace().expect("over time").values;
        volts.into_iter().fold(0.0, f64::max)
    };
    let mut plain = scene("");
    plain.seed = 5;
    let (there, expected) = (circuit(&varied, 1).0, circuit(&plain, 1).0);
    // A level is 0.04 V of 1.2 V; droop differs by a fifth of a few per cent.
    assert!((peak(&varied) / peak(&plain) / (there / expected) - 1.0).abs() < 0.06);
    let warm = "temperature_change = \"10 K\"\n";
    assert!(problems(&format!("{text}{warm}")).contains("d33_coefficient"));
}
