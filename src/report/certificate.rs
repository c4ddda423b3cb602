//! A calibration's certificate with the contents of ISO/IEC 17025:2017, 7.8.2 and 7.8.4, and
//! pictures of its impacts. What a plan does not state is named by its key.

use super::calibration::{
    budget_rows, conformity, exclusions, impact_rows, number_of_key, results, why_factor,
};
use super::page::Part;
use super::plot::{Axis, COLOURS, Plot, Series, Sheet, Stroke, trace_points};
use crate::calibrate::{CalibrationReport, ImpactResult};
use crate::numeric::intervals::NORMAL_95;
use crate::quantity::engineering;
use crate::scene::plan::{Particulars, Place};

/// Zero degrees Celsius (K).
const ZERO_CELSIUS: f64 = 273.15;

/// Size of a picture's frame: two are beside each other on a page (pixels).
const FRAME: (f64, f64) = (340.0, 180.0);
/// File of the picture of all sensitivities.
pub const SENSITIVITY_FILE: &str = "sensitivity.svg";

/// A line of a certificate: what, the text, and the plan's key for it.
struct Entry {
    what: &'static str,
    text: Option<String>,
    key: &'static str,
    /// Whether ISO/IEC 17025 asks for it in each certificate.
    is_required: bool,
}

impl Entry {
    fn new(what: &'static str, text: Option<String>, key: &'static str) -> Self {
        let text = text.filter(|text| !text.trim().is_empty());
        Self { what, text, key, is_required: true }
    }

    /// One that a certificate may lack.
    fn optional(self) -> Self {
        Self { is_required: false, ..self }
    }

    fn row(&self) -> [String; 2] {
        let text = self.text.clone();
        [self.what.to_owned(), text.unwrap_or_else(|| format!("not stated ({})", self.key))]
    }
}

fn joined(first: Option<&String>, second: Option<&String>) -> Option<String> {
    let both: Vec<&str> = first.into_iter().chain(second).map(String::as_str).collect();
    (!both.is_empty()).then(|| both.join(", "))
}

/// A value with how far it varied.
fn with_range(value: Option<String>, range: Option<String>) -> Option<String> {
    let range = range.map_or(String::new(), |range| format!(" ± {range}"));
    value.map(|value| value + &range)
}

fn place(named: &Particulars) -> Option<String> {
    let place = match named.place? {
        Place::Laboratory => "laboratory",
        Place::Customer => "customer's premises",
        Place::LaboratoryBranch => "branch of the laboratory",
        Place::CustomerBranch => "branch of the customer",
        Place::Other => "other place",
    };
    Some(named.place_address.as_ref().map_or(place.to_owned(), |text| format!("{place}, {text}")))
}

/// What identifies certificate, item, laboratory and customer.
fn identification(report: &CalibrationReport) -> Vec<Entry> {
    let named = &report.named;
    let entry = Entry::new;
    let address = "certificate.laboratory_address";
    vec![
        entry("certificate number", named.number.clone(), "certificate.number"),
        entry("item", Some(named.item.clone()), "sensor.item"),
        entry("serial number", named.serial.clone(), "sensor.serial"),
        entry("manufacturer", named.manufacturer.clone(), "sensor.manufacturer").optional(),
        entry("condition of the item", named.condition.clone(), "certificate.condition"),
        entry("calibrated in", named.host.clone(), "sensor.host").optional(),
        entry("laboratory", named.laboratory.clone(), "laboratory"),
        entry(
            "its address",
            joined(named.laboratory_address.as_ref(), named.country.as_ref()),
            address,
        ),
        entry("customer", named.customer.clone(), "customer"),
        entry("contact", named.customer_address.clone(), "certificate.customer_address"),
        entry("item received", named.received.clone(), "certificate.received"),
        entry("date of measurement", named.date.clone(), "date"),
        entry("place of measurement", place(named), "certificate.place"),
        entry("date of issue", named.issued.clone(), "certificate.issued"),
    ]
}

