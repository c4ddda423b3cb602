//! A calibration's certificate, contents as in ISO/IEC 17025, 7.8, and pictures of its impacts.

use super::calibration::{budget_rows, exclusions, impact_rows, or_not_stated, results};
use super::page::{Part, html, markdown};
use super::plot::{Plot, Series, Sheet, trace_points};
use crate::calibrate::{CalibrationReport, ImpactResult};
use crate::quantity::engineering;

/// Zero degrees Celsius (K).
const ZERO_CELSIUS: f64 = 273.15;

/// A certificate: contents as in ISO/IEC 17025, 7.8.
struct Certificate<'a> {
    report: &'a CalibrationReport,
    pictures: &'a [(String, Sheet)],
}

impl Certificate<'_> {
    fn parts(&self) -> Vec<Part> {
        let report = self.report;
        let table = |rows: Vec<Vec<String>>| Part::Table(rows, &[]);
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
            parts.push(Part::List("left out", left_out));
        }
        parts.push(heading("Uncertainty budget"));
        parts.push(table(budget_rows(report)));
        parts.push(Part::Paragraph("Inputs that impacts share, such as gain, time constant and a striker's mass, are one input each and do not average out. All inputs, the smaller ones too, stand in calibration.json.".to_owned()));
        if !report.result.notes.is_empty() {
            parts.push(heading("Notes"));
            parts.push(Part::List("note", report.result.notes.clone()));
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
        for (number, (file, sheet)) in (1..).zip(self.pictures) {
            parts.push(Part::Picture(file.clone(), format!("Impact {number}"), sheet.clone()));
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
        let ohm = |value: f64| engineering(value, "Ohm", 3);
        let farad = |value: f64| engineering(value, "F", 3);
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
                        or_not_stated(report.input_resistance_ohm.map(ohm).as_ref()),
                        or_not_stated(report.input_capacitance_f.map(farad).as_ref())
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
pub fn certificate(report: &CalibrationReport, pictures: &[(String, Sheet)]) -> (String, String) {
    let parts = Certificate { report, pictures }.parts();
    (markdown(&parts), html(&report.named.title, &parts))
}

/// Pictures of all impacts: the force, and behind it the force by the voltage alone; file names and
/// contents.
pub fn pictures(report: &CalibrationReport) -> Vec<(String, Sheet)> {
    let found = &report.result;
    let picture = |result: &ImpactResult| {
        let name = format!("impact-{}.svg", result.number);
        let why = result.exclusion.as_ref();
        let why = why.map_or(String::new(), |why| format!(" (left out: {why})"));
        let title = format!("Impact {}, {}{why}", result.number, result.striker);
        let Some(impact) = &result.impact else {
            let empty = Plot::fitted(["", ""], ["not readable", ""], Vec::new());
            return (name, Sheet::stack(title, vec![empty]));
        };
        let points = |trace: &crate::trace::Trace| -> Vec<(f64, f64)> {
            let newtons = |(time, volts)| (time, volts / found.sensitivity);
            trace_points(trace).into_iter().map(newtons).collect()
        };
        let [from, to] = impact.window;
        let behind = Series::behind("voltage over S", points(&impact.signal));
        let plot = Plot::over_time(["force", "N"], points(&impact.restored), vec![behind])
            .with_marks(vec![(from, "from".to_owned()), (to, "to".to_owned())]);
        (name, Sheet::stack(title, vec![plot]))
    };
    found.impacts.iter().map(picture).collect()
}
