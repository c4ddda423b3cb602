//! Intervals, bands and budgets of uncertain scenes, and normalised errors, as pages of text and
//! pictures.

use super::chart::{Under, charts_over};
use super::number::with_expanded;
use super::plot::{Curve, Label};
use super::table;
use super::text::hanging_indent;
use crate::predict::{
    InputMove, InputShare, NormalisedError, OutputInterval, TraceBand, UncertainPrediction,
};
use crate::quantity::{Dimension, Uncertain, engineering};
use crate::recording::{Capture, Shot};
use crate::trace::Trace;

/// Inputs with a smaller share than this are counted together (1).
const LISTED_SHARE: f64 = 0.01;

/// The intervals that `run --bands` prints.
pub fn prediction_intervals(found: &UncertainPrediction) -> String {
    let mut lines = vec![heading(found)];
    let mut rows = vec![["", "value", "95 % from", "to"].map(str::to_owned).to_vec()];
    let shown = |value: f64, unit: &str| engineering(value, unit, 5);
    rows.extend(found.outputs.iter().map(|output| {
        let [low, high] = output.interval_95;
        let value = if output.is_one_sided() {
            shown(output.value, output.unit)
        } else {
            with_expanded(output.value, output.expanded, output.unit)
        };
        vec![output.name.clone(), value, shown(low, output.unit), shown(high, output.unit)]
    }));
    lines.extend(table::lines(&rows, &[0]));
    for band in found.bands.iter().filter(|band| band.clipped_share > 0.0) {
        let note = format!(
            "{}: {:.0} % of the traces leave the converter's range, where recordings are clipped; the peak above is the signal's",
            band.channel,
            (100.0 * band.clipped_share).ceil()
        );
        lines.extend(hanging_indent("  note  ", &note));
    }
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
    let mut sources: Vec<&str> = Vec::new();
    let mut rows = vec![["input", "value", "u", "source"].map(str::to_owned).to_vec()];
    for input in &found.inputs {
        let source = input.source.as_deref().unwrap_or("not stated");
        let place = sources.iter().position(|known| *known == source).unwrap_or_else(|| {
            sources.push(source);
            sources.len() - 1
        });
        let number = |value: f64, digits| in_unit(value, &input.unit, digits);
        let (value, u) = (number(input.value, 4), number(input.u, 3));
        rows.push(vec![input.name.clone(), value, u, format!("[{}]", place + 1)]);
    }
    lines.extend(table::lines(&rows, &[0, 3]));
    for (number, source) in (1..).zip(sources) {
        lines.extend(hanging_indent(&format!("  [{number}] "), source));
    }
    lines.push(String::new());
    lines.push("share of the variance, largest first".to_owned());
    for output in &found.outputs {
        lines.extend(budget_lines(output));
    }
    lines.push(format!("  computed in {}", engineering(found.wall_s, "s", 2)));
    lines.join("\n")
}

/// A value with so many digits, with a prefix of the unit that its dimension has in the SI.
fn in_unit(value: f64, unit: &str, digits: usize) -> String {
    let dimension =
        format!("1 {unit}").parse::<crate::quantity::Quantity>().map(|one| one.dimension);
    match dimension.map(Dimension::unit).as_deref() {
        Ok("kg") => engineering(1e3 * value, "g", digits),
        Ok(base) if !unit.is_empty() => engineering(value, base, digits),
        _ if value == 0.0 => "0".to_owned(),
        _ => {
            let size = value.abs().log10().floor();
            let decimals = (digits as f64 - 1.0 - size).clamp(0.0, 9.0) as i32;
            let decimals = usize::try_from(decimals).unwrap_or_default();
            format!("{value:.decimals$}")
        }
    }
}

/// An output with its uncertainty, and which inputs carry it.
fn budget_lines(output: &OutputInterval) -> Vec<String> {
    let listed = |input: &&InputShare| input.share >= LISTED_SHARE;
    let part = |name: &str, share: f64| format!("{name} {:.0} %", 100.0 * share);
    let inputs = output.inputs.iter().filter(listed);
    let mut parts: Vec<String> = inputs.map(|input| part(&input.input, input.share)).collect();
    let left = 1.0 - output.explained;
    if left >= LISTED_SHARE {
        parts.push(part("not linear", left));
    }
    let mut lines = vec![format!("  {}  {}", output.name, interval(output))];
    lines.extend(hanging_indent("      ", &parts.join(", ")));
    lines
}

