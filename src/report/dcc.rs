//! A calibration as a digital calibration certificate (DCC).
//!
//! XML by PTB's schema, version 3.3.0 (<https://ptb.de/dcc/v3.3.0/dcc.xsd>), with quantities by the
//! D-SI schema, version 2.2.1. It contains the administrative data of the plan, the results with
//! `U`, `k`, coverage probability and distribution, the conditions, method and equipment, the whole
//! budget, and the hashes of plan and recordings. It is not signed. [`crate::scene::dcc`] reads it.

use crate::calibrate::report::Verdict;
use crate::calibrate::{CalibrationReport, NonLinearity};
use crate::numeric::intervals::NORMAL_95;
use crate::scene::dcc as kinds;
use crate::scene::plan::{DecisionRule, Particulars, Place, days};

/// Version of the schema.
const SCHEMA: &str = "3.3.0";
/// Zero degrees Celsius (K).
const ZERO_CELSIUS: f64 = 273.15;

/// Why there is no certificate.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub enum DccError {
    /// The schema demands data that the plan lacks.
    #[error("a digital calibration certificate needs data that the plan lacks:{}", list(keys))]
    Missing {
        /// The plan's keys, each with an example.
        keys: Vec<(&'static str, &'static str)>,
    },
    /// The days of the measurement are in another form.
    #[error(
        "date: found \"{date}\", a digital calibration certificate needs days, e.g. \"2026-11-27\" or \"2026-11-26 to 2026-11-27\""
    )]
    Date {
        /// The date as typed.
        date: String,
    },
}

fn list(keys: &[(&str, &str)]) -> String {
    let key = |(key, example): &(&str, &str)| format!("\n  {key} = \"{example}\"");
    keys.iter().map(key).collect::<Vec<_>>().concat()
}

/// What the schema demands of a plan.
struct Administrative<'a> {
    number: String,
    country: String,
    place: &'static str,
    days: [&'a str; 2],
    item: String,
    serial: String,
    laboratory: [String; 2],
    customer: [String; 2],
    person: String,
}

impl<'a> Administrative<'a> {
    fn of(named: &'a Particulars) -> Result<Self, DccError> {
        let mut keys = Vec::new();
        let mut demand = |key, example, text: Option<&String>| {
            let text = text.map(|text| clean(text)).filter(|text| !text.is_empty());
            if text.is_none() {
                keys.push((key, example));
            }
            text.unwrap_or_default()
        };
        let mut found = Self {
            number: demand("certificate.number", "2026-114", named.number.as_ref()),
            country: demand("certificate.country", "DE", named.country.as_ref()),
            place: "",
            days: [""; 2],
            item: demand("sensor.item", "PZT-5A plate 3 x 3 x 0.5 mm", Some(&named.item)),
            serial: demand("sensor.serial", "7", named.serial.as_ref()),
            laboratory: [
                demand("laboratory", "Granular lab", named.laboratory.as_ref()),
                demand(
                    "certificate.laboratory_address",
                    "Street 1, City",
                    named.laboratory_address.as_ref(),
                ),
            ],
            customer: [
                demand("customer", "Bench 2", named.customer.as_ref()),
                demand(
                    "certificate.customer_address",
                    "Street 2, City",
                    named.customer_address.as_ref(),
                ),
            ],
            person: demand("certificate.approved_by", "N. N.", named.approved_by.as_ref()),
        };
        match named.place {
            Some(place) => found.place = location(place),
            None => keys.push(("certificate.place", "laboratory")),
        }
        match named.date.as_ref() {
            Some(date) => {
                found.days = days(date).ok_or_else(|| DccError::Date { date: date.clone() })?;
            }
            None => keys.push(("date", "2026-11-27")),
        }
        if keys.is_empty() { Ok(found) } else { Err(DccError::Missing { keys }) }
    }
}

