//! Each method converges at its order on a smooth problem, bounded on both sides: a preloaded chain whose contacts stay closed.

use hertzscope::integrate::Method;

use super::chains::{NEVER, diatomic, kicked};

/// Velocities after 0.48 ms, in steps of `step` (s): a tolerance beyond any error leaves the pair nothing to control.
fn velocities(method: Method, step: f64) -> Vec<f64> {
    let chain = diatomic(10, 2.38, false);
    let mut bench = kicked(&chain, 0, 0.1, method, &[], NEVER);
    let steps = (0.48e-3 / step).round() as u32;
    for k in 1..=steps {
        bench
            .run_until(f64::from(k) * 0.48e-3 / f64::from(steps), false, &mut |_| ())
            .expect("a run");
    }
    bench.state().velocity.clone()
}

/// Exponent of error against step between `step` and half of it.
fn order(method: impl Fn(f64) -> Method, step: f64) -> f64 {
    // At rounding, seven orders and more below both.
    let exact = velocities(Method::DormandPrince853 { tolerance: 1e-16 }, 0.48e-3);
    let error = |step: f64| {
        let found = velocities(method(step), step);
        found.iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    (error(step) / error(0.5 * step)).log2()
}

#[test]
fn velocity_verlet_is_of_order_2() {
    let order = order(|step| Method::VelocityVerlet { step }, 0.25e-6);
    assert!((1.95..2.05).contains(&order), "{order}");
}

#[test]
fn dormand_prince_853_is_of_order_8() {
    let order = order(|_| Method::DormandPrince853 { tolerance: 1e6 }, 6e-6);
    assert!((7.5..8.7).contains(&order), "{order}");
}
