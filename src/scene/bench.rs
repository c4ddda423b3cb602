//! The oscilloscope's front panel: `[scope]` with its channels and its trigger.

use std::rc::Rc;

use super::document::{Entries, Node};
use super::oscilloscope;
use super::problem::MISSING;
use super::reader::{Bound, Problems, TableReader};
use super::sensors::sensor_names;
use crate::quantity::{Dimension, engineering};
use crate::scope::{
    AcquireMode, AcquireSetup, ChannelSetup, Coupling, Deviation, EdgeCoupling, Model, Setup,
    Slope, Trigger, TriggerMode, TriggerSource, VerticalSetup,
};
use crate::sensor::Load;

/// The keys of a scope's channels.
const CHANNELS: [&str; 4] = ["ch1", "ch2", "ch3", "ch4"];

/// A front panel that was read before. Of the scenes of a sweep few have one of their own, and
/// reading it takes longer than anything else about them.
#[derive(Debug, Clone)]
pub struct CachedPanel {
    /// The table that it was read from.
    entries: Rc<Entries>,
    /// Names of the sensors that it may be wired to.
    sensors: Vec<String>,
    /// Of the scene that it shows (s).
    duration: f64,
    setup: Setup,
}

impl CachedPanel {
    /// That of the scene `root`, whose duration this is (s), if nothing is wrong with it.
    pub fn of(root: &Node, duration: f64) -> Option<Self> {
        let problems = Problems::default();
        let root = TableReader::of(root, "", &problems)?;
        let table = root.table("scope")?;
        let sensors = sensor_names(&root);
        let setup = scope(&table, &sensors, Some(duration))?;
        let sensors = sensors.into_iter().map(str::to_owned).collect();
        let entries = Rc::clone(table.entries);
        let found = Self { entries, sensors, duration, setup };
        problems.into_sorted().is_empty().then_some(found)
    }

    /// Whether reading it again, from `table`, would find the same.
    fn is_of(&self, table: &TableReader<'_>, sensors: &[&str], duration: Option<f64>) -> bool {
        Rc::ptr_eq(&self.entries, table.entries)
            && self.sensors == sensors
            && Some(self.duration) == duration
    }
}

/// The front panel of a scene, with the front end's noise (div), and its errors drawn from a seed,
/// if any; it is `panel` where that was read from the same.
pub fn drawn(
    root: &TableReader<'_>,
    (noise, errors_of): (f64, Option<u64>),
    duration: Option<f64>,
    panel: Option<&CachedPanel>,
) -> Option<Setup> {
    if !root.has("scope") {
        let expected = "[scope] with model, time_base, trigger and channels";
        root.problem("scope", MISSING, expected);
    }
    let table = root.table("scope")?;
    let sensors = sensor_names(root);
    let known = panel.filter(|panel| panel.is_of(&table, &sensors, duration));
    let setup = if let Some(panel) = known {
        panel.setup.clone()
    } else {
        let _ = table.text("source");
        let setup = scope(&table, &sensors, duration);
        table.finish();
        setup?
    };
    let mut setup = Setup { noise, ..setup };
    for (number, channel) in (1..).zip(&mut setup.channels) {
        if let (Some(seed), Some(channel)) = (errors_of, channel) {
            channel.deviation = Deviation::drawn(seed, number);
        }
    }
    Some(setup)
}

/// Reads `[scope]`, without noise. Where the model cannot be read, everything but its limits is
/// checked still.
fn scope(table: &TableReader<'_>, sensors: &[&str], duration: Option<f64>) -> Option<Setup> {
    let model = oscilloscope::model(table);
    let time_base = table.required("time_base", Dimension::TIME_PER_DIVISION, Bound::Positive);
    let position = table.quantity("position", Dimension::TIME, Bound::Any);
    if let (Some(model), Some(time_base)) = (&model, time_base) {
        let position = if table.has("position") { position } else { Some(0.0) };
        oscilloscope::check_window(table, model, (time_base, position), duration);
    }
    let inputs = model.as_ref().map_or(CHANNELS.len(), |model| usize::from(model.channels));
    let keys = CHANNELS.get(..inputs).unwrap_or(&CHANNELS);
    let channel = |key: &&'static str| {
        let channel = table.table(key)?;
        let setup = channel_setup(&channel, model.as_ref(), sensors);
        channel.finish();
        setup
    };
    let channels: Vec<Option<ChannelSetup>> = keys.iter().map(channel).collect();
    let external = table.table("external").and_then(|external| {
        let name = input(&external, sensors);
        external.finish();
        name
    });
    one_channel_a_sensor(table, keys, &channels, external.as_ref());
    if CHANNELS.iter().all(|key| !table.has(key)) {
        table.problem("ch1", "no channel", "at least one channel, [scope.ch1] to [scope.ch4]");
    }
    if !table.has("trigger") {
        let expected = "a table [scope.trigger] with source and level";
        table.problem("trigger", "no such key", expected);
    }
    let trigger = table.table("trigger").and_then(|trigger| {
        let on: Vec<bool> = keys.iter().map(|key| table.has(key)).collect();
        let inputs = Inputs { channels: &channels, on: &on, external: table.has("external") };
        let read = trigger_setup(&trigger, model.as_ref(), &inputs);
        trigger.finish();
        read
    });
    let acquisition = acquisition(table, model.as_ref());
    Some(Setup {
        acquisition,
        model: model?,
        channels,
        external,
        time_base: time_base?,
        horizontal_position: position.unwrap_or(0.0),
        trigger: trigger?,
        noise: 0.0,
    })
}

