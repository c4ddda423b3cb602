//! From the forces that were watched to what the scope keeps, and the truth behind it.

use super::bench::Bench;
use crate::recording::{Capture, InstrumentIdentity, Origin, Shot, TrueSignal};
use crate::scene::{GENERATOR_OUTPUTS, Scene, Site, input_load};
use crate::scope::acquire::{
    TriggerPosition, before_trigger, digitise, find_trigger, fold_average,
};
use crate::scope::front_end::{condition, noise_stream};
use crate::scope::{ChannelSetup, Source, TriggerSource};
use crate::sensor::{Load, MotionKind, MotionSensor};
use crate::trace::Trace;

/// The further impacts of an average draw their noise as shots whose number begins so many bits
/// further up.
const AVERAGED_SHOT_BITS: u32 = 20;
/// Most samples of a trace of the truth.
const MAX_TRUTH_SAMPLES: usize = 50_000;

/// The signal at each channel's probe, conditioned by the front end; `None` for channels that are
/// off (V).
pub fn signals(scene: &Scene, bench: &Bench<'_>, shot: u32) -> Vec<Option<Vec<f64>>> {
    let setup = &scene.scope;
    let signal = |number: u8, channel: &ChannelSetup| {
        let volts = volts(scene, bench, channel);
        let mut noise = noise_stream(scene.seed, shot, number);
        condition(setup, channel, bench.grid().interval, &volts, &mut noise)
    };
    (1..).zip(&setup.channels).map(|(n, c)| c.as_ref().map(|c| signal(n, c))).collect()
}

/// The signal at a channel's probe tip (V).
pub fn volts(scene: &Scene, bench: &Bench<'_>, channel: &ChannelSetup) -> Vec<f64> {
    let load = input_load(&scene.scope.model, channel);
    let name = channel.input.as_deref().unwrap_or_default();
    input_voltages(scene, bench, name, load).unwrap_or_else(|| {
        let samples = bench.watches().first().map_or(0, |w| w.samples.len());
        vec![0.0; samples]
    })
}

/// The signal at the external trigger input, empty for an open one (V).
pub fn external(scene: &Scene, bench: &Bench<'_>) -> Vec<f64> {
    let Some(name) = &scene.scope.external else { return Vec::new() };
    let model = &scene.scope.model;
    let load = Load { resistance: model.input_resistance, capacitance: model.input_capacitance };
    input_voltages(scene, bench, name, load).unwrap_or_default()
}

/// Voltage of a generator's signal at its peak (V).
const GENERATOR_PEAK: f64 = 1.0;
/// Voltage of its sync output while the signal lasts (V).
const SYNC_LEVEL: f64 = 5.0;

/// Voltage of a sensor, or an output of the drive's generator, into a load (V).
fn input_voltages(scene: &Scene, bench: &Bench<'_>, name: &str, load: Load) -> Option<Vec<f64>> {
    let [generator, sync] = GENERATOR_OUTPUTS;
    let Some((_, drive)) =
        scene.chain.drives().next().filter(|_| [generator, sync].contains(&name))
    else {
        return motion_voltages(scene, bench, name)
            .or_else(|| sensor_voltages(scene, bench, name, load));
    };
    let signal = &drive.signal;
    let volts = |time: f64| {
        if name == generator {
            GENERATOR_PEAK * signal.at(time)[0]
        } else {
            let is_on = (0.0..=signal.length).contains(&time);
            if is_on { SYNC_LEVEL } else { 0.0 }
        }
    };
    // Without a probe nothing says how far the bench has come but the time itself.
    let reached = bench.grid().samples_until(bench.time());
    let samples = bench.watches().first().map_or(reached, |watch| watch.samples.len());
    Some((0..samples).map(|sample| volts(bench.grid().time(sample))).collect())
}