/// Method, conditions and traceability.
fn procedure(report: &CalibrationReport) -> Vec<Entry> {
    let named = &report.named;
    let entry = Entry::new;
    let chain = if report.in_chain {
        "sensor and scope as one chain: valid with this scope, channel and range"
    } else {
        "sensor alone; the scope's gain is an input of the budget"
    };
    let celsius = |kelvin: f64| format!("{:.1} °C", kelvin - ZERO_CELSIUS);
    let kelvin = |range: f64| format!("{range} K");
    let temperature =
        with_range(named.temperature.map(celsius), named.temperature_range.map(kelvin));
    let whole = |share: f64| format!("{:.0} %", 100.0 * share);
    let humidity = with_range(named.humidity.map(whole), named.humidity_range.map(whole));
    let load = if let Some(gain) = report.charge_amplifier_v_per_c {
        format!("a charge amplifier of {} mV/pC", 1e-9 * gain)
    } else {
        let parts = [
            report.input_resistance_ohm.map(|ohm| engineering(ohm, "Ohm", 3)),
            report.input_capacitance_f.map(|farad| engineering(farad, "F", 3)),
        ];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        format!("{} at the scope's input", parts.join(" and "))
    };
    let voltage =
        entry("voltage traceable to", named.voltage_traceability.clone(), "traceability.voltage");
    vec![
        entry("method", Some(report.method.to_owned()), ""),
        entry("deviations from the method", named.deviations.clone(), "certificate.deviations"),
        entry("scope of validity", Some(chain.to_owned()), ""),
        entry("load of the sensor", Some(load), ""),
        entry("temperature", temperature, "conditions.temperature"),
        entry("relative humidity", humidity, "conditions.humidity").optional(),
        entry("mass traceable to", named.mass_traceability.clone(), "traceability.mass"),
        entry("speed traceable to", named.speed_traceability.clone(), "traceability.speed"),
        // The scope of a chain is part of the item.
        if report.in_chain { voltage.optional() } else { voltage },
        entry("software", Some(report.software.clone()), ""),
        entry("plan, SHA-256", Some(report.plan_sha256.clone()), ""),
    ]
}

/// Who authorises the certificate.
fn authorisation(named: &Particulars) -> Vec<Entry> {
    vec![
        Entry::new("authorised by", named.approved_by.clone(), "certificate.approved_by"),
        Entry::new("function", named.function.clone(), "certificate.function"),
    ]
}

/// Keys of the plan without which a certificate lacks what ISO/IEC 17025:2017, 7.8.2.1 and 7.8.4.1,
/// ask for.
pub fn missing(report: &CalibrationReport) -> Vec<&'static str> {
    let entries = [identification(report), procedure(report), authorisation(&report.named)];
    let lacks = |entry: &Entry| entry.is_required && entry.text.is_none();
    entries.into_iter().flatten().filter(lacks).map(|entry| entry.key).collect()
}

/// The result in sentences that need no knowledge of the method.
fn in_words(report: &CalibrationReport) -> String {
    let found = &report.result;
    let volts = engineering(found.sensitivity, "V", 4);
    let sign = if found.negative { " negative" } else { "" };
    format!(
        "Within {} to {} the item gives a{sign} voltage of {volts} for each newton. The interval of ± U around this value contains the true one with a probability of 95 %. A voltage that lasts decays with the time constant tau; software that uses this certificate has to correct for it.",
        engineering(found.force_range[0], "N", 3),
        engineering(found.force_range[1], "N", 3),
    )
}

fn two_columns(rows: impl IntoIterator<Item = [String; 2]>, heading: [&str; 2]) -> Part {
    let rows = rows.into_iter().map(|row| row.to_vec());
    let heading = heading.map(str::to_owned).to_vec();
    Part::Table(std::iter::once(heading).chain(rows).collect(), &[0, 1])
}

fn heading(text: &str) -> Part {
    Part::Heading(2, text.to_owned())
}

fn paragraph(text: &str) -> Part {
    Part::Paragraph(text.to_owned())
}

