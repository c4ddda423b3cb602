//! Lines of the effects of sensors and scope: the chain's motion is the same, its signals are not.

use super::trial::{ChannelVolts, DRAWS, largest, of_chain, of_draws, of_electronics, of_signals};
use super::{BaselineRun, EffectFinding, EffectState, LedgerEntry};
use crate::experiment::acquisition::signals;
use crate::quantity::engineering;
use crate::scene::{Scene, Site};
use crate::scope::front_end::{NEGLIGIBLE_DELAY, bandwidth_ratio, low_pass};
use crate::scope::waveform::levels_per_division;
use crate::scope::{ChannelSetup, Deviation};
use crate::sensor::{SensorMeasurement, SensorTolerance};

/// Time constant of an open circuit: beyond any record (s).
const OPEN_CIRCUIT_TIME_CONSTANT: f64 = 1e6;
/// Criterion of the bandwidth's effect.
const CRITERION: &str =
    "a tenth of the accuracy that a record calls for; forces have no part in it";
/// Tolerance of both constants as stated by makers of piezo ceramics (1).
const MAKERS_TOLERANCE: f64 = 0.2;

/// The line of an effect that is either in the scene or in `other`.
fn either(
    subject: &BaselineRun<'_>,
    is_on: bool,
    other: &Scene,
    (value, reason): (Option<f64>, String),
) -> EffectFinding {
    let (with, without) = if is_on { (subject.scene, other) } else { (other, subject.scene) };
    let trial = Some(of_electronics(subject, with, without));
    EffectFinding {
        state: if is_on { EffectState::On } else { EffectState::Off },
        value,
        reason,
        trial,
    }
}

/// The line of an effect that chance decides: its change is what 95 % of many draws stay within.
fn drawn(
    subject: &BaselineRun<'_>,
    (is_on, other): (bool, &Scene),
    (value, reason): (Option<f64>, &str),
    redraw: fn(&mut Scene),
) -> EffectFinding {
    let reason = format!("{reason}; changes are what 95 % of {DRAWS} draws stay within");
    let mut found = either(subject, is_on, other, (value, reason));
    let pair = if is_on { (subject.scene, other) } else { (other, subject.scene) };
    found.trial = found.trial.map(|(times, _)| (times, of_draws(subject, pair, redraw)));
    found
}

/// True if a sensor is connected to the scope: electronics effects need one.
fn is_wired(scene: &Scene) -> bool {
    scene.scope.channels.iter().flatten().any(|channel| channel.input.is_some())
}

fn unwired(effect: &'static str, criterion: &'static str) -> LedgerEntry {
    let reason = "no sensor is wired to a channel".to_owned();
    EffectFinding { state: EffectState::Off, value: None, reason, trial: None }
        .entry(effect, criterion)
}

/// Digitiser levels in a channel's first peak, the fewest of all channels, from the signals as they
/// are.
fn levels_in_peak(subject: &BaselineRun<'_>) -> Option<f64> {
    let found = signals(subject.scene, &subject.bench, 1);
    let channels = subject.scene.scope.channels.iter().zip(found);
    let levels = channels.filter_map(|(channel, signal)| {
        let level = subject.scene.scope.model.level(channel.as_ref()?.vertical.scale);
        Some(signal?.into_iter().fold(f64::MIN, f64::max) / level)
    });
    levels.filter(|levels| *levels > 0.0).reduce(f64::min)
}

/// Plates off the centres of their hosts.
pub fn sensor_offset(subject: &BaselineRun<'_>) -> LedgerEntry {
    let inside = subject.scene.sensors.iter().filter(|sensor| sensor.site != Site::Wall);
    let value = largest(inside.map(|sensor| sensor.offset));
    let is_on = value.is_some_and(|value| value != 0.0);
    let mut reason = "plates sit in the centres; it needs offset in a sensor's table".to_owned();
    let mut trial = None;
    if is_on {
        let mut other = subject.scene.clone();
        other.sensors.iter_mut().for_each(|sensor| sensor.offset = 0.0);
        trial = of_chain(subject.scene, &other, subject.accuracy).ok();
        "on by the scene".clone_into(&mut reason);
    }
    let state = if is_on { EffectState::On } else { EffectState::Off };
    EffectFinding { state, value, reason, trial }
        .entry("sensor_offset", "distance from the centre / length of the particle")
}

