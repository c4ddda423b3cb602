//! Arrivals and speeds read off a recording's captures, in the words of `arrivals --json`: names
//! and units are part of the interface.

use crate::quantity::{Uncertain, engineering};
use serde::Serialize;

use super::force::uncoupled;
use super::metadata::{self, RecordedDistance, RecordedSensor};
use crate::analysis::arrival::Estimator;
use crate::analysis::correlation::delay;
use crate::analysis::disturbance::Disturbance;
use crate::analysis::pulse::{Conditions, Pulse};
use crate::analysis::speed::{speed, speed_over};
use crate::recording::{Capture, Shot, TraceSet};
use crate::scene::{PlatePlace, Scene, Site};
use crate::scope::Waveform;
use crate::trace::Trace;

/// Why there are no speeds, and what to do.
const NO_DISTANCES: &str = "no speeds: no distances are known; give --scene NAME, or --distance CH1-CH2=\"47.2 mm +- 0.1 mm\"";

/// Note on forces of `channels` whose sensors' sensitivities have no known uncertainty.
pub fn sensitivities_unknown(channels: &[&str]) -> String {
    format!(
        "{}: the uncertainty of the sensitivity is unknown, ± and U95 of forces do not include it: calibrate the sensor",
        channels.join(", ")
    )
}

/// A pulse smaller than this share of the largest value is not counted (1).
const MIN_PULSE_SHARE: f64 = 0.05;

/// Samples on either side of the trigger over which the slope is taken there.
const SLOPE_SAMPLES: f64 = 3.0;
/// A change over these samples by this many standard deviations of noise is a slope: two samples
/// differ by 1.4 of one (1).
const MIN_SLOPE_DEVIATIONS: f64 = 5.0;

/// Estimators that differ by more than this share of the speed are noted, where it is more than
/// their uncertainties (1).
const DIFFERENT_SPEEDS: f64 = 0.1;

/// An arrival by one estimator.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Arrival {
    /// `half_rise`, `peak`, `ten_percent` or `maximum_slope`.
    pub estimator: &'static str,
    /// Time after the crossing of the trigger's level, which lies within the sample interval before
    /// the record's zero, seconds; none if it is not determined.
    pub time_s: Option<Uncertain>,
}

/// Arrivals at one channel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChannelArrivals {
    /// `CH1`.
    pub channel: String,
    /// Name of the sensor, if the recording states it.
    pub sensor: Option<String>,
    /// Whether the sensor's droop was undone; arrivals of a drooping signal are off by more than is
    /// stated.
    pub droop_undone: bool,
    /// Samples at the converter's ends; a clipped peak is no peak.
    pub clipped: usize,
    /// Unit of the channel's values, and of `noise` and `height`.
    pub unit: String,
    /// Standard deviation of one sample (unit).
    pub noise: Option<f64>,
    /// Height of the first peak, in the channel's unit.
    pub height: Option<Uncertain>,
    /// Standard deviation of one sample of a channel in volts (V).
    pub noise_v: Option<f64>,
    /// Height of the first peak of a channel in volts.
    pub height_v: Option<Uncertain>,
    /// The same as a force, newtons, if the sensitivity is known.
    pub height_n: Option<Uncertain>,
    /// Full width at half of the first peak, seconds.
    pub width_s: Option<Uncertain>,
    /// Pulses in the record higher than a twentieth of the highest.
    pub pulses: Option<usize>,
    /// Arrivals by each estimator.
    pub arrivals: Vec<Arrival>,
    /// Why no pulse was found.
    pub problem: Option<String>,
}

/// The speed between two channels' sensors.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpeedBetween {
    /// Channel from which.
    pub from: String,
    /// Channel to which.
    pub to: String,
    /// Distance of the plates along the chain at rest (m).
    pub distance_m: f64,
    /// Its standard uncertainty, as given or from the scene's uncertain diameters and offsets (m).
    pub distance_u_m: f64,
    /// The arrival's estimator, or `cross_correlation`.
    pub estimator: &'static str,
    /// Speed, metres per second.
    pub m_per_s: Uncertain,
}

/// How much lower the first peak is from one channel's sensor to the next in a host of the same
/// kind: a plate in a heavy host feels another share of the same pulse than one in a light host.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Decay {
    /// Channel from which.
    pub from: String,
    /// Channel to which.
    pub to: String,
    /// Height there over height here, both as forces.
    pub ratio: Uncertain,
    /// Natural logarithm of the loss over the distance; none where that is not known (1/m).
    pub per_metre: Option<Uncertain>,
}

