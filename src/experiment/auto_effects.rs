//! Effects left to the accuracy, `state = "auto"`: off only where what they would change is below a
//! tenth of it.
//!
//! The change is bounded from above by closed forms, before anything is run; `tests/it/effects.rs`
//! holds them against runs. A loss takes at most `lambda T` of any velocity, `lambda` the fastest
//! decay of the chain with this loss alone, `T` the scene's duration, and 6/5 of that of a force.
//! It is felt itself, too: a contact that closes at `w` pushes back by `c w` from the start, `c`
//! the loss's slope, against the force `F` that it comes to, `c w/F = sqrt(6/5) c/(m omega)` by the
//! energy of a Hertz collision; the tenth of the rise is reached sooner by ten times that share at
//! most. Bodies close at no more than the largest difference of the initial velocities, times what
//! collisions with ever lighter ones add to a speed: `2 m/(m + m')` from each to the next. Gravity
//! changes stiffness, and with it forces and times, by at most the share of the chain's weight in
//! what presses the chain without it, and the striker's speed by at most `g T`. A magnet of slope
//! `k` that follows a particle of mass `m` changes its force by at most `k` times the particle's
//! travel, a share of the static force, and its motion by at most the share `k T^2/m`.

use std::borrow::Cow;

use super::Integration;
use super::pulse::FOOT_SHARE;
use crate::chain::{Chain, ChainSpec, EffectsSpec, LossKind};
use crate::note::Note;
use crate::scene::Scene;

/// Places on either side of rest at which the magnet's slope is looked at.
const SLOPE_SAMPLES: i32 = 500;
/// Share of the accuracy that an effect may change and yet be left out (1).
const NEGLIGIBLE_SHARE: f64 = 0.1;
/// Forces of Hertz collisions go as this power of their speed (1).
const FORCE_SPEED_EXPONENT: f64 = 1.2;
/// Pulses fade on their way, and losses weigh more in slow collisions, if at all: looked at down to
/// this share of the fastest (1).
const MIN_SPEED_SHARE: f64 = 0.1;

/// `scene` with all that it leaves to the accuracy decided, and noted. A method by hand has no
/// accuracy: all stay on.
pub fn resolve_auto_effects(scene: &Scene, integration: Integration) -> Cow<'_, Scene> {
    if scene.auto.is_empty() {
        return Cow::Borrowed(scene);
    }
    let mut settled = scene.clone();
    for name in std::mem::take(&mut settled.auto) {
        let Integration::Accuracy(accuracy) = integration else {
            let sentence = format!("{name} is on: state = \"auto\" needs an accuracy, not a step");
            settled.notes.push(Note::new("auto_effect", sentence).with("effect", name));
            continue;
        };
        let change = change_upper_bound(scene, name);
        let limit = NEGLIGIBLE_SHARE * accuracy;
        if change < limit {
            settled.spec.effects.remove(name);
        }
        let note = Note::new("auto_effect", describe_decision(name, change, limit));
        let note = note.with("effect", name).with("largest_change", change).with("limit", limit);
        settled.notes.push(note);
    }
    if settled.spec != scene.spec
        && let Ok(chain) = Chain::new(&settled.spec)
    {
        settled.chain = chain.with_indentations(&scene.chain.indentations_at_rest());
    }
    Cow::Owned(settled)
}

/// The decision in words.
fn describe_decision(name: &str, change: f64, limit: f64) -> String {
    if name == "plasticity" && change == 0.0 {
        "plasticity is off: no contact can reach the force at which it yields".to_owned()
    } else if name == "plasticity" {
        "plasticity is on: a contact may reach the force at which it yields, or has".to_owned()
    } else if change.is_infinite() {
        format!("{name} is on: its change has no known upper bound")
    } else if change < limit {
        format!(
            "{name} is off: it would change readings by less than {change:.1e}, a tenth of the accuracy is {limit:.1e}"
        )
    } else {
        format!(
            "{name} is on: it may change readings by up to {change:.1e}, a tenth of the accuracy is {limit:.1e}"
        )
    }
}

/// States whether the effect called `name` is on at `accuracy` (1), and the change that decides it.
pub(crate) fn decision(scene: &Scene, name: &str, accuracy: f64) -> String {
    describe_decision(name, change_upper_bound(scene, name), NEGLIGIBLE_SHARE * accuracy)
}

/// The most that the effect called `name` can change of first peaks, arrivals and speeds; infinite
/// where that is not known (1).
pub fn change_upper_bound(scene: &Scene, name: &str) -> f64 {
    match name {
        "gravity" => by_gravity(scene),
        "magnet_law" => by_magnet_law(scene),
        "plasticity" => by_plasticity(scene),
        // What a drive will do to the chain is not bounded here.
        _ if scene.chain.has_moving_walls() => f64::INFINITY,
        _ => LossKind::named(name).map_or(f64::INFINITY, |kind| by_loss(scene, kind)),
    }
}