/// `acquisition` and `averages`.
fn acquisition(table: &TableReader<'_>, model: Option<&Model>) -> AcquireSetup {
    let words = [
        ("sample", AcquireMode::Sample),
        ("peak detect", AcquireMode::PeakDetect),
        ("average", AcquireMode::Average),
    ];
    let mode = table.choice("acquisition", &words).unwrap_or(AcquireMode::Sample);
    let averages = table.count("averages", 2, u64::from(u32::MAX));
    let averages = averages.and_then(|number| u32::try_from(number).ok());
    let known = model.map(|model| &model.limits.averages);
    if let (Some(number), Some(known)) = (averages, known)
        && !known.contains(&number)
    {
        let known: Vec<String> = known.iter().map(u32::to_string).collect();
        table.problem("averages", number.to_string(), format!("one of {}", known.join(", ")));
    }
    AcquireSetup { mode, averages: averages.unwrap_or(AcquireSetup::default().averages) }
}

/// A plate drives one cable: the circuit knows the load of one input alone.
fn one_channel_a_sensor(
    table: &TableReader<'_>,
    keys: &[&'static str],
    channels: &[Option<ChannelSetup>],
    external: Option<&String>,
) {
    let input = |channel: &Option<ChannelSetup>| channel.as_ref().and_then(|c| c.input.clone());
    let inputs: Vec<Option<String>> = channels.iter().map(input).collect();
    let taken = inputs.iter().position(|name| name.is_some() && name.as_ref() == external);
    if let (Some(channel), Some(name), Some(table)) = (taken, external, table.table("external")) {
        let found = format!("\"{name}\", which is at the input of CH{}", channel + 1);
        table.problem("input", found, "a sensor of its own");
    }
    for (index, (key, name)) in keys.iter().zip(&inputs).enumerate() {
        let Some(name) = name else { continue };
        let first = inputs.iter().position(|other| other.as_ref() == Some(name));
        if let (Some(first), Some(channel)) =
            (first.filter(|first| *first < index), table.table(key))
        {
            let found = format!("\"{name}\", which is at the input of CH{} already", first + 1);
            channel.problem("input", found, "a sensor of its own for each channel");
        }
    }
}

/// The name of the sensor at an input.
fn input(table: &TableReader<'_>, sensors: &[&str]) -> Option<String> {
    let name = table.text("input")?;
    if !sensors.contains(&name) {
        let expected = format!("a sensor: one of {}", sensors.join(", "));
        table.problem("input", format!("\"{name}\""), expected);
    }
    Some(name.to_owned())
}

fn channel_setup(
    table: &TableReader<'_>,
    model: Option<&Model>,
    sensors: &[&str],
) -> Option<ChannelSetup> {
    let probe = table.quantity("probe", Dimension::NONE, Bound::Positive).unwrap_or(1.0);
    let scale = table.required("scale", Dimension::VOLTAGE_PER_DIVISION, Bound::Positive);
    let position = table.quantity("position", Dimension::DIVISION, Bound::Any).unwrap_or(0.0);
    let coupling = [("DC", Coupling::Dc), ("AC", Coupling::Ac), ("GND", Coupling::Ground)];
    let coupling = table.choice("coupling", &coupling).or(Some(Coupling::Dc));
    let bandwidth_limited = table.flag("bandwidth_limit").or(Some(false));
    let inverted = table.flag("invert").or(Some(false));
    let input = input(table, sensors);
    let offset = table.quantity("offset", Dimension::VOLTAGE, Bound::Any).unwrap_or(0.0);
    if let Some(model) = model {
        oscilloscope::check_vertical(table, model, (probe, scale, position));
    }
    let vertical =
        VerticalSetup { scale: scale?, position, coupling, bandwidth_limited, inverted, probe };
    Some(ChannelSetup { vertical, input, offset, deviation: Deviation::default() })
}

/// Where a trigger could look.
struct Inputs<'a> {
    channels: &'a [Option<ChannelSetup>],
    /// Which channels have a table, sound or not.
    on: &'a [bool],
    /// Whether the external input has one.
    external: bool,
}