/// Result, decision and adjustment.
fn result_parts(report: &CalibrationReport) -> Vec<Part> {
    let mut parts = vec![
        heading("Result"),
        two_columns(results(report), ["quantity", "value"]),
        Part::Paragraph(in_words(report)),
        Part::Paragraph(format!(
            "The uncertainties are expanded ones, U = k u, that cover 95 %, by JCGM 100:2008. {}",
            why_factor(report)
        )),
        paragraph(
            "The results hold for the item calibrated only, under the conditions stated, within the range of forces.",
        ),
    ];
    if let Some(words) = conformity(report) {
        parts.extend([heading("Statement of conformity"), Part::Paragraph(words)]);
    }
    if let Some(adjustment) = &report.named.adjustment {
        let before = super::table::with_expanded(
            adjustment.sensitivity.value,
            adjustment.sensitivity.expanded(),
            "V/N",
        );
        let change = 100.0 * (report.result.sensitivity / adjustment.sensitivity.value - 1.0);
        parts.extend([
            heading("Adjustment"),
            Part::Paragraph(format!(
                "Before this calibration: {}. Sensitivity before the adjustment: {before} (k = 1.96; {}). The results above are those after it: {change:+.2} %.",
                adjustment.work, adjustment.file
            )),
        ]);
    }
    parts
}

/// Impacts, budget, equipment, notes.
fn evidence_parts(report: &CalibrationReport) -> Vec<Part> {
    let mut parts = vec![
        heading("Impacts"),
        Part::Table(impact_rows(report), &[1]),
        paragraph(
            "S is the sensitivity by one impact alone, u (own) its relative standard uncertainty from the inputs that this impact shares with no other, raw what its voltage's integral gives without the correction for droop.",
        ),
    ];
    let left_out = exclusions(report);
    if !left_out.is_empty() {
        parts.push(Part::List("left out", left_out));
    }
    parts.extend([
        heading("Uncertainty budget"),
        Part::Table(budget_rows(report, 0.0), &[0, 3]),
        paragraph("c is the sensitivity coefficient, the derivative of S (V/N) by the input in its SI unit; c u its contribution; share that of the variance. Type A: from the records or the scatter of impacts; type B: as the plan states (JCGM 100:2008, 4.2 and 4.3). nu: degrees of freedom; impacts' own inputs and their unexplained scatter have those of the scatter together. Inputs that impacts share, such as gain, time constant and a striker's mass, are one input each and do not average out."),
    ]);
    let equipment = report.named.equipment.iter().map(|known| {
        let text = |text: &Option<String>| text.clone().unwrap_or_else(|| "not stated".to_owned());
        vec![known.name.clone(), text(&known.serial), text(&known.certificate)]
    });
    let equipment = super::table::titled(["equipment", "serial number", "certificate"], equipment);
    parts.extend(Part::section("Equipment", equipment, &[0, 1, 2]));
    if !report.result.notes.is_empty() {
        parts.extend([heading("Notes"), Part::List("note", report.result.notes.clone())]);
    }
    parts
}

fn recordings(report: &CalibrationReport) -> Part {
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
            proof.instrument.clone().unwrap_or_else(|| "not stated".to_owned()),
        ]
    });
    Part::Table(super::table::titled(head, rows), &[0, 1, 2, 3, 6])
}

fn parts(title: &str, report: &CalibrationReport, pictures: &[(String, Sheet)]) -> Vec<Part> {
    let named = &report.named;
    let rows = |entries: Vec<Entry>| entries.iter().map(Entry::row).collect::<Vec<_>>();
    let mut parts = vec![Part::Heading(1, title.to_owned()), Part::Paragraph(named.title.clone())];
    parts.push(two_columns(rows(identification(report)), ["", ""]));
    parts.extend(result_parts(report));
    parts
        .extend([heading("Method and conditions"), two_columns(rows(procedure(report)), ["", ""])]);
    parts.extend([heading("Authorisation"), two_columns(rows(authorisation(named)), ["", ""])]);
    parts.push(Part::Signature);
    parts.push(paragraph("This certificate may be reproduced in full only, unless the laboratory has agreed in writing."));
    let missing = missing(report);
    if !missing.is_empty() {
        let keys = missing.join(", ");
        parts.push(Part::Paragraph(format!(
            "The plan does not state what ISO/IEC 17025:2017, 7.8.2.1 and 7.8.4.1, ask for: {keys}."
        )));
    }
    parts.extend(evidence_parts(report));
    let caption =
        "Sensitivity by each impact, and the result with its expanded uncertainty.".to_owned();
    let sheet = Sheet { size: FRAME, ..sensitivity_picture(report) };
    parts.push(Part::Picture(SENSITIVITY_FILE.to_owned(), caption, sheet));
    parts.extend([heading("Recordings"), recordings(report)]);
    for (impact, (file, sheet)) in report.result.impacts.iter().zip(pictures) {
        let caption = format!(
            "Impact {}, striker {}. Blue: force on the sensor; grey: voltage over S, without correction for droop; dashed: begin and end of the contact.",
            impact.number, impact.striker
        );
        parts.push(Part::Picture(file.clone(), caption, sheet.clone()));
    }
    parts.push(Part::Paragraph(format!("End of certificate {}.", number_of_key(named))));
    parts
}