fn by_gravity(scene: &Scene) -> f64 {
    let Some(gravity) = scene.spec.effects.gravity else { return 0.0 };
    let mut spec = scene.spec.clone();
    spec.effects.gravity = None;
    // Where nothing holds the chain without it, everything hangs on it.
    let Ok(without) = Chain::new(&spec) else { return f64::INFINITY };
    let first = usize::from(without.has_striker());
    let contacts = without.contacts().iter().skip(first + 1).filter(|c| c.stiffness > 0.0);
    let presses = contacts.map(|c| c.static_force).fold(f64::INFINITY, f64::min);
    let mass: f64 = spec.particles.iter().map(|body| body.mass).sum();
    let weight = mass * gravity.acceleration.abs() / presses;
    let speed = scene.initial_velocities.first().map_or(0.0, |v| v.abs());
    let striker = if without.has_striker() {
        gravity.acceleration.abs() * scene.duration / speed
    } else {
        0.0
    };
    weight + striker
}

/// Nothing, if no contact can reach the force at which it yields: not even with all energy in it,
/// that of motion, of the static overlaps and of all weights falling at the largest speed. Infinite
/// otherwise (1).
fn by_plasticity(scene: &Scene) -> f64 {
    let chain = &scene.chain;
    let is_indented = chain.contacts().iter().any(|contact| contact.indented > 0.0);
    if is_indented || chain.has_moving_walls() || chain.pull().is_some() {
        return f64::INFINITY;
    }
    let energy = chain.energy(&chain.initial_state(&scene.initial_velocities));
    let gravity = scene.spec.effects.gravity.map_or(0.0, |gravity| gravity.acceleration.abs());
    let weight = gravity * chain.bodies().iter().map(|body| body.mass).sum::<f64>();
    let fastest = scene.initial_velocities.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let falls = (fastest + gravity * scene.duration) * scene.duration;
    let available = energy.kinetic + energy.elastic + weight * falls;
    let may_yield = chain.contacts().iter().any(|contact| {
        // `E = 2/5 A d^2.5`.
        let overlap = (2.5 * available / contact.stiffness).powf(0.4);
        contact.plastic.is_some_and(|law| overlap > law.first_overlap())
    });
    if may_yield { f64::INFINITY } else { 0.0 }
}

fn by_magnet_law(scene: &Scene) -> f64 {
    let Some((body, pull)) = scene.chain.pull() else { return 0.0 };
    let (Some(body), Some(magnet)) = (scene.chain.bodies().get(body), scene.chain.magnet()) else {
        return f64::INFINITY;
    };
    let fastest = scene.initial_velocities.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    // No body of an elastic collision leaves it at more than twice the speed of the one that came.
    let reach = 2.0 * fastest * scene.duration;
    let slope = |look: i32| pull.slope(reach * f64::from(look) / f64::from(SLOPE_SAMPLES)).abs();
    let steepest = (-SLOPE_SAMPLES..=SLOPE_SAMPLES).map(slope).fold(0.0, f64::max);
    steepest * (reach / magnet.force + scene.duration * scene.duration / body.mass)
}

fn by_loss(scene: &Scene, kind: LossKind) -> f64 {
    let all = &scene.spec.effects;
    let mut effects = EffectsSpec::default();
    effects.losses[kind as usize] = all.loss(kind).cloned();
    effects.gravity = all.gravity;
    effects.magnet_preload.clone_from(&all.magnet_preload);
    let spec = ChainSpec { effects, ..scene.spec.clone() };
    let Ok(chain) = Chain::new(&spec) else { return f64::INFINITY };
    let fastest = closing_speed(&chain, &scene.initial_velocities);
    let speeds = [MIN_SPEED_SHARE * fastest, fastest];
    let most = |of: &dyn Fn(f64) -> f64| speeds.into_iter().map(of).fold(0.0, f64::max);
    let decay = most(&|speed| chain.fastest_decay(&[speed]));
    let felt = FORCE_SPEED_EXPONENT.sqrt() * most(&|speed| chain.largest_damping(&[speed]));
    FORCE_SPEED_EXPONENT * decay * scene.duration + felt / FOOT_SHARE
}

/// The fastest that contacts of `chain` close, let go at `velocities` (m/s) (m/s).
fn closing_speed(chain: &Chain, velocities: &[f64]) -> f64 {
    let ends = |(low, high): (f64, f64), v: &f64| (v.min(low), v.max(high));
    let (low, high) = velocities.iter().fold((0.0, 0.0), ends);
    let masses: Vec<f64> = chain.bodies().iter().map(|body| body.mass).collect();
    let gain = |pairs: &mut dyn Iterator<Item = (f64, f64)>| {
        let gains = pairs.scan(1.0_f64, |run, (from, to)| {
            *run = run.max(1.0) * 2.0 * from / (from + to);
            Some(*run)
        });
        gains.fold(1.0, f64::max)
    };
    let down = gain(&mut masses.windows(2).map(|two| (two[0], two[1])));
    let up = gain(&mut masses.windows(2).rev().map(|two| (two[1], two[0])));
    (high - low) * down.max(up)
}