/// The charge that leaks through plate and input.
pub fn sensor_droop(subject: &BaselineRun<'_>) -> LedgerEntry {
    let criterion = "time of the first peak's rise / shortest time constant";
    if !is_wired(subject.scene) {
        return unwired("sensor_droop", criterion);
    }
    let mut other = subject.scene.clone();
    other.sensor_tolerance = None;
    let mut shortest = f64::INFINITY;
    for channel in subject.scene.scope.channels.iter().flatten() {
        let place = other.sensors.iter().position(|s| Some(&s.name) == channel.input.as_ref());
        let Some(place) = place else { continue };
        let Some(circuit) = subject.scene.circuit(place, channel) else { continue };
        shortest = shortest.min(circuit.time_constant);
        if let Some(placed) = other.sensors.get_mut(place) {
            placed.sensor.measured = SensorMeasurement {
                sensitivity: Some(circuit.sensitivity),
                time_constant: Some(OPEN_CIRCUIT_TIME_CONSTANT),
                ..SensorMeasurement::default()
            };
        }
    }
    let watches = subject.bench.watches().iter();
    let rises = watches.filter_map(|watch| {
        let peak = watch.pulse.first_peak()?;
        Some(peak.time_s - watch.pulse.first_reach(0.1 * peak.dynamic_n)?)
    });
    let value = rises.reduce(f64::max).map(|rise| rise / shortest);
    let tau = engineering(shortest, "s", 3);
    let reason = format!("always on: charge leaks with {tau}; compared with no leak");
    either(subject, true, &other, (value, reason)).entry("sensor_droop", criterion)
}

/// Plates that differ from their data.
pub fn sensor_tolerance(subject: &BaselineRun<'_>) -> LedgerEntry {
    let criterion = "half width of d33 and permittivity";
    if !is_wired(subject.scene) {
        return unwired("sensor_tolerance", criterion);
    }
    let set = subject.scene.sensor_tolerance;
    let mut other = subject.scene.clone();
    other.sensor_tolerance = match set {
        Some(_) => None,
        None => Some(SensorTolerance {
            spread: MAKERS_TOLERANCE,
            temperature: 0.0,
            permittivity_coefficient: 0.0,
            d33_coefficient: 0.0,
        }),
    };
    let reason = match set {
        Some(_) => "on by the scene: drawn from the seed",
        None => "no table in the scene; compared with draws within the makers' 20 %",
    };
    let value = Some(set.map_or(0.0, |tolerance| tolerance.spread));
    drawn(subject, (set.is_some(), &other), (value, reason), |_| ())
        .entry("sensor_tolerance", criterion)
}

/// The front end's bandwidth.
pub fn bandwidth(subject: &BaselineRun<'_>) -> LedgerEntry {
    let scene = subject.scene;
    let criterion = "delay of the slowest channel / sample interval";
    let ratios = |scene: &Scene| -> Vec<Option<f64>> {
        let ratio = |c: &Option<_>| {
            c.as_ref().map(|c| bandwidth_ratio(&scene.scope, c, subject.bench.grid().interval))
        };
        scene.scope.channels.iter().map(ratio).collect()
    };
    let ratios = ratios(scene);
    let Some(delay) = ratios.iter().flatten().map(|ratio| 1.0 / ratio).reduce(f64::max) else {
        return unwired("bandwidth", criterion);
    };
    let mut endless = scene.clone();
    endless.scope.model.bandwidth = f64::MAX;
    endless.scope.model.limited_bandwidth = f64::MAX;
    let (times, mut change) = of_electronics(subject, scene, &endless);
    let is_on = delay > NEGLIGIBLE_DELAY;
    if !is_on {
        let off = signals(scene, &subject.bench, 1);
        let filter = |(signal, ratio): (&Option<Vec<f64>>, &Option<f64>)| {
            signal.as_ref().zip(*ratio).map(|(signal, ratio)| low_pass(signal, ratio))
        };
        let on: ChannelVolts = off.iter().zip(&ratios).map(filter).collect();
        change = of_signals(subject, &on, &off);
    }
    let reason = if is_on {
        format!("on: the delay is above {NEGLIGIBLE_DELAY} of a sample interval, {CRITERION}")
    } else {
        format!("off: the delay is below {NEGLIGIBLE_DELAY} of a sample interval, {CRITERION}")
    };
    let times = if is_on { times } else { None };
    let found = EffectFinding {
        state: EffectState::Auto,
        value: Some(delay),
        reason,
        trial: Some((times, change)),
    };
    LedgerEntry { active: is_on, ..found.entry("bandwidth", criterion) }
}

