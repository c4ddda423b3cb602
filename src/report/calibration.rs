//! A calibration as a page of text, as a certificate, and as pictures of its impacts.

use super::chart::chart_over;
use super::document::{Part, html, markdown};
use super::plot::Curve;
use super::table;
use crate::analysis::calibration::{Calibration, ImpactResult};
use crate::experiment::calibration::CalibrationReport;
use crate::experiment::calibration::words::ImpactReport;
use crate::quantity::engineering;

/// Inputs with a smaller share of the variance than this are one line of the page together (1).
const SHOWN_SHARE: f64 = 0.005;
/// What a temperature in kelvin is above one in degrees Celsius.
const ZERO_CELSIUS: f64 = 273.15;

/// `0.4012 ± 0.0031 V/N`: a number with its expanded uncertainty to two digits (text).
fn with(value: f64, expanded: f64, unit: &str) -> String {
    let shown = engineering(value, unit, 6);
    let Some((number, prefixed)) = shown.split_once(' ') else { return shown };
    let Ok(mantissa) = number.parse::<f64>() else { return shown };
    let scale = 10f64.powf((mantissa / value).log10().round());
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few digits")]
    let decimals = (1.0 - (expanded * scale).log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{:.decimals$} ± {:.decimals$} {prefixed}", value * scale, expanded * scale)
}

fn percent(share: f64) -> String {
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

fn or_not_stated(text: Option<&String>) -> String {
    text.cloned().unwrap_or_else(|| "not stated".to_owned())
}

/// The result, line by line: what it is, and the number.
fn results(report: &CalibrationReport) -> Vec<[String; 2]> {
    let s = report.sensitivity_v_per_n;
    let row = |what: &str, number: String| [what.to_owned(), number];
    let mut rows = vec![
        row(
            "sensitivity S",
            format!(
                "{} (k = 2), {} of it",
                with(s, 2.0 * report.standard_uncertainty_v_per_n, "V/N"),
                percent(report.u_relative_k2)
            ),
        ),
        row(
            "time constant tau",
            format!(
                "{} (k = 2), {}",
                with(report.tau_s, 2.0 * report.tau_u_s, "s"),
                report.tau_source
            ),
        ),
        row(
            "force range",
            format!(
                "{} to {}, {} levels",
                engineering(report.force_range_n[0], "N", 3),
                engineering(report.force_range_n[1], "N", 3),
                report.levels
            ),
        ),
    ];
    if let (Some(change), Some(u)) = (report.nonlinearity, report.nonlinearity_u) {
        rows.push(row(
            "non-linearity",
            format!(
                "{:+.2} % ± {:.2} % (k = 2) from the lowest to the highest force",
                100.0 * change,
                200.0 * u
            ),
        ));
    }
    if let Some(drawn) = &report.monte_carlo {
        let [low, high] = drawn.interval_95_v_per_n.map(|s| engineering(s, "V/N", 6));
        let verdict = if drawn.agrees_with_gum { "agrees" } else { "DISAGREES" };
        rows.push(row("Monte Carlo", format!(
            "95 % within {low} to {high}; {verdict} with the propagation ({} draws, JCGM 101 clause 8)",
            drawn.draws
        )));
    }
    rows.push(row(
        "raw voltage",
        format!(
            "its integral would give {}, {:+.1} %: droop ignored",
            engineering(report.naive_v_per_n, "V/N", 4),
            100.0 * (report.naive_v_per_n / s - 1.0)
        ),
    ));
    rows
}

fn impact_rows(report: &CalibrationReport) -> Vec<Vec<String>> {
    let heading = ["", "striker", "peak force", "contact", "momentum", "S", "u (own)", "raw"];
    let number = |value: Option<f64>, unit: &str, digits| {
        value.map_or("-".to_owned(), |value| engineering(value, unit, digits))
    };
    let row = |impact: &ImpactReport| {
        let own = impact.own_u_v_per_n.zip(impact.sensitivity_v_per_n);
        vec![
            format!("{}{}", impact.number, if impact.used { "" } else { " left out" }),
            impact.striker.clone(),
            number(impact.peak_force_n, "N", 4),
            number(impact.duration_s, "s", 3),
            number(impact.momentum_n_s, "N*s", 4),
            number(impact.sensitivity_v_per_n, "V/N", 5),
            own.map_or("-".to_owned(), |(u, s)| percent(u / s)),
            number(impact.naive_v_per_n, "V/N", 4),
        ]
    };
    std::iter::once(heading.map(str::to_owned).to_vec())
        .chain(report.impacts.iter().map(row))
        .collect()
}

/// The budget, small shares of impacts' own inputs put together.
fn budget_rows(report: &CalibrationReport) -> Vec<Vec<String>> {
    let mut rows = vec![
        ["input", "estimate", "standard uncertainty", "in S", "share"].map(str::to_owned).to_vec(),
    ];
    let (mut count, mut rest) = (0, 0.0);
    let mut lines: Vec<_> = report.budget.iter().collect();
    lines.sort_by(|a, b| b.share.total_cmp(&a.share));
    for line in lines {
        if line.share < SHOWN_SHARE {
            count += 1;
            rest += line.share;
            continue;
        }
        rows.push(vec![
            line.input.clone(),
            in_unit(line.value, &line.unit, 5),
            in_unit(line.standard_uncertainty, &line.unit, 3),
            engineering(line.contribution_v_per_n.abs(), "V/N", 3),
            percent(line.share),
        ]);
    }
    if count > 0 {
        let dash = || "-".to_owned();
        rows.push(vec![format!("{count} smaller inputs"), dash(), dash(), dash(), percent(rest)]);
    }
    rows
}

fn exclusions(report: &CalibrationReport) -> Vec<String> {
    let line = |impact: &ImpactReport| {
        let why = impact.excluded.as_ref()?;
        Some(format!("impact {} ({}) is left out: {why}", impact.number, impact.evidence.recording))
    };
    report.impacts.iter().filter_map(line).collect()
}

/// The page that `calibrate` prints.
#[must_use]
pub fn page(report: &CalibrationReport) -> String {
    let mut lines = vec![report.title.clone()];
    lines.extend(results(report).iter().map(|[what, number]| format!("  {what:<18} {number}")));
    lines.push(String::new());
    lines.extend(table::lines(&impact_rows(report), &[0, 1]));
    lines.push(String::new());
    lines.push("uncertainty budget, largest shares first".to_owned());
    lines.extend(table::lines(&budget_rows(report), &[0]));
    lines.extend(exclusions(report).iter().map(|line| format!("  note  {line}")));
    lines.extend(report.notes.iter().map(|note| format!("  note  {note}")));
    lines.join("\n")
}

/// A certificate: contents as in ISO/IEC 17025, 7.8.
struct Certificate<'a> {
    report: &'a CalibrationReport,
    pictures: &'a [(String, String)],
}

impl Certificate<'_> {
    fn parts(&self) -> Vec<Part> {
        let report = self.report;
        let table = |rows: Vec<Vec<String>>| Part::Table(rows);
        let pair = |[what, text]: &[String; 2]| vec![what.clone(), text.clone()];
        let heading = |text: &str| Part::Heading(2, text.to_owned());
        let titled = |first: &str, second: &str| vec![first.to_owned(), second.to_owned()];
        let two = |rows: &[[String; 2]], first: &str, second: &str| {
            table(std::iter::once(titled(first, second)).chain(rows.iter().map(pair)).collect())
        };
        let mut parts = vec![
            Part::Heading(1, format!("Calibration certificate: {}", report.title)),
            two(&self.identification(), "", ""),
            heading("Result"),
            two(&results(report), "quantity", "value"),
            Part::Paragraph("The uncertainties stated are expanded ones, the standard uncertainty times k = 2, which covers about 95 %. The results hold for the item calibrated, under the conditions stated, within the range of forces.".to_owned()),
            heading("Impacts"),
            table(impact_rows(report)),
        ];
        let left_out = exclusions(report);
        if !left_out.is_empty() {
            parts.push(Part::List(left_out));
        }
        parts.push(heading("Uncertainty budget"));
        parts.push(table(budget_rows(report)));
        parts.push(Part::Paragraph("Inputs that impacts share, such as gain, time constant and a striker's mass, are one input each and do not average out. All inputs, the smaller ones too, stand in calibration.json.".to_owned()));
        if !report.notes.is_empty() {
            parts.push(heading("Notes"));
            parts.push(Part::List(report.notes.clone()));
        }
        parts.push(heading("Recordings"));
        let head = ["", "recording", "SHA-256", "channel", "range", "time base", "instrument"];
        let rows = report.impacts.iter().map(|impact| {
            let proof = &impact.evidence;
            vec![
                impact.number.to_string(),
                format!("{}, shot {}", proof.recording, proof.shot),
                proof.sha256.clone(),
                proof.channel.clone(),
                format!("{}, probe {}x", engineering(proof.volts_per_div, "V/div", 3), proof.probe),
                engineering(proof.seconds_per_div, "s/div", 3),
                or_not_stated(proof.instrument.as_ref()),
            ]
        });
        parts.push(table(std::iter::once(head.map(str::to_owned).to_vec()).chain(rows).collect()));
        for (number, (file, svg)) in (1..).zip(self.pictures) {
            parts.push(Part::Picture(file.clone(), format!("Impact {number}"), svg.clone()));
        }
        parts
    }

    fn identification(&self) -> Vec<[String; 2]> {
        let report = self.report;
        let chain = if report.in_chain {
            "sensor and scope as one chain: valid with this scope, channel and range"
        } else {
            "sensor alone; the scope's gain is an input of the budget"
        };
        let celsius = |kelvin: f64| format!("{:.1} °C", kelvin - ZERO_CELSIUS);
        let texts = [
            ("item", report.item.clone()),
            ("scope of validity", chain.to_owned()),
            ("laboratory", or_not_stated(report.laboratory.as_ref())),
            ("customer", or_not_stated(report.customer.as_ref())),
            ("date of measurement", or_not_stated(report.date.as_ref())),
            ("method", report.method.clone()),
            ("software", report.software.clone()),
            ("plan, SHA-256", report.plan_sha256.clone()),
            ("temperature", report.temperature_k.map_or("not stated".to_owned(), celsius)),
            (
                "load",
                format!(
                    "{} and {} at the scope's input",
                    engineering(report.input_resistance_ohm, "Ohm", 3),
                    engineering(report.input_capacitance_f, "F", 3)
                ),
            ),
            ("mass traceable to", or_not_stated(report.traceability_mass.as_ref())),
            ("speed traceable to", or_not_stated(report.traceability_speed.as_ref())),
            ("voltage traceable to", or_not_stated(report.traceability_voltage.as_ref())),
        ];
        texts.map(|(what, text)| [what.to_owned(), text]).to_vec()
    }
}

