//! How a run is integrated: the choice of method and tolerance for an accuracy, and which methods a
//! scene allows.

use super::error::{MAX_STEPS, RunError};
use crate::chain::{Chain, Contact, LOSS_MODELS};
use crate::motion::Method;
use crate::scene::Scene;

/// Methods for losses.
const FOR_LOSSES: &str =
    "runge-kutta-4, dormand-prince-54, dormand-prince-853 or rodas, or --accuracy instead";
/// Methods for walls that move.
const FOR_MOVING_WALLS: &str =
    "runge-kutta-4, dormand-prince-54 or dormand-prince-853, or --accuracy instead";
/// Losses are stiff where the decay of a contact, in units of its own angular frequency, exceeds
/// this. Stability and not accuracy limits the explicit pair beyond, and errors of first peaks are
/// many times what its steps tolerate: 19 times at 0.81, 130 times at 1.3 (hundreds of tolerances
/// of ten scenes of the bench, 5 to 10 N s/m) (1).
const STIFF_DAMPING: f64 = 0.75;
/// From this accuracy on losses of any size are left to the implicit method: as long steps of the
/// explicit pair are at the limit of its stability, and no faster (`hertzscope cost`, dashpots of 1
/// to 10 N s/m) (1).
const LOOSE_ACCURACY: f64 = 1e-3;
/// With losses a step tolerates the accuracy asked for divided by this: errors of first peaks and
/// their times stayed below 10 times the error tolerated in a step (150 tolerances up to 6e-5 of 20
/// scenes that the tests do not use; `tests/it/losses/tolerances.rs`) (1).
const LOSS_MARGIN: f64 = 16.0;
/// The same for the implicit method: errors were up to 5.8 times what a step tolerates (Kuwabara
/// and Kono's losses at 2e-3, 400 accuracies) (1).
const STIFF_LOSS_MARGIN: f64 = 8.0;
/// Steps of two lengths are made for the accuracy asked divided by this: first peaks were off by up
/// to 1.13 times what they are made for, in 256 scenes from 2e-4 to 1e-3
/// (`tests/it/vector_path.rs`) (1).
const TWO_STEP_MARGIN: f64 = 2.0;
/// From this accuracy on they are the cheapest (`hertzscope cost` of the shipped scenes) (1).
const TWO_STEP_FROM: f64 = 2e-4;
/// A contact is preloaded whose static overlap is this share of the coming impact's, or more: its
/// frequency goes as the fourth root of the overlap (1).
const PRELOADED_SHARE: f64 = 1e-3;
/// How a run is integrated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Integration {
    /// To the accuracy that is asked for: relative error of first-peak forces and times (1).
    Accuracy(f64),
    /// By this method with this setting.
    Method(Method),
}

/// The method of `integration` for `scene`.
///
/// # Errors
/// [`RunError`] for a method by hand that losses rule out, or whose step cannot be stable or takes
/// too long.
pub fn method(scene: &Scene, integration: Integration) -> Result<Method, RunError> {
    let method = match integration {
        Integration::Accuracy(accuracy) => {
            return Ok(method_for(&scene.chain, &scene.initial_velocities, accuracy));
        }
        Integration::Method(method) => method,
    };
    refuse(scene, method)?;
    if let Some((step, _)) = method.fixed_step() {
        let steps = scene.duration / step;
        if steps > MAX_STEPS {
            return Err(RunError::TooManySteps { step, steps });
        }
    }
    let limit = method.fixed_step().and_then(|(step, reach)| {
        let limit = scene.chain.stability_limit(&scene.initial_velocities, reach)?;
        (step > limit.step).then_some((step, limit))
    });
    match limit {
        Some((step, limit)) => Err(RunError::Unstable { step, limit }),
        None => Ok(method),
    }
}