/// Fails if the schema demands data that a plan lacks.
///
/// # Errors
/// [`DccError`], with all keys that are missing.
pub fn check(named: &Particulars) -> Result<(), DccError> {
    Administrative::of(named).map(|_| ())
}

/// The schema's word for a place.
fn location(place: Place) -> &'static str {
    match place {
        Place::Laboratory => "laboratory",
        Place::Customer => "customer",
        Place::LaboratoryBranch => "laboratoryBranch",
        Place::CustomerBranch => "customerBranch",
        Place::Other => "other",
    }
}

/// Text as the schema takes it: one blank between words, no character that XML lacks.
fn clean(text: &str) -> String {
    let is_allowed = |c: char| c >= ' ' && !matches!(c, '\u{fffe}' | '\u{ffff}');
    let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
    words.chars().map(|c| if is_allowed(c) { c } else { '\u{fffd}' }).collect()
}

/// Text between tags.
fn escaped(text: &str) -> String {
    clean(text).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// The element `name` around `inner`.
fn tag(name: &str, inner: &str) -> String {
    format!("<{name}>{inner}</{name}>\n")
}

/// The element `name` of a `refType` around `inner`.
fn of_kind(name: &str, kind: &str, inner: &str) -> String {
    format!("<{name} refType=\"{kind}\">\n{inner}</{name}>\n")
}

/// Text of the program or of the plan, whose language is not known.
fn content(text: &str) -> String {
    tag("dcc:content", &escaped(text))
}

fn called(text: &str) -> String {
    tag("dcc:name", &content(text))
}

fn described(text: &str) -> String {
    tag("dcc:description", &content(text))
}

/// A number by the D-SI's patterns, which have no infinity.
fn number(value: f64) -> String {
    if value.is_finite() { format!("{value}") } else { "NaN".to_owned() }
}

/// A unit in the D-SI's form.
fn unit(unit: &str) -> &'static str {
    match unit {
        "V/N" => r"\volt\newton\tothe{-1}",
        "C/N" => r"\coulomb\newton\tothe{-1}",
        "V" => r"\volt",
        "V*s" => r"\volt\second",
        "N" => r"\newton",
        "s" => r"\second",
        "1/s" => r"\second\tothe{-1}",
        "m" => r"\metre",
        "m/s" => r"\metre\second\tothe{-1}",
        "m/s^2" => r"\metre\second\tothe{-2}",
        "kg" => r"\kilogram",
        "Ohm" => r"\ohm",
        "F" => r"\farad",
        "°C" => r"\degreecelsius",
        _ => r"\one",
    }
}

/// The unit of a sensitivity coefficient, volts per newton over the input's.
fn coefficient_unit(input: &str) -> &'static str {
    match input {
        "V" => r"\newton\tothe{-1}",
        "V*s" => r"\newton\tothe{-1}\second\tothe{-1}",
        "s" => r"\volt\newton\tothe{-1}\second\tothe{-1}",
        "1/s" => r"\volt\newton\tothe{-1}\second",
        "m" => r"\volt\newton\tothe{-1}\metre\tothe{-1}",
        "m/s" => r"\volt\newton\tothe{-1}\metre\tothe{-1}\second",
        "m/s^2" => r"\volt\newton\tothe{-1}\metre\tothe{-1}\second\tothe{2}",
        "kg" => r"\volt\newton\tothe{-1}\kilogram\tothe{-1}",
        "V/N" => r"\one",
        _ => unit("V/N"),
    }
}

/// A `si:real`; `uncertainty` is one of [`expanded`] and [`standard`], or empty.
fn real(value: f64, unit: &str, uncertainty: &str) -> String {
    let value = tag("si:value", &number(value));
    tag("si:real", &format!("{value}{}{uncertainty}", tag("si:unit", unit)))
}

