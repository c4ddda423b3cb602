//! The oscilloscope's front panel: `[scope]` with its channels and its trigger.

use std::rc::Rc;

use super::document::{Entries, Node};
use super::drive::OUTPUTS;
use super::oscilloscope;
use super::problem::one_of;
use super::table::{Bound, TableReader};
use super::table::{any, count, flag, positive, quantity, table, table_of, text, word, words};
use crate::quantity::{Dimension, engineering};
use crate::scope::{
    AcquireMode, AcquireSetup, ChannelSetup, Coupling, Deviation, EdgeCoupling, Model, Setup,
    Slope, Trigger, TriggerMode, TriggerSource, VerticalSetup,
};
use crate::sensor::Load;

/// The keys of a scope's channels.
const CHANNELS: [&str; 4] = ["ch1", "ch2", "ch3", "ch4"];

table! {
    /// `[scope]` beside its model.
    pub struct PanelKeys<'a> {
        /// `hertzscope list scopes`; each number of its file can be replaced here, e.g.
        /// bandwidth = "60 MHz"
        model: &'a str =
            text().required().needs("the name of an oscilloscope, e.g. \"tds2014\""),
        /// ten divisions
        time_base: f64 = positive(Dimension::TIME_PER_DIVISION).required(),
        /// of the screen's centre after the trigger
        position: f64 = quantity(Dimension::TIME, Bound::Any).or("0 s"),
        /// or "peak detect" (lowest and highest sample of each two intervals),
        /// "average" of many impacts
        acquisition: AcquireMode = word::<AcquireMode>().or("sample"),
        /// 4, 16, 64 or 128 impacts in an average, of one motion with other noise
        averages: u32 = count(2, u32::MAX as u64).or("16"),
        trigger: TriggerKeys<'a> = table_of(&[TriggerKeys::KEYS])
            .required()
            .needs("a table [scope.trigger] with source and level"),
        /// up to [scope.ch4]; a channel without a table is off
        ch1: ChannelKeys<'a> = table_of(&[ChannelKeys::KEYS]),
        ch2: ChannelKeys<'a> = table_of(&[ChannelKeys::KEYS]),
        ch3: ChannelKeys<'a> = table_of(&[ChannelKeys::KEYS]),
        ch4: ChannelKeys<'a> = table_of(&[ChannelKeys::KEYS]),
        /// a sensor at the external trigger input
        external: InputKeys<'a> = table_of(&[InputKeys::KEYS]),
    }
}

table! {
    /// What is connected to an input.
    pub struct InputKeys<'a> {
        /// the sensor's name, or "sync", "generator" of a drive; default: nothing connected
        input: &'a str = text(),
    }
}

table! {
    /// `[scope.ch1]` to `[scope.ch4]`.
    pub struct ChannelKeys<'a> {
        /// the sensor's name, or "generator", "sync" of a drive; default: nothing connected
        input: &'a str = text(),
        scale: f64 = positive(Dimension::VOLTAGE_PER_DIVISION).required(),
        /// of the trace's zero from the screen's centre
        position: f64 = quantity(Dimension::DIVISION, Bound::Any).or("0 div"),
        /// attenuation: 1, 10, 100, 1000
        probe: f64 = positive(Dimension::NONE).or("1"),
        /// or "AC", "GND"
        coupling: Coupling = word::<Coupling>().or("DC"),
        /// true: 20 MHz
        bandwidth_limit: bool = flag().or("false"),
        invert: bool = flag().or("false"),
        /// what the input itself adds
        offset: f64 = quantity(Dimension::VOLTAGE, Bound::Any).or("0 V"),
    }
}

table! {
    /// `[scope.trigger]`.
    pub struct TriggerKeys<'a> {
        /// or "CH2" to "CH4", "EXT", "EXT5"
        source: &'a Node = any(&[]).required().needs("what to watch, e.g. \"CH1\""),
        level: f64 = quantity(Dimension::VOLTAGE, Bound::Any).required(),
        /// or "fall"
        slope: Slope = word::<Slope>().or("rise"),
        /// or "normal"
        mode: TriggerMode = word::<TriggerMode>().or("auto"),
        /// or "AC", "HF reject", "LF reject", "noise reject"
        coupling: EdgeCoupling = word::<EdgeCoupling>().or("DC"),
        /// no other trigger for so long, where the bench is struck again and again (`serve`)
        holdoff: f64 = positive(Dimension::TIME).or("500 ns"),
    }
}

