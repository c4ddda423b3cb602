//! What a user says of the files that a command reads: a table's columns, the bench they were taken
//! on, and which of their shots and channels are meant.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use anyhow::{anyhow, bail};
use clap::Args;

use super::acquire::one_shot;
use crate::data;
use crate::experiment::facts;
use crate::measurement::compare::mapping::Assignment;
use crate::measurement::force::{count_gains, wire};
use crate::measurement::metadata::{self, RecordedDistance};
use crate::numeric::intervals::NORMAL_95;
use crate::quantity::{Dimension, Uncertain, parse};
use crate::recording::format::{Recording, open_shot};
use crate::recording::tek_csv::TableColumns;
use crate::recording::{Shot, TraceSet};
use crate::scene::{Scene, sensors};
use crate::scope::Source;
#[cfg(feature = "tui")]
use crate::tui::model::BenchOption;

/// Metadata groups of sensors begin like this.
const SENSOR: &str = "hertzscope:sensor/";

/// What the columns of a table are.
#[derive(Debug, Args)]
pub struct TableArguments {
    /// Columns of a table (.csv) whose header does not name them, counted from 1, e.g.
    /// time=1:ms,CH1=2:V,p14=4:N
    #[arg(long, value_name = "NAME=COLUMN:UNIT,...")]
    columns: Option<TableColumns>,
}

impl TableArguments {
    /// Opens a recording, a file or a folder, or takes one shot from the scope at an address.
    pub fn open(&self, path: &Path) -> anyhow::Result<Recording> {
        match one_shot(path)? {
            Some(set) => Ok(set.into()),
            None => Ok(Recording::open(path, &self.columns())?),
        }
    }

    /// The columns, or none where they are left to the file.
    pub fn columns(&self) -> TableColumns {
        self.columns.clone().unwrap_or_default()
    }

    /// The same, with shot `number` only.
    pub fn open_shot(&self, path: &Path, number: u32) -> anyhow::Result<TraceSet> {
        match one_shot(path)? {
            Some(set) => Ok(set),
            None => Ok(open_shot(path, number, &self.columns())?),
        }
    }
}

/// Which shots and channels of a file are meant.
#[derive(Debug, Args)]
pub struct Selection {
    /// Only this shot [default: all shots, or the first if the command uses one]
    #[arg(long, value_name = "N")]
    shot: Option<u32>,
    /// Only this channel; may be repeated
    #[arg(long, value_name = "CH")]
    channel: Vec<String>,
}

impl Selection {
    /// The shot that is meant where a single one is looked at.
    pub fn single(&self) -> u32 {
        self.shot.unwrap_or(1)
    }

    /// Whether all of a file is meant.
    #[cfg(feature = "tui")]
    fn is_all(&self) -> bool {
        self.shot.is_none() && self.channel.is_empty()
    }

    /// Places and numbers of the shots that are meant, in order of time.
    pub fn shots(&self, recording: &Recording) -> anyhow::Result<Vec<(usize, u32)>> {
        let numbers = recording.index().iter().map(|(number, _)| *number).enumerate();
        let wants = |(_, number): &(usize, u32)| self.shot.is_none_or(|shot| shot == *number);
        let found: Vec<(usize, u32)> = numbers.filter(wants).collect();
        if let Some(number) = self.shot.filter(|_| found.is_empty()) {
            bail!("no shot {number}: the file has {}", recording.index().len());
        }
        known_channels(&recording.channels(), self.channel.iter())?;
        Ok(found)
    }

    /// Calls `act` with each shot that is meant, one after the other in order of time.
    pub fn for_each_shot(
        &self,
        recording: &mut Recording,
        mut act: impl FnMut(&mut TraceSet) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        for (place, _) in self.shots(recording)? {
            act(self.read(recording, place)?)?;
        }
        Ok(())
    }

