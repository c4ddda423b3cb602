//! Sensors of motion.

use hertzscope::chain::{Body, Chain, ChainSpec, EffectsSpec, End};
use hertzscope::experiment::accuracy::run_to_accuracy;
use hertzscope::experiment::bench::{Bench, Grid, Mover};
use hertzscope::motion::Method;
use hertzscope::scene::Scene;

use crate::chains::{NEVER, ptfe_sphere};

/// A solitary wave: speed in sites over the fifth root of the largest bead velocity, with
/// `A = m = 1`, is 0.907470 (a numerical solution of the discrete wave by another program), by the
/// methods with and without losses.
#[test]
fn a_vibrometer_sees_the_solitary_wave() {
    let particles: Vec<Body> = (0..110).map(|_| ptfe_sphere()).collect();
    let spec = ChainSpec {
        striker: None,
        particles,
        top: End::Free,
        bottom: End::Free,
        wall_preload: 0.0,
        effects: EffectsSpec::default(),
    };
    let chain = Chain::new(&spec).expect("a chain");
    let mut velocities = vec![0.0; 110];
    velocities[0] = 0.5;
    let interval = 2e-7;
    let grid = Grid { start: -1e-5, interval };
    for method in [
        Method::DormandElMikkawyPrince86 { tolerance: 1e-9 },
        Method::DormandPrince853 { tolerance: 1e-10 },
    ] {
        let movers = [Mover::Body(70), Mover::Body(100)];
        let bench = Bench::new(&chain, &velocities, method, &[], grid, NEVER);
        let mut bench = bench.following(&movers);
        bench.run_until(4e-3, false, &mut |_| ()).expect("a run");
        let top = |samples: &[f64]| {
            let place = (1..samples.len() - 1)
                .max_by(|a, b| samples[*a].total_cmp(&samples[*b]))
                .expect("samples");
            let [a, b, c] = [samples[place - 1], samples[place], samples[place + 1]];
            let shift = 0.5 * (a - c) / (a - 2.0 * b + c);
            (grid.time(place) + shift * interval, b - 0.25 * (a - c) * shift)
        };
        let [(early, first), (late, second)] = [0, 1].map(|k| top(&bench.motions()[k].samples));
        assert!((second / first - 1.0).abs() < 1e-4, "{first} {second}");
        let stiffness = chain.contacts()[5].stiffness;
        let scale = (stiffness / 0.1226e-3_f64).powf(0.4) * second.powf(0.2);
        let speed = 30.0 / (late - early) / scale;
        println!("{method}: {speed:.6}");
        assert!((speed - 0.907470).abs() < 2e-5, "{speed}");
    }
}

/// The strain of a rod is that of the force on its face, `F/(Z c)`, later by the distance over the
/// speed of sound, and comes back from the free end with the other sign.
#[test]
fn a_strain_gauge_sees_the_force_on_the_face_later() {
    let text = "base = \"hopkinson-bar\"\neffects.scope_noise = false\n[strain_gauges.bar]\ndistance = \"0.5 m\"\nsensitivity = \"100 kV\"\n[accelerometers.a]\nparticle = 5\nsensitivity = \"1 uV*s^2/m\"\nresonance = \"1 MHz\"\n[scope.ch3]\ninput = \"bar\"\nscale = \"20 mV/div\"\n[scope.ch4]\ninput = \"a\"\nscale = \"100 mV/div\"\n";
    let scene = Scene::from_text("bar", "bar.toml", text).expect("a scene");
    let outcome = run_to_accuracy(&scene, 1e-6, 1, &mut |_| ()).expect("a run");
    let wall = outcome.summary.wall.expect("a wall").first_peak.expect("a peak");
    let (modulus, density, diameter) = (200e9_f64, 7650.0_f64, 12.7e-3_f64);
    let speed = (modulus / density).sqrt();
    let section = 0.25 * std::f64::consts::PI * diameter * diameter;
    // -F/(A E), 100 kV for a strain of 1.
    let expected = -1e5 * wall.dynamic_n / (section * modulus);
    let capture = &outcome.shot.captures[2].waveform;
    let values: Vec<f64> = (0..capture.codes.len()).filter_map(|i| capture.volts(i)).collect();
    let trigger = outcome.shot.trigger_time.expect("a trigger");
    let before = wall.time_s + 0.5 / speed + 2e-5 - trigger;
    let first = values.iter().enumerate().filter(|(i, _)| capture.time(*i) < before);
    let (place, lowest) = first.min_by(|a, b| a.1.total_cmp(b.1)).expect("samples");
    println!("{lowest} V, expected {expected} V");
    assert!((lowest / expected - 1.0).abs() < 0.02, "{lowest} {expected}");
    let at = capture.time(place) + trigger;
    assert!((at - wall.time_s - 0.5 / speed).abs() < 2e-6, "{at} {}", wall.time_s);
    let highest = values.iter().fold(0.0_f64, |most, v| most.max(*v));
    assert!((highest / -expected - 1.0).abs() < 0.05, "{highest} {expected}");
    let facts = hertzscope::experiment::facts::facts(
        &scene,
        hertzscope::experiment::Integration::Accuracy(1e-6),
    );
    let facts = facts.expect("facts");
    assert_eq!(facts["hertzscope:motion_sensor/1"]["kind"], "accelerometer");
    assert_eq!(facts["hertzscope:motion_sensor/2"]["unit"], "1");
}

/// What is wrong with a sensor of motion is said at its place; words that people try get an answer.
#[test]
fn mistakes_and_words_that_people_try_get_an_answer() {
    let told = |more: &str| {
        let text = format!("base = \"magnet-0.61g\"\n{more}");
        Scene::from_text("s", "s.toml", &text).expect_err("a mistake").to_string()
    };
    let gauge = "[strain_gauges.g]\ndistance = \"1 m\"\nsensitivity = \"1 V\"\n";
    assert!(told(gauge).contains("without a rod"), "{}", told(gauge));
    let far = "[vibrometers.v]\nparticle = 99\nsensitivity = \"1 V*s/m\"\n";
    assert!(told(far).contains("from 1 to 38"), "{}", told(far));
    for (key, answer) in [
        ("actuator", "[drive]"),
        ("actuatr", "[drive]"),
        ("friction", "without turning"),
        ("2d", "one chain"),
        ("resonators", "rigid"),
        ("hopkinson", "chain.bottom"),
    ] {
        let told = told(&format!("[{key}]\nx = 1\n"));
        assert!(told.contains(answer), "{key}: {told}");
    }
}
