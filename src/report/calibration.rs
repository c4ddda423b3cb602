//! A calibration as a page of text, as a certificate, and as pictures of its impacts.

use super::table;
use super::table::with_expanded;
use crate::calibrate::{CalibrationReport, ImpactResult};
use crate::quantity::engineering;

/// Inputs with a smaller share of the variance than this are one line of the page together (1).
const SHOWN_SHARE: f64 = 0.005;
/// A certified interval that is wider than the propagated one by this factor is explained (1).
const WIDER_FACTOR: f64 = 1.05;

pub(super) fn percent(share: f64) -> String {
    format!("{:.2} %", 100.0 * share)
}

/// A number with its unit; a kilogram has its prefix already, and a plain number has none.
fn in_unit(value: f64, unit: &str, digits: usize) -> String {
    match unit {
        "kg" => engineering(1e3 * value, "g", digits),
        "1" => format!("{value:.digits$}"),
        _ => engineering(value, unit, digits),
    }
}

pub(super) fn or_not_stated(text: Option<&String>) -> String {
    text.cloned().unwrap_or_else(|| "not stated".to_owned())
}

/// Both intervals, by draws and by propagation, and whether they agree.
fn monte_carlo(report: &CalibrationReport) -> Vec<[String; 2]> {
    let Some(drawn) = &report.result.monte_carlo else { return Vec::new() };
    let row = |what: &str, number: String| [what.to_owned(), number];
    let shown = |s: f64| engineering(s, "V/N", 6);
    let ends = |[low, high]: [f64; 2]| format!("{} to {}", shown(low), shown(high));
    let drawn_ends = ends(drawn.interval_95);
    let propagated = ends(drawn.propagated_95);
    let verdict = if drawn.agrees { "agree" } else { "DISAGREE" };
    let [apart, tolerance] =
        [drawn.difference, drawn.tolerance].map(|volts| engineering(volts, "V/N", 2));
    let criterion = "(JCGM 101, 7.9.2 and 8)";
    let mut rows = vec![
        row("Monte Carlo", format!("95 % of {} draws: {drawn_ends}", drawn.draws)),
        row("propagation", format!("of the same inputs: {propagated}")),
        row("", format!("the ends {verdict}: {apart} apart, tolerance {tolerance} {criterion}")),
    ];
    let [low, high] = drawn.propagated_95;
    if !drawn.agrees {
        let rule = "propagation does not hold: the certified interval reaches the farther end of the drawn one (JCGM 101, 8.2)";
        rows.push(row("", rule.to_owned()));
    } else if 2.0 * report.result.expanded > WIDER_FACTOR * (high - low) {
        let factor = report.result.coverage_factor;
        let wider = format!("the certified interval is wider by Student's t (k = {factor:.2})");
        rows.push(row("", wider));
    }
    rows
}

/// The result, line by line: what it is, and the number.
pub(super) fn results(report: &CalibrationReport) -> Vec<[String; 2]> {
    let s = report.result.sensitivity;
    let freedom = Some(report.result.freedom).filter(|nu| nu.is_finite());
    let freedom = freedom.map_or_else(String::new, |nu| format!(", {nu:.1} degrees of freedom"));
    let row = |what: &str, number: String| [what.to_owned(), number];
    let mut rows = vec![
        row(
            "sensitivity S",
            format!(
                "{}, {} of it (k = {:.2}{})",
                with_expanded(s, report.result.expanded, "V/N"),
                percent(report.result.expanded_relative),
                report.result.coverage_factor,
                freedom
            ),
        ),
        row(
            "time constant tau",
            format!(
                "{}, {}",
                with_expanded(report.result.tau, report.result.tau_expanded, "s"),
                if report.result.tau_fitted { "read off the records" } else { "given" }
            ),
        ),
        row(
            "force range",
            format!(
                "{} to {}, {} levels",
                engineering(report.result.force_range[0], "N", 3),
                engineering(report.result.force_range[1], "N", 3),
                report.result.levels
            ),
        ),
    ];
    if let Some(line) = report.result.nonlinearity {
        rows.push(row(
            "non-linearity",
            format!(
                "{:+.2} % ± {:.2} % from the lowest to the highest force",
                100.0 * line.change,
                100.0 * line.expanded
            ),
        ));
    }
    rows.push(row(
        "Birge ratio",
        format!(
            "{:.2}: scatter of the impacts over what their uncertainties explain; enlarges u where above 1",
            report.result.birge_ratio
        ),
    ));
    rows.extend(monte_carlo(report));
    rows.push(row(
        "raw voltage",
        format!(
            "its integral would give {}, {:+.1} %: droop ignored",
            engineering(report.result.naive, "V/N", 4),
            100.0 * (report.result.naive / s - 1.0)
        ),
    ));
    rows
}

