//! A simulated test as files: the plan, and one recording an impact.

use crate::quantity::Uncertain;
use std::fmt::Write as _;

use super::equation::SpeedSource;
use super::simulation::BlindCalibration;
use crate::recording::{Origin, Shot, TraceSet};
use crate::scene::input_load;
use crate::scope::Setup;

/// A plan and the recordings that it names.
#[derive(Debug, Clone, PartialEq)]
pub struct Test {
    /// The plan's text.
    pub plan: String,
    /// File names and contents.
    pub recordings: Vec<(String, TraceSet)>,
}

/// Puts a blind calibration of `sensor` into files.
pub fn write(
    blind: &BlindCalibration,
    sensor: &str,
    gain: Option<Uncertain>,
    setup: &Setup,
) -> Test {
    let scope = match gain {
        None => "in_chain = true".to_owned(),
        Some(gain) if gain.half_width > 0.0 => format!("gain_limit = {}", gain.half_width),
        Some(gain) => format!("gain_u = {}", gain.u),
    };
    let load = setup.channels.iter().flatten().next().map(|c| input_load(&setup.model, c));
    let load = load.map_or(String::new(), |load| {
        let (resistance, capacitance) = (load.resistance, load.capacitance);
        format!(
            "input_resistance = \"{resistance} Ohm\"\ninput_capacitance = \"{capacitance} F\"\n"
        )
    });
    let gravity = lines("gravity", blind.common.gravity, "m/s^2");
    let mut plan = format!(
        "# Simulated by `hertzscope calibrate --simulate`. `_u` is the standard uncertainty (k = 1) of what stands before it.\n\
         title = \"Simulated momentum test of {sensor}\"\nchannel = \"CH1\"\n{gravity}\n\
         [sensor]\nitem = \"{sensor}, simulated\"\nname = \"{sensor}-calibrated\"\n\n[scope]\n{scope}\n{load}\n\
         [traceability]\nmass = \"none: simulated\"\nspeed = \"none: simulated\"\nvoltage = \"none: simulated\"\n"
    );
    for (name, mass) in &blind.common.strikers {
        let _ = write!(plan, "\n[strikers.\"{name}\"]\n{}", lines("mass", *mass, "kg"));
    }
    let mut recordings = Vec::new();
    for (number, (strike, capture)) in (1..).zip(blind.strikes.iter().zip(&blind.captures)) {
        let file = format!("impact-{number}.mcap");
        let name = blind.common.strikers.get(strike.motion.striker).map_or("", |(name, _)| name);
        let _ = write!(
            plan,
            "\n[[impacts]]\nrecording = \"{file}\"\nstriker = \"{name}\"\n{}{}",
            speed("", strike.motion.incoming),
            speed("rebound_", strike.motion.rebound)
        );
        let shot = Shot {
            number: 1,
            origin: Origin::Simulated,
            timestamp_ns: 0,
            captures: vec![capture.clone()],
            truth: Vec::new(),
            trigger_time: None,
        };
        recordings.push((file, TraceSet { shots: vec![shot], ..TraceSet::default() }));
    }
    Test { plan, recordings }
}

fn speed(prefix: &str, speed: SpeedSource) -> String {
    match speed {
        SpeedSource::Speed(value) => lines(&format!("{prefix}speed"), value, "m/s"),
        SpeedSource::Height(value) => lines(&format!("{prefix}height"), value, "m"),
        SpeedSource::GateTime(value) => lines(&format!("{prefix}gate_time"), value, "s"),
        SpeedSource::FlightTime(value) => lines("flight_time", value, "s"),
    }
}

fn lines(key: &str, value: Uncertain, unit: &str) -> String {
    format!("{key} = \"{:.6e} {unit}\"\n{key}_u = \"{:.3e} {unit}\"\n", value.value, value.u)
}
