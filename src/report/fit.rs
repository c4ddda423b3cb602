//! A fit as a page with pictures; blind fits as a page of text.

use super::comparison::measured_over;
use super::page::Part;
use super::plot::{Plot, Sheet};
use super::table;
use super::table::{decimals, plus_minus};
use crate::fit::blind::BlindFits;
use crate::fit::{ChannelResult, Fit, FitReport, Nuisance, Parameter};
use crate::quantity::engineering;

/// Correlations above this are named (1).
const BAD_CORRELATION: f64 = 0.99;

fn parameter_rows(report: &FitReport) -> Vec<Vec<String>> {
    let heading = ["", "start", "found", "95 % from", "to", "U95"];
    let row = |p: &Parameter| {
        let scaled = |value: f64| value / p.unit_in_si;
        let decimals = decimals(scaled(p.expanded));
        let plain = |value: f64| format!("{:.decimals$}", scaled(value));
        vec![
            p.path.clone(),
            format!("{} {}", plain(p.start), p.unit).trim_end().to_owned(),
            plus_minus(scaled(p.value), scaled(p.expanded), &p.unit),
            plain(p.interval_95[0]),
            plain(p.interval_95[1]),
            format!("{:.3} %", 100.0 * p.expanded / p.value.abs()),
        ]
    };
    table::titled(heading, report.parameters.iter().map(row))
}

/// What the scene states as uncertain beside the freed numbers: stated and found.
fn input_rows(report: &FitReport) -> Vec<Vec<String>> {
    let row = |p: &Parameter| {
        let scaled = |value: f64| value / p.unit_in_si;
        let decimals = decimals(scaled(p.expanded));
        let stated = format!("{:.decimals$} {}", scaled(p.start), p.unit);
        let found = plus_minus(scaled(p.value), scaled(p.expanded), &p.unit);
        vec![p.path.clone(), stated.trim_end().to_owned(), found]
    };
    table::titled(["", "stated", "found"], report.inputs.iter().map(row))
}

fn nuisance(found: &Nuisance) -> String {
    let (scale, unit) = match found.name.as_str() {
        "trigger time" => (1e6, "µs"),
        "time base" => (1e6, "ppm"),
        name if name.starts_with("offset") => (1e3, "mV"),
        _ => (1.0, ""),
    };
    format!(
        "{}: {}",
        found.name,
        plus_minus(found.found.value * scale, found.found.expanded() * scale, unit)
    )
}

fn channel_rows(report: &FitReport) -> Vec<Vec<String>> {
    let heading = ["", "noise", "rms", "largest", "autocorrelation", "channel from"];
    let row = |c: &ChannelResult| {
        vec![
            format!("{} {}", c.name, c.sensor.as_deref().unwrap_or("")).trim_end().to_owned(),
            engineering(c.sigma_v, "V", 3),
            engineering(c.rms_v, "V", 3),
            engineering(c.max_v, "V", 3),
            format!("{:+.3}", c.lag_one),
            c.mapped_by.to_owned(),
        ]
    };
    table::titled(heading, report.channels.iter().map(row))
}

fn correlation_rows(report: &FitReport) -> Vec<Vec<String>> {
    // Those of the scene's other inputs are in JSON.
    let shown = report.names.len() - report.inputs.len();
    let heading = (1..=shown).map(|number| number.to_string());
    let heading = std::iter::once(String::new()).chain(heading).collect();
    let row = |(number, (name, row)): (usize, (&String, &Vec<f64>))| {
        let name = format!("{number} {name}");
        let cells = row.iter().take(shown).map(|c| format!("{c:+.3}"));
        std::iter::once(name).chain(cells).collect()
    };
    let rows = report.names.iter().zip(&report.correlation).take(shown);
    std::iter::once(heading).chain((1..).zip(rows).map(row)).collect()
}

/// Pairs that the data hardly tell apart, each free parameter with what it goes with.
fn bad_correlations(report: &FitReport) -> Vec<String> {
    let names = |row: &[f64], own: usize| -> Vec<String> {
        let close = row.iter().zip(&report.names).enumerate();
        let close = close.filter(|(other, (c, _))| *other != own && c.abs() > BAD_CORRELATION);
        close.map(|(_, (c, name))| format!("{name} ({c:+.3})")).collect()
    };
    let line = |(own, parameter): (usize, &Parameter)| {
        let others = names(report.correlation.get(own)?, own);
        (!others.is_empty()).then(|| {
            format!(
                "{}: hardly told apart from {}; what all of them leave free is in its ±",
                parameter.path,
                others.join(", ")
            )
        })
    };
    report.parameters.iter().enumerate().filter_map(line).collect()
}