    /// Reads the shot at `place` without channels that are not meant.
    pub fn read<'a>(
        &self,
        recording: &'a mut Recording,
        place: usize,
    ) -> anyhow::Result<&'a mut TraceSet> {
        let set = recording.shot(place)?;
        self.filter(set);
        Ok(set)
    }

    /// Number of captures that are meant.
    pub fn captures(&self, recording: &Recording) -> anyhow::Result<usize> {
        let shots = self.shots(recording)?;
        let channels = shots.iter().filter_map(|(place, _)| recording.index().get(*place));
        let meant = channels.flat_map(|(_, sources)| sources).filter(|source| {
            let name = source.to_string();
            self.channel.is_empty() || self.channel.iter().any(|c| name.eq_ignore_ascii_case(c))
        });
        Ok(meant.count())
    }

    /// Leaves out of `set` all channels but those named, if any are.
    pub fn keep_channels(&self, set: &mut TraceSet) -> anyhow::Result<()> {
        known_channels(&channels(set), self.channel.iter())?;
        self.filter(set);
        Ok(())
    }

    fn filter(&self, set: &mut TraceSet) {
        let wanted = |name: &str| self.channel.iter().any(|known| name.eq_ignore_ascii_case(known));
        for shot in set.shots.iter_mut().filter(|_| !self.channel.is_empty()) {
            shot.captures.retain(|capture| wanted(&capture.waveform.source.to_string()));
        }
    }
}

/// Names of the channels of all shots in `set`.
pub fn channels(set: &TraceSet) -> BTreeSet<String> {
    let captures = set.shots.iter().flat_map(|shot| &shot.captures);
    captures.map(|capture| capture.waveform.source.to_string()).collect()
}

/// The shot of a number.
pub fn shot<'a>(set: &'a TraceSet, name: &str, number: u32) -> anyhow::Result<&'a Shot> {
    let Some(shot) = set.shots.iter().find(|shot| shot.number == number) else {
        bail!("{name}: found {} shots, expected one with number {number}", set.shots.len());
    };
    Ok(shot)
}

/// Why a file has no capture to look at.
pub fn no_capture(problems: &[String]) -> anyhow::Error {
    match problems {
        [] => anyhow!("no capture in this file: the scope was not triggered"),
        problems => anyhow!("no capture can be read from this file: {}", problems.join("; ")),
    }
}

/// What is read of a file: its columns, its bench, its shots and channels.
#[derive(Debug, Args)]
pub struct ReadingArguments {
    #[command(flatten)]
    pub table: TableArguments,
    #[command(flatten)]
    bench: BenchArguments,
    #[command(flatten)]
    pub selection: Selection,
}

impl ReadingArguments {
    /// Opens a recording, a file or a folder, and notes in it what is known of the bench.
    pub fn open_recording(&self, path: &Path) -> anyhow::Result<Recording> {
        let mut recording = self.table.open(path)?;
        let channels = recording.channels();
        // A sensor's load follows from the settings of a capture of its channel.
        let with_captures: BTreeSet<usize> =
            self.bench.sensor.iter().filter_map(|wired| first_shot(&recording, wired)).collect();
        for place in with_captures {
            self.bench.apply(recording.shot(place)?, &channels)?;
        }
        if self.bench.sensor.is_empty() {
            self.bench.apply(recording.facts_mut(), &channels)?;
        }
        Ok(recording)
    }

    /// Notes in the facts of `recording` how well the gain of each channel is known, by the last
    /// shot that has the channel.
    pub fn count_gains(&self, recording: &mut Recording) -> anyhow::Result<()> {
        let mut seen = BTreeSet::new();
        let mut places = self.selection.shots(recording)?;
        places.reverse();
        places.retain(|(place, _)| {
            let sources = recording.index().get(*place).map(|(_, sources)| sources.clone());
            sources.is_some_and(|sources| {
                // Not `any`, which stops at the first new one.
                let new = sources.into_iter().filter(|source| seen.insert(*source)).count();
                new > 0
            })
        });
        for (place, _) in places.into_iter().rev() {
            count_gains(recording.shot(place)?)?;
        }
        Ok(())
    }

    /// Opens a recording, a file or a folder, with all shots that are meant in memory.
    pub fn open(&self, path: &Path) -> anyhow::Result<TraceSet> {
        self.whole(self.open_recording(path)?)
    }

