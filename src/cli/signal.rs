//! The signal of a recording that a command looks at.

use std::path::PathBuf;

use anyhow::bail;
use clap::{Args, ValueEnum};

use super::input::{BenchArguments, TableArguments};
use crate::analysis::gate::Gate;
use crate::analysis::spectrum::Window;
use crate::measurement::metadata;
use crate::quantity::{Dimension, parse};
use crate::recording::true_signal::topic;
use crate::recording::{Shot, TraceSet, TrueSignal};
use crate::scene::Site;
use crate::trace::Trace;

/// The window function of a record.
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

/// Which signal of a recording, and which part of it.
#[derive(Debug, Args)]
pub struct SignalArguments {
    /// A recording (.mcap), a TDS2000 file (.csv), or a folder of them
    file: PathBuf,
    #[command(flatten)]
    table: TableArguments,
    #[command(flatten)]
    bench: BenchArguments,
    /// Channel to transform, e.g. CH2 [default: the first]
    #[arg(long, value_name = "CH", conflicts_with = "truth")]
    channel: Option<String>,
    /// A simulated signal, less its static part: a sensor's name, contact/3, bead/7
    #[arg(long, value_name = "NAME")]
    truth: Option<String>,
    /// Shot to look at
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub shot: u32,
    /// First time to take, e.g. 200us: after the trigger, or with --truth after the striker's first contact
    #[arg(long, value_name = "T", value_parser = time, allow_hyphen_values = true)]
    from: Option<f64>,
    /// First time to leave out
    #[arg(long, value_name = "T", value_parser = time, allow_hyphen_values = true)]
    to: Option<f64>,
}

impl SignalArguments {
    /// Reads the recording and finds the signal in it.
    pub fn read(&self) -> anyhow::Result<(TraceSet, SelectedSignal)> {
        let mut set = self.table.open_shot(&self.file, self.shot)?;
        self.bench.apply(&mut set)?;
        let Some(shot) = set.shots.iter().find(|shot| shot.number == self.shot) else {
            bail!("found {} shots, expected one with number {}", set.shots.len(), self.shot);
        };
        let found = signal(&set, shot, self.channel.as_deref(), self.truth.as_deref())?;
        Ok((set, found))
    }

    /// How many samples of the signal are clipped, where any are.
    pub fn clipped(&self, set: &TraceSet) -> Option<String> {
        let shot = set.shots.iter().find(|shot| shot.number == self.shot)?;
        let wanted =
            |name: &str| self.channel.as_ref().is_none_or(|c| name.eq_ignore_ascii_case(c));
        let mut captures = shot.captures.iter().map(|capture| &capture.waveform);
        let waveform = captures
            .find(|waveform| wanted(&waveform.source.to_string()))
            .filter(|waveform| self.truth.is_none() && waveform.clipped() > 0)?;
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

/// A signal, where it was felt, and what is subtracted from it.
pub type SelectedSignal = (Trace, Option<Site>, f64);

/// The truth called `named`, or the capture of `channel`, the first without one.
pub fn signal(
    set: &TraceSet,
    shot: &Shot,
    channel: Option<&str>,
    named: Option<&str>,
) -> anyhow::Result<SelectedSignal> {
    match named {
        Some(name) => truth(set, shot, name),
        None => capture(set, shot, channel),
    }
}

fn capture(set: &TraceSet, shot: &Shot, channel: Option<&str>) -> anyhow::Result<SelectedSignal> {
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
    let sensors = metadata::sensors_of(set, shot.number);
    let sensor = sensors.iter().find(|sensor| sensor.channel.as_ref() == Some(&name));
    if let Some(sensor) = sensor {
        trace.name = format!("{name}, sensor {}", sensor.name);
    }
    Ok((trace, sensor.and_then(crate::measurement::metadata::RecordedSensor::site), 0.0))
}

/// The truth called `name`, in full, by its topic, or a sensor's by the sensor's name. What it starts from is its static part.
fn truth(set: &TraceSet, shot: &Shot, name: &str) -> anyhow::Result<SelectedSignal> {
    let name = name.trim_start_matches("/truth/");
    let of_sensor = |trace: &Trace| TrueSignal::of(trace)?.sensor().map(str::to_owned);
    let found = shot.truth.iter().find(|trace| {
        topic(trace) == name || trace.name == name || of_sensor(trace).as_deref() == Some(name)
    });
    let Some(trace) = found else {
        let names: Vec<&str> = shot.truth.iter().map(topic).collect();
        bail!("found no truth `{name}`, expected one of: {}", names.join(", "));
    };
    let sensors = metadata::sensors_of(set, shot.number);
    let sensor = of_sensor(trace).and_then(|name| sensors.iter().find(|s| s.name == name));
    let offset = trace.values.first().copied().unwrap_or(0.0);
    Ok((trace.clone(), sensor.and_then(crate::measurement::metadata::RecordedSensor::site), offset))
}