/// Voltage of the sensor of motion `name`; none if there is no such sensor (V).
fn motion_voltages(scene: &Scene, bench: &Bench<'_>, name: &str) -> Option<Vec<f64>> {
    let place = scene.motion_sensors.iter().position(|sensor| sensor.name == name)?;
    let (before, sensor) = (&scene.motion_sensors[..place], &scene.motion_sensors[place]);
    let by_velocity = |s: &&MotionSensor| !matches!(s.kind, MotionKind::Accelerometer { .. });
    let by_force = |s: &&MotionSensor| !matches!(s.kind, MotionKind::Vibrometer { .. });
    let velocity = bench.motions().get(before.iter().filter(by_velocity).count());
    let first = scene.sensors.len() + usize::from(scene.chain.wall_contact().is_some());
    let force = bench.watches().get(first + before.iter().filter(by_force).count());
    let interval = bench.grid().interval;
    let measured = match sensor.kind {
        MotionKind::Vibrometer { .. } => velocity?.samples.clone(),
        MotionKind::Accelerometer { particle, .. } => {
            let mass = scene.chain.bodies().get(scene.chain.body_of(particle))?.mass;
            force?.samples.iter().map(|force| force / mass).collect()
        }
        MotionKind::StrainGauge { end, distance, speed } => {
            let backing = scene.chain.supports()[end].backing()?;
            // Into the rod.
            let sign = if end == 0 { -1.0 } else { 1.0 };
            let both = velocity?.samples.iter().zip(&force?.samples);
            let departing = both.map(|(v, force)| 0.5 * (sign * v + force / backing.impedance));
            let departing: Vec<f64> = departing.collect();
            let delay = distance / speed;
            let strain = |sample: usize| {
                let at = |late: f64| between(&departing, sample as f64 - late / interval);
                let returning =
                    backing.echo.map_or(0.0, |echo| echo.reflection * at(echo.delay - delay));
                (returning - at(delay)) / speed
            };
            (0..departing.len()).map(strain).collect()
        }
    };
    Some(sensor.respond(&measured, interval))
}

/// `samples` at a place between two of them, by the cubic through the nearest four; 0 before the
/// first (unit).
fn between(samples: &[f64], place: f64) -> f64 {
    let first = place.floor();
    let sample = |offset: f64| {
        let index = first + offset;
        if index < 0.0 { 0.0 } else { samples.get(index as usize).copied().unwrap_or(0.0) }
    };
    let (t, [a, b, c, d]) = (place - first, [-1.0, 0.0, 1.0, 2.0].map(sample));
    let third = (d - a) / 6.0 + 0.5 * (b - c);
    let second = 0.5 * (a + c) - b;
    let slope = c - b - second - third;
    b + t * (slope + t * (second + t * third))
}

/// Voltage of the sensor `name` into a load (V).
fn sensor_voltages(scene: &Scene, bench: &Bench<'_>, name: &str, load: Load) -> Option<Vec<f64>> {
    let index = scene.sensors.iter().position(|sensor| sensor.name == name)?;
    let (watch, placed) = bench.watches().get(index).zip(scene.sensors.get(index))?;
    let circuit = scene.circuit_into(index, load)?;
    let force = bench.grid().trace(&placed.name, "N", watch.samples.clone());
    Some(circuit.respond(&force).values)
}

/// Scale of the trigger's source: a channel's vertical scale (V/div).
pub fn trigger_scale(scene: &Scene) -> Option<f64> {
    let setup = &scene.scope;
    match setup.trigger.source {
        TriggerSource::Channel(number) => {
            Some(setup.channels.get(usize::from(number) - 1)?.as_ref()?.vertical.scale)
        }
        external @ (TriggerSource::External | TriggerSource::External5) => {
            Some(external.external_scale(&setup.model))
        }
        TriggerSource::Line => None,
    }
}

/// Where the scope triggers on the conditioned `signals` of all channels (V). A scene never leaves
/// the trigger to the mains.
pub fn trigger(
    scene: &Scene,
    bench: &Bench<'_>,
    signals: &[Option<Vec<f64>>],
) -> Option<TriggerPosition> {
    let scale = trigger_scale(scene)?;
    let apart;
    let signal = if let Some(number) = scene.scope.trigger.source.channel() {
        signals.get(usize::from(number) - 1)?.as_ref()?
    } else {
        apart = external(scene, bench);
        &apart
    };
    let earliest = before_trigger(&scene.scope);
    find_trigger(&scene.scope, scale, signal, bench.grid().samples_until(0.0), earliest)
}

