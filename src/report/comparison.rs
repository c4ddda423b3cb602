//! A comparison as a page, and as facts of a recording.

use std::collections::BTreeMap;

use super::page::Part;
use super::plot::{COLOURS, Plot, Series, Sheet, Stroke, trace_points};
use super::table;
use crate::measurement::compare::mapping::ASSUMED;
use crate::measurement::compare::{ChannelScore, Compared, Comparison};
use crate::numeric::intervals::NORMAL_95;
use crate::predict::TraceBand;
use crate::quantity::{Uncertain, engineering};

fn signed(value: f64, unit: &str, digits: usize) -> String {
    let sign = if value >= 0.0 { "+" } else { "" };
    format!("{sign}{}", engineering(value, unit, digits))
}

fn or_dash(text: Option<String>) -> String {
    text.unwrap_or_else(|| "-".to_owned())
}

fn rows(comparison: &Comparison) -> Vec<Vec<String>> {
    let heading = ["", "against", "gain", "offset", "peak", "arrival", "correlation", "spectrum"];
    let row = |c: &ChannelScore| {
        let sensor = c.sensor.as_ref().map_or_else(String::new, |sensor| format!(" {sensor}"));
        vec![
            format!("{}{sensor}", c.name),
            c.against.clone(),
            table::plus_minus(c.gain.value, c.gain.expanded(), ""),
            signed(c.offset, &c.unit, 2),
            or_dash(c.peak_error.map(table::signed_percent)),
            or_dash(c.arrival_error_s.map(|error| {
                if error.value == 0.0 {
                    return "0 s, aligned".to_owned();
                }
                table::signed_with_expanded(error.value, Some(error.expanded()), "s")
            })),
            or_dash(c.correlation.map(|c| format!("{c:.5}"))),
            or_dash(c.spectrum_distance.map(|d| format!("{:.2} %", 100.0 * d))),
        ]
    };
    table::titled(heading, comparison.channels.iter().map(row))
}

fn residual_rows(comparison: &Comparison) -> Vec<Vec<String>> {
    let heading = ["", "rms", "", "", "largest", "", "", "samples"];
    let row = |c: &ChannelScore| {
        let newtons = |value: Option<f64>| or_dash(value.map(|n| engineering(n, "N", 3)));
        vec![
            c.name.clone(),
            engineering(c.rms, &c.unit, 3),
            format!("{:.2} LSB", c.rms_lsb),
            newtons(c.rms_n),
            engineering(c.max, &c.unit, 3),
            format!("{:.2} LSB", c.max_lsb),
            newtons(c.max_n),
            c.samples.to_string(),
        ]
    };
    table::titled(heading, comparison.channels.iter().map(row))
}

fn speed_rows(comparison: &Comparison) -> Vec<Vec<String>> {
    let heading = ["", "estimator", "measured", "simulated", "error"];
    table::titled(
        heading,
        comparison.speeds.iter().map(|s| {
            let speed = |u: Uncertain| table::with_expanded(u.value, u.expanded(), "m/s");
            vec![
                format!("{} -> {}", s.from, s.to),
                s.estimator.replace('_', "-"),
                speed(s.measured_m_per_s),
                speed(s.simulated_m_per_s),
                table::signed_percent(s.error),
            ]
        }),
    )
}

fn alignment(comparison: &Comparison) -> String {
    let expanded = comparison.shift_u_s.map(|u| NORMAL_95 * u);
    let shift = table::signed_with_expanded(comparison.shift_s, expanded, "s");
    format!(
        "aligned by {}: simulated traces shifted by {shift}; gain and offset are reported, not removed",
        comparison.align
    )
}

fn verdict(comparison: &Comparison) -> String {
    let tolerance = comparison.tolerance.join(", ");
    let expected = if comparison.failures.is_empty() { "" } else { "expected " };
    format!("{}: {expected}{tolerance}", comparison.verdict)
}

fn mapping(comparison: &Comparison) -> Vec<String> {
    let line = |c: &ChannelScore| {
        let ChannelScore { name, against, mapped_by, .. } = c;
        match *mapped_by {
            ASSUMED => {
                format!("assumed: measured {name} = simulated {against} (change with --map)")
            }
            _ => format!("measured {name} = simulated {against}, from {mapped_by}"),
        }
    };
    let clipped = comparison.channels.iter().filter(|c| c.clipped > 0);
    let clipped =
        clipped.map(|c| format!("{}: {} samples at the converter's ends", c.name, c.clipped));
    comparison
        .channels
        .iter()
        .map(line)
        .chain(clipped)
        .chain(table::joined(comparison.notes.iter().cloned()))
        .collect()
}