/// An expanded uncertainty that covers 95 %.
fn expanded(expanded: f64, factor: f64, distribution: &str) -> String {
    let parts = [
        tag("si:valueExpandedMU", &number(expanded)),
        tag("si:coverageFactor", &number(factor)),
        tag("si:coverageProbability", "0.95"),
        tag("si:distribution", distribution),
    ];
    tag("si:measurementUncertaintyUnivariate", &tag("si:expandedMU", &parts.concat()))
}

/// A standard uncertainty.
fn standard(u: f64, distribution: &str) -> String {
    let parts = [tag("si:valueStandardMU", &number(u)), tag("si:distribution", distribution)];
    tag("si:measurementUncertaintyUnivariate", &tag("si:standardMU", &parts.concat()))
}

/// A quantity with its name.
fn quantity(name: &str, kind: Option<&str>, real: &str) -> String {
    let inner = format!("{}{real}", called(name));
    match kind {
        Some(kind) => of_kind("dcc:quantity", kind, &inner),
        None => tag("dcc:quantity", &inner),
    }
}

/// A name and texts as data about the result.
fn meta(name: &str, inner: &str) -> String {
    tag("dcc:metaData", &format!("{}{inner}", called(name)))
}

/// A statement in words.
fn statement(name: &str, text: &str) -> String {
    let declaration = tag("dcc:declaration", &content(text));
    tag("dcc:statement", &format!("{}{declaration}", called(name)))
}

/// The certificate.
///
/// # Errors
/// [`DccError`], with all keys that are missing.
pub fn dcc(report: &CalibrationReport) -> Result<String, DccError> {
    let plan = Administrative::of(&report.named)?;
    let administrative = administrative(report, &plan);
    let parts = [
        called(&report.named.title),
        methods(report),
        tag("dcc:usedSoftware", &software()),
        equipment(report),
        conditions(report),
        tag("dcc:results", &(results(report) + &budget(report))),
        tag("dcc:measurementMetaData", &metadata(report)),
    ];
    let result = tag("dcc:measurementResult", &parts.concat());
    Ok(format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <dcc:digitalCalibrationCertificate xmlns:dcc=\"{dcc}\" xmlns:si=\"{si}\" xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" \
         xsi:schemaLocation=\"{dcc} https://ptb.de/dcc/v{SCHEMA}/dcc.xsd\" schemaVersion=\"{SCHEMA}\">\n{}{}</dcc:digitalCalibrationCertificate>\n",
        tag("dcc:administrativeData", &administrative),
        tag("dcc:measurementResults", &result),
        dcc = kinds::DCC_NAMESPACE,
        si = kinds::SI_NAMESPACE,
    ))
}

fn software() -> String {
    let version = env!("CARGO_PKG_VERSION").split(['-', '+']).next().unwrap_or_default();
    let release = tag("dcc:release", &format!("v{version}"));
    tag("dcc:software", &format!("{}{release}", called("hertzscope")))
}