/// Volts that the scene adds to a channel.
pub fn scope_offset(subject: &BaselineRun<'_>) -> LedgerEntry {
    let channels = subject.scene.scope.channels.iter().flatten();
    let level = |channel: &ChannelSetup| subject.scene.scope.model.level(channel.vertical.scale);
    let value = largest(channels.map(|channel| channel.offset / level(channel)));
    let is_on = value.is_some_and(|value| value != 0.0);
    let finding = if is_on {
        let mut other = subject.scene.clone();
        other.scope.channels.iter_mut().flatten().for_each(|channel| channel.offset = 0.0);
        either(subject, true, &other, (value, "on by the scene".to_owned()))
    } else {
        let reason = "no channel has one; it needs offset in a channel's table".to_owned();
        EffectFinding { state: EffectState::Off, value, reason, trial: None }
    };
    finding.entry("scope_offset", "offset / digitiser level")
}

/// Errors of gain and zero within the data sheet.
pub fn scope_errors(subject: &BaselineRun<'_>) -> LedgerEntry {
    let scene = subject.scene;
    let is_off = |deviation: Deviation| deviation == Deviation::default();
    let is_on = scene.scope.channels.iter().flatten().any(|c| !is_off(c.deviation));
    let mut other = scene.clone();
    if is_on {
        let channels = other.scope.channels.iter_mut().flatten();
        channels.for_each(|channel| channel.deviation = Deviation::default());
    } else {
        draw_deviations(&mut other);
    }
    let (model, channels) = (&scene.scope.model, scene.scope.channels.iter().flatten());
    let gains = channels.map(|c| model.accuracy.gain_at(c.vertical.scale / c.vertical.probe));
    let reason = if is_on {
        "on by the scene: drawn from the seed"
    } else {
        "no table in the scene; compared with draws within the data sheet"
    };
    let value = gains.reduce(f64::max);
    drawn(subject, (is_on, &other), (value, reason), draw_deviations)
        .entry("scope_errors", "largest gain error in the data sheet")
}

/// Draws gain and zero of all channels by the scene's seed.
fn draw_deviations(scene: &mut Scene) {
    for (number, channel) in (1..).zip(&mut scene.scope.channels) {
        if let Some(channel) = channel {
            channel.deviation = Deviation::drawn(scene.seed, number);
        }
    }
}

/// Noise of the front end.
pub fn scope_noise(subject: &BaselineRun<'_>) -> LedgerEntry {
    let noise = subject.scene.scope.noise;
    let value = Some(noise * levels_per_division(subject.scene.scope.model.bits));
    let finding = if noise > 0.0 {
        let mut other = subject.scene.clone();
        other.scope.noise = 0.0;
        drawn(subject, (true, &other), (value, "on by the scene: drawn from the seed"), |_| ())
    } else {
        let reason = "no table in the scene; it needs rms".to_owned();
        EffectFinding { state: EffectState::Off, value, reason, trial: None }
    };
    finding.entry("scope_noise", "noise, root mean square / digitiser level")
}

/// The converter's levels.
pub fn quantisation(subject: &BaselineRun<'_>) -> LedgerEntry {
    let off = signals(subject.scene, &subject.bench, 1);
    let rounded = |(signal, channel): (&Option<Vec<f64>>, &Option<ChannelSetup>)| {
        let level = subject.scene.scope.model.level(channel.as_ref()?.vertical.scale);
        Some(signal.as_ref()?.iter().map(|volts| (volts / level).round() * level).collect())
    };
    let on: ChannelVolts = off.iter().zip(&subject.scene.scope.channels).map(rounded).collect();
    let change = of_signals(subject, &on, &off);
    let value = levels_in_peak(subject).map(f64::recip);
    let levels = levels_per_division(subject.scene.scope.model.bits);
    let reason = format!("always on: a record is made of levels, {levels} a division");
    EffectFinding { state: EffectState::On, value, reason, trial: Some((None, change)) }
        .entry("quantisation", "digitiser level / smallest channel's peak")
}
