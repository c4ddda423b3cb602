//! Each method converges at its order on a smooth problem, bounded on both sides: a preloaded chain
//! whose contacts stay closed.

use hertzscope::chain::{Chain, EndOfContact, LossKind, LossSpec};
use hertzscope::motion::Method;

use super::chains::{NEVER, diatomic, kicked, pressed, ptfe_sphere, steel_cylinder};

/// Time over which errors grow (s).
const TIME: f64 = 0.48e-3;

/// A tolerance beyond any error: methods that choose their steps then take those they are given.
const ANY: f64 = 1e9;

/// The preloaded chain, with a dashpot of 2 N s/m in each contact where `lossy`.
fn chain(lossy: bool) -> Chain {
    if !lossy {
        return diatomic(10, 2.38, false);
    }
    let particles = (0..10).flat_map(|_| [ptfe_sphere(), steel_cylinder()]).collect();
    let mut spec = pressed(particles, 2.38, false);
    let dashpot = LossSpec::everywhere(2.0, EndOfContact::ZeroOverlap);
    spec.effects = spec.effects.with_loss(LossKind::Dashpot, dashpot);
    Chain::new(&spec).expect("a chain")
}

/// Velocities after [`TIME`], in steps of `step` (s); the accounts of losses stand behind the
/// bodies'.
fn velocities(method: Method, step: f64, lossy: bool) -> Vec<f64> {
    let chain = chain(lossy);
    let mut bench = kicked(&chain, (0, 0.1), method, &[], NEVER);
    let steps = (TIME / step).round() as u32;
    for k in 1..=steps {
        bench.run_until(f64::from(k) * TIME / f64::from(steps), false, &mut |_| ()).expect("a run");
    }
    bench.state().velocity.clone()
}

/// Largest error of a velocity (m/s).
fn error(method: Method, step: f64, lossy: bool) -> f64 {
    // At rounding, five orders and more below the others; from another family than all but one
    // method tested.
    let exact = velocities(Method::DormandPrince853 { tolerance: 1e-16 }, TIME, lossy);
    let found = velocities(method, step, lossy);
    found.iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Exponent of error against step between `step` and half of it.
fn order(method: impl Fn(f64) -> Method, step: f64, lossy: bool) -> f64 {
    let error = |step: f64| error(method(step), step, lossy);
    (error(step) / error(0.5 * step)).log2()
}

#[test]
fn methods_have_their_order() {
    type Make = fn(f64) -> Method;
    let methods: [(Make, f64); 7] = [
        (|step| Method::VelocityVerlet { step }, 0.25e-6),
        (|step| Method::ForceGradient { step }, 4e-6),
        (|_| Method::TwoStepForceGradient { tolerance: ANY }, 4e-6),
        (|_| Method::DormandElMikkawyPrince86 { tolerance: ANY }, 6e-6),
        (|_| Method::DormandPrince853 { tolerance: ANY }, 6e-6),
        (|step| Method::RungeKutta4 { step }, 1e-6),
        (|_| Method::DormandPrince54 { tolerance: ANY }, 3e-6),
    ];
    for (method, step) in methods {
        let (found, stated) = (order(method, step, false), f64::from(method(step).order()));
        println!("{}: {found:.2}", method(step).name());
        // Half an order below; the next term of the error may help by nearly a whole one.
        assert!(found > stated - 0.5 && found < stated + 0.9, "{}: {found}", method(step));
    }
}

/// Where forces depend on velocities; what the losses have taken converges with the motion, for it
/// is integrated along.
#[test]
fn methods_for_losses_have_their_order_with_losses() {
    type Make = fn(f64) -> Method;
    let methods: [(Make, f64); 4] = [
        (|step| Method::RungeKutta4 { step }, 1e-6),
        (|_| Method::DormandPrince54 { tolerance: ANY }, 3e-6),
        (|_| Method::DormandPrince853 { tolerance: ANY }, 12e-6),
        (|_| Method::Rodas { tolerance: ANY }, 2e-6),
    ];
    for (method, step) in methods {
        let (found, stated) = (order(method, step, true), f64::from(method(step).order()));
        println!("{}: {found:.2}", method(step).name());
        assert!(found > stated - 0.5 && found < stated + 0.9, "{}: {found}", method(step));
    }
}
