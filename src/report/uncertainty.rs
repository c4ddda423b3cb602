//! Intervals, bands and budgets of uncertain scenes, and normalised errors, as pages of text and
//! pictures.

use super::page::Part;
use super::plot::{Axis, COLOURS, Plot, Series, Sheet, Stroke, trace_points};
use super::table;
use super::table::with_expanded;
use super::text::hanging_indent;
use crate::predict::{
    InputMove, InputShare, NormalisedError, OutputInterval, TraceBand, UncertainPrediction,
};
use crate::quantity::{Dimension, Uncertain, engineering};
use crate::recording::{Capture, Shot};
use crate::scene::random_inputs::RandomInput;
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

/// The uncertain inputs of a scene as a table: value, standard uncertainty, source.
pub fn uncertain_inputs(inputs: &[RandomInput]) -> Vec<Vec<String>> {
    let row = |input: &RandomInput| {
        let number = |value: f64, digits| in_unit(value, &input.unit, digits);
        let source = input.source.clone().unwrap_or_else(|| "not stated".to_owned());
        vec![input.name.clone(), number(input.value, 4), number(input.u, 3), source]
    };
    table::titled(["input", "value", "u", "source"], inputs.iter().map(row))
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
fn interval(output: &OutputInterval) -> String {
    let shown = |value: f64| engineering(value, output.unit, 5);
    let [low, high] = output.interval_95;
    if output.is_one_sided() {
        format!("{}, {} to {}", shown(output.value), shown(low), shown(high))
    } else {
        with_expanded(output.value, output.expanded, output.unit)
    }
}

/// Colours of the other inputs, and of what is not linear.
const REST: [(&str, &str); 2] = [("other inputs", "#b0b0b0"), ("not linear", "#e4e4e4")];

/// Share of the variance of `output` that the input `name` carries (1).
fn share_of(output: &OutputInterval, name: &str) -> f64 {
    output.inputs.iter().find(|input| input.input == name).map_or(0.0, |input| input.share)
}

/// The budget as a picture: a bar for each output, divided among the inputs that carry its
/// variance.
pub fn budget_picture(found: &UncertainPrediction) -> Sheet {
    let total =
        |name: &str| -> f64 { found.outputs.iter().map(|output| share_of(output, name)).sum() };
    let mut inputs: Vec<&str> = found.inputs.iter().map(|input| input.name.as_str()).collect();
    inputs.sort_by(|a, b| total(b).total_cmp(&total(a)));
    inputs.truncate(COLOURS.len());
    let names = inputs.iter().copied().zip(COLOURS).chain(REST);
    let mut legend: Vec<Series> =
        names.map(|(name, colour)| Series::new(name, Vec::new(), colour, Stroke::Bars)).collect();
    for (row, output) in found.outputs.iter().enumerate() {
        let mut shares: Vec<f64> = inputs.iter().map(|name| share_of(output, name)).collect();
        let named: f64 = shares.iter().sum();
        shares.extend([(output.explained - named).max(0.0), 1.0 - output.explained]);
        let mut from = 0.0;
        for (series, share) in legend.iter_mut().zip(shares) {
            let to = (from + 100.0 * share).clamp(from, 100.0);
            series.points.extend([(from, row as f64), (to, row as f64)]);
            from = to;
        }
    }
    let names = found.outputs.iter().map(|output| output.name.clone());
    let mut plot = Plot::of_rows(Axis::linear("share of the variance (%)", 0.0, 100.0), names);
    plot.beside =
        found.outputs.iter().enumerate().map(|(row, o)| (row as f64, interval(o))).collect();
    let unnamed = |series: &Series| Series { name: String::new(), ..series.clone() };
    plot.lines = legend.iter().map(unnamed).collect();
    for series in &mut legend {
        series.points.clear();
    }
    let sheet = Sheet::rows(format!("{}: shares of the variance", found.scene), plot);
    Sheet { legend, ..sheet }
}

/// All channels with their bands, as a picture.
pub fn bands_picture(bands: &[TraceBand], title: &str) -> Sheet {
    let panel = |band: &TraceBand| {
        let points = |values: &[f64]| -> Vec<(f64, f64)> {
            let time = |index: usize| band.start_s + index as f64 * band.interval_s;
            values.iter().enumerate().map(|(index, volts)| (time(index), *volts)).collect()
        };
        let [low, high] = [&band.low_v, &band.high_v].map(|edge| points(edge));
        let area = Series::area("95 % of the traces", &low, &high);
        Plot::over_time([&band.channel, "V"], points(&band.nominal_v), vec![area])
    };
    Sheet::stack(title, bands.iter().map(panel).collect())
}

/// What the scope recorded of a shot, as a picture.
pub fn shot_picture(shot: Option<&Shot>, title: &str) -> Sheet {
    let traces = shot.into_iter().flat_map(|shot| &shot.captures).filter_map(Capture::trace);
    let panel =
        |trace: Trace| Plot::over_time([&trace.name, "V"], trace_points(&trace), Vec::new());
    Sheet::stack(title, traces.map(panel).collect())
}

/// Normalised errors as parts of a page of `compare`; none without any.
pub fn normalised_error_parts(errors: &[NormalisedError], samples: usize) -> Vec<Part> {
    let mut rows = vec![["", "measured", "simulated", "E_n"].map(str::to_owned).to_vec()];
    let shown = |number: Option<Uncertain>, unit: &str| {
        number.map_or("-".to_owned(), |number| with_expanded(number.value, number.expanded(), unit))
    };
    rows.extend(errors.iter().map(|error| {
        let (measured, simulated) =
            (shown(error.measured, error.unit), shown(error.simulated, error.unit));
        vec![error.quantity.clone(), measured, simulated, error.figure()]
    }));
    let title =
        "normalised errors E_n, the difference over the combined U95: up to 1 agrees, each alone";
    let mut parts: Vec<Part> = Part::section(title, rows, &[0]).collect();
    if parts.is_empty() {
        return parts;
    }
    let simulated = format!(
        "simulated: the middle of the interval that the scene's uncertainty leaves, from {samples} runs (--samples)"
    );
    parts.push(Part::List("note", vec![simulated]));
    let beyond = errors.iter().filter(|error| !error.agrees());
    parts.push(Part::List("note", beyond.filter_map(moves_to_agree).collect()));
    parts
}

/// Which inputs would have to move for both sides of `error` to be equal.
fn moves_to_agree(error: &NormalisedError) -> Option<String> {
    let told = |by_u: fn(&InputMove) -> f64| {
        let moves = error.moves.iter().map(|one| format!("{} by {:+.1} u", one.input, by_u(one)));
        moves.collect::<Vec<_>>()
    };
    let together = told(|one| one.by_u).join(", ");
    let alone = told(|one| one.alone_by_u);
    Some(match alone.first()? {
        alone if error.moves.len() > 1 => format!(
            "{}: to agree, inputs would have to move together: {together}; or one alone: {alone}",
            error.quantity
        ),
        _ => format!("{}: to agree, {together}", error.quantity),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half, a quarter, and a quarter that is not linear: together 100 %.
    #[test]
    fn a_bar_is_divided_by_shares() {
        let input = |name: &str| RandomInput {
            name: name.to_owned(),
            value: 1.0,
            unit: String::new(),
            u: 0.1,
            source: None,
        };
        let share = |name: &str, share| InputShare { input: name.to_owned(), change: 1.0, share };
        let output = OutputInterval {
            name: "a peak".to_owned(),
            unit: "N",
            value: 3.0,
            as_run: 3.0,
            u: 0.05,
            expanded: 0.1,
            interval_95: [2.9, 3.1],
            drawn: Vec::new(),
            explained: 0.75,
            inputs: vec![share("speed", 0.5), share("mass", 0.25)],
        };
        let found = UncertainPrediction {
            scene: "bench".to_owned(),
            samples: 20,
            seed: 1,
            failed: 0,
            wall_s: 0.1,
            inputs: vec![input("mass"), input("speed")],
            outputs: vec![output],
            speeds_as_measured: Vec::new(),
            bands: Vec::new(),
        };
        let sheet = budget_picture(&found);
        let names: Vec<&str> = sheet.legend.iter().map(|series| series.name.as_str()).collect();
        assert_eq!(names, ["speed", "mass", "other inputs", "not linear"]);
        let ends = sheet.panels[0].lines.iter().map(|series| series.points[1].0);
        assert_eq!(ends.collect::<Vec<_>>(), [50.0, 75.0, 75.0, 100.0]);
        assert_eq!(sheet.panels[0].beside, [(0.0, "3.00 ± 0.10 N".to_owned())]);
    }
}