    /// All shots of `recording` that are meant, in memory.
    pub fn whole(&self, recording: Recording) -> anyhow::Result<TraceSet> {
        let numbers: Vec<u32> =
            self.selection.shots(&recording)?.into_iter().map(|(_, number)| number).collect();
        let mut set = recording.into_set()?;
        set.shots.retain(|shot| numbers.contains(&shot.number));
        self.selection.filter(&mut set);
        count_gains(&mut set)?;
        Ok(set)
    }

    /// Calls `act` with each shot that is meant, one after the other in order of time.
    pub fn for_each_shot(
        &self,
        recording: &mut Recording,
        mut act: impl FnMut(&mut TraceSet) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        self.selection.for_each_shot(recording, |set| {
            count_gains(set)?;
            act(set)
        })
    }

    /// Opens the single shot that is looked at.
    pub fn open_single(&self, path: &Path) -> anyhow::Result<(TraceSet, Shot)> {
        let number = self.selection.single();
        let mut set = self.table.open_shot(path, number)?;
        let channels = channels(&set);
        self.bench.apply(&mut set, &channels)?;
        self.selection.keep_channels(&mut set)?;
        let shot = shot(&set, &path.display().to_string(), number)?.clone();
        Ok((set, shot))
    }

    /// Whether the file is looked at as it is.
    #[cfg(feature = "tui")]
    pub fn is_as_it_is(&self) -> bool {
        self.bench.is_empty() && self.selection.is_all()
    }
}

/// Refuses a channel that no shot has.
fn known_channels<'a>(
    names: &BTreeSet<String>,
    mut asked: impl Iterator<Item = &'a String>,
) -> anyhow::Result<()> {
    let unknown = |channel: &&String| !names.iter().any(|name| name.eq_ignore_ascii_case(channel));
    if let Some(channel) = asked.find(unknown) {
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        bail!("no channel {channel}: the file has {}", names.join(", "));
    }
    Ok(())
}

/// The bench on which a file was taken.
#[derive(Debug, Args)]
pub struct BenchArguments {
    /// Scene that describes the bench (included, or a .toml file): which sensor is at which
    /// channel, distances, calibrations
    #[arg(long, value_name = "SCENE")]
    scene: Option<String>,
    /// Sensor of the scene at a channel, e.g. CH1=p2,CH2=p14 [default: as in the scene]
    #[arg(long, value_name = "CH=NAME", value_delimiter = ',', value_parser = assignment)]
    map: Vec<Assignment>,
    /// Calibration of the sensor at a channel, an included sensor or a file that `calibrate` wrote,
    /// e.g. CH1=sensor.toml
    #[arg(long, value_name = "CH=SENSOR", value_parser = wired)]
    sensor: Vec<SensorAssignment>,
    /// Distance along the chain between two channels' sensors, with its expanded uncertainty (95
    /// %), e.g. CH1-CH2="47.2 mm +- 0.1 mm"
    #[arg(long, value_name = "CH-CH=D", value_parser = distance)]
    distance: Vec<RecordedDistance>,
}

impl BenchArguments {
    /// Whether the user says nothing.
    #[cfg(feature = "tui")]
    fn is_empty(&self) -> bool {
        self.scene.is_none()
            && self.map.is_empty()
            && self.sensor.is_empty()
            && self.distance.is_empty()
    }

    /// What a single option says.
    #[cfg(feature = "tui")]
    fn single(option: BenchOption, value: &str) -> Result<Self, String> {
        let mut said =
            Self { scene: None, map: Vec::new(), sensor: Vec::new(), distance: Vec::new() };
        match option {
            BenchOption::Scene => said.scene = Some(value.to_owned()),
            BenchOption::Map => {
                said.map = value.split(',').map(assignment).collect::<Result<_, _>>()?;
            }
            BenchOption::Sensor => said.sensor.push(wired(value)?),
            BenchOption::Distance => said.distance.push(distance(value)?),
        }
        Ok(said)
    }

