//! Each method converges at its order on a smooth problem, bounded on both sides: a preloaded chain whose contacts stay closed.

use hertzscope::integrate::Method;

use super::chains::{NEVER, diatomic, kicked};

/// Time over which errors grow (s).
const TIME: f64 = 0.48e-3;

/// A tolerance beyond any error: the pairs then take the steps they are given.
const ANY: f64 = 1e9;

/// Velocities after [`TIME`], in steps of `step` (s).
fn velocities(method: Method, step: f64) -> Vec<f64> {
    let chain = diatomic(10, 2.38, false);
    let mut bench = kicked(&chain, (0, 0.1), method, &[], NEVER);
    let steps = (TIME / step).round() as u32;
    for k in 1..=steps {
        bench.run_until(f64::from(k) * TIME / f64::from(steps), false, &mut |_| ()).expect("a run");
    }
    bench.state().velocity.clone()
}

/// Exponent of error against step between `step` and half of it.
fn order(method: impl Fn(f64) -> Method, step: f64) -> f64 {
    // At rounding, five orders and more below both; from another family than all but one method tested.
    let exact = velocities(Method::DormandPrince853 { tolerance: 1e-16 }, TIME);
    let error = |step: f64| {
        let found = velocities(method(step), step);
        found.iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    (error(step) / error(0.5 * step)).log2()
}

#[test]
fn methods_have_their_order() {
    type Make = fn(f64) -> Method;
    let methods: [(Make, f64); 6] = [
        (|step| Method::VelocityVerlet { step }, 0.25e-6),
        (|step| Method::Pefrl { step }, 2e-6),
        (|step| Method::BlanesMoan { step }, 6e-6),
        (|_| Method::DormandElMikkawyPrince64 { tolerance: ANY }, 3e-6),
        (|_| Method::DormandElMikkawyPrince86 { tolerance: ANY }, 6e-6),
        (|_| Method::DormandPrince853 { tolerance: ANY }, 6e-6),
    ];
    for (method, step) in methods {
        let (found, stated) = (order(method, step), f64::from(method(step).order()));
        println!("{}: {found:.2}", method(step).name());
        // Half an order below; the next term of the error may help by nearly a whole one.
        assert!(found > stated - 0.5 && found < stated + 0.9, "{}: {found}", method(step));
    }
}
