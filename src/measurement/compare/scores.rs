//! The scores of one channel, and of speeds between channels.

use super::mapping::{ChannelMapping, sensor_at};
use super::{ChannelScore, CompareError, ComparedShot, SpeedScore, scene_of};
use crate::analysis::arrival::Estimator;
use crate::analysis::comparison::Pair;
use crate::analysis::least_squares::squares;
use crate::analysis::pulse::{Conditions, Pulse};
use crate::analysis::speed::speed;
use crate::measurement::arrivals::{first_pulse, neighbours, pulse_in, sort_down};
use crate::measurement::force::forces;
use crate::measurement::metadata::{self, RecordedSensor};
use crate::quantity::Uncertain;
use crate::recording::Capture;
use crate::scene::{PlatePlace, Scene};
use crate::scope::Source;
use crate::trace::Trace;

/// Estimators whose speeds are compared.
const ESTIMATORS: [Estimator; 2] = [Estimator::HalfRise, Estimator::Peak];

/// What one `g` of an accelerometer is, by definition (m/s^2).
const STANDARD_GRAVITY: f64 = 9.80665;

/// Both sides of one channel.
pub struct ChannelPair {
    /// The measured channel.
    pub name: String,
    /// The measured trace, in `unit`.
    pub measured: Trace,
    /// The simulated trace on its own axis, in `unit`.
    pub simulated: Trace,
    against: String,
    unit: String,
    lsb: f64,
    clipped: usize,
    /// Whether the simulated sensor's calibration stands in for an unknown one.
    pub borrowed: bool,
    gain_u: f64,
    pulses: Option<(Pulse, Pulse)>,
    sensitivities: Option<(f64, f64)>,
    place: Option<PlatePlace>,
}

impl ChannelPair {
    /// Takes up what `wire` connects.
    pub fn of(
        measured: ComparedShot<'_>,
        simulated: ComparedShot<'_>,
        wire: &ChannelMapping,
        notes: &mut Vec<String>,
    ) -> Result<Self, CompareError> {
        let (here, there) =
            (&measured.shot.captures[wire.measured], &simulated.shot.captures[wire.simulated]);
        let (name, against) = (here.waveform.source.to_string(), there.waveform.source.to_string());
        let known = |side: ComparedShot<'_>| metadata::sensors_of(side.set, side.shot.number);
        let (own, other) = (known(measured), known(simulated));
        let (own, other) = (sensor_at(&own, &name), sensor_at(&other, &against));
        let or_other = |of: fn(&RecordedSensor) -> Option<f64>| {
            (
                own.and_then(of).or_else(|| other.and_then(of)),
                other.and_then(of).or_else(|| own.and_then(of)),
            )
        };
        let (tau, tau_there) = or_other(|sensor| sensor.time_constant);
        let (sensitivity, sensitivity_there) = or_other(|sensor| sensor.sensitivity);
        let borrowed = own.and_then(|sensor| sensor.sensitivity).is_none() && sensitivity.is_some();
        let (unit, sides) = in_one_unit((measured, here), (simulated, there))?;
        let is_volts = unit == "V";
        let pulse = |capture: &Capture, side: &ConvertedTrace, tau: Option<f64>| {
            if !side.was_converted {
                return first_pulse(capture, tau.filter(|_| is_volts));
            }
            let conditions = Conditions { level: side.level, ..Conditions::default() };
            pulse_in(&side.trace, &capture.waveform, conditions)
        };
        let found = pulse(here, &sides[0], tau)
            .and_then(|found| Ok((found, pulse(there, &sides[1], tau_there)?)));
        for (side, name) in sides.iter().zip([("measured", &name), ("simulated", &against)]) {
            if side.was_converted {
                let (which, name) = name;
                notes.push(format!("{which} {name} is in {unit} by its sensor's sensitivity"));
            }
        }
        let gain_u = if metadata::is_scope_exact(measured.set)
            || here.waveform.preamble.y_unit != "V"
        {
            0.0
        } else {
            let scene = scene_of(simulated).or_else(|| scene_of(measured));
            let vertical = here.waveform.vertical;
            let limit =
                |scene: Scene| scene.scope.model.accuracy.gain_at(vertical.scale / vertical.probe);
            scene.map_or(0.0, limit) / 3f64.sqrt()
        };
        if let Err(problem) = &found {
            notes.push(format!("{name}: no peak and no arrival: {problem}"));
        }
        let [own_side, other_side] = sides;
        Ok(Self {
            name,
            against,
            lsb: own_side.level,
            clipped: here.waveform.clipped(),
            borrowed: borrowed && is_volts,
            gain_u,
            pulses: found.ok(),
            // Forces need the droop undone.
            sensitivities: match unit.as_str() {
                "V" => tau.and(sensitivity).zip(tau_there.and(sensitivity_there)),
                "N" => Some((1.0, 1.0)),
                _ => None,
            },
            unit,
            place: other.and_then(|s| s.place).or_else(|| own.and_then(|s| s.place)),
            measured: own_side.trace,
            simulated: other_side.trace,
        })
    }