fn administrative(report: &CalibrationReport, plan: &Administrative<'_>) -> String {
    let named = &report.named;
    let optional = |name: &str, text: Option<&String>| {
        text.map_or(String::new(), |text| tag(name, &escaped(text)))
    };
    let core = [
        tag("dcc:countryCodeISO3166_1", &plan.country),
        tag("dcc:usedLangCodeISO639_1", "en"),
        tag("dcc:mandatoryLangCodeISO639_1", "en"),
        tag("dcc:uniqueIdentifier", &escaped(&plan.number)),
        optional("dcc:receiptDate", named.received.as_ref()),
        tag("dcc:beginPerformanceDate", plan.days[0]),
        tag("dcc:endPerformanceDate", plan.days[1]),
        tag("dcc:performanceLocation", plan.place),
        optional("dcc:issueDate", named.issued.as_ref()),
    ];
    let identification = |issuer: &str, value: &str, name: &str| {
        let parts = [tag("dcc:issuer", issuer), tag("dcc:value", &escaped(value)), called(name)];
        tag("dcc:identification", &parts.concat())
    };
    let stated = |text: &Option<String>| text.as_deref().map(clean).filter(|text| !text.is_empty());
    let maker = |name: String| tag("dcc:manufacturer", &called(&name));
    let item = [
        called(&plan.item),
        stated(&named.condition)
            .map_or(String::new(), |text| described(&format!("condition: {text}"))),
        stated(&named.manufacturer).map_or(String::new(), maker),
        tag("dcc:identifications", &identification("manufacturer", &plan.serial, "serial number")),
    ];
    let address = |text: &str| tag("dcc:further", &content(text));
    let country = tag("dcc:countryCode", &plan.country);
    let contact = |[name, text]: &[String; 2], country: &str| {
        format!("{}{}", called(name), tag("dcc:location", &format!("{country}{}", address(text))))
    };
    let person = [
        tag("dcc:person", &called(&plan.person)),
        stated(&named.function).map_or(String::new(), |text| tag("dcc:role", &escaped(&text))),
        tag("dcc:mainSigner", "true"),
    ];
    let mut statements = vec![
        statement(
            "validity",
            "The results hold for the item calibrated only, under the conditions stated, within the range of forces.",
        ),
        statement(
            "reproduction",
            "This certificate may be reproduced in full only, unless the laboratory has agreed in writing.",
        ),
    ];
    for (what, text) in [
        ("place of performance", &named.place_address),
        ("deviations from the method", &named.deviations),
        ("traceability of mass", &named.mass_traceability),
        ("traceability of speed", &named.speed_traceability),
        ("traceability of voltage", &named.voltage_traceability),
    ] {
        statements.extend(stated(text).map(|text| statement(what, &text)));
    }
    [
        tag("dcc:dccSoftware", &software()),
        tag("dcc:coreData", &core.concat()),
        tag("dcc:items", &tag("dcc:item", &item.concat())),
        tag("dcc:calibrationLaboratory", &tag("dcc:contact", &contact(&plan.laboratory, &country))),
        tag("dcc:respPersons", &tag("dcc:respPerson", &person.concat())),
        tag("dcc:customer", &contact(&plan.customer, "")),
        tag("dcc:statements", &statements.concat()),
    ]
    .concat()
}

fn methods(report: &CalibrationReport) -> String {
    let mut norms = vec!["JCGM 100:2008"];
    norms.extend(report.result.monte_carlo.map(|_| "JCGM 101:2008"));
    let norms: String = norms.into_iter().map(|norm| tag("dcc:norm", norm)).collect();
    let parts = [called("linear momentum of impacts"), described(report.method), norms];
    tag("dcc:usedMethods", &tag("dcc:usedMethod", &parts.concat()))
}

fn equipment(report: &CalibrationReport) -> String {
    let identification = |issuer: &str, value: &Option<String>, name: &str| {
        let value = value.as_deref().map(escaped).filter(|value| !value.is_empty());
        let parts =
            |value: String| [tag("dcc:issuer", issuer), tag("dcc:value", &value), called(name)];
        value.map_or(String::new(), |value| tag("dcc:identification", &parts(value).concat()))
    };
    let mut all: Vec<String> = Vec::new();
    for known in &report.named.equipment {
        let numbers = identification("manufacturer", &known.serial, "serial number")
            + &identification("other", &known.certificate, "calibration certificate");
        let numbers =
            if numbers.is_empty() { numbers } else { tag("dcc:identifications", &numbers) };
        all.push(called(&known.name) + &numbers);
    }
    let proofs = report.result.impacts.iter().filter_map(|impact| impact.evidence.as_ref());
    all.extend(proofs.filter_map(|proof| proof.instrument.as_deref()).map(called));
    all.sort();
    all.dedup();
    if all.is_empty() {
        return String::new();
    }
    let each: String = all.iter().map(|inner| tag("dcc:measuringEquipment", inner)).collect();
    tag("dcc:measuringEquipments", &each)
}

