//! The bench of Herbold et al. (2009) with the 0.61 g striker and the magnet: forces in particles
//! 2, 14 and 27 and at the wall.

use std::sync::LazyLock;

/// Particles of the chain.
const PARTICLES: usize = 38;
/// Integration step (s).
const STEP: f64 = 2e-8;
/// Steps from one force to the next.
const STEPS_PER_FORCE: usize = 5;
/// Time between two forces (s).
pub const INTERVAL: f64 = STEP * STEPS_PER_FORCE as f64;
/// End of the motion (s).
const DURATION: f64 = 2.5e-3;
const GRAVITY: f64 = 9.81;
/// Force of the magnet on particle 1 (N).
const MAGNET: f64 = 2.38;
const SPEED: f64 = 0.44;

/// Forces above the static ones at the four sensors, from the striker's first contact on (N).
pub static FORCES: LazyLock<[Vec<f64>; 4]> = LazyLock::new(simulate);

fn mass(body: usize) -> f64 {
    match body {
        0 => 0.61e-3,
        1 => 0.45e-3,
        body if body.is_multiple_of(2) => 0.1226e-3,
        _ => 0.485e-3,
    }
}

/// Hertz's constant of the contact above body `contact`, of the wall's for the last (N/m^1.5);
/// `4/3 E* sqrt(R*)` from the bench's moduli and radii.
fn stiffness(contact: usize) -> f64 {
    let (ptfe, steel, alumina) = ((1.46e9, 0.46), (193e9, 0.30), (400e9, 0.22));
    let radius: f64 = 2.38e-3;
    let compliance = |(modulus, ratio): (f64, f64)| (1.0 - ratio * ratio) / modulus;
    let of = |a, b, radius: f64| 4.0 / 3.0 * radius.sqrt() / (compliance(a) + compliance(b));
    match contact {
        1 => of(alumina, steel, radius),
        2 => of(steel, ptfe, radius / 2.0),
        _ => of(ptfe, steel, radius),
    }
}

fn simulate() -> [Vec<f64>; 4] {
    let bodies = PARTICLES + 1;
    let stiffness: Vec<f64> = (0..=bodies).map(|contact| stiffness(contact.max(1))).collect();
    // Contact `c` joins bodies c - 1 and c; contact 39 is the wall's. Contact 1 begins at zero.
    let mut weight = MAGNET;
    let mut rest = vec![0.0; bodies + 1];
    let mut static_force = vec![0.0; bodies + 1];
    for contact in 2..=bodies {
        weight += mass(contact - 1) * GRAVITY;
        static_force[contact] = weight;
        rest[contact] = (weight / stiffness[contact]).powf(2.0 / 3.0);
    }
    let force = |contact: usize, x: &[f64]| {
        let below = x.get(contact).copied().unwrap_or(0.0);
        let overlap = (rest[contact] + x[contact - 1] - below).max(0.0);
        stiffness[contact] * overlap * overlap.sqrt()
    };
    let acceleration = |x: &[f64]| -> Vec<f64> {
        let forces: Vec<f64> = (1..=bodies).map(|contact| force(contact, x)).collect();
        (0..bodies)
            .map(|body| {
                let above = if body == 0 { 0.0 } else { forces[body - 1] };
                let magnet = if body == 1 { MAGNET } else { 0.0 };
                GRAVITY + (above - forces[body] + magnet) / mass(body)
            })
            .collect()
    };
    let mut x = vec![0.0; bodies];
    let mut v = vec![0.0; bodies];
    v[0] = SPEED;
    let mut found: [Vec<f64>; 4] = Default::default();
    let steps = (DURATION / STEP).round() as usize;
    let moved = |a: &[f64], b: &[f64], share: f64| -> Vec<f64> {
        a.iter().zip(b).map(|(a, b)| a + share * STEP * b).collect()
    };
    for step in 0..=steps {
        if step % STEPS_PER_FORCE == 0 {
            let dynamic = |contact: usize| force(contact, &x) - static_force[contact];
            for (found, particle) in found.iter_mut().zip([2, 14, 27]) {
                found.push(0.5 * (dynamic(particle) + dynamic(particle + 1)));
            }
            found[3].push(dynamic(bodies));
        }
        let a1 = acceleration(&x);
        let v2 = moved(&v, &a1, 0.5);
        let a2 = acceleration(&moved(&x, &v, 0.5));
        let v3 = moved(&v, &a2, 0.5);
        let a3 = acceleration(&moved(&x, &v2, 0.5));
        let v4 = moved(&v, &a3, 1.0);
        let a4 = acceleration(&moved(&x, &v3, 1.0));
        for body in 0..bodies {
            x[body] += STEP / 6.0 * (v[body] + 2.0 * (v2[body] + v3[body]) + v4[body]);
            v[body] += STEP / 6.0 * (a1[body] + 2.0 * (a2[body] + a3[body]) + a4[body]);
        }
    }
    found
}

/// Height (N) and time (s) of the first maximum above a quarter of the largest force, and the time
/// when half of the height is reached first (s).
pub fn first_peak(forces: &[f64]) -> (f64, f64, f64) {
    let largest = forces.iter().fold(0.0_f64, |a, b| a.max(*b));
    let place = (1..forces.len() - 1)
        .find(|&i| {
            forces[i] > 0.25 * largest && forces[i] >= forces[i - 1] && forces[i] > forces[i + 1]
        })
        .expect("a peak");
    // The parabola through three points.
    let (a, b, c) = (forces[place - 1], forces[place], forces[place + 1]);
    let shift = 0.5 * (a - c) / (a - 2.0 * b + c);
    let height = b - 0.25 * (a - c) * shift;
    (height, (place as f64 + shift) * INTERVAL, first_crossing(forces, 0.5 * height))
}

/// Time at which a level (N) is reached first (s).
pub fn first_crossing(forces: &[f64], level: f64) -> f64 {
    let rise = forces.windows(2).position(|pair| pair[1] >= level).expect("a rise");
    let share = (level - forces[rise]) / (forces[rise + 1] - forces[rise]);
    (rise as f64 + share) * INTERVAL
}

#[test]
fn the_bench_has_the_constants_and_speeds_of_two_independent_calculations() {
    for (contact, expected) in [(1, 9169263323.248), (2, 84438957.3279418), (3, 119414718.6458183)]
    {
        assert!((stiffness(contact) / expected - 1.0).abs() < 1e-12);
    }
    // 170.9 m/s by half-rise, 164.5 m/s by peaks over 51.1228 mm, from particle 14 to 27.
    let (_, peak_14, half_14) = first_peak(&FORCES[1]);
    let (_, peak_27, half_27) = first_peak(&FORCES[2]);
    assert!((51.1228e-3 / (half_27 - half_14) - 170.9).abs() < 0.05);
    assert!((51.1228e-3 / (peak_27 - peak_14) - 164.5).abs() < 0.05);
}