pub(super) fn impact_rows(report: &CalibrationReport) -> Vec<Vec<String>> {
    let heading = ["", "striker", "peak force", "contact", "momentum", "S", "u (own)", "raw"];
    let number = |value: Option<f64>, unit: &str, digits| {
        value.map_or("-".to_owned(), |value| engineering(value, unit, digits))
    };
    let row = |impact: &ImpactResult| {
        let own = impact.own_uncertainty.zip(impact.sensitivity);
        vec![
            format!("{}{}", impact.number, if impact.used { "" } else { " left out" }),
            impact.striker.clone(),
            number(impact.peak_force, "N", 4),
            number(impact.impact.as_ref().map(|i| i.duration), "s", 3),
            number(impact.momentum, "N*s", 4),
            number(impact.sensitivity, "V/N", 5),
            own.map_or("-".to_owned(), |(u, s)| percent(u / s)),
            number(impact.naive, "V/N", 4),
        ]
    };
    table::titled(heading, report.result.impacts.iter().map(row))
}

/// The budget, small shares of impacts' own inputs put together.
pub(super) fn budget_rows(report: &CalibrationReport) -> Vec<Vec<String>> {
    let mut rows = vec![
        ["input", "estimate", "standard uncertainty", "in S", "share"].map(str::to_owned).to_vec(),
    ];
    let (mut count, mut rest) = (0, 0.0);
    let mut lines: Vec<_> = report.result.budget.iter().collect();
    lines.sort_by(|a, b| b.share.total_cmp(&a.share));
    for line in lines {
        if line.share < SHOWN_SHARE {
            count += 1;
            rest += line.share;
            continue;
        }
        rows.push(vec![
            line.name.clone(),
            in_unit(line.value, line.unit, 5),
            in_unit(line.u, line.unit, 3),
            engineering(line.contribution.abs(), "V/N", 3),
            percent(line.share),
        ]);
    }
    if count > 0 {
        let dash = || "-".to_owned();
        rows.push(vec![format!("{count} smaller inputs"), dash(), dash(), dash(), percent(rest)]);
    }
    rows
}

pub(super) fn exclusions(report: &CalibrationReport) -> Vec<String> {
    let line = |impact: &ImpactResult| {
        let (why, proof) = (impact.exclusion.as_ref()?, impact.evidence.as_ref()?);
        Some(format!("impact {} ({}) is left out: {why}", impact.number, proof.recording))
    };
    report.result.impacts.iter().filter_map(line).collect()
}

/// The page that `calibrate` prints.
pub fn page(report: &CalibrationReport) -> String {
    let mut lines = vec![format!("{}; ± is the expanded uncertainty (95 %)", report.named.title)];
    lines.extend(report.contradictions.iter().map(|wrong| format!("  REFUSED  {wrong}")));
    lines.extend(results(report).iter().map(|[what, number]| format!("  {what:<18} {number}")));
    lines.push(String::new());
    lines.extend(table::lines(&impact_rows(report), &[0, 1]));
    lines.push(String::new());
    lines.push("uncertainty budget, largest shares first".to_owned());
    lines.extend(table::lines(&budget_rows(report), &[0]));
    lines.extend(exclusions(report).iter().map(|line| format!("  note  {line}")));
    lines.extend(report.result.notes.iter().map(|note| format!("  note  {note}")));
    lines.join("\n")
}