/// The conditions under which the result holds.
fn conditions(report: &CalibrationReport) -> String {
    let named = &report.named;
    let condition = |kind: &str, name: &str, spread: Option<String>, data: &str| {
        let spread = spread.map_or(String::new(), |text| described(&text));
        let inner = format!("{}{spread}{}", called(name), tag("dcc:data", data));
        of_kind("dcc:influenceCondition", kind, &inner)
    };
    let bare = |value: f64, of: &str| tag("dcc:quantity", &real(value, unit(of), ""));
    let words = |text: &str| tag("dcc:text", &content(text));
    let [low, high] = report.result.force_range;
    let mut all = vec![
        condition("hertzscope_lowestForce", "lowest peak force", None, &bare(low, "N")),
        condition("hertzscope_highestForce", "highest peak force", None, &bare(high, "N")),
    ];
    if let Some(kelvin) = named.temperature {
        let spread = named.temperature_range.map(|range| format!("± {range} K"));
        let celsius = bare(kelvin - ZERO_CELSIUS, "°C");
        all.push(condition("basic_temperature", "temperature", spread, &celsius));
    }
    if let Some(share) = named.humidity {
        let spread = named.humidity_range.map(|range| format!("± {range}"));
        all.push(condition(
            "basic_humidityRelative",
            "relative humidity",
            spread,
            &bare(share, "1"),
        ));
    }
    for (kind, name, value, of) in [
        (
            kinds::INPUT_RESISTANCE,
            "resistance of the scope's input",
            report.input_resistance_ohm,
            "Ohm",
        ),
        (
            kinds::INPUT_CAPACITANCE,
            "capacitance of the scope's input",
            report.input_capacitance_f,
            "F",
        ),
        (
            kinds::RANGE,
            "vertical scale of the channel calibrated with the sensor, for a division",
            report.range_v_per_div,
            "V",
        ),
    ] {
        all.extend(value.map(|value| condition(kind, name, None, &bare(value, of))));
    }
    for (kind, name, text) in [
        (kinds::CHANNEL, "channel calibrated with the sensor as one", &report.channel),
        (kinds::HOST, "body that contains the sensor", &named.host),
    ] {
        all.extend(text.as_ref().map(|text| condition(kind, name, None, &words(text))));
    }
    tag("dcc:influenceConditions", &all.concat())
}

/// Name of the distribution that the expanded uncertainty is from.
fn distribution(report: &CalibrationReport) -> &'static str {
    let found = &report.result;
    match (found.unconfirmed().is_some(), found.half_width > 0.0, found.freedom.is_finite()) {
        (true, _, _) => "drawn",
        (_, true, _) => "convolution of normal and rectangular",
        (_, _, true) => "studentT",
        _ => "normal",
    }
}

fn results(report: &CalibrationReport) -> String {
    let found = &report.result;
    let distribution = distribution(report);
    let sensitivity = |name: &str, kind: Option<&str>, factor: f64, of: &str| {
        let uncertainty = expanded(factor * found.expanded, found.coverage_factor, distribution);
        quantity(name, kind, &real(factor * found.sensitivity, unit(of), &uncertainty))
    };
    let mut all = vec![sensitivity("sensitivity", Some(kinds::SENSITIVITY), 1.0, "V/N")];
    let charge = report.charge_sensitivity_c_per_n.map(|charge| charge / found.sensitivity);
    all.extend(charge.map(|factor| sensitivity("charge sensitivity", None, factor, "C/N")));
    let tau = expanded(found.tau_expanded, NORMAL_95, "normal");
    all.push(quantity(
        "time constant",
        Some(kinds::TIME_CONSTANT),
        &real(found.tau, unit("s"), &tau),
    ));
    if let Some(NonLinearity { change, u, expanded: whole, .. }) =
        found.nonlinearity.filter(|line| line.u > 0.0)
    {
        let uncertainty = expanded(whole, whole / u, "studentT");
        let name = "change of the sensitivity from the lowest to the highest force, relative";
        all.push(quantity(name, None, &real(change, r"\one", &uncertainty)));
    }
    let data = tag("dcc:data", &tag("dcc:list", &all.concat()));
    tag("dcc:result", &format!("{}{data}", called("result")))
}