/// The comparison as a page; pictures are called `<stem>-CH1.svg` and `<stem>-CH1-difference.svg`.
/// `bands` are those of the simulated channels.
pub fn comparison_page(compared: &Compared, bands: &[TraceBand], stem: &str) -> Vec<Part> {
    let comparison = &compared.comparison;
    let mut parts = vec![
        Part::Heading(1, format!("{} against {}", comparison.measured, comparison.simulated)),
        Part::Paragraph(alignment(comparison)),
    ];
    let title = "measured over simulated; ± is the expanded uncertainty (95 %)";
    parts.extend(Part::section(title, rows(comparison), &[0, 1]));
    parts.extend(Part::section("measured minus simulated", residual_rows(comparison), &[0]));
    parts.extend(Part::section("speed between sensors", speed_rows(comparison), &[0, 1]));
    parts.push(Part::Fact("verdict", verdict(comparison)));
    parts.push(Part::List("beyond", comparison.failures.clone()));
    for (score, pair) in comparison.channels.iter().zip(&compared.pairs) {
        let name = &score.name;
        let title = format!("{name}: measured and simulated");
        let band = bands
            .iter()
            .find(|band| score.unit == "V" && band.channel.eq_ignore_ascii_case(&score.against));
        let area = band.map(|band| area(band, comparison.shift_s));
        let simulated = trace_points(&pair.simulated);
        let both = measured_over(
            [name, &score.unit],
            trace_points(&pair.measured),
            area,
            ("simulated", simulated),
        );
        let both = Sheet::stack(title.as_str(), vec![both]);
        let residual = trace_points(&pair.residual());
        let shown = format!("{name}: measured minus simulated");
        let apart =
            Plot::over_time([&format!("{name}, difference"), &score.unit], residual, Vec::new());
        let apart = Sheet::stack(format!("{name}: difference"), vec![apart]);
        parts.push(Part::Picture(format!("{stem}-{name}.svg"), title, both));
        parts.push(Part::Picture(format!("{stem}-{name}-difference.svg"), shown, apart));
    }
    parts.push(Part::List("note", mapping(comparison)));
    parts
}

/// The band of a simulated channel, shifted as its trace is (s).
fn area(band: &TraceBand, shift: f64) -> Series {
    let points = |values: &[f64]| -> Vec<(f64, f64)> {
        let time = |index: usize| band.start_s + shift + index as f64 * band.interval_s;
        values.iter().enumerate().map(|(index, volts)| (time(index), *volts)).collect()
    };
    Series::area("95 % of simulated", &points(&band.low_v), &points(&band.high_v))
}

/// A measured trace and over it a calculated one with its name, both in the legend; `axis` is the
/// channel and the unit.
pub(super) fn measured_over(
    axis: [&str; 2],
    measured: Vec<(f64, f64)>,
    area: Option<Series>,
    (name, calculated): (&str, Vec<(f64, f64)>),
) -> Plot {
    let measured = Series { name: "measured".to_owned(), ..Series::main(measured) };
    let calculated = Series::new(name, calculated, COLOURS[1], Stroke::Solid);
    let lines = area.into_iter().chain([measured, calculated]).collect();
    Plot::fitted(["time after the trigger", "s"], axis, lines)
}

/// The comparison as facts for a recording's metadata: `hertzscope:comparison`, and a group a
/// channel.
pub fn comparison_facts(comparison: &Comparison) -> BTreeMap<String, BTreeMap<String, String>> {
    let flat = |value: serde_json::Value| -> BTreeMap<String, String> {
        let serde_json::Value::Object(fields) = value else { return BTreeMap::new() };
        let plain = fields.into_iter().filter(|(_, value)| !value.is_null());
        plain
            .map(|(key, value)| match value {
                serde_json::Value::String(text) => (key, text),
                other => (key, other.to_string()),
            })
            .collect()
    };
    let as_json = |value: &dyn Fn() -> serde_json::Result<serde_json::Value>| {
        flat(value().unwrap_or_default())
    };
    let mut whole = as_json(&|| serde_json::to_value(comparison));
    whole.remove("channels");
    let mut groups = BTreeMap::from([("hertzscope:comparison".to_owned(), whole)]);
    for score in &comparison.channels {
        let name = format!("hertzscope:comparison/{}", score.name);
        groups.insert(name, as_json(&|| serde_json::to_value(score)));
    }
    groups
}