/// Arrivals, speeds and decay of a shot.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Survey {
    /// Number of the shot.
    pub shot: u32,
    /// One a channel.
    pub channels: Vec<ChannelArrivals>,
    /// Speeds between neighbouring sensors, from the top.
    pub speeds: Vec<SpeedBetween>,
    /// Decay of the first peak from sensor to sensor in hosts of one kind, from the top.
    pub decays: Vec<Decay>,
    /// Notes on missing values.
    pub notes: Vec<String>,
}

/// Reads arrivals and speeds off `shot` of `set`.
pub fn survey(set: &TraceSet, shot: &Shot) -> Survey {
    let sensors = metadata::sensors_of(set, shot.number);
    let distances = metadata::distances(set);
    let mut notes = Vec::new();
    let scene = scene(set, shot, &distances, &mut notes);
    let mut read: Vec<ReadChannel<'_>> =
        shot.captures.iter().map(|capture| ReadChannel::new(capture, &sensors)).collect();
    count_from_trigger(&mut read);
    notes.extend(read.iter().flat_map(|channel| channel.notes(scene.as_ref())));
    notes.extend(unknown_facts(&read));
    let mut placed: Vec<PlacedPulse<'_>> = read.iter().filter_map(ReadChannel::placed).collect();
    sort_down(&mut placed, |placed| placed.place);
    let mut speeds = measured_speeds(&distances, &read);
    let of_scene = scene.as_ref().map(|scene| scene_speeds(scene, &placed, &distances));
    speeds.extend(of_scene.into_iter().flatten());
    notes.extend(changes_of_shape(&speeds));
    let decays = scene.as_ref().map_or_else(Vec::new, |scene| decays(scene, &placed));
    let channels = read.into_iter().map(|channel| channel.arrivals).collect();
    Survey { shot: shot.number, speeds, decays, channels, notes }
}

/// The scene of `shot`, or a note why distances are not known.
fn scene(
    set: &TraceSet,
    shot: &Shot,
    distances: &[RecordedDistance],
    notes: &mut Vec<String>,
) -> Option<Scene> {
    match metadata::scene_of(set, shot.number) {
        Some(Ok(scene)) => return Some(scene),
        Some(Err(error)) => {
            notes.push(format!("no distances: the recording's scene cannot be read: {error}"));
        }
        None if distances.is_empty() => notes.push(NO_DISTANCES.to_owned()),
        None => {}
    }
    None
}

/// A channel with its sensor and its first pulse.
struct ReadChannel<'a> {
    arrivals: ChannelArrivals,
    sensor: Option<&'a RecordedSensor>,
    pulse: Option<Pulse>,
    is_over_time: bool,
}

/// Standard uncertainty of the time at which the trigger's level was crossed, and the half-width of
/// its evenly distributed part (s), in a shot with these pulses.
///
/// The crossing lies within the sample interval before the record's zero, on average in its middle,
/// but for the noise on the trigger's signal: noise over slope of the signal that is steepest there
/// against its noise. Without any such signal the trigger is another one's, and the interval counts
/// either way.
pub(super) fn trigger_u<'p>(interval: f64, pulses: impl Iterator<Item = &'p Pulse>) -> (f64, f64) {
    let jitter = |pulse: &Pulse| {
        let signal = &pulse.signal;
        let zero = (-signal.start / signal.interval).round();
        let at = |index: f64| signal.values.get(index as usize).copied();
        let change = (at(zero + SLOPE_SAMPLES - 1.0)? - at(zero - SLOPE_SAMPLES)?).abs();
        let is_steep = zero >= SLOPE_SAMPLES && change > MIN_SLOPE_DEVIATIONS * pulse.noise;
        let span = (2.0 * SLOPE_SAMPLES - 1.0) * signal.interval;
        is_steep.then(|| pulse.noise * span / change)
    };
    match pulses.filter_map(jitter).reduce(f64::min) {
        Some(jitter) => (jitter.hypot(interval / 12f64.sqrt()), 0.5 * interval),
        None => (interval / 3f64.sqrt(), interval),
    }
}

/// Counts arrivals from the crossing of the trigger's level instead of from the records' zero.
fn count_from_trigger(read: &mut [ReadChannel<'_>]) {
    let Some(interval) = read.iter().find_map(|c| Some(c.pulse.as_ref()?.signal.interval)) else {
        return;
    };
    let (u, half_width) = trigger_u(interval, read.iter().filter_map(|c| c.pulse.as_ref()));
    let arrivals = read.iter_mut().flat_map(|channel| &mut channel.arrivals.arrivals);
    for time in arrivals.filter_map(|arrival| arrival.time_s.as_mut()) {
        let value = time.value + 0.5 * interval;
        *time = Uncertain { value, u: time.u.hypot(u), half_width };
    }
}

/// A pulse and the place of its sensor.
struct PlacedPulse<'a> {
    channel: &'a str,
    place: PlatePlace,
    pulse: &'a Pulse,
    force: Option<Uncertain>,
}