words! { AcquireMode { "sample" => Sample, "peak detect" => PeakDetect, "average" => Average } }
words! { Coupling { "DC" => Dc, "AC" => Ac, "GND" => Ground } }
words! { Slope { "rise" => Rise, "fall" => Fall } }
words! { TriggerMode { "auto" => Auto, "normal" => Normal } }
words! {
    EdgeCoupling {
        "DC" => Dc,
        "AC" => Ac,
        "HF reject" => HighFrequencyReject,
        "LF reject" => LowFrequencyReject,
        "noise reject" => NoiseReject,
    }
}

/// A front panel that was read before. Few scenes of a sweep have one of their own, and reading it
/// takes longer than anything else about them.
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
    /// The panel of `table` in a scene of this duration (s), if nothing is wrong with it.
    pub fn of(table: &TableReader<'_>, sensors: Vec<&str>, duration: f64) -> Option<Self> {
        let setup = panel(table, &sensors, Some(duration))?;
        let sensors = sensors.into_iter().map(str::to_owned).collect();
        Some(Self { entries: Rc::clone(table.entries), sensors, duration, setup })
    }

    /// Whether reading it again, from `table`, would find the same.
    fn is_of(&self, table: &TableReader<'_>, sensors: &[&str], duration: Option<f64>) -> bool {
        Rc::ptr_eq(&self.entries, table.entries)
            && self.sensors == sensors
            && Some(self.duration) == duration
    }
}

/// The front panel of a scene; it is `known` if that was read from the same table.
pub fn setup(
    table: &TableReader<'_>,
    sensors: &[&str],
    duration: Option<f64>,
    known: Option<&CachedPanel>,
) -> Option<Setup> {
    match known.filter(|panel| panel.is_of(table, sensors, duration)) {
        Some(panel) => Some(panel.setup.clone()),
        None => panel(table, sensors, duration),
    }
}

/// Reads `[scope]`, without noise. If the model cannot be read, everything but its limits is
/// checked.
fn panel(table: &TableReader<'_>, sensors: &[&str], duration: Option<f64>) -> Option<Setup> {
    let keys = PanelKeys::read(table);
    // Without a model every key of its file would be missing: once is enough.
    let model = if table.has("model") { oscilloscope::model(table) } else { None };
    if let (Some(model), Some(time_base)) = (&model, keys.time_base) {
        oscilloscope::check_window(table, model, (time_base, keys.position), duration);
    }
    let tables = [keys.ch1, keys.ch2, keys.ch3, keys.ch4];
    let inputs = model.as_ref().map_or(CHANNELS.len(), |model| usize::from(model.channels));
    for key in CHANNELS.iter().skip(inputs).filter(|key| table.has(key)) {
        let expected = format!("at most ch{inputs}: the scope has {inputs} channels");
        table.problem(key, format!("[scope.{key}]"), expected);
    }
    let tables = tables.get(..inputs).unwrap_or(&tables);
    let channels: Vec<Option<ChannelSetup>> =
        tables.iter().map(|keys| channel_setup(keys.as_ref()?, model.as_ref(), sensors)).collect();
    let external = keys.external.as_ref().and_then(|keys| input(&keys.table, keys.input, sensors));
    one_channel_a_sensor(tables, &channels, keys.external.as_ref(), external.as_ref());
    if CHANNELS.iter().all(|key| !table.has(key)) {
        table.problem("ch1", "no channel", "at least one channel, [scope.ch1] to [scope.ch4]");
    }
    let trigger = keys.trigger.and_then(|trigger| {
        let on: Vec<bool> = CHANNELS.iter().take(inputs).map(|key| table.has(key)).collect();
        let inputs = Inputs { channels: &channels, on: &on, external: table.has("external") };
        trigger_setup(&trigger, model.as_ref(), &inputs)
    });
    if let (Some(number), Some(model)) = (keys.averages, &model)
        && !model.limits.averages.contains(&number)
    {
        let known = one_of(model.limits.averages.iter().map(u32::to_string));
        table.problem("averages", number.to_string(), known);
    }
    Some(Setup {
        acquisition: AcquireSetup { mode: keys.acquisition?, averages: keys.averages? },
        model: model?,
        channels,
        external,
        time_base: keys.time_base?,
        horizontal_position: keys.position?,
        trigger: trigger?,
        noise: 0.0,
    })
}