/// Title and parts of the certificate; `pictures` are file names and contents, one an impact.
pub fn certificate(
    report: &CalibrationReport,
    pictures: &[(String, Sheet)],
) -> (String, Vec<Part>) {
    let title = format!("Calibration certificate {}", number_of_key(&report.named));
    let parts = parts(&title, report, pictures);
    (title, parts)
}

/// Pictures of all impacts: the force, and behind it the force by the voltage alone; file names and
/// contents.
pub fn pictures(report: &CalibrationReport) -> Vec<(String, Sheet)> {
    let found = &report.result;
    let picture = |result: &ImpactResult| {
        let name = format!("impact-{}.svg", result.number);
        let why = result.exclusion.as_ref();
        let why = why.map_or(String::new(), |why| format!(" (left out: {why})"));
        let title = format!("Impact {}, striker {}{why}", result.number, result.striker);
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
        let mut plot = Plot::over_time(["force", "N"], points(&impact.restored), vec![behind])
            .with_marks(vec![(from, "begin".to_owned()), (to, "end".to_owned())]);
        if let Some(line) = plot.lines.last_mut() {
            "force, droop corrected".clone_into(&mut line.name);
        }
        (name, Sheet { size: FRAME, ..Sheet::stack(title, vec![plot]) })
    };
    found.impacts.iter().map(picture).collect()
}

/// Sensitivity by each impact over its largest force, with the result and its expanded uncertainty.
pub fn sensitivity_picture(report: &CalibrationReport) -> Sheet {
    let found = &report.result;
    let used = found.impacts.iter().filter(|impact| impact.used);
    let points: Vec<(f64, f64, f64)> = used
        .filter_map(|impact| {
            let u = NORMAL_95 * impact.own_uncertainty?;
            Some((impact.peak_force?, impact.sensitivity?, u))
        })
        .collect();
    let [from, to] = found.force_range;
    let (from, to) = (from - 0.05 * to, 1.05 * to);
    let [low, high] = found.interval_95;
    let (low_end, high_end) =
        points.iter().fold((low, high), |(low, high), (_, s, u)| (low.min(s - u), high.max(s + u)));
    let padding = 0.1 * (high_end - low_end);
    let x = Axis::prefixed("largest force", "N", (from.max(0.0), to));
    let y = Axis::prefixed("sensitivity", "V/N", (low_end - padding, high_end + padding));
    let level = |height: f64| vec![(x.from, height), (x.to, height)];
    let mut lines = vec![
        Series::area("S ± U (95 %)", &level(low), &level(high)),
        Series { name: "S".to_owned(), ..Series::main(level(found.sensitivity)) },
    ];
    lines.extend(points.iter().map(|(force, s, u)| {
        Series::new("", vec![(*force, s - u), (*force, s + u)], COLOURS[1], Stroke::Solid)
    }));
    let dots = points.iter().map(|(force, s, _)| (*force, *s)).collect();
    lines.push(Series::new(
        "by one impact, with U of its own inputs",
        dots,
        COLOURS[1],
        Stroke::Dots,
    ));
    let plot = Plot { lines, ..Plot::new("", x, y) };
    Sheet::stack(report.named.title.clone(), vec![plot])
}
