//! Intervals, bands and budgets of uncertain scenes, and normalised errors, as pages of text and pictures.

use super::plot::Curve;
use super::{chart_over, table};
use crate::quantity::{Uncertain, engineering};
use crate::studies::uncertainty::{
    InputShare, NormalisedError, OutputInterval, TraceBand, UncertainPrediction,
};

/// Inputs with a smaller share than this are counted together (1).
const LISTED_SHARE: f64 = 0.01;

/// A number with its expanded uncertainty to two digits, in the number's prefix: `3.19 ± 0.12 N`.
fn with(value: f64, expanded: f64, unit: &str) -> String {
    let shown = engineering(value, unit, 4);
    let Some((number, prefixed)) = shown.split_once(' ') else { return shown };
    let Ok(mantissa) = number.parse::<f64>() else { return shown };
    if mantissa == 0.0 || !expanded.is_finite() {
        return shown;
    }
    let scale = 10f64.powf((mantissa / value).log10().round());
    let decimals = (1.0 - (expanded * scale).log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{:.decimals$} ± {:.decimals$} {prefixed}", value * scale, expanded * scale)
}

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

/// The intervals that `run --bands` prints.
pub fn prediction_intervals(found: &UncertainPrediction) -> String {
    let mut lines = vec![heading(found)];
    let mut rows = vec![["", "value", "95 % from", "to"].map(str::to_owned).to_vec()];
    let shown = |value: f64, unit: &str| engineering(value, unit, 5);
    rows.extend(found.outputs.iter().map(|output| {
        let [low, high] = output.interval_95;
        let value = with(output.value, output.expanded, output.unit);
        vec![output.name.clone(), value, shown(low, output.unit), shown(high, output.unit)]
    }));
    lines.extend(table::lines(&rows, &[0]));
    lines.join("\n")
}

fn heading(found: &UncertainPrediction) -> String {
    let failed = if found.failed > 0 {
        format!(", {} of which gave no result", found.failed)
    } else {
        String::new()
    };
    format!(
        "{}: {} inputs by Latin hypercube, {} samples{failed}, seed {}; ± is the expanded uncertainty (95 %)",
        found.scene,
        found.inputs.len(),
        found.samples,
        found.seed
    )
}

/// The page that `budget` prints.
pub fn uncertainty_budget(found: &UncertainPrediction) -> String {
    let mut lines = vec![heading(found)];
    let mut rows = vec![["input", "value", "u", "source"].map(str::to_owned).to_vec()];
    rows.extend(found.inputs.iter().map(|input| {
        let number = |value: f64| match input.unit.as_str() {
            "" => format!("{value:.4}"),
            unit => in_unit(value, unit),
        };
        let source = input.source.clone().unwrap_or_else(|| "not stated".to_owned());
        vec![input.name.clone(), number(input.value), number(input.u), source]
    }));
    lines.extend(table::lines(&rows, &[0, 3]));
    lines.push(String::new());
    lines.push("share of the variance, largest first; what is not linear is left".to_owned());
    lines.extend(found.outputs.iter().map(budget_line));
    lines.join("\n")
}

/// A value in SI units in the base unit of the unit that the scene states it in.
fn in_unit(value: f64, unit: &str) -> String {
    let factor = crate::quantity::parse_any(&format!("1 {unit}")).map_or(1.0, |(factor, _)| factor);
    format!("{} {unit}", significant(value / factor))
}

fn significant(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let decimals = (3.0 - value.abs().log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.decimals$}")
}

fn budget_line(output: &OutputInterval) -> String {
    let listed = |input: &&InputShare| input.share >= LISTED_SHARE;
    let mut parts: Vec<String> = output
        .inputs
        .iter()
        .filter(listed)
        .map(|input| format!("{} {}", input.input, percent(input.share)))
        .collect();
    parts.push(format!("not linear {}", percent(1.0 - output.explained)));
    let value = with(output.value, output.expanded, output.unit);
    format!("  {}: {value}: {}", output.name, parts.join(", "))
}

/// A channel's band with its nominal trace, as a picture.
pub fn band_picture(band: &TraceBand, title: &str) -> String {
    let time = |index: usize| band.start_s + index as f64 * band.interval_s;
    let points = |values: &[f64]| -> Vec<(f64, f64)> {
        values.iter().enumerate().map(|(index, volts)| (time(index), *volts)).collect()
    };
    let edges = points(&band.low_v).into_iter().chain(points(&band.high_v).into_iter().rev());
    let curve = Curve {
        points: points(&band.nominal_v),
        marks: Vec::new(),
        x_label: "time after the trigger".to_owned(),
        y_label: "volts; grey: 95 % of the traces".to_owned(),
    };
    chart_over(&curve, &edges.collect::<Vec<_>>(), title, ("s", "V"))
}

/// Normalised errors as lines of `compare`.
pub fn normalised_error_lines(errors: &[NormalisedError]) -> Vec<String> {
    let mut lines = vec!["by what both sides know (E_n up to 1 agrees)".to_owned()];
    let mut rows = vec![["", "measured", "simulated", "E_n"].map(str::to_owned).to_vec()];
    let shown = |number: Uncertain, unit: &str| with(number.value, number.expanded(), unit);
    rows.extend(errors.iter().map(|error| {
        let (measured, simulated) =
            (shown(error.measured, error.unit), shown(error.simulated, error.unit));
        vec![error.quantity.clone(), measured, simulated, format!("{:.2}", error.e_n)]
    }));
    lines.extend(table::lines(&rows, &[0]));
    for error in errors.iter().filter(|error| !error.agrees()) {
        let moves: Vec<String> =
            error.moves.iter().map(|one| format!("{} by {:+.1} u", one.input, one.by_u)).collect();
        lines.push(format!("  would agree  {}: {}", error.quantity, moves.join(", ")));
    }
    lines
}