/// The method that serves `accuracy` (1) for a chain with these initial velocities (m/s).
pub fn method_for(chain: &Chain, velocities: &[f64], accuracy: f64) -> Method {
    let two_lengths =
        two_step(chain, accuracy / TWO_STEP_MARGIN).filter(|_| is_preloaded(chain, velocities));
    two_lengths.unwrap_or_else(|| controlled_for(chain, velocities, accuracy))
}

/// Steps of two lengths for `accuracy` (1), where they are the cheapest. In a chain that is not
/// preloaded only a reference run shows whether they are as accurate.
fn two_step(chain: &Chain, accuracy: f64) -> Option<Method> {
    let serves = accuracy >= TWO_STEP_FROM && chain.is_plain();
    serves.then_some(Method::TwoStepForceGradient { tolerance: accuracy })
}

/// The method with error control that serves `accuracy` (1).
pub fn controlled_for(chain: &Chain, velocities: &[f64], accuracy: f64) -> Method {
    if !chain.needs_general_method() {
        for_accuracy(accuracy)
    } else if chain.needs_explicit_method() {
        Method::DormandPrince853 { tolerance: accuracy / LOSS_MARGIN }
    } else if accuracy > LOOSE_ACCURACY || chain.largest_damping(velocities) > STIFF_DAMPING {
        Method::Rodas { tolerance: accuracy / STIFF_LOSS_MARGIN }
    } else {
        Method::DormandPrince853 { tolerance: accuracy / LOSS_MARGIN }
    }
}

/// The pair that serves `accuracy` without losses (1).
pub fn for_accuracy(accuracy: f64) -> Method {
    Method::DormandElMikkawyPrince86 { tolerance: accuracy }
}

/// Whether `method` may serve `chain`: forces that follow from more than positions need a general
/// one, and the implicit one knows the tangents of losses alone.
pub(crate) fn serves(chain: &Chain, method: Method) -> bool {
    if chain.needs_explicit_method() {
        method.suits(true) && method.suits(false)
    } else {
        method.suits(chain.is_dissipative())
    }
}

/// Whether contacts are preloaded, all but a striker's: they stay about as stiff as they will be at
/// most.
fn is_preloaded(chain: &Chain, velocities: &[f64]) -> bool {
    let least = PRELOADED_SHARE * chain.impact_overlap(velocities);
    let unloaded = |c: &&Contact| c.stiffness > 0.0 && c.static_overlap < least;
    chain.contacts().iter().filter(unloaded).nth(1).is_none()
}

/// Refuses a method by hand that losses rule out, or that is for losses only.
///
/// # Errors
/// [`RunError`] where the method is not made for losses, or for nothing else, and where its step is
/// too long for them.
fn refuse(scene: &Scene, method: Method) -> Result<(), RunError> {
    if scene.chain.needs_explicit_method() && !serves(&scene.chain, method) {
        let losses = "a drive, rod, plate, plastic contacts or effects.contact_law".to_owned();
        let (method, expected) = (method.name(), FOR_MOVING_WALLS);
        return Err(RunError::NotForLosses { method, losses, expected });
    }
    if !scene.chain.is_dissipative() {
        let refused = RunError::OnlyForLosses { method: method.name() };
        return if method.suits(false) { Ok(()) } else { Err(refused) };
    }
    if !method.allows_losses() {
        let losses = LOSS_MODELS.iter().zip(&scene.spec.effects.losses);
        let losses: Vec<&str> =
            losses.filter(|(_, spec)| spec.is_some()).map(|(model, _)| model.name).collect();
        let losses = format!("losses ({})", losses.join(", "));
        let method = method.name();
        return Err(RunError::NotForLosses { method, losses, expected: FOR_LOSSES });
    }
    let (Some((step, _)), Some(reach)) = (method.fixed_step(), method.decay_reach()) else {
        return Ok(());
    };
    match scene.chain.decay_limit(&scene.initial_velocities, reach) {
        Some(limit) if step > limit.step => {
            let decay = reach / limit.step;
            Err(RunError::UnstableLoss { step, limit, decay })
        }
        _ => Ok(()),
    }
}
