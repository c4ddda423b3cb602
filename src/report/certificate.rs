//! A calibration's certificate, contents as in ISO/IEC 17025, 7.8, and pictures of its impacts.

use super::calibration::{budget_rows, exclusions, impact_rows, or_not_stated, results};
use super::chart::{Under, chart, chart_over};
use super::document::{Part, html, markdown};
use super::plot::{Curve, Label};
use crate::calibrate::{CalibrationReport, ImpactResult};
use crate::quantity::engineering;

/// Zero degrees Celsius (K).
const ZERO_CELSIUS: f64 = 273.15;

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
            Part::Heading(1, format!("Calibration certificate: {}", report.named.title)),
            two(&self.identification(), "", ""),
            heading("Result"),
            two(&results(report), "quantity", "value"),
            Part::Paragraph("The uncertainties stated are expanded ones that cover 95 %: the standard uncertainty times a coverage factor k. This is Student's t for the effective degrees of freedom (Welch-Satterthwaite), or smaller, down to 1.65, where an input that is evenly distributed within limits, such as a data sheet's gain, outweighs the others. If the Monte Carlo check does not confirm the propagation of uncertainty, the interval of its draws is stated instead, up to its farther end. The results hold for the item calibrated, under the conditions stated, within the range of forces.".to_owned()),
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
        if !report.result.notes.is_empty() {
            parts.push(heading("Notes"));
            parts.push(Part::List(report.result.notes.clone()));
        }
        parts.push(heading("Recordings"));
        let head = ["", "recording", "SHA-256", "channel", "range", "time base", "instrument"];
        let proofs = report.result.impacts.iter().filter_map(|i| Some((i, i.evidence.as_ref()?)));
        let rows = proofs.map(|(impact, proof)| {
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
            ("item", report.named.item.clone()),
            ("scope of validity", chain.to_owned()),
            ("laboratory", or_not_stated(report.named.laboratory.as_ref())),
            ("customer", or_not_stated(report.named.customer.as_ref())),
            ("date of measurement", or_not_stated(report.named.date.as_ref())),
            ("method", report.method.to_owned()),
            ("software", report.software.clone()),
            ("plan, SHA-256", report.plan_sha256.clone()),
            ("temperature", report.named.temperature.map_or("not stated".to_owned(), celsius)),
            (
                "load",
                match report.charge_amplifier_v_per_c {
                    Some(gain) => {
                        format!("a charge amplifier of {} mV/pC", 1e-9 * gain)
                    }
                    None => format!(
                        "{} and {} at the scope's input",
                        engineering(report.input_resistance_ohm.unwrap_or(f64::NAN), "Ohm", 3),
                        engineering(report.input_capacitance_f.unwrap_or(f64::NAN), "F", 3)
                    ),
                },
            ),
            ("mass traceable to", or_not_stated(report.named.mass_traceability.as_ref())),
            ("speed traceable to", or_not_stated(report.named.speed_traceability.as_ref())),
            ("voltage traceable to", or_not_stated(report.named.voltage_traceability.as_ref())),
        ];
        texts.map(|(what, text)| [what.to_owned(), text]).to_vec()
    }
}

/// The certificate as Markdown and as HTML; `pictures` are file names and contents, one an impact.
pub fn certificate(report: &CalibrationReport, pictures: &[(String, String)]) -> (String, String) {
    let parts = Certificate { report, pictures }.parts();
    (markdown(&parts), html(&report.named.title, &parts))
}

/// Pictures of all impacts: the force, and below it the force by the voltage alone; file names and
/// contents.
pub fn pictures(report: &CalibrationReport) -> Vec<(String, String)> {
    let found = &report.result;
    let picture = |result: &ImpactResult| {
        let name = format!("impact-{}.svg", result.number);
        let why = result.exclusion.as_ref();
        let why = why.map_or(String::new(), |why| format!(" (left out: {why})"));
        let title = format!("Impact {}, {}{why}", result.number, result.striker);
        let Some(impact) = &result.impact else {
            let empty = Curve {
                points: vec![],
                marks: vec![],
                x: Label::new("", ""),
                y: Label::new("not readable", ""),
            };
            return (name, chart(&empty, &title));
        };
        let points = |trace: &crate::trace::Trace| -> Vec<(f64, f64)> {
            let values = trace.values.iter().enumerate();
            values.map(|(i, v)| (trace.time(i), v / found.sensitivity)).collect()
        };
        let [from, to] = impact.window;
        let curve = Curve {
            points: points(&impact.restored),
            marks: vec![(from, "from".to_owned()), (to, "to".to_owned())],
            x: Label::new("time after the trigger", "s"),
            y: Label::new("force", "N"),
        };
        let under = Under::new("voltage over S", vec![points(&impact.signal)]);
        (name, chart_over(&curve, &[under], &title))
    };
    found.impacts.iter().map(picture).collect()
}