    /// Notes in `set` what is known of the bench; `names` are the channels of all its shots.
    fn apply(&self, set: &mut TraceSet, names: &BTreeSet<String>) -> anyhow::Result<()> {
        let mut map = self.map.clone();
        if let Some(name) = &self.scene {
            map.extend(labels(set));
            place_scene(set, &Scene::load(name)?);
        }
        for assignment in &map {
            // A label of a table's column need not be a sensor's name.
            let is_said = self.map.contains(assignment);
            if !wire_scene_sensor(set, assignment) && is_said {
                let names: Vec<String> =
                    metadata::sensors(set).into_iter().map(|sensor| sensor.name).collect();
                let Assignment { channel, target } = assignment;
                bail!(
                    "{channel}={target}: no sensor `{target}` is known, {}",
                    if names.is_empty() {
                        "give the bench with --scene".to_owned()
                    } else {
                        format!("the sensors are {}", names.join(", "))
                    }
                );
            }
        }
        let channels = self.distance.iter().flat_map(|known| [&known.from, &known.to]);
        known_channels(names, channels.chain(self.map.iter().map(|said| &said.channel)))?;
        wire_all(set, names, &self.sensor)?;
        count_gains(set)?;
        for distance in &self.distance {
            let (group, facts) = distance.facts();
            set.metadata.insert(group, facts);
        }
        Ok(())
    }
}

/// Place of the first shot that has the channel of `wired`; the first of all if none has.
fn first_shot(recording: &Recording, wired: &SensorAssignment) -> Option<usize> {
    let has = |sources: &Vec<Source>| {
        sources.iter().any(|source| source.to_string().eq_ignore_ascii_case(&wired.channel))
    };
    let index = recording.index();
    let place = index.iter().position(|(_, sources)| has(sources));
    place.or_else(|| (!index.is_empty()).then_some(0))
}

/// Notes in `set` what one option says of the bench, for commands of the screen.
#[cfg(feature = "tui")]
pub fn note_option(set: &mut TraceSet, option: BenchOption, value: &str) -> Result<(), String> {
    let said = BenchArguments::single(option, value)?;
    let names = channels(set);
    said.apply(set, &names).map_err(|error| format!("{error:#}"))
}

/// Channels with labels of a table's columns.
fn labels(set: &TraceSet) -> Vec<Assignment> {
    let sensors = metadata::sensors(set).into_iter().filter(|sensor| sensor.place.is_none());
    sensors
        .filter_map(|sensor| Some(Assignment { channel: sensor.channel?, target: sensor.name }))
        .collect()
}

/// Puts `scene` in the place of whatever scene `set` had.
fn place_scene(set: &mut TraceSet, scene: &Scene) {
    set.metadata
        .retain(|name, _| !name.starts_with(SENSOR) && !name.starts_with("hertzscope:shot/"));
    set.attachments.retain(|attachment| attachment.media_type != "application/toml");
    let of_shot = "hertzscope:shot/1/sensor/";
    let sensors = facts::shot_facts(scene, 1, 1).into_iter();
    set.metadata.extend(sensors.filter_map(|(name, facts)| {
        Some((format!("{SENSOR}{}", name.strip_prefix(of_shot)?), facts))
    }));
    set.attachments.extend(facts::scene_attachments(scene));
}

/// Notes that a sensor which is known by name is at a channel; whether there is such a sensor.
fn wire_scene_sensor(set: &mut TraceSet, Assignment { channel, target }: &Assignment) -> bool {
    let channel = channel.to_ascii_uppercase();
    let is_sensor = |(name, facts): &(&String, &mut BTreeMap<String, String>)| {
        name.contains("sensor/") && facts.contains_key("name")
    };
    let mut sensors: Vec<_> =
        set.metadata.iter_mut().filter(is_sensor).map(|(_, facts)| facts).collect();
    let named = |facts: &BTreeMap<String, String>| {
        facts.get("name").is_some_and(|name| name.eq_ignore_ascii_case(target))
    };
    if !sensors.iter().any(|facts| named(facts)) {
        return false;
    }
    for facts in &mut sensors {
        if named(facts) {
            facts.insert("channel".to_owned(), channel.clone());
        } else if facts.get("channel") == Some(&channel) {
            facts.remove("channel");
        }
    }
    true
}

