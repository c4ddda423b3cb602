//! Two free bodies that meet.

use hertzscope::chain::{
    Chain, ChainSpec, EffectsSpec, End, EndOfContact, LossKind, LossSpec, Restitution,
};
use hertzscope::motion::Method;

use crate::chains::{NEVER, STEEL, body, kicked};

const SPEED: f64 = 0.44;

fn chain(effects: EffectsSpec) -> Chain {
    let spec = ChainSpec {
        striker: Some(body("striker", 0.61e-3, None, STEEL)),
        particles: vec![body("sphere", 0.45e-3, Some(2.38e-3), STEEL)],
        top: End::Free,
        bottom: End::Free,
        wall_preload: 0.0,
        effects,
    };
    Chain::new(&spec).expect("a chain")
}

/// Ratio of the speeds of separation and approach.
fn restitution(chain: &Chain, method: Method) -> f64 {
    let mut bench = kicked(chain, (0, SPEED), method, &[], NEVER);
    bench.run_until(200e-6, false, &mut |_| ()).expect("a run");
    let velocity = &bench.state().velocity;
    (velocity[1] - velocity[0]) / SPEED
}

/// The table of the viscoelastic collision for `x = 3/2 eta (A/mu)^(2/5) v^(1/5)`, as printed to
/// six digits.
#[test]
fn viscoelastic_restitution() {
    let elastic = chain(EffectsSpec::default());
    let stiffness = elastic.contacts()[1].stiffness;
    let reduced = 0.61e-3 * 0.45e-3 / (0.61e-3 + 0.45e-3);
    for (x, at_zero_overlap, at_zero_force) in [
        (0.01, 0.988545, 0.988547),
        (0.05, 0.944260, 0.944397),
        (0.1, 0.892148, 0.892859),
        (0.2, 0.797550, 0.800965),
    ] {
        for (end, expected) in
            [(EndOfContact::ZeroOverlap, at_zero_overlap), (EndOfContact::ZeroForce, at_zero_force)]
        {
            let eta = x / 1.5 * (stiffness / reduced).powf(-0.4) * SPEED.powf(-0.2);
            let loss = LossSpec::everywhere(eta, end);
            let chain = chain(EffectsSpec::default().with_loss(LossKind::KuwabaraKono, loss));
            let tolerance = 1e-9;
            for method in [Method::DormandPrince853 { tolerance }, Method::Rodas { tolerance }] {
                let found = restitution(&chain, method);
                println!("x {x}, {}, {method}: {found:.8}, expected {expected}", end.name());
                assert!((found - expected).abs() < 1e-6, "{x}, {}: {found}", end.name());
            }
        }
    }
}

/// A dashpot in a collision that ends at zero overlap, for an elastic contact that is negligible:
/// velocities decay as `exp(-gamma t/mu)` while the overlap grows to `mu v/gamma`, so that nothing
/// of the approach comes back.
#[test]
fn dashpots_take_what_they_must() {
    let loss = |gamma| LossSpec::everywhere(gamma, EndOfContact::ZeroForce);
    let with = |gamma| chain(EffectsSpec::default().with_loss(LossKind::Dashpot, loss(gamma)));
    let method = Method::DormandPrince853 { tolerance: 1e-10 };
    let mut before = 1.0;
    for gamma in [0.0, 0.5, 5.0, 50.0, 500.0] {
        let found = restitution(&with(gamma), method);
        println!("gamma {gamma}: {found:.6}");
        if gamma == 0.0 {
            assert!((found - 1.0).abs() < 1e-8);
        } else {
            assert!(found < before && found > -1e-9, "{gamma}: {found}");
        }
        before = found;
    }
    // While the dashpot dominates, the closing speed falls as it does for a dashpot alone.
    let chain = with(500.0);
    let reduced = 0.61e-3 * 0.45e-3 / (0.61e-3 + 0.45e-3);
    let mut bench = kicked(&chain, (0, SPEED), method, &[], NEVER);
    let time = reduced / 500.0;
    bench.run_until(time, false, &mut |_| ()).expect("a run");
    let velocity = &bench.state().velocity;
    let closing = (velocity[0] - velocity[1]) / SPEED;
    // The elastic force is below a thousandth of the dashpot's by then.
    assert!((closing - (-1.0_f64).exp()).abs() < 1e-3, "{closing}");
}

/// A restitution in place of a coefficient: two bodies that meet at the stated speed come apart so,
/// whatever the loss and the end of the contact.
#[test]
fn a_restitution_that_is_asked_for_comes_out() {
    for kind in LossKind::ALL {
        for end in [EndOfContact::ZeroOverlap, EndOfContact::ZeroForce] {
            for value in [0.95, 0.6, 0.3] {
                let exponent = if kind == LossKind::PowerLaw { 1.5 } else { 1.0 };
                let restitution = Some(Restitution { value, speed: SPEED });
                let loss = LossSpec { restitution, exponent, ..LossSpec::everywhere(0.0, end) };
                let chain = chain(EffectsSpec::default().with_loss(kind, loss));
                let found = restitution_of(&chain);
                println!("{kind:?}, {}: {found:.8}, expected {value}", end.name());
                assert!((found - value).abs() < 1e-6, "{kind:?} {}: {found}", end.name());
            }
        }
    }
}

fn restitution_of(chain: &Chain) -> f64 {
    restitution(chain, Method::DormandPrince853 { tolerance: 1e-11 })
}