/// A plate drives one cable: the circuit includes the load of one input alone.
fn one_channel_a_sensor(
    tables: &[Option<ChannelKeys<'_>>],
    channels: &[Option<ChannelSetup>],
    external_table: Option<&InputKeys<'_>>,
    external: Option<&String>,
) {
    let input = |channel: &Option<ChannelSetup>| {
        channel.as_ref().and_then(|c| c.input.clone()).filter(|name| !OUTPUTS.contains(&&**name))
    };
    let inputs: Vec<Option<String>> = channels.iter().map(input).collect();
    let taken = inputs.iter().position(|name| name.is_some() && name.as_ref() == external);
    if let (Some(channel), Some(name), Some(keys)) = (taken, external, external_table) {
        let found = format!("\"{name}\", which is at the input of CH{}", channel + 1);
        keys.table.problem("input", found, "a sensor of its own");
    }
    for (index, (table, name)) in tables.iter().zip(&inputs).enumerate() {
        let first = inputs.iter().position(|other| name.is_some() && other == name);
        if let (Some(keys), Some(name), Some(first)) = (table, name, first)
            && first < index
        {
            let found = format!("\"{name}\", which is at the input of CH{} already", first + 1);
            keys.table.problem("input", found, "a sensor of its own for each channel");
        }
    }
}

/// The name of the sensor at an input.
fn input(table: &TableReader<'_>, name: Option<&str>, sensors: &[&str]) -> Option<String> {
    let name = name?;
    if !sensors.contains(&name) {
        table.problem("input", format!("\"{name}\""), format!("a sensor: {}", one_of(sensors)));
    }
    Some(name.to_owned())
}

fn channel_setup(
    keys: &ChannelKeys<'_>,
    model: Option<&Model>,
    sensors: &[&str],
) -> Option<ChannelSetup> {
    let input = input(&keys.table, keys.input, sensors);
    if let (Some(model), Some(probe), Some(position)) = (model, keys.probe, keys.position) {
        oscilloscope::check_vertical(&keys.table, model, (probe, keys.scale, position));
    }
    let vertical = VerticalSetup {
        scale: keys.scale?,
        position: keys.position?,
        coupling: Some(keys.coupling?),
        bandwidth_limited: Some(keys.bandwidth_limit?),
        inverted: Some(keys.invert?),
        probe: keys.probe?,
    };
    Some(ChannelSetup { vertical, input, offset: keys.offset?, deviation: Deviation::default() })
}

/// The inputs that a trigger may watch.
struct Inputs<'a> {
    channels: &'a [Option<ChannelSetup>],
    /// Which channels have a table, right or not.
    on: &'a [bool],
    /// Whether the external input has one.
    external: bool,
}

/// The trigger's source.
fn trigger_source(keys: &TriggerKeys<'_>, channels: usize) -> Option<TriggerSource> {
    let node = keys.source?;
    if node.is_text("LINE") {
        let expected = "a source with the impact's signal; the mains have none";
        keys.table.problem("source", "\"LINE\"", expected);
        return None;
    }
    let channels = (1..).take(channels).map(TriggerSource::Channel);
    let sources: Vec<TriggerSource> =
        channels.chain([TriggerSource::External, TriggerSource::External5]).collect();
    let found = sources.iter().find(|source| node.is_text(&source.to_string())).copied();
    if found.is_none() {
        let names = sources.iter().map(|source| format!("\"{source}\""));
        keys.table.problem("source", node.describe(), one_of(names));
    }
    found
}

fn trigger_setup(
    keys: &TriggerKeys<'_>,
    model: Option<&Model>,
    inputs: &Inputs<'_>,
) -> Option<Trigger> {
    let table = &keys.table;
    let source = trigger_source(keys, inputs.channels.len());
    let limits = model.map_or((0.0, f64::INFINITY), |model| model.limits.holdoff);
    let seconds = |time: f64| engineering(time, "s", 3);
    // The default is the shortest of this family; another model may have another.
    let holdoff = if table.has("holdoff") { keys.holdoff } else { Some(limits.0) };
    if let Some(holdoff) = holdoff.filter(|time| *time < limits.0 || *time > limits.1) {
        let expected = format!("{} to {}", seconds(limits.0), seconds(limits.1));
        table.problem("holdoff", seconds(holdoff), expected);
    }
    let (source, level) = (source?, keys.level?);
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
    Some(Trigger {
        source,
        level,
        slope: keys.slope?,
        mode: keys.mode?,
        coupling: keys.coupling?,
        holdoff: holdoff?,
    })
}

/// The load of a sensor at this channel's input.
pub fn load(model: &Model, channel: &ChannelSetup) -> Load {
    if channel.vertical.probe > 1.0 {
        Load { resistance: model.probe_resistance, capacitance: model.probe_capacitance }
    } else {
        Load { resistance: model.input_resistance, capacitance: model.input_capacitance }
    }
}
