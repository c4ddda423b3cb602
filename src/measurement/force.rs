//! Tells a recording which sensor was wired to a channel, and turns its volts into newtons.
//!
//! `N = (V + (1/tau) integral V dt)/S`. The standard uncertainty of each value is put together from
//! the sensitivity's, the time constant's (`u(tau)/tau` times what droop took away), the scope's
//! gain, the baseline's and the noise's, the latter two grown by the inverse filter. Source: JCGM
//! 100:2008, 5.1.2. Valid from a start at rest and discharged.

use std::collections::BTreeMap;

use super::metadata::{self, RecordedSensor};
use crate::analysis::droop::{error_gain, undo_coupling};
use crate::analysis::pulse::{Conditions, Pulse, PulseError};
use crate::numeric::intervals::expanded_95;
use crate::recording::{Capture, Shot, TraceSet};
use crate::scene::{Scene, SceneError, gain_u, input_load};
use crate::scope::front_end::ac_time_constant;
use crate::scope::{ChannelSetup, Coupling, Deviation, VerticalSetup};
use crate::sensor::{InChain, Sensor};
use crate::trace::Trace;

/// Where the limits of the scope's input are taken from.
const BENCH: &str = "momentum-test";

/// Forces of one channel.
#[derive(Debug, Clone, PartialEq)]
pub struct Forces {
    /// The channel.
    pub channel: String,
    /// The sensor.
    pub sensor: RecordedSensor,
    /// Force over time.
    pub force: Trace,
    /// Standard uncertainty of each value (N).
    pub u: Vec<f64>,
    /// Expanded uncertainty of each value for 95 % (N).
    pub expanded: Vec<f64>,
    /// The same without what is common to all values: noise alone (N).
    pub noise_u: Vec<f64>,
    /// Samples at the converter's ends, where the true force is larger.
    pub clipped: usize,
    /// Place of the first of them; from there on no uncertainty holds.
    pub first_clipped: Option<usize>,
}

/// Why a channel has no forces.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ForcesError {
    /// No sensor is known, or it is not known how sensitive it is.
    #[error(
        "{channel}: no sensor with sensitivity and time constant is known: give one with --sensor {channel}=NAME or FILE, or the bench with --scene"
    )]
    NoSensor {
        /// The channel.
        channel: String,
    },
    /// A record of something else than volts or newtons.
    #[error("{channel}: the record is in {unit}: forces are made from volts")]
    NotVolts {
        /// The channel.
        channel: String,
        /// The unit of its values.
        unit: String,
    },
    /// A record over frequency.
    #[error("{channel}: found a record over frequency, expected one over time")]
    NoTime {
        /// The channel.
        channel: String,
    },
    /// Nothing to take the baseline from.
    #[error(transparent)]
    Pulse(#[from] PulseError),
}

/// Notes in `set` that `sensor` was wired to `channel`; what was noted of that channel before is
/// gone.
///
/// # Errors
/// [`SceneError`] where the scope's description cannot be read.
pub fn wire(set: &mut TraceSet, channel: &str, sensor: &Sensor) -> Result<(), SceneError> {
    let model = Scene::load(BENCH)?.scope.model;
    let captures = || set.shots.iter().flat_map(|shot| &shot.captures);
    let named = captures().find(|c| c.waveform.source.to_string().eq_ignore_ascii_case(channel));
    let Some(vertical) = named.map(|capture| capture.waveform.vertical) else { return Ok(()) };
    let deviation = Deviation::default();
    let setup = ChannelSetup { vertical, input: None, offset: 0.0, deviation };
    let circuit = sensor.connect(input_load(&model, &setup));
    let channel = channel.to_ascii_uppercase();
    // Where it sits stays.
    let before = set
        .metadata
        .iter()
        .find(|(name, facts)| name.contains("sensor/") && facts.get("channel") == Some(&channel));
    let place = before.map(|(_, facts)| facts.clone()).unwrap_or_default();
    let place =
        ["site", "offset", "offset_u"].map(|key| place.get(key).map(|it| (key, it.clone())));
    set.metadata
        .retain(|name, facts| !name.contains("sensor/") || facts.get("channel") != Some(&channel));
    let mut facts = vec![
        ("name", sensor.model.clone()),
        ("model", sensor.model.clone()),
        ("channel", channel.clone()),
        ("sensitivity_v_per_n", circuit.sensitivity.to_string()),
        ("time_constant_s", circuit.time_constant.to_string()),
    ];
    facts.extend(place.into_iter().flatten());
    facts.extend(sensor.calibrated_host.clone().map(|host| ("calibrated_host", host)));
    facts.extend(sensor.measured.chain.into_iter().flat_map(InChain::facts));
    let measured = &sensor.measured;
    let uncertainty = |key, value: Option<f64>| value.map(|value| (key, value.to_string()));
    facts.extend(uncertainty("sensitivity_u_relative", measured.sensitivity_u));
    facts.extend(uncertainty("time_constant_u_relative", measured.time_constant_u));
    let facts: BTreeMap<String, String> =
        facts.into_iter().map(|(key, value)| (key.to_owned(), value)).collect();
    let shots = set.shots.iter().map(|shot| format!("hertzscope:shot/{}", shot.number));
    let own = shots.filter(|name| set.metadata.contains_key(name));
    let groups: Vec<String> = own
        .map(|shot| format!("{shot}/sensor/{channel}"))
        .chain([format!("hertzscope:sensor/{channel}")])
        .collect();
    for group in groups {
        set.metadata.insert(group, facts.clone());
    }
    count_gains(set)
}