/// Reads `CH1=p2`.
pub fn assignment(text: &str) -> Result<Assignment, String> {
    match text.split_once('=') {
        Some((channel, target)) if !channel.trim().is_empty() && !target.trim().is_empty() => {
            Ok(Assignment { channel: channel.trim().to_owned(), target: target.trim().to_owned() })
        }
        _ => Err(format!("found {text}, expected a channel and a sensor, e.g. CH1=p2")),
    }
}

/// Reads `CH1-CH2=47.2 mm +- 0.1 mm`.
fn distance(text: &str) -> Result<RecordedDistance, String> {
    let example = "e.g. CH1-CH2=\"47.2 mm +- 0.1 mm\"";
    let pair = text.split_once('=').and_then(|(pair, value)| Some((pair.split_once('-')?, value)));
    let Some(((from, to), value)) = pair else {
        return Err(format!("`{text}` names no two channels: give both and a distance, {example}"));
    };
    let length = |text: &str| {
        parse(text.trim(), Dimension::LENGTH).map_err(|error| format!("{error}; {example}"))
    };
    let (value, expanded) =
        value.split_once("+-").or_else(|| value.split_once('±')).unwrap_or((value, "0 m"));
    let distance = Uncertain::normal(length(value)?, length(expanded)? / NORMAL_95);
    if distance.value <= 0.0 || distance.u < 0.0 {
        return Err(format!("`{text}` is no distance above zero, {example}"));
    }
    let name = |channel: &str| channel.trim().to_ascii_uppercase();
    Ok(RecordedDistance { from: name(from), to: name(to), distance })
}

/// A channel and its sensor, as typed.
#[derive(Debug, Clone)]
pub struct SensorAssignment {
    /// The measured channel.
    pub channel: String,
    sensor: String,
}

/// Reads `CH1=NAME`.
pub fn wired(text: &str) -> Result<SensorAssignment, String> {
    match text.split_once('=') {
        Some((channel, sensor)) if !channel.trim().is_empty() && !sensor.trim().is_empty() => {
            Ok(SensorAssignment {
                channel: channel.trim().to_owned(),
                sensor: sensor.trim().to_owned(),
            })
        }
        _ => Err(format!("found {text}, expected a channel and a sensor, e.g. CH1=sensor.toml")),
    }
}

/// Notes all of them in `set`, whose shots have the channels `names`.
pub fn wire_all(
    set: &mut TraceSet,
    names: &BTreeSet<String>,
    wires: &[SensorAssignment],
) -> anyhow::Result<()> {
    for SensorAssignment { channel, sensor } in wires {
        if !names.iter().any(|name| name.eq_ignore_ascii_case(channel)) {
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            bail!("found no channel {channel}, expected one of {}", names.join(", "));
        }
        let Some(found) = sensors::load(sensor)? else {
            let names = data::instrument_names("sensors").join(", ");
            bail!(
                "found no sensor `{sensor}`, expected one of {names}, or the path of a sensor's file"
            );
        };
        wire(set, channel, &found)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_have_uncertainties() {
        let found = distance("ch1-CH2=47.2 mm +- 0.1 mm").expect("a distance");
        assert_eq!((found.from.as_str(), found.to.as_str()), ("CH1", "CH2"));
        assert!(
            (found.distance.value - 0.0472).abs() < 1e-15
                && (1.96 * found.distance.u - 1e-4).abs() < 1e-8
        );
        assert!(distance("CH1-CH2=5 cm").is_ok_and(|found| found.distance.u == 0.0));
        for text in ["CH1=5 cm", "CH1-CH2=-5 cm", "CH1-CH2=5 s", "CH1-CH2=5 cm +- x"] {
            assert!(distance(text).is_err(), "{text}");
        }
    }
}