    /// Both traces, and the weight that makes channels of different height count alike (1).
    pub fn weighted(&self) -> (&Trace, &Trace, f64) {
        let count = self.simulated.values.len().max(1) as f64;
        let weight = count / squares(&self.simulated.values).max(f64::MIN_POSITIVE);
        (&self.measured, &self.simulated, weight)
    }

    /// The first pulses on both sides, the measured one first.
    pub fn pulses(&self) -> Option<&(Pulse, Pulse)> {
        self.pulses.as_ref()
    }

    /// Arrivals on both sides, each on its own clock.
    pub fn arrivals(&self, estimator: Estimator) -> Option<(Uncertain, Uncertain)> {
        let (measured, simulated) = self.pulses.as_ref()?;
        Some((measured.arrival(estimator)?, simulated.arrival(estimator)?))
    }

    /// Forces on both sides: baseline and droop taken out, by each side's own sensor (N).
    fn forces(&self, shift: f64) -> Option<Pair> {
        let (measured, simulated) = self.pulses.as_ref()?;
        let (own, other) = self.sensitivities?;
        let force = |pulse: &Pulse, sensitivity: f64| {
            let scale = if pulse.inverted { -sensitivity } else { sensitivity };
            let values = pulse.signal.values.iter().map(|v| v / scale).collect();
            Trace { unit: "N".to_owned(), values, ..pulse.signal.clone() }
        };
        Pair::new(&force(measured, own), &force(simulated, other), shift)
    }

    /// Zero and noise on both sides, the measured one first, if there is a pulse; in `unit`.
    pub fn quiet(&self) -> Option<[Uncertain; 2]> {
        let (measured, simulated) = self.pulses.as_ref()?;
        Some(
            [measured, simulated].map(|pulse| Uncertain::normal(pulse.baseline.level, pulse.noise)),
        )
    }

    /// The scores, with both traces in `pair`.
    pub fn score(&self, pair: &Pair, wire: &ChannelMapping, shift_s: f64) -> ChannelScore {
        let noise = |pulses: &(Pulse, Pulse)| pulses.0.noise / pulses.1.noise;
        let ratio = self.pulses.as_ref().map_or(1.0, noise).powi(2);
        let distance = pair.distance(ratio);
        let in_newtons = self.forces(shift_s).map(|pair| pair.distance(1.0));
        let heights = self.pulses.as_ref().and_then(|(m, s)| Some((m.height()?, s.height()?)));
        let peak_error = heights.map(|(m, s)| {
            let sign = self.pulses.as_ref().is_some_and(|(m, s)| m.inverted != s.inverted);
            let value = if sign { -m.value / s.value } else { m.value / s.value };
            let u = (m.u / m.value).hypot(s.u / s.value);
            Uncertain::normal(value - 1.0, (value * u).abs())
        });
        let arrivals = self.arrivals(Estimator::HalfRise);
        let arrival = arrivals.map(|(m, s)| {
            let u = m.u.hypot(s.u);
            Uncertain::normal(m.value - s.value - shift_s, u)
        });
        ChannelScore {
            name: self.name.clone(),
            against: self.against.clone(),
            sensor: wire.sensor.clone(),
            mapped_by: wire.by,
            shift_s,
            gain: distance.gain,
            gain_u: self.gain_u,
            unit: self.unit.clone(),
            offset: distance.offset,
            peak_measured: heights.map(|(m, _)| m),
            peak_simulated: heights.map(|(_, s)| s),
            peak_error,
            arrival_measured_s: arrivals.map(|(m, _)| m),
            arrival_simulated_s: arrivals.map(|(_, s)| s),
            arrival_error_s: arrival,
            rms: distance.rms,
            rms_lsb: distance.rms / self.lsb,
            rms_n: in_newtons.map(|d| d.rms),
            max: distance.largest,
            max_lsb: distance.largest / self.lsb,
            max_n: in_newtons.map(|d| d.largest),
            lsb: self.lsb,
            correlation: distance.correlation,
            spectrum_distance: distance.spectrum,
            samples: pair.measured.values.len(),
            clipped: self.clipped,
        }
    }
}

/// A channel's trace in the unit of the comparison.
struct ConvertedTrace {
    trace: Trace,
    /// One level of it (unit).
    level: f64,
    /// Whether its values are not those of the record.
    was_converted: bool,
}

