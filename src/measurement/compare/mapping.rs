//! Which measured channel belongs to which simulated one: by what the user says, by the wiring that
//! both recordings tell, else by the channel's number, which is a guess and is called one.

use super::ComparedShot;
use crate::measurement::metadata::{self, RecordedSensor};
use crate::recording::Capture;
use crate::scene::Scene;

/// How a channel without wiring or `--map` is mapped: to the simulated channel of the same name.
pub const ASSUMED: &str = "assumed: the same channel";

/// A measured channel and what it is, as the user says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Assignment {
    /// The measured channel, `CH1`.
    pub channel: String,
    /// A sensor or a channel of the simulation.
    pub target: String,
}

/// Two channels that belong together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ChannelMapping {
    /// Place of the measured capture.
    pub measured: usize,
    /// Place of the simulated capture, or of the scene's channel.
    pub simulated: usize,
    /// The sensor, where known.
    pub sensor: Option<String>,
    /// Where that is known from.
    pub by: &'static str,
}

/// Why channels do not find each other.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum MappingError {
    /// The user names a measured channel that is not there.
    #[error("found no measured channel {channel}, expected one of {}", known.join(", "))]
    NoChannel {
        /// The channel.
        channel: String,
        /// Those there are.
        known: Vec<String>,
    },
    /// The user names a target that is not there.
    #[error("found no simulated sensor or channel {target}, expected one of {}", known.join(", "))]
    NoTarget {
        /// The target.
        target: String,
        /// Those there are.
        known: Vec<String>,
    },
    /// Two measured channels are one simulated one.
    #[error("found two measured channels for {target}, expected one")]
    Twice {
        /// The target.
        target: String,
    },
    /// Nothing belongs together.
    #[error(
        "found no channel of {measured} that belongs to one of {simulated}, expected at least one: --map {first}={}",
        known.first().map_or("SENSOR", String::as_str)
    )]
    None {
        /// The measured side.
        measured: String,
        /// The simulated side.
        simulated: String,
        /// A measured channel.
        first: String,
        /// The candidates.
        known: Vec<String>,
    },
    /// A side without a capture over time.
    #[error(
        "{side}: found no capture over time in shot {shot}, expected at least one: was the scope triggered?"
    )]
    Empty {
        /// The side.
        side: String,
        /// Its shot.
        shot: u32,
    },
}

/// Channels of one side.
pub struct ChannelNames {
    side: String,
    /// Place, channel and sensor.
    names: Vec<(usize, String, Option<String>)>,
    /// Channels whose sensor has no place in a chain, as one of a calibration's file.
    unplaced: Vec<String>,
}

impl ChannelNames {
    /// The captures over time of a side.
    ///
    /// # Errors
    /// [`MappingError::Empty`] where there are none.
    pub fn of(side: ComparedShot<'_>, notes: &mut Vec<String>) -> Result<Self, MappingError> {
        let sensors = metadata::sensors_of(side.set, side.shot.number);
        let (mut names, mut unplaced) = (Vec::new(), Vec::new());
        for (place, capture) in side.shot.captures.iter().enumerate() {
            let name = capture.waveform.source.to_string();
            if over_time(capture) {
                let sensor = sensor_at(&sensors, &name);
                if sensor.is_some_and(|sensor| sensor.place.is_none()) {
                    unplaced.push(name.clone());
                }
                let sensor = sensor.map(|sensor| sensor.name.clone());
                names.push((place, name, sensor));
            } else {
                notes.push(format!("{}: {name} is no record over time and is left out", side.name));
            }
        }
        if names.is_empty() {
            let (side, shot) = (side.name.to_owned(), side.shot.number);
            return Err(MappingError::Empty { side, shot });
        }
        Ok(Self { side: side.name.to_owned(), names, unplaced })
    }

    /// The channels of a scene's scope that a sensor is wired to.
    pub fn of_scene(scene: &Scene) -> Self {
        let channels = scene.scope.channels.iter().enumerate();
        let wired = channels.filter_map(|(place, channel)| {
            let sensor = channel.as_ref()?.input.clone()?;
            Some((place, format!("CH{}", place + 1), Some(sensor)))
        });
        Self { side: scene.name.clone(), names: wired.collect(), unplaced: Vec::new() }
    }

    /// Place of a channel, or of the channel with a sensor.
    fn find(&self, name: &str) -> Option<&(usize, String, Option<String>)> {
        let by_sensor = self.names.iter().find(|(_, _, sensor)| sensor.as_deref() == Some(name));
        by_sensor.or_else(|| {
            self.names.iter().find(|(_, channel, _)| channel.eq_ignore_ascii_case(name))
        })
    }

    fn known(&self) -> Vec<String> {
        self.names
            .iter()
            .map(|(_, name, sensor)| sensor.clone().unwrap_or_else(|| name.clone()))
            .collect()
    }
}

fn over_time(capture: &Capture) -> bool {
    capture.waveform.preamble.x_unit == "s"
}

/// The sensor at a channel.
pub(super) fn sensor_at<'a>(
    sensors: &'a [RecordedSensor],
    channel: &str,
) -> Option<&'a RecordedSensor> {
    sensors.iter().find(|sensor| sensor.channel.as_deref() == Some(channel))
}

/// Channels that belong together, in the order of the measured ones.
///
/// # Errors
/// [`MappingError`] for names that are not there, and where nothing belongs together.
pub fn wires(
    from: &ChannelNames,
    to: &ChannelNames,
    assignments: &[Assignment],
    notes: &mut Vec<String>,
) -> Result<Vec<ChannelMapping>, MappingError> {
    for Assignment { channel, .. } in assignments {
        if !from.names.iter().any(|(_, name, _)| name.eq_ignore_ascii_case(channel)) {
            let known = from.names.iter().map(|(_, name, _)| name.clone()).collect();
            return Err(MappingError::NoChannel { channel: channel.clone(), known });
        }
    }
    let mut wires: Vec<ChannelMapping> = Vec::new();
    for (place, name, sensor) in &from.names {
        let said = assignments.iter().find(|a| a.channel.eq_ignore_ascii_case(name));
        let same_channel = || to.names.iter().find(|(_, other, _)| other == name);
        let (partner, by) = match (said, sensor) {
            (Some(said), _) => {
                let unknown =
                    || MappingError::NoTarget { target: said.target.clone(), known: to.known() };
                (Some(to.find(&said.target).ok_or_else(unknown)?), "--map")
            }
            (None, Some(sensor)) => {
                let same = to.names.iter().find(|(_, _, other)| other.as_ref() == Some(sensor));
                // A calibration replaces numbers, not the wiring.
                if same.is_none() && from.unplaced.contains(name) {
                    (same_channel(), ASSUMED)
                } else {
                    (same, "the recorded wiring")
                }
            }
            (None, None) => (same_channel(), ASSUMED),
        };
        let Some((simulated, target, there)) = partner else {
            let what = sensor.as_ref().map_or_else(String::new, |sensor| format!(" ({sensor})"));
            notes.push(format!("{name}{what} has no partner in the simulation and is left out"));
            continue;
        };
        if wires.iter().any(|wire| wire.simulated == *simulated) {
            return Err(MappingError::Twice { target: target.clone() });
        }
        let sensor = there.clone().or_else(|| sensor.clone());
        wires.push(ChannelMapping { measured: *place, simulated: *simulated, sensor, by });
    }
    if wires.is_empty() {
        return Err(MappingError::None {
            measured: from.side.clone(),
            simulated: to.side.clone(),
            first: from.names.first().map(|(_, name, _)| name.clone()).unwrap_or_default(),
            known: to.known(),
        });
    }
    Ok(wires)
}