/// The value with its `±`, or where its interval lies beside it, with the interval's ends.
pub(super) fn interval(output: &OutputInterval) -> String {
    let shown = |value: f64| engineering(value, output.unit, 5);
    let [low, high] = output.interval_95;
    if output.is_one_sided() {
        format!("{}, {} to {}", shown(output.value), shown(low), shown(high))
    } else {
        with_expanded(output.value, output.expanded, output.unit)
    }
}

/// All channels with their bands, as a picture.
pub fn bands_picture(bands: &[TraceBand], title: &str) -> String {
    let panel = |band: &TraceBand| {
        let time = |index: usize| band.start_s + index as f64 * band.interval_s;
        let points = |values: &[f64]| -> Vec<(f64, f64)> {
            values.iter().enumerate().map(|(index, volts)| (time(index), *volts)).collect()
        };
        let edges = vec![points(&band.low_v), points(&band.high_v)];
        (
            voltage(&band.channel, points(&band.nominal_v)),
            vec![Under::new("95 % of the traces", edges)],
        )
    };
    charts_over(&bands.iter().map(panel).collect::<Vec<_>>(), title)
}

/// What the scope recorded of a shot, as a picture.
pub fn shot_picture(shot: &Shot, title: &str) -> String {
    let traces = shot.captures.iter().filter_map(Capture::trace);
    let panel = |trace: Trace| {
        let points = trace.values.iter().enumerate().map(|(i, volts)| (trace.time(i), *volts));
        (voltage(&trace.name, points.collect()), Vec::new())
    };
    charts_over(&traces.map(panel).collect::<Vec<_>>(), title)
}

fn voltage(channel: &str, points: Vec<(f64, f64)>) -> Curve {
    let (x, y) = (Label::new("time after the trigger", "s"), Label::new(channel, "V"));
    Curve { points, marks: Vec::new(), x, y }
}

/// Normalised errors as lines of `compare`.
pub fn normalised_error_lines(errors: &[NormalisedError]) -> Vec<String> {
    let mut lines = vec![
        "normalised errors E_n, the difference over the combined U95: up to 1 agrees".to_owned(),
        "  (simulated: the middle of the interval that the scene's uncertainty leaves)".to_owned(),
    ];
    let mut rows = vec![["", "measured", "simulated", "E_n"].map(str::to_owned).to_vec()];
    let shown = |number: Option<Uncertain>, unit: &str| {
        number.map_or("-".to_owned(), |number| with_expanded(number.value, number.expanded(), unit))
    };
    rows.extend(errors.iter().map(|error| {
        let (measured, simulated) =
            (shown(error.measured, error.unit), shown(error.simulated, error.unit));
        vec![error.quantity.clone(), measured, simulated, error.figure()]
    }));
    lines.extend(table::lines(&rows, &[0]));
    for error in errors.iter().filter(|error| !error.agrees()) {
        let told = |by_u: fn(&InputMove) -> f64| {
            let moves =
                error.moves.iter().map(|one| format!("{} by {:+.1} u", one.input, by_u(one)));
            moves.collect::<Vec<_>>()
        };
        let together = told(|one| one.by_u).join(", ");
        lines.push(match told(|one| one.alone_by_u).first() {
            Some(alone) if error.moves.len() > 1 => format!(
                "  note  {}: to agree, inputs would have to move together: {together}; or one alone: {alone}",
                error.quantity
            ),
            Some(_) => format!("  note  {}: to agree, {together}", error.quantity),
            None => continue,
        });
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both edges of the area keep their waves: they are thinned one by one, each from left to
    /// right.
    #[test]
    fn a_band_has_two_edges() {
        let wave = |by: f64| (0..5000).map(|i| by + (f64::from(i) / 300.0).sin()).collect();
        let band = TraceBand {
            channel: "CH1".to_owned(),
            start_s: 0.0,
            interval_s: 1e-6,
            nominal_v: wave(0.0),
            low_v: wave(-0.5),
            high_v: wave(0.5),
            clipped_share: 0.0,
        };
        let svg = bands_picture(&[band], "a band");
        let area = svg.lines().find(|line| line.contains("Z\"")).expect("an area");
        let places =
            area.split(['M', 'L']).filter_map(|place| place.split('Z').next()?.split_once(' '));
        let mut heights: Vec<f64> =
            places.filter_map(|(_, y)| y.split('"').next()?.parse().ok()).collect();
        heights.dedup();
        let turns = heights.windows(3).filter(|h| (h[1] - h[0]) * (h[2] - h[1]) < 0.0).count();
        // 5000 samples of a wave of 2 pi 300 samples turn five times on each edge.
        assert!((8..=12).contains(&turns), "{turns}");
    }
}
