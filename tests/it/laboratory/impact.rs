//! A striker on a sensor that does not move: force over time and rebound speed.

/// One impact.
pub struct Impact {
    /// Times between the forces (s)
    pub interval: f64,
    /// Forces from the first contact on, with zeros after the last (N)
    pub force: Vec<f64>,
    /// Speed after the contact, away from the sensor (m/s)
    pub rebound: f64,
    /// Time of contact (s)
    pub contact: f64,
}

/// A striker of `mass` (kg) hits with `speed` (m/s): `m x'' = m g - A (x^1.5 + 1.5 eta x^0.5 x')`
/// (Hertz 1882; Kuwabara and Kono 1987), `A` = `stiffness` (N/m^1.5), `eta` = `loss` (s), by the
/// classical Runge-Kutta method with 20,000 steps in the contact.
pub fn impact(mass: f64, speed: f64, stiffness: f64, loss: f64, gravity: f64) -> Impact {
    let force = |x: f64, v: f64| {
        let root = x.max(0.0).sqrt();
        (stiffness * (x.max(0.0) * root + 1.5 * loss * root * v)).max(0.0)
    };
    let deepest = (1.25 * mass * speed * speed / stiffness).powf(0.4);
    let interval = 2.943 * deepest / speed / 20_000.0;
    let acceleration = |x: f64, v: f64| gravity - force(x, v) / mass;
    let (mut x, mut v) = (0.0, speed);
    let mut forces = vec![0.0];
    loop {
        let (k1, l1) = (v, acceleration(x, v));
        let at = |k: f64, l: f64, share: f64| (x + share * interval * k, v + share * interval * l);
        let (x2, v2) = at(k1, l1, 0.5);
        let (k2, l2) = (v2, acceleration(x2, v2));
        let (x3, v3) = at(k2, l2, 0.5);
        let (k3, l3) = (v3, acceleration(x3, v3));
        let (x4, v4) = at(k3, l3, 1.0);
        let (k4, l4) = (v4, acceleration(x4, v4));
        x += interval / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
        v += interval / 6.0 * (l1 + 2.0 * (l2 + l3) + l4);
        forces.push(force(x, v));
        if x <= 0.0 || (v < 0.0 && force(x, v) == 0.0) {
            let contact = interval * (forces.len() - 1) as f64;
            forces.push(0.0);
            return Impact { interval, force: forces, rebound: -v, contact };
        }
    }
}

#[test]
fn a_lossless_impact_meets_hertz() {
    let (mass, speed, stiffness) = (2.75e-3, 0.6, 1.2e8);
    let found = impact(mass, speed, stiffness, 0.0, 0.0);
    let deepest: f64 = (1.25 * mass * speed * speed / stiffness).powf(0.4);
    let largest = found.force.iter().fold(0.0, |a: f64, b| a.max(*b));
    assert!((found.rebound / speed - 1.0).abs() < 1e-9);
    assert!((largest / (stiffness * deepest.powf(1.5)) - 1.0).abs() < 1e-7);
    // 2.943275184324705 deepest / speed (Johnson 1985, Eq. 11.24).
    assert!((found.contact / (2.943275184324705 * deepest / speed) - 1.0).abs() < 1e-4);
    let momentum: f64 = found.force.iter().sum::<f64>() * found.interval;
    assert!((momentum / (2.0 * mass * speed) - 1.0).abs() < 1e-8);
}
