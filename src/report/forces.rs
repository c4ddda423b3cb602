//! Forces by calibrated sensors as a page of text and as a curve.

use serde::{Serialize, Serializer};

use super::plot::{Plot, Series, Sheet, terminal, trace_points};
use super::table;
use crate::measurement::arrivals::sensitivities_unknown;
use crate::measurement::force::Forces;
use crate::numeric::intervals::NORMAL_95;
use crate::quantity::engineering;

/// Page of `force`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ForcePage {
    /// Number of the shot.
    pub shot: u32,
    /// Forces of the channels.
    #[serde(serialize_with = "channels")]
    pub channels: Vec<Forces>,
    /// Why other channels have no forces.
    pub problems: Vec<String>,
    /// Notes for the reader.
    pub notes: Vec<String>,
}

fn channels<S: Serializer>(found: &[Forces], serializer: S) -> Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    #[allow(clippy::struct_field_names, reason = "keys of JSON")]
    struct Channel<'a> {
        channel: &'a str,
        sensor: &'a str,
        sensitivity_v_per_n: Option<f64>,
        sensitivity_u_relative: Option<f64>,
        gain_u_relative: f64,
        gain_note: Option<String>,
        tau_s: Option<f64>,
        tau_u_relative: Option<f64>,
        start_s: f64,
        interval_s: f64,
        force_n: &'a [f64],
        u_n: &'a [f64],
        #[serde(rename = "U95_n")]
        expanded_n: &'a [f64],
        noise_u_n: &'a [f64],
        clipped: usize,
    }
    serializer.collect_seq(found.iter().map(|forces| Channel {
        channel: &forces.channel,
        sensor: &forces.sensor.name,
        sensitivity_v_per_n: forces.sensor.sensitivity,
        sensitivity_u_relative: forces.sensor.sensitivity_u,
        gain_u_relative: forces.sensor.gain_u,
        gain_note: forces.sensor.gain_note(),
        tau_s: forces.sensor.time_constant,
        tau_u_relative: forces.sensor.time_constant_u,
        start_s: forces.force.start,
        interval_s: forces.force.interval,
        force_n: &forces.force.values,
        u_n: &forces.u,
        expanded_n: &forces.expanded,
        noise_u_n: &forces.noise_u,
        clipped: forces.clipped,
    }))
}

/// Force of a channel over time, with its expanded uncertainty.
fn force_plot(forces: &Forces) -> Plot {
    let force = trace_points(&forces.force);
    let edge = |sign: f64| -> Vec<(f64, f64)> {
        let samples = force.iter().zip(&forces.expanded);
        samples.map(|((time, force), u)| (*time, force + sign * u)).collect()
    };
    let area = Series::area("95 %", &edge(-1.0), &edge(1.0));
    let name = format!("force at {}", forces.force.name);
    Plot::over_time([&name, "N"], force, vec![area])
}

/// Forces of all channels with their expanded uncertainties, as a picture.
pub fn force_picture(found: &[Forces], title: &str) -> Sheet {
    Sheet::stack(title, found.iter().map(force_plot).collect())
}

/// The page that `force` prints.
pub fn forces(page: &ForcePage) -> String {
    let found = &page.channels;
    let heading =
        ["", "sensor", "sensitivity", "tau", "largest force", "U95", "at", "U95 of noise"];
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    for channel in found {
        let values =
            channel.force.values.iter().zip(&channel.expanded).zip(&channel.noise_u).enumerate();
        let Some((index, ((force, expanded), noise))) =
            values.max_by(|a, b| a.1.0.0.abs().total_cmp(&b.1.0.0.abs()))
        else {
            continue;
        };
        let sensor = &channel.sensor;
        let is_clipped = channel.first_clipped.is_some_and(|first| index >= first);
        let or_none = |value: Option<f64>, unit| table::known(value, unit, 4);
        rows.push(vec![
            channel.channel.clone(),
            sensor.name.clone(),
            or_none(sensor.sensitivity, "V/N"),
            or_none(sensor.time_constant, "s"),
            format!("{}{}", if is_clipped { "> " } else { "" }, engineering(*force, "N", 4)),
            if is_clipped { "clipped".to_owned() } else { engineering(*expanded, "N", 2) },
            engineering(channel.force.time(index), "s", 4),
            engineering(NORMAL_95 * noise, "N", 2),
        ]);
    }
    let mut lines = table::lines(&rows, &[0, 1]);
    let unknown = found.iter().filter(|channel| channel.sensor.sensitivity_u.is_none());
    let unknown: Vec<&str> = unknown.map(|channel| channel.channel.as_str()).collect();
    if !unknown.is_empty() {
        let note = sensitivities_unknown(&unknown);
        lines.push(format!("  note  {note}"));
    }
    let cut = found.iter().filter(|channel| channel.clipped > 0);
    lines.extend(cut.map(|channel| {
        format!(
            "  note  {}: {} samples are clipped at the converter's ends: the true force is larger there, and wrong behind it",
            channel.channel, channel.clipped
        )
    }));
    let gains = found.iter().filter_map(|channel| channel.sensor.gain_note());
    let others = page.problems.iter().chain(&page.notes).cloned();
    lines.extend(table::joined(gains.chain(others)).iter().map(|note| format!("  note  {note}")));
    if let Some(first) = found.first() {
        lines.push(String::new());
        lines.extend(terminal(&force_plot(first)));
    }
    lines.join("\n")
}