impl<'a> ReadChannel<'a> {
    fn new(capture: &Capture, sensors: &'a [RecordedSensor]) -> Self {
        let name = capture.waveform.source.to_string();
        let sensor = sensors.iter().find(|sensor| sensor.channel.as_ref() == Some(&name));
        let (arrivals, pulse) = channel(capture, sensor);
        let is_over_time = capture.waveform.preamble.x_unit == "s";
        Self { arrivals, sensor, pulse, is_over_time }
    }

    /// What its sensor's gain and host add, and what disturbs it.
    fn notes(&self, scene: Option<&Scene>) -> Vec<String> {
        let disturbance = self.pulse.as_ref().and_then(|p| p.baseline.disturbance.as_ref());
        let found = disturbance.and_then(Disturbance::note);
        let found = found.map(|note| format!("{}: {note}", self.arrivals.channel));
        let found = found.into_iter().chain(self.missing_arrivals());
        let Some(sensor) = self.sensor else { return found.collect() };
        if self.is_over_time && self.arrivals.unit != "V" {
            let (channel, unit) = (&self.arrivals.channel, &self.arrivals.unit);
            let unused = sensor.sensitivity.map(|_| {
                format!(
                    "{channel}: the record is in {unit}: the sensitivity of {}, in volts, is not used",
                    sensor.name
                )
            });
            return unused.into_iter().chain(found).collect();
        }
        let host = scene.and_then(|scene| sensor.host_note(scene));
        sensor.gain_note().into_iter().chain(host).chain(found).collect()
    }

    /// Why a pulse has no arrival by some estimators.
    fn missing_arrivals(&self) -> Option<String> {
        let pulse = self.pulse.as_ref()?;
        let height = pulse.height()?;
        let missing: Vec<String> = Estimator::ALL
            .into_iter()
            .filter(|estimator| pulse.arrival(*estimator).is_none())
            .map(|estimator| estimator.to_string())
            .collect();
        let unit = &pulse.signal.unit;
        (!missing.is_empty()).then(|| {
            format!(
                "{}: no arrival by {}: the noise of {} hides it in a pulse of {}; take averages or fewer volts a division",
                self.arrivals.channel,
                missing.join(", "),
                engineering(pulse.noise, unit, 2),
                engineering(height.value, unit, 3)
            )
        })
    }

    fn placed(&self) -> Option<PlacedPulse<'_>> {
        let channel = self.arrivals.channel.as_str();
        let (pulse, force) = (self.pulse.as_ref()?, self.arrivals.height_n);
        Some(PlacedPulse { channel, place: self.sensor?.place?, pulse, force })
    }
}

/// Notes on sensitivities without uncertainty, and on time constants that are not known.
fn unknown_facts(read: &[ReadChannel<'_>]) -> Vec<String> {
    let is_unknown = |channel: &&ReadChannel<'_>| {
        let is_known = channel.sensor.is_some_and(|sensor| sensor.sensitivity_u.is_some());
        channel.arrivals.height_n.is_some() && !is_known
    };
    let unknown: Vec<&str> =
        read.iter().filter(is_unknown).map(|channel| channel.arrivals.channel.as_str()).collect();
    let mut notes = Vec::new();
    if !unknown.is_empty() {
        notes.push(sensitivities_unknown(&unknown));
    }
    if read.iter().any(|channel| channel.is_over_time && !channel.arrivals.droop_undone) {
        notes.push(
            "a sensor's time constant is not known: its droop moves arrivals by more than is stated"
                .to_owned(),
        );
    }
    notes
}

