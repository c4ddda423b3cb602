//! `--sensor CH1=FILE`: which sensor a recording's channel was wired to.

use anyhow::bail;

use crate::data;
use crate::measurement::force::wire;
use crate::recording::TraceSet;
use crate::scene::sensors;

/// A channel and its sensor, as typed.
#[derive(Debug, Clone)]
pub struct SensorAssignment {
    channel: String,
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

/// Notes all of them in `set`.
pub fn wire_all(set: &mut TraceSet, wires: &[SensorAssignment]) -> anyhow::Result<()> {
    for SensorAssignment { channel, sensor } in wires {
        let mut names: Vec<String> = set
            .shots
            .iter()
            .flat_map(|shot| &shot.captures)
            .map(|capture| capture.waveform.source.to_string())
            .collect();
        if !names.iter().any(|name| name.eq_ignore_ascii_case(channel)) {
            names.dedup();
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