/// The whole budget: for each input its value with the standard uncertainty, the sensitivity
/// coefficient, its contribution and its share of the variance.
fn budget(report: &CalibrationReport) -> String {
    let line = |line: &crate::calibrate::equation::BudgetLine| {
        let freedom =
            if line.freedom.is_finite() { number(line.freedom) } else { "infinite".to_owned() };
        let how = format!(
            "type {}, {}, degrees of freedom: {freedom}",
            line.evaluation, line.distribution
        );
        let bare = |name: &str, value: f64, of: &str| quantity(name, None, &real(value, of, ""));
        let parts = [
            called(&line.name),
            described(&how),
            quantity(
                "input",
                None,
                &real(line.value, unit(line.unit), &standard(line.u, line.distribution)),
            ),
            bare("sensitivity coefficient", line.coefficient, coefficient_unit(line.unit)),
            bare("contribution", line.contribution, unit("V/N")),
            bare("share of the variance", line.share, r"\one"),
        ];
        tag("dcc:list", &parts.concat())
    };
    let lines: String = report.result.budget.iter().map(line).collect();
    if lines.is_empty() {
        return String::new();
    }
    let data = tag("dcc:data", &of_kind("dcc:list", "hertzscope_uncertaintyBudget", &lines));
    tag("dcc:result", &format!("{}{data}", called("uncertainty budget")))
}

/// Conformity, adjustment, notes, and the hashes of plan and recordings.
fn metadata(report: &CalibrationReport) -> String {
    let said = |text: &str| tag("dcc:declaration", &content(text));
    let mut all = vec![meta("plan, SHA-256", &said(&report.plan_sha256))];
    if let Some(conformity) = report.conformity() {
        let norm = "ILAC-G8:09/2019";
        let status = match conformity.verdict {
            Verdict::Pass => "pass",
            Verdict::Fail => "fail",
            Verdict::NotShown => "noPass",
        };
        let rule = match conformity.tolerance.rule {
            DecisionRule::GuardBand => "guard band of the expanded uncertainty",
            DecisionRule::SimpleAcceptance => "simple acceptance",
        };
        let text = format!(
            "nominal {} V/N, tolerance {} V/N, {rule}",
            conformity.tolerance.nominal, conformity.tolerance.tolerance
        );
        let parts = [tag("dcc:norm", norm), said(&text), tag("dcc:conformity", status)];
        all.push(meta("statement of conformity", &parts.concat()));
    }
    if let Some(adjustment) = &report.named.adjustment {
        let before = real(
            adjustment.sensitivity.value,
            unit("V/N"),
            &standard(adjustment.sensitivity.u, "normal"),
        );
        let data = tag(
            "dcc:data",
            &quantity(
                "sensitivity before adjustment",
                Some("hertzscope_beforeAdjustment"),
                &before,
            ),
        );
        all.push(meta(
            "adjustment before this calibration",
            &format!("{}{data}", said(&adjustment.work)),
        ));
    }
    for impact in &report.result.impacts {
        let left_out =
            impact.exclusion.as_ref().map_or(String::new(), |why| format!("; left out: {why}"));
        let name = format!("recording of impact {}", impact.number);
        all.extend(impact.evidence.as_ref().map(|proof| {
            meta(
                &name,
                &said(&format!(
                    "{}, shot {}, {}, SHA-256 {}{left_out}",
                    proof.recording, proof.shot, proof.channel, proof.sha256
                )),
            )
        }));
    }
    all.extend(report.result.notes.iter().map(|note| meta("note", &said(note))));
    all.concat()
}