/// Notes in `set` how well the gain of each sensor's channel is known, unless its scope is exact.
///
/// # Errors
/// As [`wire`].
pub fn count_gains(set: &mut TraceSet) -> Result<(), SceneError> {
    if metadata::is_scope_exact(set) {
        return Ok(());
    }
    let model = Scene::load(BENCH)?.scope.model;
    let captures = set.shots.iter().flat_map(|shot| &shot.captures);
    let verticals: BTreeMap<String, VerticalSetup> =
        captures.map(|c| (c.waveform.source.to_string(), c.waveform.vertical)).collect();
    let sensors = set.metadata.iter_mut().filter(|(name, _)| name.contains("sensor/"));
    for (_, facts) in sensors {
        let Some((channel, vertical)) =
            facts.get("channel").and_then(|channel| verticals.get_key_value(channel))
        else {
            continue;
        };
        let number = channel.trim_start_matches("CH").parse().unwrap_or(0);
        let gain = gain_u(&model, number, vertical, InChain::of_facts(facts));
        facts.insert("gain_u_relative".to_owned(), gain.to_string());
    }
    Ok(())
}

/// The trace of `capture` with AC coupling undone, where the recording states it; none of a record
/// over frequency.
pub fn uncoupled(capture: &Capture) -> Option<Trace> {
    let trace = capture.trace()?;
    let vertical = &capture.waveform.vertical;
    if vertical.coupling != Some(Coupling::Ac) {
        return Some(trace);
    }
    let model = Scene::load(BENCH).ok()?.scope.model;
    Some(undo_coupling(trace, ac_time_constant(&model, vertical)))
}

/// Forces of all channels of `shot`, or why they cannot be computed.
pub fn forces(set: &TraceSet, shot: &Shot) -> Vec<Result<Forces, ForcesError>> {
    let sensors = metadata::sensors_of(set, shot.number);
    shot.captures.iter().map(|capture| of_channel(capture, &sensors)).collect()
}

fn of_channel(capture: &Capture, sensors: &[RecordedSensor]) -> Result<Forces, ForcesError> {
    let channel = capture.waveform.source.to_string();
    let clipped = capture.waveform.clipped();
    let first_clipped = capture.waveform.clipped_points().next();
    match capture.waveform.preamble.y_unit.as_str() {
        "V" | "dB" => {}
        "N" => return of_newtons(capture, channel),
        unit => return Err(ForcesError::NotVolts { channel, unit: unit.to_owned() }),
    }
    let sensor = sensors.iter().find(|sensor| sensor.channel.as_ref() == Some(&channel));
    let circuit = sensor.and_then(|s| Some((s, s.sensitivity?, s.time_constant?)));
    let Some((sensor, sensitivity, tau)) = circuit else {
        return Err(ForcesError::NoSensor { channel });
    };
    let Some(record) = uncoupled(capture) else { return Err(ForcesError::NoTime { channel }) };
    let level = capture.waveform.preamble.y_mult.abs();
    let pulse = Pulse::find(&record, Conditions { level, ..Conditions::default() })?;
    let (volts, _) = pulse.baseline.take_from(&record, None);
    let (felt, modes) = pulse.baseline.take_from(&record, Some(tau));
    let start = pulse.baseline.end;
    let (scale_u, tau_u) = (sensor.scale_u(), sensor.time_constant_u.unwrap_or(0.0));
    let (interval, limit) = (felt.interval, sensor.gain_half_width());
    let (mut u, mut expanded, mut noise_u) = (Vec::new(), Vec::new(), Vec::new());
    for (index, (felt, volts)) in felt.values.iter().zip(&volts.values).enumerate() {
        let gain = error_gain(index.saturating_sub(start), interval, tau);
        let noise = gain.noise * pulse.noise;
        let zero: f64 = modes.iter().filter_map(|mode| mode.get(index)).map(|m| m * m).sum();
        let rest = [felt * scale_u, (felt - volts) * tau_u, zero.sqrt()];
        noise_u.push(noise / sensitivity);
        let whole = rest.iter().fold(noise, |sum, part| sum.hypot(*part)) / sensitivity;
        expanded.push(expanded_95(whole, felt.abs() * limit / sensitivity));
        u.push(whole);
    }
    let values = felt.values.iter().map(|v| v / sensitivity).collect();
    let name = format!("{channel}, sensor {}", sensor.name);
    let force = Trace { name, unit: "N".to_owned(), values, ..felt };
    let sensor = sensor.clone();
    Ok(Forces { channel, sensor, force, u, expanded, noise_u, clipped, first_clipped })
}

/// A record that is in newtons already, as it stands; only its noise is known.
fn of_newtons(capture: &Capture, channel: String) -> Result<Forces, ForcesError> {
    let Some(force) = capture.trace() else { return Err(ForcesError::NoTime { channel }) };
    let level = capture.waveform.preamble.y_mult.abs();
    let noise = Pulse::find(&force, Conditions { level, ..Conditions::default() })?.noise;
    let u = vec![noise; force.values.len()];
    let expanded = u.iter().map(|u| expanded_95(*u, 0.0)).collect();
    let sensor = RecordedSensor {
        name: "in newtons".to_owned(),
        channel: Some(channel.clone()),
        place: None,
        gain_u: 0.0,
        chain: None,
        sensitivity: None,
        sensitivity_u: None,
        time_constant: None,
        time_constant_u: None,
        calibrated_host: None,
    };
    let clipped = capture.waveform.clipped();
    let first_clipped = capture.waveform.clipped_points().next();
    let noise_u = u.clone();
    Ok(Forces { channel, sensor, force, u, expanded, noise_u, clipped, first_clipped })
}