fn trigger_setup(
    table: &TableReader<'_>,
    model: Option<&Model>,
    inputs: &Inputs<'_>,
) -> Option<Trigger> {
    let channels = (1..).zip(inputs.channels).map(|(n, _)| TriggerSource::Channel(n));
    let sources: Vec<(String, TriggerSource)> = channels
        .chain([TriggerSource::External, TriggerSource::External5])
        .map(|source| (source.to_string(), source))
        .collect();
    let words: Vec<(&str, TriggerSource)> =
        sources.iter().map(|(name, s)| (name.as_str(), *s)).collect();
    let source = if table.is_word("source", "LINE") {
        let expected = "a source with the impact's signal; the mains have none";
        table.problem("source", "\"LINE\"", expected);
        None
    } else {
        table.choice("source", &words)
    };
    if source.is_none() && !table.has("source") {
        table.problem("source", "no such key", "what to watch, e.g. \"CH1\"");
    }
    let level = table.required("level", Dimension::VOLTAGE, Bound::Any);
    let slope_words = [("rise", Slope::Rise), ("fall", Slope::Fall)];
    let mode_words = [("auto", TriggerMode::Auto), ("normal", TriggerMode::Normal)];
    let slope = table.choice("slope", &slope_words).unwrap_or(Slope::Rise);
    let coupling_words = [
        ("DC", EdgeCoupling::Dc),
        ("AC", EdgeCoupling::Ac),
        ("HF reject", EdgeCoupling::HighFrequencyReject),
        ("LF reject", EdgeCoupling::LowFrequencyReject),
        ("noise reject", EdgeCoupling::NoiseReject),
    ];
    let coupling = table.choice("coupling", &coupling_words).unwrap_or(EdgeCoupling::Dc);
    let holdoff = table.quantity("holdoff", Dimension::TIME, Bound::Positive);
    let limits = model.map_or((0.0, f64::INFINITY), |model| model.limits.holdoff);
    if let Some(holdoff) = holdoff.filter(|time| *time < limits.0 || *time > limits.1) {
        let seconds = |time: f64| engineering(time, "s", 3);
        let expected = format!("{} to {}", seconds(limits.0), seconds(limits.1));
        table.problem("holdoff", seconds(holdoff), expected);
    }
    let holdoff = holdoff.unwrap_or(limits.0);
    let mode = table.choice("mode", &mode_words).unwrap_or(TriggerMode::Auto);
    let (source, level) = (source?, level?);
    if let Some(number) = source.channel() {
        let index = usize::from(number) - 1;
        let Some(channel) = inputs.channels.get(index).and_then(Option::as_ref) else {
            // A channel that is there but wrong has left its own problem.
            if !inputs.on.get(index).copied().unwrap_or(false) {
                table.problem("source", source.to_string(), "a channel that is on");
            }
            return None;
        };
        let vertical = channel.vertical;
        let divisions = level / vertical.scale + vertical.position;
        if let Some(range) = model.map(|m| m.trigger_range).filter(|range| divisions.abs() > *range)
        {
            let expected = format!("a level within {range} div of the screen's centre");
            table.problem("level", engineering(level, "V", 3), expected);
        }
    } else {
        if !inputs.external {
            let expected = "a sensor at the external input, [scope.external]";
            table.problem("source", source.to_string(), expected);
        }
        let reach = model.map(|model| source.reach(model)).filter(|reach| level.abs() > *reach);
        if let Some(reach) = reach {
            let expected = format!("a level within {} at {source}", engineering(reach, "V", 3));
            table.problem("level", engineering(level, "V", 3), expected);
        }
    }
    Some(Trigger { source, level, slope, mode, coupling, holdoff })
}

/// The load of a sensor at this channel's input.
pub fn load(model: &Model, channel: &ChannelSetup) -> Load {
    if channel.vertical.probe > 1.0 {
        Load { resistance: model.probe_resistance, capacitance: model.probe_capacitance }
    } else {
        Load { resistance: model.input_resistance, capacitance: model.input_capacitance }
    }
}
