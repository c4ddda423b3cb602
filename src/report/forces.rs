//! Forces by calibrated sensors as a page of text and as a curve.

use super::chart::{Under, charts_over};
use super::plot::{Curve, Label, braille};
use super::table;
use crate::measurement::arrivals::sensitivities_unknown;
use crate::measurement::force::Forces;
use crate::numeric::intervals::NORMAL_95;
use crate::quantity::engineering;

/// Force over time.
fn force_curve(forces: &Forces) -> Curve {
    let values = forces.force.values.iter().enumerate();
    Curve {
        points: values.map(|(i, force)| (forces.force.time(i), *force)).collect(),
        marks: Vec::new(),
        x: Label::new("time after the trigger", "s"),
        y: Label::new(&format!("force at {}", forces.force.name), "N"),
    }
}

/// Forces of all channels with their expanded uncertainties, as a picture.
pub fn force_picture(found: &[Forces], title: &str) -> String {
    let panel = |forces: &Forces| {
        let samples = || forces.force.values.iter().zip(&forces.expanded).enumerate();
        let edge = |sign: f64| {
            samples().map(move |(i, (force, u))| (forces.force.time(i), force + sign * u))
        };
        let edges = [-1.0, 1.0].map(|sign| edge(sign).collect()).to_vec();
        (force_curve(forces), vec![Under::new("95 %", edges)])
    };
    charts_over(&found.iter().map(panel).collect::<Vec<_>>(), title)
}

/// The page that `force` prints.
pub fn forces(found: &[Forces], problems: &[String]) -> String {
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
        let or_none = |value: Option<f64>, unit| {
            value.map_or("-".to_owned(), |value| engineering(value, unit, 4))
        };
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
    lines.extend(gains.map(|note| format!("  note  {note}")));
    lines.extend(problems.iter().map(|problem| format!("  note  {problem}")));
    if let Some(first) = found.first() {
        lines.push(String::new());
        lines.extend(braille(&force_curve(first)));
    }
    lines.join("\n")
}