/// Speeds over distances that the recording states.
fn measured_speeds(distances: &[RecordedDistance], read: &[ReadChannel<'_>]) -> Vec<SpeedBetween> {
    let pulse =
        |channel: &str| read.iter().find(|read| read.arrivals.channel == channel)?.pulse.as_ref();
    let speeds = |known: &RecordedDistance| {
        let start = (known.from.as_str(), pulse(&known.from)?);
        Some(between(known.distance, start, (known.to.as_str(), pulse(&known.to)?)))
    };
    distances.iter().filter_map(speeds).flatten().collect()
}

/// Speeds between neighbouring sensors by the scene's distances, where the recording states none.
fn scene_speeds(
    scene: &Scene,
    placed: &[PlacedPulse<'_>],
    distances: &[RecordedDistance],
) -> Vec<SpeedBetween> {
    let is_measured = |a: &str, b: &str| {
        distances.iter().any(|d| (d.from == a && d.to == b) || (d.from == b && d.to == a))
    };
    let speeds = |(a, b): (usize, usize)| {
        let (a, b) = (&placed[a], &placed[b]);
        let distance =
            scene.distance(a.place, b.place).filter(|_| !is_measured(a.channel, b.channel))?;
        Some(between(distance, (a.channel, a.pulse), (b.channel, b.pulse)))
    };
    neighbours(placed, |placed| placed.place).into_iter().filter_map(speeds).flatten().collect()
}

/// Notes on pairs of channels between which estimators disagree by more than their uncertainties.
fn changes_of_shape(speeds: &[SpeedBetween]) -> Vec<String> {
    let pairs = speeds.chunk_by(|a, b| (&a.from, &a.to) == (&b.from, &b.to));
    let note = |pair: &[SpeedBetween]| {
        let by_value =
            |a: &&SpeedBetween, b: &&SpeedBetween| a.m_per_s.value.total_cmp(&b.m_per_s.value);
        let (low, high) = (pair.iter().min_by(by_value)?, pair.iter().max_by(by_value)?);
        let (slow, fast) = (low.m_per_s, high.m_per_s);
        let apart = fast.value - slow.value;
        let differs = apart > DIFFERENT_SPEEDS * slow.value.abs();
        (differs && apart > slow.expanded() + fast.expanded()).then(|| {
            format!(
                "{} -> {}: estimators of the speed differ by {:.0} %: the pulse changes its shape between these sensors, none of them is the speed",
                low.from,
                low.to,
                100.0 * apart / slow.value.abs()
            )
        })
    };
    pairs.filter_map(note).collect()
}

/// Decays of the first peak from each sensor to the next in a host of the same kind, of sensors
/// sorted from the top.
fn decays(scene: &Scene, placed: &[PlacedPulse<'_>]) -> Vec<Decay> {
    let kind = |placed: &PlacedPulse<'_>| {
        let Site::Particle(particle) = placed.place.site else { return None };
        let chain = &scene.chain;
        Some(chain.bodies().get(chain.body_of(particle))?.name.clone())
    };
    let decay = |(index, b): (usize, &PlacedPulse<'_>)| {
        let of_kind = kind(b)?;
        let is_like = |a: &&PlacedPulse<'_>| {
            a.place.site != b.place.site && kind(a).as_ref() == Some(&of_kind)
        };
        let a = placed[..index].iter().rev().find(is_like)?;
        let ratio = b.force?.over(a.force?);
        let distance = scene.distance(a.place, b.place)?;
        let rate = -ratio.value.ln() / distance.value;
        let u = (ratio.u / ratio.value).hypot(rate * distance.u) / distance.value;
        let rate = Uncertain::normal(rate, u);
        Some(Decay {
            from: a.channel.to_owned(),
            to: b.channel.to_owned(),
            ratio,
            per_metre: Some(rate).filter(|rate| rate.value.is_finite() && rate.u.is_finite()),
        })
    };
    placed.iter().enumerate().filter_map(decay).collect()
}

/// Puts sensors in their order along the chain, from the top.
pub(super) fn sort_down<T>(sensors: &mut [T], place: impl Fn(&T) -> PlatePlace) {
    let along = |sensor: &T| match place(sensor).site {
        Site::Particle(particle) => (particle, place(sensor).offset),
        Site::Wall => (usize::MAX, 0.0),
    };
    sensors.sort_by(|a, b| along(a).partial_cmp(&along(b)).unwrap_or(std::cmp::Ordering::Equal));
}

/// Each of `sensors`, sorted from the top, with those in the next host: places in the list.
pub(super) fn neighbours<T>(
    sensors: &[T],
    place: impl Fn(&T) -> PlatePlace,
) -> Vec<(usize, usize)> {
    let site = |index: usize| sensors.get(index).map(|sensor| place(sensor).site);
    let below = |upper: usize| {
        let next = (upper + 1..sensors.len()).find(|lower| site(*lower) != site(upper));
        let lower = (upper + 1..sensors.len())
            .filter(move |lower| next.is_some_and(|next| site(*lower) == site(next)));
        lower.map(move |lower| (upper, lower)).collect::<Vec<_>>()
    };
    (0..sensors.len()).flat_map(below).collect()
}

/// The first pulse of `capture`, with the droop of `time_constant` (s) undone; or why it has
/// neither height nor arrival.
pub(super) fn first_pulse(capture: &Capture, time_constant: Option<f64>) -> Result<Pulse, String> {
    let trace = uncoupled(capture).ok_or("a record over frequency has no arrival")?;
    let level = capture.waveform.preamble.y_mult.abs();
    pulse_in(&trace, &capture.waveform, Conditions { level, time_constant, baseline: None })
}

/// The first pulse in `trace`, the samples of `waveform` in any unit; or why it has neither height
/// nor arrival.
pub(super) fn pulse_in(
    trace: &Trace,
    waveform: &Waveform,
    conditions: Conditions,
) -> Result<Pulse, String> {
    let pulse = Pulse::find(trace, conditions).map_err(|error| error.to_string())?;
    // Behind the middle of the falling edge clipping is another pulse's.
    let end = pulse.arrival(Estimator::Peak).zip(pulse.width());
    let end = end.map_or(f64::INFINITY, |(peak, width)| peak.value + 0.5 * width.value);
    if waveform.clipped_points().next().is_some_and(|place| trace.time(place) <= end) {
        return Err(format!(
            "{} samples are clipped at the converter's ends, the first pulse with them: it has no height and no arrival; take more volts a division",
            waveform.clipped()
        ));
    }
    Ok(pulse)
}

fn channel(capture: &Capture, sensor: Option<&RecordedSensor>) -> (ChannelArrivals, Option<Pulse>) {
    let unit = capture.waveform.preamble.y_unit.as_str();
    // A record in newtons, or in any other unit than volts, is no sensor's voltage.
    let sensor_of_volts = sensor.filter(|_| unit == "V");
    let time_constant = sensor_of_volts.and_then(|sensor| sensor.time_constant);
    let (pulse, problem) = match first_pulse(capture, time_constant) {
        Ok(pulse) => (Some(pulse), None),
        Err(problem) => (None, Some(problem)),
    };
    let height = pulse.as_ref().and_then(Pulse::height);
    let sensitivity = sensor_of_volts.and_then(|sensor| sensor.sensitivity);
    let scale_u = sensor.map_or(0.0, RecordedSensor::scale_u);
    let limit = sensor.map_or(0.0, RecordedSensor::gain_half_width);
    let force = height.zip(sensitivity).map(|(height, sensitivity)| {
        let value = height.value / sensitivity;
        let u = height.u.hypot(height.value * scale_u) / sensitivity;
        // Of two even parts the smaller counts as normal.
        let half_width = (value.abs() * limit).max(height.half_width / sensitivity);
        Uncertain { value, u, half_width }
    });
    let arrival = |estimator: Estimator| Arrival {
        estimator: estimator.key(),
        time_s: pulse.as_ref().and_then(|pulse| pulse.arrival(estimator)),
    };
    let channel = ChannelArrivals {
        channel: capture.waveform.source.to_string(),
        sensor: sensor.map(|sensor| sensor.name.clone()),
        droop_undone: time_constant.is_some() || unit != "V",
        clipped: capture.waveform.clipped(),
        unit: unit.to_owned(),
        noise: pulse.as_ref().map(|pulse| pulse.noise),
        height,
        noise_v: pulse.as_ref().map(|pulse| pulse.noise).filter(|_| unit == "V"),
        height_v: height.filter(|_| unit == "V"),
        height_n: force.or(height.filter(|_| unit == "N")),
        width_s: pulse.as_ref().and_then(Pulse::width),
        pulses: pulse.as_ref().map(|pulse| pulse.count(MIN_PULSE_SHARE)),
        arrivals: Estimator::ALL.map(arrival).to_vec(),
        problem,
    };
    (channel, pulse)
}

/// Speeds over `distance` (m) from one channel to another by every estimator that finds both
/// arrivals, and by cross-correlation.
fn between(
    distance: Uncertain,
    (from, start): (&str, &Pulse),
    (to, end): (&str, &Pulse),
) -> Vec<SpeedBetween> {
    let by_arrival = |estimator: Estimator| {
        let (start, end) = (start.arrival(estimator)?, end.arrival(estimator)?);
        Some((estimator.key(), speed(distance, start, end)?))
    };
    let by_shape = delay(start, end).and_then(|time| speed_over(distance, time));
    let shape = by_shape.map(|speed| ("cross_correlation", speed));
    let found = Estimator::ALL.into_iter().filter_map(by_arrival).chain(shape);
    found
        .map(|(estimator, m_per_s)| SpeedBetween {
            from: from.to_owned(),
            to: to.to_owned(),
            distance_m: distance.value,
            distance_u_m: distance.u,
            estimator,
            m_per_s,
        })
        .collect()
}