impl ConvertedTrace {
    /// The trace of `capture` in `unit`: as it is, by the sensitivity of the force sensor (droop
    /// undone), or by that of the scene's sensor of motion.
    fn of((side, capture): (ComparedShot<'_>, &Capture), unit: &str) -> Option<Self> {
        let trace = capture.trace()?;
        let level = capture.waveform.preamble.y_mult.abs();
        if trace.unit == unit {
            return Some(Self { trace, level, was_converted: false });
        }
        if trace.unit != "V" {
            return None;
        }
        if unit == "N" {
            let found = forces(side.set, side.shot).into_iter().flatten();
            let channel = capture.waveform.source.to_string();
            let found = found.into_iter().find(|forces| forces.channel == channel)?;
            let level = level / found.sensor.sensitivity?;
            return Some(Self { trace: found.force, level, was_converted: true });
        }
        let Source::Channel(number) = capture.waveform.source else { return None };
        let scene = scene_of(side)?;
        let channel = scene.scope.channels.get(usize::from(number).checked_sub(1)?)?.as_ref()?;
        let name = channel.input.as_ref()?;
        let sensor = scene.motion_sensors.iter().find(|sensor| &sensor.name == name)?;
        // Volts for one of `unit`.
        let volts = match (sensor.kind.unit(), unit) {
            ("m/s^2", "g") => sensor.sensitivity * STANDARD_GRAVITY,
            ("1", "m/m") => sensor.sensitivity,
            (own, wanted) if own == wanted => sensor.sensitivity,
            _ => return None,
        };
        let values = trace.values.iter().map(|value| value / volts).collect();
        let trace = Trace { values, unit: unit.to_owned(), ..trace };
        Some(Self { trace, level: level / volts.abs(), was_converted: true })
    }
}

/// Both captures in one unit: the measurement's if possible, else the simulation's.
fn in_one_unit(
    measured: (ComparedShot<'_>, &Capture),
    simulated: (ComparedShot<'_>, &Capture),
) -> Result<(String, [ConvertedTrace; 2]), CompareError> {
    let unit = |side: (ComparedShot<'_>, &Capture)| side.1.waveform.preamble.y_unit.clone();
    let units = [unit(measured), unit(simulated)];
    let in_unit = |unit: &String| {
        Some([ConvertedTrace::of(measured, unit)?, ConvertedTrace::of(simulated, unit)?])
    };
    if let Some(found) = units.iter().find_map(|unit| Some((unit.clone(), in_unit(unit)?))) {
        return Ok(found);
    }
    let [unit, other] = units;
    Err(CompareError::Units {
        channel: measured.1.waveform.source.to_string(),
        unit,
        against: simulated.1.waveform.source.to_string(),
        other,
    })
}

/// Speeds between neighbouring sensors on both sides.
pub fn speeds(
    channels: &[ChannelPair],
    sides: [ComparedShot<'_>; 2],
    notes: &mut Vec<String>,
) -> Vec<SpeedScore> {
    let scenes = sides.map(scene_of);
    let [Some(of_measured), Some(of_simulated)] = (match scenes {
        [Some(a), Some(b)] => [Some(a), Some(b)],
        [one, other] => {
            let known = one.or(other);
            [known.clone(), known]
        }
    }) else {
        notes.push("no speeds: neither side has a scene with distances".to_owned());
        return Vec::new();
    };
    let mut placed: Vec<(&ChannelPair, PlatePlace)> =
        channels.iter().filter_map(|channel| Some((channel, channel.place?))).collect();
    sort_down(&mut placed, |(_, place)| *place);
    let mut found = Vec::new();
    for (upper, lower) in neighbours(&placed, |(_, place)| *place) {
        let (from, to) = (placed[upper], placed[lower]);
        let distance = |scene: &Scene| scene.distance(from.1, to.1);
        let Some(distances) = distance(&of_measured).zip(distance(&of_simulated)) else { continue };
        found.extend(ESTIMATORS.into_iter().filter_map(|e| between(from.0, to.0, distances, e)));
    }
    found
}

fn between(
    from: &ChannelPair,
    to: &ChannelPair,
    (of_measured, of_simulated): (Uncertain, Uncertain),
    estimator: Estimator,
) -> Option<SpeedScore> {
    let (start, start_there) = from.arrivals(estimator)?;
    let (end, end_there) = to.arrivals(estimator)?;
    let exact = |value: f64| Uncertain::normal(value, 0.0);
    let measured = speed(of_measured, start, end)?;
    let simulated = speed(exact(of_simulated.value), start_there, end_there)?;
    let ratio = measured.value / simulated.value;
    let relative = |speed: Uncertain| speed.u / speed.value;
    Some(SpeedScore {
        from: from.name.clone(),
        to: to.name.clone(),
        estimator: estimator.key(),
        distance_m: of_measured.value,
        distance_u_m: of_measured.u,
        measured_m_per_s: measured,
        measured_over_exact_distance: speed(exact(of_measured.value), start, end)?,
        simulated_m_per_s: simulated,
        error: Uncertain::normal(
            ratio - 1.0,
            (ratio * relative(measured).hypot(relative(simulated))).abs(),
        ),
    })
}