/// The certificate as Markdown and as HTML; `pictures` are file names and contents, one an impact.
#[must_use]
pub fn certificate(report: &CalibrationReport, pictures: &[(String, String)]) -> (String, String) {
    let parts = Certificate { report, pictures }.parts();
    (markdown(&parts), html(&report.title, &parts))
}

/// Pictures of all impacts: the force, and under it what the voltage alone would say; file names and contents.
#[must_use]
pub fn pictures(found: &Calibration, report: &CalibrationReport) -> Vec<(String, String)> {
    let picture = |(result, told): (&ImpactResult, &ImpactReport)| {
        let name = format!("impact-{}.svg", told.number);
        let why = told.excluded.as_ref().map_or(String::new(), |why| format!(" (left out: {why})"));
        let title = format!("Impact {}, {}{why}", told.number, told.striker);
        let Some(impact) = &result.impact else {
            let empty = Curve {
                points: vec![],
                marks: vec![],
                x_label: String::new(),
                y_label: "not readable".to_owned(),
            };
            return (name, chart_over(&empty, &[], &title, ("s", "N")));
        };
        let points = |trace: &crate::trace::Trace| -> Vec<(f64, f64)> {
            let values = trace.values.iter().enumerate();
            values.map(|(i, v)| (trace.time(i), v / found.sensitivity)).collect()
        };
        let [from, to] = impact.window;
        let curve = Curve {
            points: points(&impact.restored),
            marks: vec![(from, "from".to_owned()), (to, "to".to_owned())],
            x_label: "time after the trigger".to_owned(),
            y_label: "force (N); grey: the voltage over S".to_owned(),
        };
        (name, chart_over(&curve, &points(&impact.signal), &title, ("s", "N")))
    };
    found.impacts.iter().zip(&report.impacts).map(picture).collect()
}
