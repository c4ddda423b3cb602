//! The signal of a recording that a command looks at.

use std::path::PathBuf;

use anyhow::bail;
use clap::{Args, ValueEnum};

use super::input::{ReadingArguments, no_capture};
use super::value::quantity;
use crate::analysis::gate::Gate;
use crate::analysis::spectrum::Window;
use crate::measurement::metadata;
use crate::quantity::Dimension;
use crate::recording::true_signal::topic;
use crate::recording::{Capture, Shot, TraceSet, TrueSignal};
use crate::scene::Site;
use crate::trace::Trace;

/// The window function of a record.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum WindowChoice {
    /// No window: for pulses that end within the record
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

/// Which signal of a recording, and which part of it.
#[derive(Debug, Args)]
pub struct SignalArguments {
    /// A recording (.mcap), a scope's file (.csv, .isf), a folder of them, or a scope's address
    /// (see `acquire`) to record one shot from
    file: PathBuf,
    #[command(flatten)]
    reading: ReadingArguments,
    /// A simulated signal without its static part: a sensor's name, contact/3, bead/7
    #[arg(long, value_name = "NAME", conflicts_with = "channel")]
    truth: Option<String>,
    /// Start, e.g. 200us: after the trigger, or with --truth after the striker's first contact
    #[arg(long, value_name = "T", value_parser = quantity(Dimension::TIME, .., "200us"), allow_hyphen_values = true)]
    from: Option<f64>,
    /// Stop at this time
    #[arg(long, value_name = "T", value_parser = quantity(Dimension::TIME, .., "200us"), allow_hyphen_values = true)]
    to: Option<f64>,
}

impl SignalArguments {
    /// Reads the recording and finds the signal in it.
    pub fn read(&self) -> anyhow::Result<(TraceSet, SelectedSignal)> {
        let (set, shot) = self.reading.open_single(&self.file)?;
        let found = match &self.truth {
            Some(name) => truth(&set, &shot, name)?,
            None => capture(&set, &shot)?,
        };
        Ok((set, found))
    }

    /// Number of the shot.
    pub fn shot(&self) -> u32 {
        self.reading.selection.single()
    }

    /// How many samples of the signal are clipped, where any are.
    pub fn clipped(&self, set: &TraceSet) -> Option<String> {
        let shot = set.shots.iter().find(|shot| shot.number == self.shot())?;
        let waveform = &shot.captures.first()?.waveform;
        if self.truth.is_some() || waveform.clipped() == 0 {
            return None;
        }
        let (source, clipped) = (waveform.source, waveform.clipped());
        Some(format!(
            "{source}: {clipped} samples are clipped at the converter's ends: the spectrum holds the clipping's own harmonics"
        ))
    }

    /// The part of it that is looked at.
    pub fn gate(&self) -> Gate {
        Gate { from: self.from.unwrap_or(f64::NEG_INFINITY), to: self.to.unwrap_or(f64::INFINITY) }
    }

    /// Where it is from and what it is.
    pub fn title(&self, trace: &Trace) -> String {
        format!("{}: {}", self.file.display(), trace.name)
    }
}

/// A signal, its sensor's site, and the offset that is subtracted (unit).
pub type SelectedSignal = (Trace, Option<Site>, f64);

/// The first channel that is meant.
fn capture(set: &TraceSet, shot: &Shot) -> anyhow::Result<SelectedSignal> {
    let capture = shot.captures.first().ok_or_else(|| no_capture(&set.problems))?;
    of_capture(set, shot, capture)
}

/// The channel called `name`, or else the truth.
pub fn named(set: &TraceSet, shot: &Shot, name: &str) -> anyhow::Result<SelectedSignal> {
    let is_named = |c: &&Capture| c.waveform.source.to_string().eq_ignore_ascii_case(name);
    match shot.captures.iter().find(is_named) {
        Some(capture) => of_capture(set, shot, capture),
        None => truth(set, shot, name),
    }
}

fn of_capture(set: &TraceSet, shot: &Shot, capture: &Capture) -> anyhow::Result<SelectedSignal> {
    let name = capture.waveform.source.to_string();
    let Some(mut trace) = capture.trace() else {
        bail!("{name}: found a record over frequency, expected one over time");
    };
    let sensors = metadata::sensors_of(set, shot.number);
    let sensor = sensors.iter().find(|sensor| sensor.channel.as_ref() == Some(&name));
    if let Some(sensor) = sensor {
        trace.name = format!("{name}, sensor {}", sensor.name);
    }
    Ok((trace, sensor.and_then(crate::measurement::metadata::RecordedSensor::site), 0.0))
}

/// Topics of the truth: sensors one by one, of contacts and bodies the first and the last.
fn topics(shot: &Shot) -> Vec<String> {
    let topics: Vec<&str> = shot.truth.iter().map(topic).collect();
    let kind = |topic: &str| topic.split('/').next().unwrap_or_default().to_owned();
    let groups = topics.chunk_by(|a, b| kind(a) == kind(b) && kind(a) != "sensor");
    let told = groups.filter_map(|group| match group {
        [first, .., last] => Some(format!("{first} to {last}")),
        [one] => Some((*one).to_owned()),
        [] => None,
    });
    told.collect()
}

/// The truth called `name`, in full, by its topic, or a sensor's by the sensor's name. What it
/// starts from is its static part.
fn truth(set: &TraceSet, shot: &Shot, name: &str) -> anyhow::Result<SelectedSignal> {
    let name = name.trim_start_matches("/truth/");
    let of_sensor = |trace: &Trace| TrueSignal::of(trace)?.sensor().map(str::to_owned);
    let found = shot.truth.iter().find(|trace| {
        topic(trace) == name || trace.name == name || of_sensor(trace).as_deref() == Some(name)
    });
    let Some(trace) = found else {
        bail!("found no truth `{name}`, expected one of: {}", topics(shot).join(", "));
    };
    let sensors = metadata::sensors_of(set, shot.number);
    let sensor = of_sensor(trace).and_then(|name| sensors.iter().find(|s| s.name == name));
    let offset = trace.values.first().copied().unwrap_or(0.0);
    Ok((trace.clone(), sensor.and_then(crate::measurement::metadata::RecordedSensor::site), offset))
}
