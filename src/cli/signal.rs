//! The signal of a recording that a command looks at.

use anyhow::bail;
use clap::ValueEnum;

use crate::analysis::window::Window;
use crate::experiment::recorded;
use crate::quantity::{Dimension, parse};
use crate::recording::{Shot, TraceSet};
use crate::scene::Site;
use crate::trace::Trace;

/// What a record is multiplied with.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum WindowChoice {
    /// None: for pulses that end within the record
    Rectangular,
    /// For lines close to each other
    Hann,
    /// For the height of lines
    FlatTop,
}

impl WindowChoice {
    /// The window.
    pub fn window(self) -> Window {
        match self {
            Self::Rectangular => Window::Rectangular,
            Self::Hann => Window::Hann,
            Self::FlatTop => Window::FlatTop,
        }
    }
}

/// Reads a time.
pub fn time(text: &str) -> Result<f64, String> {
    parse(text, Dimension::TIME).map_err(|error| format!("{error}, expected a time, e.g. 200us"))
}

/// A signal, where it was felt, and what is subtracted from it.
pub type Signal = (Trace, Option<Site>, f64);

/// The truth called `named`, or the capture of `channel`, the first without one.
pub fn signal(
    set: &TraceSet,
    shot: &Shot,
    channel: Option<&str>,
    named: Option<&str>,
) -> anyhow::Result<Signal> {
    match named {
        Some(name) => truth(set, shot, name),
        None => capture(set, shot, channel),
    }
}

fn capture(set: &TraceSet, shot: &Shot, channel: Option<&str>) -> anyhow::Result<Signal> {
    let name_of = |capture: &crate::recording::Capture| capture.waveform.source.to_string();
    let wanted = |c: &&crate::recording::Capture| {
        channel.is_none_or(|channel| name_of(c).eq_ignore_ascii_case(channel))
    };
    let Some(capture) = shot.captures.iter().find(wanted) else {
        let names: Vec<String> = shot.captures.iter().map(name_of).collect();
        bail!(
            "found no capture {}, expected one of: {}",
            channel.unwrap_or("at all"),
            names.join(", ")
        );
    };
    let name = name_of(capture);
    let Some(mut trace) = capture.trace() else {
        bail!("{name}: found a record over frequency, expected one over time");
    };
    let sensors = recorded::sensors_of(set, shot.number);
    let sensor = sensors.iter().find(|sensor| sensor.channel.as_ref() == Some(&name));
    if let Some(sensor) = sensor {
        trace.name = format!("{name}, sensor {}", sensor.name);
    }
    Ok((trace, sensor.and_then(|sensor| sensor.site), 0.0))
}

/// The truth called `name`, in full, by its topic, or a sensor's by the sensor's name. What it starts from is its static part.
fn truth(set: &TraceSet, shot: &Shot, name: &str) -> anyhow::Result<Signal> {
    let name = name.trim_start_matches("/truth/");
    let topic = |trace: &Trace| {
        trace.name.split_once(": ").map_or(&*trace.name, |(topic, _)| topic).to_owned()
    };
    let sensor_topic = format!("sensor/{name}");
    let found = shot.truth.iter().find(|trace| {
        let topic = topic(trace);
        topic == name || topic == sensor_topic || trace.name == name
    });
    let Some(trace) = found else {
        let names: Vec<String> = shot.truth.iter().map(topic).collect();
        bail!("found no truth `{name}`, expected one of: {}", names.join(", "));
    };
    let sensors = recorded::sensors_of(set, shot.number);
    let topic = topic(trace);
    let sensor = sensors.iter().find(|s| Some(s.name.as_str()) == topic.strip_prefix("sensor/"));
    let offset = trace.values.first().copied().unwrap_or(0.0);
    Ok((trace.clone(), sensor.and_then(|sensor| sensor.site), offset))
}
