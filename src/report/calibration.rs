//! A calibration as a page of text, as a certificate, and as pictures of its impacts.

use super::table;
use super::table::with_expanded;
use crate::calibrate::report::{Conformity, Verdict};
use crate::calibrate::{CalibrationReport, ImpactResult};
use crate::quantity::engineering;
use crate::scene::plan::{DecisionRule, Particulars};

/// Inputs with a smaller share of the variance than this are one line of the page together (1).
const SHOWN_SHARE: f64 = 0.005;
/// A certified interval that is wider than the propagated one by this factor is explained (1).
const WIDER_FACTOR: f64 = 1.05;

pub(super) fn percent(share: f64) -> String {
    format!("{:.2} %", 100.0 * share)
}

/// A share in percent with two significant digits.
fn two_digits(share: f64) -> String {
    let percent = 100.0 * share;
    let decimals = (1 - percent.abs().log10().floor() as i32).clamp(0, 9) as usize;
    format!("{percent:.decimals$} %")
}

/// A number with its unit; a kilogram has its prefix already, and a plain number has none.
fn in_unit(value: f64, unit: &str, digits: usize) -> String {
    match unit {
        "kg" => engineering(1e3 * value, "g", digits),
        "1" => format!("{value:.digits$}"),
        _ => engineering(value, unit, digits),
    }
}

/// The certificate's number, or that there is none.
pub(super) fn number_of_key(named: &Particulars) -> &str {
    named.number.as_deref().unwrap_or("without a number")
}

/// Why the coverage factor is what it is.
pub(super) fn why_factor(report: &CalibrationReport) -> String {
    let found = &report.result;
    let k = format!("{:.2}", found.coverage_factor);
    if found.unconfirmed().is_some() {
        return format!(
            "k = {k}: the draws do not confirm the propagation of uncertainty, and U reaches the farther end of their interval (JCGM 101:2008, 8.2)."
        );
    }
    let even = (found.half_width / (3f64.sqrt() * found.u)).powi(2);
    let largest = found.budget.iter().filter(|line| line.distribution == "rectangular");
    let largest = largest.max_by(|a, b| a.share.total_cmp(&b.share));
    if let Some(input) = largest.filter(|_| even > SHOWN_SHARE) {
        return format!(
            "k = {k}, less than the 1.96 of a normal distribution: {} of the variance is from one input, {}, that may be anywhere within its limits (rectangular distribution), and 95 % of such a distribution are within 1.65 u.",
            percent(even),
            input.name
        );
    }
    if found.freedom.is_finite() {
        return format!(
            "k = {k}, Student's t for {:.1} effective degrees of freedom (Welch and Satterthwaite, JCGM 100:2008, G.4): the impacts scatter {:.2} times as much as their inputs explain, so that this part of u is known from {} impacts only.",
            found.freedom,
            found.birge_ratio,
            found.impacts.iter().filter(|impact| impact.used).count()
        );
    }
    format!(
        "k = {k}, as of a normal distribution: no input outweighs the others, and the impacts scatter no more than their inputs explain."
    )
}

/// The statement of conformity with its decision rule, if the plan has a tolerance.
pub(super) fn conformity(report: &CalibrationReport) -> Option<String> {
    let Conformity { tolerance, verdict, risk } = report.conformity()?;
    let shown = |value: f64| engineering(value, "V/N", 4);
    let verdict = match verdict {
        Verdict::Pass => "The item conforms",
        Verdict::Fail => "The item does not conform",
        Verdict::NotShown => "Conformity is not shown",
    };
    let off = shown(report.result.sensitivity - tolerance.nominal);
    let rule = match tolerance.rule {
        DecisionRule::GuardBand => format!(
            "guard band of U (ILAC-G8:09/2019, 4.2.2): the difference must be at most {}, the tolerance less U, which limits the risk of a wrong acceptance to 2.5 %",
            shown((tolerance.tolerance - report.result.expanded).max(0.0))
        ),
        DecisionRule::SimpleAcceptance => "simple acceptance (ILAC-G8:09/2019, 4.2.1): the difference must be at most the tolerance; the risk of a wrong acceptance is up to 50 %".to_owned(),
    };
    Some(format!(
        "{verdict} to {} ± {}: the sensitivity differs by {off}. Decision rule: {rule}. Probability that the true sensitivity is outside of the tolerance: {}.",
        shown(tolerance.nominal),
        shown(tolerance.tolerance),
        if risk < 1e-4 { "below 0.01 %".to_owned() } else { percent(risk) }
    ))
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
                two_digits(report.result.expanded_relative),
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
                "{} from the lowest to the highest force",
                table::plus_minus(100.0 * line.change, 100.0 * line.expanded, "%")
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

/// The budget; inputs with a share of the variance below `least` are one line together (1).
pub(super) fn budget_rows(report: &CalibrationReport, least: f64) -> Vec<Vec<String>> {
    let heading = ["input", "estimate", "u", "distribution", "type", "nu", "c", "c u", "share"];
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    let (mut count, mut rest) = (0, 0.0);
    let mut lines: Vec<_> = report.result.budget.iter().collect();
    lines.sort_by(|a, b| b.share.total_cmp(&a.share));
    for line in lines {
        if line.share < least {
            count += 1;
            rest += line.share;
            continue;
        }
        let freedom = if line.freedom.is_finite() {
            format!("{:.0}", line.freedom)
        } else {
            "∞".to_owned()
        };
        rows.push(vec![
            line.name.clone(),
            in_unit(line.value, line.unit, 5),
            in_unit(line.u, line.unit, 3),
            line.distribution.to_owned(),
            line.evaluation.to_string(),
            freedom,
            format!("{:.2e}", line.coefficient),
            engineering(line.contribution.abs(), "V/N", 3),
            percent(line.share),
        ]);
    }
    if count > 0 {
        let mut row = vec!["-".to_owned(); heading.len()];
        row[0] = format!("{count} smaller inputs");
        row[heading.len() - 1] = percent(rest);
        rows.push(row);
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
    lines.extend(conformity(report).map(|words| format!("  {:<18} {words}", "conformity")));
    lines.push(String::new());
    lines.extend(table::lines(&impact_rows(report), &[0, 1]));
    lines.push(String::new());
    lines.push("uncertainty budget, largest shares first".to_owned());
    lines.extend(table::lines(&budget_rows(report, SHOWN_SHARE), &[0, 3]));
    lines.extend(exclusions(report).iter().map(|line| format!("  note  {line}")));
    lines.extend(report.result.notes.iter().map(|note| format!("  note  {note}")));
    lines.join("\n")
}