/// Captures and truth of one trigger.
pub fn record(
    scene: &Scene,
    bench: &Bench<'_>,
    found: Option<TriggerPosition>,
    number: u32,
) -> Shot {
    let setup = &scene.scope;
    let depth = setup.acquisition.depth();
    let instrument = InstrumentIdentity {
        model: setup.model.name.replace(' ', ""),
        serial: setup.model.serial.clone(),
        firmware: setup.model.firmware.clone(),
    };
    let signals = signals(scene, bench, number);
    let capture =
        |number: u8, channel: &ChannelSetup, signal: &[f64], found: TriggerPosition| Capture {
            waveform: digitise(setup, Source::Channel(number), channel, signal, found.index),
            instrument: Some(instrument.clone()),
            notes: Vec::new(),
        };
    let channels = (1..).zip(setup.channels.iter().zip(&signals));
    let mut captures: Vec<Capture> = found.map_or_else(Vec::new, |found| {
        channels
            .filter_map(|(n, (c, s))| Some(capture(n, c.as_ref()?, s.as_ref()?, found)))
            .collect()
    });
    if depth > 1 {
        average(scene, bench, &mut captures, number);
        for capture in &mut captures {
            capture.notes.push(format!("average of {depth} impacts"));
        }
    }
    let trigger_time = found.map(|found| bench.grid().time(found.index));
    // Shots follow each other as on a bench, or readers that sort by time would mix them up.
    let spacing = (scene.duration + setup.model.horizontal_divisions * setup.time_base).ceil();
    let at = f64::from(number.saturating_sub(1)) * spacing + trigger_time.unwrap_or(0.0).max(0.0);
    let timestamp_ns = (at * 1e9).round() as u64;
    Shot {
        number,
        origin: Origin::Simulated,
        timestamp_ns,
        captures,
        truth: truth(scene, bench),
        trigger_time,
    }
}

/// Averages the records with those of as many impacts as the scope is set to. The motion is the
/// same in each, the noise is not.
fn average(scene: &Scene, bench: &Bench<'_>, captures: &mut [Capture], number: u32) {
    let setup = &scene.scope;
    let depth = setup.acquisition.depth();
    let mut means: Vec<Vec<f64>> = vec![Vec::new(); captures.len()];
    for (capture, mean) in captures.iter_mut().zip(&mut means) {
        fold_average(mean, &mut capture.waveform, 1, depth);
    }
    let mut taken = 1;
    for more in 1..depth {
        let signals = signals(scene, bench, number.wrapping_add(more << AVERAGED_SHOT_BITS));
        let Some(found) = trigger(scene, bench, &signals) else { continue };
        taken += 1;
        for (capture, mean) in captures.iter_mut().zip(&mut means) {
            let Source::Channel(channel) = capture.waveform.source else { continue };
            let place = usize::from(channel) - 1;
            let known = setup.channels.get(place).and_then(Option::as_ref);
            let Some((knobs, signal)) = known.zip(signals.get(place).and_then(Option::as_ref))
            else {
                continue;
            };
            let source = capture.waveform.source;
            let mut next = digitise(setup, source, knobs, signal, found.index);
            fold_average(mean, &mut next, taken, depth);
            capture.waveform.codes = next.codes;
        }
    }
}

/// A trace with at most [`MAX_TRUTH_SAMPLES`] samples: of more, every second, third, and so on.
fn thinned(trace: Trace) -> Trace {
    let step = trace.values.len().div_ceil(MAX_TRUTH_SAMPLES).max(1);
    let values = trace.values.into_iter().step_by(step).collect();
    Trace { interval: trace.interval * step as f64, values, ..trace }
}

/// Ground truth: the force at each sensor on the sample grid, and the frames, thinned.
pub fn truth(scene: &Scene, bench: &Bench<'_>) -> Vec<Trace> {
    let forces = scene.sensors.iter().zip(bench.watches()).map(|(placed, watch)| {
        let static_force = watch.pulse.static_force();
        let signal = TrueSignal::Force(placed.name.clone());
        let place = match placed.site {
            Site::Particle(particle) => format!("inside particle {particle}"),
            Site::Wall => "at the wall".to_owned(),
        };
        let values = watch.samples.iter().map(|force| force + static_force).collect();
        bench.grid().trace(&format!("{signal}: force {place}"), "N", values)
    });
    let film = bench.film();
    let contacts = film.contact_forces.iter().enumerate();
    let contacts = contacts
        .filter(|(j, _)| scene.chain.contacts().get(*j).is_some_and(|c| c.stiffness > 0.0))
        .map(|(j, forces)| {
            let name = format!("{}: force in contact {j}", TrueSignal::Contact(j));
            film.grid.trace(&name, "N", forces.clone())
        });
    let tracks = film.displacements.iter().enumerate().map(|(i, track)| {
        let name = format!("{}: displacement of body {i}", TrueSignal::Displacement(i));
        film.grid.trace(&name, "m", track.clone())
    });
    forces.chain(contacts).chain(tracks).map(thinned).collect()
}
