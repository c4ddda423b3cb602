//! The choice of method and tolerance for an accuracy, and which methods a scene allows.

use super::RunError;
use crate::chain::{Chain, Contact, Effect};
use crate::integrate::Method;
use crate::scene::Scene;

/// Methods for losses.
const FOR_LOSSES: &str =
    "runge-kutta-4, dormand-prince-54, dormand-prince-853 or rodas, or --accuracy instead";
/// Losses are stiff where a contact's decay, in units of its own angular frequency, exceeds this. Stability and not accuracy limits the explicit pair there, and
/// its interpolant is no longer what its steps are: with dashpots of 8 N s/m on the bench, where this is 1.3, errors of first peaks and their times were up to 130 times
/// the error tolerated in a step, of 10 N s/m up to 7700 times (100 tolerances of four scenes each) (1).
const STIFF: f64 = 1.25;
/// Nearly stiff from here on: the same 130 times, but no more than 38 where steps are held to less than 3e-8; below, 10 times at most (the same runs, and 100 of
/// six scenes from 5 to 9 N s/m); at 0.81 once 19 times (1).
const NEARLY_STIFF: f64 = 0.75;
/// Up to this accuracy the pair serves what is nearly stiff: the implicit method took up to seven times as long (`hertzscope cost`) (1).
const NEARLY_STIFF_UP_TO: f64 = 1e-6;
/// What [`STEP_MARGIN`] is there (1).
const NEARLY_STIFF_MARGIN: f64 = 100.0;
/// Where steps are held to this or less, the implicit method pays for stiff losses only: on the bench it took from 0.9 to 1.2 times the pair's time at 1e-4, for
/// which steps are held to this, and up to six times as long at 1e-9 (`hertzscope cost`, dashpots of 1 to 10 N s/m) (1).
const LOOSE: f64 = 1e-3;
/// Where steps are looser, or contacts are left with a loss and hardly any overlap, it pays from where a contact's decay times `tolerance^(1/8)` exceeds this: the
/// power is what the pair's steps go with. On the bench that is from dashpots of 0.6 N s/m on at 1e-3, where both take the same time (1).
const DAMPED: f64 = 0.051;
/// With losses a step is held to the accuracy asked for divided by this: errors of first peaks and their times stayed below 10 times the
/// error tolerated in a step, in chains whose losses are not stiff (150 tolerances up to 6e-5 of 20 scenes; `tests/it/losses/tolerances.rs` holds
/// runs to it) (1).
const STEP_MARGIN: f64 = 16.0;
/// The same for lossless chains under a magnet that follows its particle, where openings are not corrected: and errors were up to 23 times what a step tolerates (600 accuracies of two scenes) (1).
const UNCORRECTED_MARGIN: f64 = 48.0;
/// Up to this accuracy the pair's steps are far better than they must be (1).
const EIGHTH_ORDER_UP_TO: f64 = 6e-4;
/// Steps of two lengths are made for the accuracy asked divided by this: first peaks were off by up to 1.13 times what they are made for, in 256 scenes
/// from 2e-4 to 1e-3 (`tests/it/vector_path.rs`) (1).
const TWO_STEP_MARGIN: f64 = 2.0;
/// From this accuracy on they are the cheapest: at 1e-3 they are, at 1e-4 pairs are as cheap or cheaper (`hertzscope cost` of the
/// shipped scenes) (1).
const TWO_STEP_FROM: f64 = 2e-4;
/// A contact is loaded whose static overlap is this share of the coming impact's, or more: its frequency, which steps of two lengths go by, goes as the
/// fourth root of the overlap (1).
const LOADED: f64 = 1e-3;
/// So many contacts may not be: a striker's.
const MOST_UNLOADED: usize = 1;
/// There, they are held to so many times the accuracy (1).
const EIGHTH_ORDER_MARGIN: f64 = 3.0;
/// What [`STEP_MARGIN`] is for the implicit method: errors were up to 5.8 times what a step tolerates (Kuwabara and Kono's losses at 2e-3, 400 accuracies; overdamped
/// pulses have flat peaks, whose times were 3.2 times as far off, from 10 to 1000 N s/m) (1).
const STIFF_MARGIN: f64 = 8.0;

/// The method that serves `accuracy` (1).
pub fn method(scene: &Scene, accuracy: f64) -> Method {
    method_for(&scene.chain, &scene.initial_velocities, accuracy)
}

/// The same for a chain with these initial velocities (m/s).
pub fn method_for(chain: &Chain, velocities: &[f64], accuracy: f64) -> Method {
    let two_lengths =
        two_step(chain, accuracy / TWO_STEP_MARGIN).filter(|_| is_preloaded(chain, velocities));
    two_lengths.unwrap_or_else(|| controlled_for(chain, velocities, accuracy))
}

/// Steps of two lengths for `accuracy` (1), where they are the cheapest; none elsewhere. In a chain that is not preloaded only a reference run shows
/// whether they are as accurate.
pub fn two_step(chain: &Chain, accuracy: f64) -> Option<Method> {
    let serves = accuracy >= TWO_STEP_FROM && !chain.is_dissipative() && chain.is_plain();
    serves.then_some(Method::TwoStepForceGradient { tolerance: accuracy })
}

/// The method with error control that serves `accuracy` (1).
pub fn controlled_for(chain: &Chain, velocities: &[f64], accuracy: f64) -> Method {
    if !chain.is_dissipative() {
        return for_accuracy(if chain.is_plain() {
            accuracy
        } else {
            accuracy / UNCORRECTED_MARGIN
        });
    }
    let damping = chain.largest_damping(velocities);
    let nearly_stiff = damping > NEARLY_STIFF;
    let tolerance = accuracy / if nearly_stiff { NEARLY_STIFF_MARGIN } else { STEP_MARGIN };
    let damped = damping * tolerance.powf(0.125) > DAMPED;
    let stiff = damping > STIFF
        || (nearly_stiff && accuracy > NEARLY_STIFF_UP_TO)
        || (damped && (accuracy > LOOSE || !is_preloaded(chain, velocities)));
    if stiff {
        Method::Rodas { tolerance: accuracy / STIFF_MARGIN }
    } else {
        Method::DormandPrince853 { tolerance }
    }
}

/// The pair that serves `accuracy` without losses (1).
pub fn for_accuracy(accuracy: f64) -> Method {
    let margin = if accuracy > EIGHTH_ORDER_UP_TO { 1.0 } else { EIGHTH_ORDER_MARGIN };
    Method::DormandElMikkawyPrince86 { tolerance: margin * accuracy }
}

/// Whether contacts are preloaded, all but a striker's: they stay about as stiff as they will be at most.
fn is_preloaded(chain: &Chain, velocities: &[f64]) -> bool {
    let least = LOADED * chain.impact_overlap(velocities);
    let unloaded = |c: &&Contact| c.stiffness > 0.0 && c.static_overlap < least;
    chain.contacts().iter().filter(unloaded).nth(MOST_UNLOADED).is_none()
}

/// Refuses a method by hand that losses rule out, or that is for losses only.
///
/// # Errors
/// [`RunError`] where the method is not made for losses, or for nothing else, and where its step is too long for them.
pub fn refuse(scene: &Scene, method: Method) -> Result<(), RunError> {
    if !scene.chain.is_dissipative() {
        let refused = RunError::OnlyForLosses { method: method.name() };
        return if method.suits(false) { Ok(()) } else { Err(refused) };
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