fn profile_lines(report: &FitReport) -> Vec<String> {
    let line = |profile: &crate::fit::Profile| {
        let parameter = report.parameters.iter().find(|p| p.path == profile.path);
        let (scale, unit) = parameter.map_or((1.0, ""), |p| (p.unit_in_si, p.unit.as_str()));
        let decimals = parameter.map_or(3, |p| decimals(p.u / scale));
        let end = |end: Option<f64>| {
            end.map_or_else(|| "open".to_owned(), |value| format!("{:.decimals$}", value / scale))
        };
        let [low, high] = profile.interval_95.map(end);
        let points = profile
            .points
            .iter()
            .map(|(value, rise)| format!("{:.decimals$}: {rise:.2}", value / scale));
        let points = points.collect::<Vec<_>>().join(", ");
        format!(
            "{}: 95 % from {low} to {high} {unit} (rise of chi squared at {points})",
            profile.path
        )
    };
    report.profiles.iter().map(line).collect()
}

fn quality(report: &FitReport) -> String {
    format!(
        "reduced chi squared {:.3} ({} degrees of freedom); {} runs in {}",
        report.residual_variance,
        report.degrees_of_freedom,
        report.runs,
        engineering(report.wall_s, "s", 3)
    )
}

/// The fit as a page; pictures are called `<stem>-CH1.svg` and `<stem>-CH1-residual.svg`.
pub fn fit_page(fit: &Fit, stem: &str) -> Vec<Part> {
    let report = &fit.report;
    let title = format!(
        "{} fitted to {}; ± is the expanded uncertainty (95 %)",
        report.scene, report.measured
    );
    let nuisances = report.nuisances.iter().map(nuisance).collect();
    let mut parts = vec![
        Part::Heading(1, title),
        Part::Table(parameter_rows(report), &[0]),
        Part::List("also fitted", nuisances),
    ];
    let title = "other uncertain inputs of the scene, which moved within what it states";
    parts.extend(Part::section(title, input_rows(report), &[0]));
    parts.extend(Part::section("correlations", correlation_rows(report), &[0]));
    parts.push(Part::List("note", bad_correlations(report)));
    let title = "residuals (autocorrelation from one sample to the next)";
    parts.extend(Part::section(title, channel_rows(report), &[0, 5]));
    parts.push(Part::Paragraph(quality(report)));
    parts.push(Part::List("profile", profile_lines(report)));
    let axis = fit.records.axis;
    for (record, shown) in fit.records.list.iter().zip(&fit.shown) {
        let name = &record.name;
        let points = |values: &mut dyn Iterator<Item = f64>| -> Vec<(f64, f64)> {
            let time = |index: usize| axis.start + index as f64 * axis.interval;
            values.enumerate().map(|(index, volts)| (time(index), volts)).collect()
        };
        let title = format!("{name}: measured and fitted");
        let fitted = points(&mut shown.iter().copied());
        let measured = points(&mut record.volts.iter().copied());
        let both = measured_over([name, "V"], measured, None, ("fitted", fitted));
        let both = Sheet::stack(title.as_str(), vec![both]);
        let what = format!("{name}: measured minus fitted");
        let left = record.volts.iter().zip(shown).zip(&record.counts);
        let mut left = left.map(|((m, s), counts)| if *counts { m - s } else { 0.0 });
        let apart =
            Plot::over_time([&format!("{name}, residual"), "V"], points(&mut left), Vec::new());
        let apart = Sheet::stack(format!("{name}: residual"), vec![apart]);
        parts.push(Part::Picture(format!("{stem}-{name}.svg"), title, both));
        parts.push(Part::Picture(format!("{stem}-{name}-residual.svg"), what, apart));
    }
    parts.push(Part::List("note", report.notes.clone()));
    parts
}

/// The page that `fit --blind` prints.
pub fn blind(found: &BlindFits, scene: &str) -> String {
    let heading = ["", "inside 95 %", "bias", "spread", "mean u"];
    let mut rows = table::titled(
        heading,
        found.parameters.iter().map(|p| {
            vec![
                p.path.clone(),
                format!("{:.1} %", 100.0 * p.coverage_95),
                format!("{:+.3} u", p.bias),
                format!("{:.3} u", p.spread),
                format!("{:.4} %", 100.0 * p.mean_u_relative),
            ]
        }),
    );
    rows.push(vec!["all".to_owned(), format!("{:.1} %", 100.0 * found.coverage_95)]);
    let mut lines = vec![format!(
        "{} blind fits of {scene}, numbers hidden within {} %",
        found.trials,
        100.0 * found.spread
    )];
    lines.extend(table::lines(&rows, &[0]));
    lines.push(format!(
        "  {} failed; residual variance {:.4}; {:.0} runs and {} a fit",
        found.failed,
        found.residual_variance,
        found.runs_per_fit,
        engineering(found.seconds_per_fit, "s", 3)
    ));
    lines.join("\n")
}
