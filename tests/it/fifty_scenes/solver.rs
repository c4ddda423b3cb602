//! The reference solver against what others have solved: the goldens, and closed forms.

use std::path::Path;

use serde_json::Value;

use super::FINE;
use super::reference::Reference;
use super::setup::{Bead, End, Law, Loss, Material, Setup};

/// Largest relative difference from the goldens' peaks and times, which are known to about 1e-12
/// (1).
const GOLDEN_TOLERANCE: f64 = 1e-11;
/// Digits to which restitutions are known (1).
const RESTITUTION_TOLERANCE: f64 = 1e-6;

fn goldens() -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/bench-goldens.json");
    serde_json::from_str(&std::fs::read_to_string(path).expect("goldens")).expect("JSON")
}

/// The bench of the goldens under gravity, from their own parameters.
fn bench(parameters: &Value, duration: f64, losses: Vec<Loss>) -> Setup {
    let number = |key: &str| parameters[key].as_f64().expect("a parameter");
    let material = |name, modulus, ratio| {
        let (modulus, ratio) = (number(modulus), number(ratio));
        Material { name, modulus, ratio, density: 1.0 }
    };
    let steel = material("steel", "E_steel", "nu_steel");
    let sphere = |material, radius: &str, mass: &str| {
        let (diameter, mass) = (2.0 * number(radius), number(mass));
        Bead { material, diameter, height: None, mass }
    };
    let soft = sphere(material("ptfe", "E_ptfe", "nu_ptfe"), "R_ptfe", "m_ptfe");
    let flat = |material, mass| Bead { material, diameter: 5e-3, height: Some(3e-3), mass };
    let hard = flat(steel, number("m_cyl"));
    let mut beads = vec![sphere(steel, "R_magnet_sphere", "m_magnet_sphere"), soft];
    for _ in 0..18 {
        beads.extend([hard, soft]);
    }
    Setup {
        name: "the bench of the goldens",
        beads,
        striker: Some((flat(material("alumina", "E_alumina", "nu_alumina"), 0.61e-3), 0.44)),
        top: End::Free,
        bottom: End::Wall(steel, 0.0),
        gravity: number("g"),
        magnet: None,
        losses,
        zero_force: false,
        velocities: Vec::new(),
        sensors: vec![(2, 0.0), (14, 0.0), (27, 0.0)],
        duration,
    }
}

/// Largest relative difference of peaks, their times and half-rises from a golden record (1).
fn difference(run: &Reference, golden: &Value, keys: [&str; 3]) -> f64 {
    let places =
        ["p2", "p14", "p27", "wall"].into_iter().zip(run.readings()).zip(run.static_forces());
    let mut worst = 0.0_f64;
    for ((place, reading), at_rest) in places {
        let golden = &golden[place];
        if golden.is_null() {
            continue;
        }
        let reading = reading.expect("a pulse");
        let found = [reading.force + at_rest, reading.time, reading.half_rise];
        for (key, found) in keys.into_iter().zip(found) {
            if let Some(exact) = golden[key]["value"].as_f64() {
                worst = worst.max((found / exact - 1.0).abs());
            }
        }
    }
    worst
}

#[test]
fn it_meets_the_lossless_goldens() {
    let goldens = goldens();
    let golden = &goldens["table_scenes"]["gravity_0.61g"];
    let setup = bench(&goldens["parameters"], 2e-3, Vec::new());
    let run = Reference::run(&setup, FINE);
    let worst = difference(&run, golden, ["first_peak_F", "first_peak_t", "half_rise_t"]);
    println!("lossless: off by {worst:.1e} in {} steps", run.steps());
    assert!(worst < GOLDEN_TOLERANCE, "{worst:e}");
}

#[test]
fn it_meets_the_golden_with_a_dashpot() {
    let goldens = goldens();
    let golden = &goldens["dissipative"]["gravity_0.61g_gamma0.5"];
    let loss = Loss { law: Law::Dashpot, coefficient: 0.5, single: Vec::new() };
    let setup = bench(&goldens["parameters"], 1.2e-3, vec![loss]);
    let run = Reference::run(&setup, FINE);
    let worst = difference(&run, golden, ["F_total", "t", "none"]);
    let ends = golden["u_end"].as_array().expect("a state").iter().zip(&run.last);
    let apart =
        ends.map(|(exact, found)| (exact["value"].as_f64().expect("a number") - found).abs());
    let apart = apart.fold(0.0, f64::max);
    println!("with a dashpot: off by {worst:.1e}, {apart:.1e} m in {} steps", run.steps());
    assert!(worst < GOLDEN_TOLERANCE && apart < 1e-14, "{worst:e}, {apart:e} m");
}

/// Restitution of two equal spheres with Kuwabara and Kono's loss, for both ends of a contact:
/// figures of a separate calculation, six digits of them, for `x = 3/2 eta (A/mu)^(2/5) v^(1/5)`.
#[test]
fn it_meets_the_restitution_of_viscoelastic_spheres() {
    let speed = 0.37;
    let material = Material { name: "any", modulus: 50e9, ratio: 0.25, density: 1.0 };
    let ball = Bead { material, diameter: 7e-3, height: None, mass: 0.4e-3 };
    let modulus = 0.5 * material.modulus / (1.0 - material.ratio * material.ratio);
    let stiffness = 4.0 / 3.0 * modulus * (0.25 * ball.diameter).sqrt();
    let scale = 1.5 * (stiffness / (0.5 * ball.mass)).powf(0.4) * f64::powf(speed, 0.2);
    for (x, zero_overlap, zero_force) in [
        (0.01, 0.988545, 0.988547),
        (0.05, 0.944260, 0.944397),
        (0.1, 0.892148, 0.892859),
        (0.2, 0.797550, 0.800965),
    ] {
        for (ends_at_force, expected) in [(false, zero_overlap), (true, zero_force)] {
            let loss = Loss { law: Law::KuwabaraKono, coefficient: x / scale, single: Vec::new() };
            let setup = Setup {
                name: "two equal spheres",
                beads: vec![ball],
                striker: Some((ball, speed)),
                top: End::Free,
                bottom: End::Free,
                gravity: 0.0,
                magnet: None,
                losses: vec![loss],
                zero_force: ends_at_force,
                velocities: Vec::new(),
                sensors: vec![(1, 0.0)],
                duration: 1e-4,
            };
            let run = Reference::run(&setup, FINE);
            let restitution = (run.last[3] - run.last[2]) / speed;
            println!("x = {x}, ends at zero force {ends_at_force}: {restitution:.6}");
            assert!((restitution - expected).abs() < RESTITUTION_TOLERANCE, "{x}: {restitution}");
        }
    }
}
