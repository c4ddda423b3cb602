//! The plan of a calibration: recordings, strikers, speeds, and their uncertainties.
//!
//! A key that ends in `_u` is the standard uncertainty (k = 1) of the key before it, in its unit or
//! as a share of it.

pub mod lab;

use std::path::{Path, PathBuf};

use super::document::{Node, SourceLocation, Value};
use super::library;
use super::problem::{MISSING, SceneError, one_of};
use super::problems::Problems;
use super::root::MAX_SEED;
use super::sensors;
use super::table::{Bound, Key, Places, TableReader, quantity};
use super::table::{NamedTables, text, texts};
use super::table::{any, count, difference, flag, list_of, not_negative, positive};
use super::table::{table, table_of, tables_of, word, words};
use serde::Serialize;

use crate::quantity::{Difference, Dimension, Uncertain, parse};
use crate::sensor::Load;

/// Standard acceleration of free fall, CGPM 1901 (m/s^2).
const FREE_FALL: f64 = 9.806_65;
/// Largest difference from it at sea level, relative: 9.780 at the equator, 9.832 at the poles (1).
const LATITUDES: f64 = 0.0027;
/// The input of a scope of this family.
pub const INPUT: Load = Load { resistance: 1e6, capacitance: 20e-12 };
/// What a plan states of the scope's gain.
const GAIN_STATEMENT: &str = "gain_u = \"1 %\" of a calibrated scope, gain_limit = \"3 %\" of its data sheet, or in_chain = true where sensor and scope are calibrated as one";
/// Limits of times that are measured on a bench (s).
const DURATION: Bound = Bound::Bench(1e-9, 1e6);
/// Limits of the acceleration of free fall (m/s^2).
const GRAVITY: Bound = Bound::Bench(1e-3, 1e3);
/// Limits of a relative uncertainty: beyond its value nothing is known.
const SHARE: Bound = Bound::Within(0.0, 1.0);
/// Fewest draws that resolve half a unit of the first digit of the standard uncertainty, which may
/// be a twentieth of it: `3 * 2.67/sqrt(n) <= 0.05` (JCGM 101:2008, 7.9.2).
const MIN_DRAWS: u64 = 30_000;

table! {
    /// The file.
    pub struct PlanKeys<'a> {
        /// on the certificate
        title: String = text(),
        laboratory: String = text(),
        customer: String = text(),
        /// of the measurement: a day, or the first and the last, "2026-11-26 to 2026-11-27"
        date: String = text(),
        /// of impacts that name none
        channel: &'a str = text().or("CH1"),
        /// local; without it 9.80665 m/s^2 within 0.27 %
        gravity: f64 = quantity(Dimension::ACCELERATION, GRAVITY),
        gravity_u: &'a Node = any(&[]),
        /// of the Monte-Carlo part
        seed: u64 = count(0, MAX_SEED).or("0"),
        draws: u64 = count(MIN_DRAWS, 10_000_000).or("200000"),
        sensor: ItemKeys<'a> = table_of(&[ItemKeys::KEYS])
            .required()
            .needs("[sensor] with item and name: what is calibrated"),
        scope: ScopeKeys<'a> = table_of(&[ScopeKeys::KEYS, GainKeys::KEYS]),
        speeds: SpeedKeys<'a> = table_of(&[SpeedKeys::KEYS]),
        strikers: NamedTables<'a> = tables_of(&[StrikerKeys::KEYS]),
        impacts: Vec<TableReader<'a>> = list_of(&[ImpactKeys::KEYS]),
        conditions: ConditionKeys<'a> = table_of(&[ConditionKeys::KEYS]),
        traceability: TraceKeys<'a> = table_of(&[TraceKeys::KEYS]),
        certificate: CertificateKeys<'a> = table_of(&[CertificateKeys::KEYS]),
        equipment: NamedTables<'a> = tables_of(&[EquipmentKeys::KEYS]),
        conformity: ConformityKeys<'a> = table_of(&[ConformityKeys::KEYS]),
        adjustment: AdjustmentKeys<'a> = table_of(&[AdjustmentKeys::KEYS]),
    }
}

table! {
    /// `[sensor]`.
    pub struct ItemKeys<'a> {
        item: String = text().or(""),
        serial: String = text(),
        manufacturer: String = text(),
        /// the sensor's file: plate-7.toml
        name: String = text().or("sensor"),
        /// what it sits in: a scene with another host gets a note
        host: String = text(),
        /// time constant, if it is not to be read off the records' ends
        tau: f64 = quantity(Dimension::TIME, DURATION),
        tau_u: &'a Node = any(&[]),
        /// between plate and striker, and
        mass_above: f64 = quantity(Dimension::MASS, Bound::MASS),
        mass_above_u: &'a Node = any(&[]),
        /// all that the impact sets in motion, that mass and the anvil included: the
        /// plate feels the rest
        mass_moved: f64 = quantity(Dimension::MASS, Bound::MASS),
        mass_moved_u: &'a Node = any(&[]),
    }
}

table! {
    /// `[scope]` beside its gain.
    pub struct ScopeKeys<'a> {
        input_resistance: f64 = positive(Dimension::RESISTANCE).or("1 MOhm"),
        input_capacitance: f64 = not_negative(Dimension::CAPACITANCE).or("20 pF"),
        /// instead of both: then the sensor's file holds for any scope behind that amplifier
        charge_amplifier: f64 = positive(Dimension::VOLTAGE_PER_CHARGE),
    }
}

table! {
    /// The scope's gain.
    pub struct GainKeys<'a> {
        /// sensor and this channel, at this range, are calibrated as one
        in_chain: bool = flag().or("false"),
        /// of the channel's gain
        gain_u: f64 = quantity(Dimension::NONE, SHARE),
        /// its limits in the data sheet, within which it may be anywhere
        gain_limit: f64 = quantity(Dimension::NONE, SHARE),
    }
}

table! {
    /// `[speeds]`.
    pub struct SpeedKeys<'a> {
        scale_u: f64 = quantity(Dimension::NONE, SHARE).or("0"),
        /// of the light gates
        gate_distance: f64 = quantity(Dimension::LENGTH, Bound::LENGTH),
        gate_distance_u: &'a Node = any(&[]),
    }
}

table! {
    /// `[strikers.NAME]`.
    pub struct StrikerKeys<'a> {
        mass: f64 = quantity(Dimension::MASS, Bound::MASS).required(),
        mass_u: &'a Node = any(&[]),
    }
}

table! {
    /// `[conditions]`.
    pub struct ConditionKeys<'a> {
        temperature: f64 = positive(Dimension::TEMPERATURE),
        /// expanded uncertainty of it, or how far it varied: "0.5 K"
        temperature_range: f64 = difference(Dimension::TEMPERATURE),
        /// relative
        humidity: f64 = quantity(Dimension::NONE, SHARE),
        humidity_range: f64 = quantity(Dimension::NONE, SHARE),
    }
}

table! {
    /// `[traceability]`.
    pub struct TraceKeys<'a> {
        mass: String = text(),
        speed: String = text(),
        voltage: String = text(),
    }
}

table! {
    /// `[certificate]`: what identifies it and who answers for it.
    pub struct CertificateKeys<'a> {
        /// unique, on each page
        number: String = text(),
        /// ISO 3166-1 code of the laboratory's country
        country: String = text(),
        laboratory_address: String = text(),
        customer_address: String = text(),
        /// of the measurement; "customer", "laboratory branch", "customer branch" or "other"
        place: Place = word::<Place>(),
        /// if the laboratory's or the customer's address is not the place
        place_address: String = text(),
        /// day the item was received: "2026-11-20"
        received: String = text(),
        /// day of issue
        issued: String = text(),
        /// of the item as received
        condition: String = text(),
        /// deviations from the method, or "none"
        deviations: String = text(),
        /// who authorises the certificate
        approved_by: String = text(),
        function: String = text(),
    }
}

table! {
    /// `[equipment.NAME]`: a standard or an instrument that was used.
    pub struct EquipmentKeys<'a> {
        serial: String = text(),
        /// of its own calibration
        certificate: String = text(),
    }
}

table! {
    /// `[conformity]`: the tolerance that the sensitivity is compared with.
    pub struct ConformityKeys<'a> {
        nominal: f64 = positive(Dimension::VOLTAGE_PER_FORCE)
            .required()
            .needs("the nominal sensitivity, e.g. \"400 mV/N\""),
        /// either way, or as a share: "3 %"
        tolerance: &'a Node = any(&[]).needs("the tolerance, e.g. \"3 %\" or \"12 mV/N\""),
        /// or "simple acceptance"
        rule: DecisionRule = word::<DecisionRule>().or("guard band"),
    }
}

table! {
    /// `[adjustment]`: the sensor was adjusted before this calibration.
    pub struct AdjustmentKeys<'a> {
        /// what was done
        work: String = text().required().needs("what was done, e.g. \"gain of the amplifier set\""),
        /// result before it: a sensor's file or a digital certificate
        before: &'a str = text().required().needs("a sensor's file or a digital certificate, e.g. \"before.xml\""),
    }
}

table! {
    /// One of `[[impacts]]`.
    pub struct ImpactKeys<'a> {
        /// beside the plan: .mcap, .csv, .isf, or a folder
        recording: &'a str = text().required().needs(
            "a file: .mcap, .csv, .isf, a folder, or the address of a scope, e.g. tcp://HOST:PORT",
        ),
        /// default: the plan's
        channel: String = text(),
        shot: u32 = count(1, u32::MAX as u64).or("1"),
        /// needed with several strikers only
        striker: &'a str = text(),
        speed: f64 = quantity(Dimension::SPEED, Bound::SPEED),
        speed_u: &'a Node = any(&[]),
        /// of the fall; or one of:
        height: f64 = quantity(Dimension::LENGTH, Bound::LENGTH),
        height_u: &'a Node = any(&[]),
        /// with `[speeds]`
        gate_time: f64 = quantity(Dimension::TIME, DURATION),
        gate_time_u: &'a Node = any(&[]),
        rebound_speed: f64 = quantity(Dimension::SPEED, Bound::SPEED),
        rebound_speed_u: &'a Node = any(&[]),
        /// or one of:
        rebound_height: f64 = quantity(Dimension::LENGTH, Bound::LENGTH),
        rebound_height_u: &'a Node = any(&[]),
        rebound_gate_time: f64 = quantity(Dimension::TIME, DURATION),
        rebound_gate_time_u: &'a Node = any(&[]),
        /// until it lands again: speed g t/2
        flight_time: f64 = quantity(Dimension::TIME, DURATION),
        flight_time_u: &'a Node = any(&[]),
        /// integration window; default: found from the record
        window: Places<'a> = texts(),
    }
}

/// Ways to measure the speed before the contact, and after it.
const INCOMING: [(&str, SpeedMethod); 3] = [
    ("speed", SpeedMethod::Speed),
    ("height", SpeedMethod::Height),
    ("gate_time", SpeedMethod::GateTime),
];
const REBOUND: [(&str, SpeedMethod); 4] = [
    ("rebound_speed", SpeedMethod::Speed),
    ("rebound_height", SpeedMethod::Height),
    ("rebound_gate_time", SpeedMethod::GateTime),
    ("flight_time", SpeedMethod::FlightTime),
];

words! {
    Place {
        "laboratory" => Laboratory,
        "customer" => Customer,
        "laboratory branch" => LaboratoryBranch,
        "customer branch" => CustomerBranch,
        "other" => Other,
    }
}

/// Where a calibration was performed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Place {
    /// In the laboratory.
    Laboratory,
    /// At the customer's.
    Customer,
    /// In a branch of the laboratory.
    LaboratoryBranch,
    /// In a branch of the customer's.
    CustomerBranch,
    /// Elsewhere.
    Other,
}

words! {
    DecisionRule {
        "guard band" => GuardBand,
        "simple acceptance" => SimpleAcceptance,
    }
}

/// How a statement of conformity accounts for the uncertainty. Source: ILAC-G8:09/2019, 4.2.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum DecisionRule {
    /// Conforms if the value lies within the tolerance by at least its expanded uncertainty.
    GuardBand,
    /// Conforms if the value lies within the tolerance.
    SimpleAcceptance,
}

/// How a speed was measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpeedMethod {
    /// As a speed.
    Speed,
    /// As a height.
    Height,
    /// As the time between two gates.
    GateTime,
    /// As the time until the striker comes back.
    FlightTime,
}

/// One impact of a plan.
#[derive(Debug, Clone)]
pub struct PlannedImpact {
    /// File or folder of its recording, or the address of a scope that is to record it.
    pub recording: PathBuf,
    /// Where the plan names it.
    pub place: SourceLocation,
    /// Channel.
    pub channel: String,
    /// Number of the shot.
    pub shot: u32,
    /// Which of the strikers, from 0.
    pub striker: usize,
    /// Speed before the contact, by what it was measured.
    pub incoming: (SpeedMethod, Uncertain),
    /// Speed after it.
    pub rebound: (SpeedMethod, Uncertain),
    /// First and last time to integrate, if not to be found (s).
    pub window: Option<[f64; 2]>,
}

/// A standard or an instrument that was used.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Equipment {
    /// Its name.
    pub name: String,
    /// Its serial number.
    pub serial: Option<String>,
    /// Certificate of its own calibration.
    pub certificate: Option<String>,
}

/// The tolerance of a statement of conformity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Tolerance {
    /// Nominal sensitivity (V/N).
    #[serde(rename = "nominal_v_per_n")]
    pub nominal: f64,
    /// Largest difference from it that is allowed (V/N).
    #[serde(rename = "tolerance_v_per_n")]
    pub tolerance: f64,
    /// Decision rule.
    pub rule: DecisionRule,
}

/// An adjustment before the calibration.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Adjustment {
    /// What was done.
    pub work: String,
    /// File of the result before it, as typed.
    pub file: String,
    /// Sensitivity before it (V/N).
    pub sensitivity: Uncertain,
}

/// Entries of the certificate that do not enter the calculation.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Particulars {
    /// One line about the calibration.
    pub title: String,
    /// The calibrated sensor.
    pub item: String,
    /// Its serial number.
    pub serial: Option<String>,
    /// Its manufacturer.
    pub manufacturer: Option<String>,
    /// Name of the sensor's file.
    pub sensor: String,
    /// Kind of body that the plate sat in, as scenes call it.
    pub host: Option<String>,
    /// Day of the measurement, as typed.
    pub date: Option<String>,
    /// Who measured.
    pub laboratory: Option<String>,
    /// Whom it was for.
    pub customer: Option<String>,
    /// Temperature of the room (K).
    #[serde(rename = "temperature_k")]
    pub temperature: Option<f64>,
    /// Expanded uncertainty of the temperature, or how far it varied (K).
    #[serde(rename = "temperature_range_k")]
    pub temperature_range: Option<f64>,
    /// Relative humidity (1).
    pub humidity: Option<f64>,
    /// Its expanded uncertainty, or how far it varied (1).
    pub humidity_range: Option<f64>,
    /// Traceability of the mass.
    #[serde(rename = "traceability_mass")]
    pub mass_traceability: Option<String>,
    /// Traceability of the speed.
    #[serde(rename = "traceability_speed")]
    pub speed_traceability: Option<String>,
    /// Traceability of the voltage.
    #[serde(rename = "traceability_voltage")]
    pub voltage_traceability: Option<String>,
    /// Unique number of the certificate.
    pub number: Option<String>,
    /// ISO 3166-1 code of the laboratory's country.
    pub country: Option<String>,
    /// Address of the laboratory.
    pub laboratory_address: Option<String>,
    /// Address of the customer.
    pub customer_address: Option<String>,
    /// Where it was performed.
    pub place: Option<Place>,
    /// Address of that place.
    pub place_address: Option<String>,
    /// Day the item was received.
    pub received: Option<String>,
    /// Day of issue.
    pub issued: Option<String>,
    /// Condition of the item.
    pub condition: Option<String>,
    /// Deviations from the method.
    pub deviations: Option<String>,
    /// Who authorises the certificate.
    pub approved_by: Option<String>,
    /// That person's function.
    pub function: Option<String>,
    /// Standards and instruments.
    pub equipment: Vec<Equipment>,
    /// Tolerance of the sensitivity.
    pub conformity: Option<Tolerance>,
    /// Adjustment before the calibration.
    pub adjustment: Option<Adjustment>,
}

/// A checked plan.
#[derive(Debug, Clone)]
pub struct CalibrationPlan {
    /// The file.
    pub file: PathBuf,
    /// The file as typed.
    pub text: String,
    /// For the certificate.
    pub particulars: Particulars,
    /// The scope's gain, true over shown; none where sensor and scope are calibrated as one chain.
    pub gain: Option<Uncertain>,
    /// The scope's input, the sensor's load unless there is a charge amplifier.
    pub load: Load,
    /// Gain of a charge amplifier between sensor and scope (V/C).
    pub charge_amplifier: Option<f64>,
    /// Relative standard uncertainty that all speeds share (1).
    pub speed_scale_u: f64,
    /// Distance of the gates (m).
    pub gate_distance: Option<Uncertain>,
    /// Acceleration of free fall (m/s^2).
    pub gravity: Uncertain,
    /// Time constant, if it is not to be read off the records (s).
    pub tau: Option<Uncertain>,
    /// Mass above the plate over all that is set in motion (1).
    pub above: Uncertain,
    /// Name and mass of each striker (kg).
    pub strikers: Vec<(String, Uncertain)>,
    /// The impacts.
    pub impacts: Vec<PlannedImpact>,
    /// Seed of the Monte-Carlo part.
    pub seed: u64,
    /// Its draws.
    pub draws: u64,
}

/// Loads the plan in `file`.
///
/// # Errors
/// [`SceneError`]: not readable, or every problem found in it, recordings that do not exist
/// included.
pub fn load(file: &Path) -> Result<CalibrationPlan, SceneError> {
    const WHAT: &str = "the plan";
    let node =
        library::open_file(file, "a plan, e.g. plan.toml").map_err(|error| error.in_file(WHAT))?;
    let problems = Problems::default();
    let plan = read(file, &node, &problems);
    problems.finish(plan).map_err(|problems| SceneError::InFile { what: WHAT, problems })
}

fn read(file: &Path, node: &Node, problems: &Problems) -> Option<CalibrationPlan> {
    let keys = PlanKeys::read(&TableReader::of(node, "", &[PlanKeys::KEYS], problems)?);
    let root = &keys.table;
    let gravity = if root.has("gravity") {
        uncertain(root, PlanKeys::KEYS, "gravity")
    } else {
        // Anywhere between both, with equal probability: JCGM 100:2008, 4.3.7.
        Some(Uncertain::normal(FREE_FALL, FREE_FALL * LATITUDES / 3f64.sqrt()))
    };
    let scope = scope(root, keys.scope.as_ref());
    let gates = keys.speeds.as_ref().filter(|keys| keys.table.has("gate_distance"));
    let gates = gates.and_then(|keys| uncertain(&keys.table, SpeedKeys::KEYS, "gate_distance"));
    let scale = match &keys.speeds {
        Some(keys) => keys.scale_u,
        None => Some(0.0),
    };
    let item = keys.sensor.as_ref();
    let tau = item.filter(|keys| keys.table.has("tau"));
    let tau = tau.and_then(|keys| uncertain(&keys.table, ItemKeys::KEYS, "tau"));
    let above = item.map_or(Some(Uncertain::normal(0.0, 0.0)), above_plate);
    let striker = |(name, table): &(&str, TableReader<'_>)| {
        let mass = uncertain(table, StrikerKeys::KEYS, "mass");
        // A mass that could not be read has left its problem; impacts may name its striker.
        ((*name).to_owned(), mass.unwrap_or(Uncertain::normal(1.0, 0.0)))
    };
    let strikers: Vec<_> = keys.strikers.iter().flatten().map(striker).collect();
    let channel = keys.channel?;
    let context = ImpactContext { file, channel, strikers: &strikers, gates: gates.is_some() };
    let tables = keys.impacts.as_deref().unwrap_or_default();
    let impacts: Vec<PlannedImpact> =
        tables.iter().filter_map(|table| impact(table, &context)).collect();
    if tables.is_empty() {
        root.problem("impacts", "no impacts", "at least one [[impacts]]");
    }
    (impacts.len() == tables.len()).then_some(())?;
    let (seed, draws) = (keys.seed?, keys.draws?);
    Some(CalibrationPlan {
        file: file.to_owned(),
        text: node.place.text().to_string(),
        particulars: particulars(file, keys)?,
        gain: scope.gain,
        charge_amplifier: scope.charge_amplifier,
        load: scope.load,
        speed_scale_u: scale?,
        gate_distance: gates,
        gravity: gravity?,
        tau,
        above: above?,
        strikers,
        impacts,
        seed,
        draws,
    })
}

/// What `keys` say for the certificate alone.
fn particulars(file: &Path, keys: PlanKeys<'_>) -> Option<Particulars> {
    let stem = file.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let item = keys.sensor?;
    let equipment = |(name, table): &(&str, TableReader<'_>)| {
        let EquipmentKeys { serial, certificate, .. } = EquipmentKeys::read(table);
        Equipment { name: (*name).to_owned(), serial, certificate }
    };
    let mut particulars = Particulars {
        title: keys.title.or(stem).unwrap_or_default(),
        item: item.item?,
        serial: item.serial,
        manufacturer: item.manufacturer,
        sensor: item.name?,
        host: item.host,
        date: keys.date,
        laboratory: keys.laboratory,
        customer: keys.customer,
        equipment: keys.equipment.iter().flatten().map(equipment).collect(),
        conformity: keys.conformity.as_ref().and_then(conformity),
        adjustment: keys.adjustment.and_then(adjustment),
        ..Particulars::default()
    };
    if let Some(keys) = keys.conditions {
        particulars.temperature = keys.temperature;
        particulars.temperature_range = keys.temperature_range;
        particulars.humidity = keys.humidity;
        particulars.humidity_range = keys.humidity_range;
    }
    if let Some(keys) = keys.traceability {
        particulars.mass_traceability = keys.mass;
        particulars.speed_traceability = keys.speed;
        particulars.voltage_traceability = keys.voltage;
    }
    if let Some(keys) = keys.certificate {
        for (key, day) in [("received", &keys.received), ("issued", &keys.issued)] {
            if day.as_ref().is_some_and(|day| !is_day(day)) {
                keys.table.problem(key, format!("\"{}\"", day.as_deref().unwrap_or("")), A_DAY);
            }
        }
        if let Some(country) = keys.country.as_ref().filter(|code| !is_country(code)) {
            let expected = "an ISO 3166-1 code in capitals, e.g. \"DE\"";
            keys.table.problem("country", format!("\"{country}\""), expected);
        }
        particulars.number = keys.number;
        particulars.country = keys.country;
        particulars.laboratory_address = keys.laboratory_address;
        particulars.customer_address = keys.customer_address;
        particulars.place = keys.place;
        particulars.place_address = keys.place_address;
        particulars.received = keys.received;
        particulars.issued = keys.issued;
        particulars.condition = keys.condition;
        particulars.deviations = keys.deviations;
        particulars.approved_by = keys.approved_by;
        particulars.function = keys.function;
    }
    Some(particulars)
}

/// Codes of ISO 3166-1.
const COUNTRIES: &str = "AD AE AF AG AI AL AM AO AQ AR AS AT AU AW AX AZ BA BB BD BE BF BG BH BI BJ BL BM BN BO BQ BR BS BT BV BW BY BZ \
    CA CC CD CF CG CH CI CK CL CM CN CO CR CU CV CW CX CY CZ DE DJ DK DM DO DZ EC EE EG EH ER ES ET FI FJ FK FM FO FR GA GB GD GE GF GG \
    GH GI GL GM GN GP GQ GR GS GT GU GW GY HK HM HN HR HT HU ID IE IL IM IN IO IQ IR IS IT JE JM JO JP KE KG KH KI KM KN KP KR KW KY KZ \
    LA LB LC LI LK LR LS LT LU LV LY MA MC MD ME MF MG MH MK ML MM MN MO MP MQ MR MS MT MU MV MW MX MY MZ NA NC NE NF NG NI NL NO NP NR \
    NU NZ OM PA PE PF PG PH PK PL PM PN PR PS PT PW PY QA RE RO RS RU RW SA SB SC SD SE SG SH SI SJ SK SL SM SN SO SR SS ST SV SX SY SZ \
    TC TD TF TG TH TJ TK TL TM TN TO TR TT TV TW TZ UA UG UM US UY UZ VA VC VE VG VI VN VU WF WS YE YT ZA ZM ZW";

fn is_country(code: &str) -> bool {
    COUNTRIES.split(' ').any(|known| known == code)
}

/// The expected form of a day.
const A_DAY: &str = "a day of the calendar, e.g. \"2026-11-27\"";

/// Whether `text` is a day of the Gregorian calendar in ISO 8601's form, year-month-day.
fn is_day(text: &str) -> bool {
    let bytes = text.as_bytes();
    let is_form = bytes.len() == 10
        && bytes.iter().enumerate().all(|(at, byte)| match at {
            4 | 7 => *byte == b'-',
            _ => byte.is_ascii_digit(),
        });
    if !is_form {
        return false;
    }
    let number = |range: std::ops::Range<usize>| text[range].parse::<u32>().unwrap_or(0);
    let (year, month, day) = (number(0..4), number(5..7), number(8..10));
    let is_leap = year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
    let days = match month {
        2 => 28 + u32::from(is_leap),
        4 | 6 | 9 | 11 => 30,
        1..=12 => 31,
        _ => 0,
    };
    year > 0 && (1..=days).contains(&day)
}

/// First and last day of a measurement that was typed as `2026-11-27` or `2026-11-26 to
/// 2026-11-27`; none if it is anything else.
pub fn days(date: &str) -> Option<[&str; 2]> {
    let (first, last) = date.split_once(" to ").unwrap_or((date, date));
    let [first, last] = [first, last].map(str::trim);
    // Days in this form are in the order of their texts.
    (is_day(first) && is_day(last) && first <= last).then_some([first, last])
}

/// `[conformity]`; `None` if it is wrong.
fn conformity(keys: &ConformityKeys<'_>) -> Option<Tolerance> {
    let expected = "the tolerance, e.g. \"3 %\" or \"12 mV/N\"";
    let Some(node) = keys.tolerance else {
        keys.table.missing("tolerance", expected);
        return None;
    };
    let nominal = keys.nominal?;
    let tolerance = difference_or_share(node, Dimension::VOLTAGE_PER_FORCE, nominal);
    let Some(tolerance) = tolerance.filter(|tolerance| *tolerance > 0.0) else {
        keys.table.problem("tolerance", node.describe(), expected);
        return None;
    };
    Some(Tolerance { nominal, tolerance, rule: keys.rule? })
}

/// `[adjustment]` with the result that it names; `None` if it is wrong.
fn adjustment(keys: AdjustmentKeys<'_>) -> Option<Adjustment> {
    let (work, name) = (keys.work?, keys.before?);
    let before = sensors::load_beside(&keys.table, "before", name)?.measured;
    let Some((value, u)) = before.sensitivity.zip(before.sensitivity_u) else {
        let found = format!("\"{name}\", without a sensitivity and its uncertainty");
        keys.table.problem("before", found, "a calibrated sensor");
        return None;
    };
    let sensitivity = Uncertain::normal(value, u * value);
    Some(Adjustment { work, file: name.to_owned(), sensitivity })
}

/// `[scope]` of a plan.
struct ScopeInput {
    gain: Option<Uncertain>,
    load: Load,
    charge_amplifier: Option<f64>,
}

/// The gain with its uncertainty, none for a chain calibrated as one, and the input.
fn scope(root: &TableReader<'_>, keys: Option<&ScopeKeys<'_>>) -> ScopeInput {
    let Some(keys) = keys else {
        if !root.has("scope") {
            root.missing("scope", format!("[scope] with {GAIN_STATEMENT}"));
        }
        return ScopeInput { gain: None, load: INPUT, charge_amplifier: None };
    };
    let table = &keys.table;
    let states_input = table.has("input_resistance") || table.has("input_capacitance");
    if table.has("charge_amplifier") && states_input {
        let found = "both a charge amplifier and the scope's input";
        table.problem("charge_amplifier", found, "one of them as the sensor's load");
    }
    let load = Load {
        resistance: keys.input_resistance.unwrap_or(INPUT.resistance),
        capacitance: keys.input_capacitance.unwrap_or(INPUT.capacitance),
    };
    ScopeInput { gain: gain_of(table), load, charge_amplifier: keys.charge_amplifier }
}

/// Mass above the plate over all that is set in motion (1); `None` if it is wrong.
fn above_plate(keys: &ItemKeys<'_>) -> Option<Uncertain> {
    let table = &keys.table;
    if !table.has("mass_above") && !table.has("mass_moved") {
        return Some(Uncertain::normal(0.0, 0.0));
    }
    for key in ["mass_above", "mass_moved"] {
        table.require(ItemKeys::KEYS, key);
    }
    let above = uncertain(table, ItemKeys::KEYS, "mass_above")?;
    let moved = uncertain(table, ItemKeys::KEYS, "mass_moved")?;
    let share = above.over(moved);
    if share.value >= 1.0 {
        table.problem("mass_above", "more than all that is moved", "less than mass_moved");
        return None;
    }
    Some(share)
}

/// The scope's gain in `table`; none for a chain calibrated as one.
fn gain_of(table: &TableReader<'_>) -> Option<Uncertain> {
    let keys = GainKeys::read(table);
    let in_chain = keys.in_chain.unwrap_or(false);
    let stated = [in_chain, table.has("gain_u"), table.has("gain_limit")];
    if stated.iter().filter(|is_stated| **is_stated).count() != 1 {
        let several = stated.contains(&true);
        let found = if several { "more than one statement about the gain" } else { MISSING };
        table.problem("gain_u", found, GAIN_STATEMENT);
    }
    let limited =
        |half_width: f64| Uncertain { value: 1.0, u: half_width / 3f64.sqrt(), half_width };
    let gain = keys.gain_u.map(|u| Uncertain::normal(1.0, u));
    gain.or_else(|| keys.gain_limit.map(limited)).filter(|_| !in_chain)
}

/// The plan's data that impacts refer to.
struct ImpactContext<'a> {
    /// The plan's file.
    file: &'a Path,
    /// The channel of impacts that name none.
    channel: &'a str,
    /// The strikers.
    strikers: &'a [(String, Uncertain)],
    /// Whether there are light gates with a known distance.
    gates: bool,
}

/// Reads one of `[[impacts]]`.
fn impact(table: &TableReader<'_>, context: &ImpactContext<'_>) -> Option<PlannedImpact> {
    let keys = ImpactKeys::read(table);
    let is_address = |name: &str| name.contains("://") || name.starts_with("serial:");
    let path = keys.recording.map(|name| match context.file.parent() {
        Some(folder) if !is_address(name) => folder.join(name),
        _ => name.into(),
    });
    if let (Some(name), Some(path)) = (keys.recording, &path)
        && !is_address(name)
        && !path.exists()
    {
        let found = format!("\"{name}\", which does not exist");
        table.problem("recording", found, "a recording, its path relative to the plan");
    }
    let striker = match (keys.striker, context.strikers) {
        (None, [_]) => Some(0),
        (name, strikers) => {
            let found = strikers.iter().position(|(known, _)| Some(known.as_str()) == name);
            if found.is_none() {
                let known = one_of(strikers.iter().map(|(name, _)| name));
                let found = name.map_or(MISSING.to_owned(), |name| format!("\"{name}\""));
                let expected = known.replacen("one of ", "one of [strikers]: ", 1);
                table.problem("striker", found, expected);
            }
            found
        }
    };
    let incoming = speed(table, &INCOMING, context.gates);
    let rebound = speed(table, &REBOUND, context.gates);
    let window = window(table, keys.window);
    Some(PlannedImpact {
        recording: path?,
        place: table.place_of("recording").clone(),
        channel: keys.channel.unwrap_or_else(|| context.channel.to_owned()),
        shot: keys.shot?,
        striker: striker?,
        incoming: incoming?,
        rebound: rebound?,
        window: window?,
    })
}

/// The one of several ways to measure a speed that is used.
fn speed(
    table: &TableReader<'_>,
    ways: &[(&'static str, SpeedMethod)],
    gates: bool,
) -> Option<(SpeedMethod, Uncertain)> {
    let used: Vec<_> = ways.iter().filter(|(key, _)| table.has(key)).collect();
    let [(key, method)] = used.as_slice() else {
        let found =
            if used.is_empty() { MISSING.to_owned() } else { format!("{} of them", used.len()) };
        table.problem(ways.first()?.0, found, one_of(ways.iter().map(|(key, _)| key)));
        return None;
    };
    if *method == SpeedMethod::GateTime && !gates {
        table.problem(key, "a time between gates", "[speeds] with gate_distance as well");
    }
    Some((*method, uncertain(table, ImpactKeys::KEYS, key)?))
}

/// `window = ["-10 us", "200 us"]`; `Some(None)` without one, `None` if it is wrong.
#[allow(clippy::option_option, reason = "wrong, or not there, or there")]
fn window(table: &TableReader<'_>, texts: Option<Places<'_>>) -> Option<Option<[f64; 2]>> {
    if !table.has("window") {
        return Some(None);
    }
    let texts = texts.unwrap_or_default();
    let times: Vec<f64> =
        texts.iter().filter_map(|(text, _)| parse(text, Dimension::TIME).ok()).collect();
    match times.as_slice() {
        [from, to] if from < to && texts.len() == 2 => Some(Some([*from, *to])),
        _ => {
            let found = texts.iter().map(|(text, _)| *text).collect::<Vec<_>>().join(", ");
            let expected = "two times after the trigger, e.g. [\"-10 us\", \"200 us\"]";
            table.problem("window", format!("[{found}]"), expected);
            None
        }
    }
}

/// The quantity `key` of `keys` and its standard uncertainty, `key` with `_u`, in its unit or as a
/// share of it.
fn uncertain(table: &TableReader<'_>, keys: &'static [Key], key: &str) -> Option<Uncertain> {
    let declared = keys.iter().find(|known| known.name == key)?;
    let dimension = declared.dimension()?;
    let value: Option<f64> = table.get(declared);
    let uncertainty = format!("{key}_u");
    let Some(node) = table.node(&uncertainty) else {
        let expected =
            format!("the standard uncertainty of {key}, as {dimension} or a share, e.g. \"0.5 %\"");
        table.missing(&uncertainty, expected);
        return None;
    };
    // A share needs its quantity, whose absence has left its problem.
    let Some(u) = difference_or_share(node, dimension, value.unwrap_or(1.0)) else {
        let expected = format!("{dimension} of zero or more, or a share, e.g. \"0.5 %\"");
        table.problem(&uncertainty, node.describe(), expected);
        return None;
    };
    let quantity = Uncertain::normal(value?, u);
    if !quantity.is_known() {
        let found = format!("{}, more than {key} itself", node.describe());
        table.problem(&uncertainty, found, "a standard uncertainty (k = 1) below the value");
        return None;
    }
    Some(quantity)
}

/// A finite difference of zero or more, of `dimension`, or as a share of `value`; none for anything
/// else (unit).
fn difference_or_share(node: &Node, dimension: Dimension, value: f64) -> Option<f64> {
    let read: Option<Difference> = match &node.value {
        Value::Number { value, .. } => {
            Some(Difference { value: *value, dimension: Dimension::NONE })
        }
        Value::Text(text) => text.parse().ok(),
        _ => None,
    };
    let read = read.filter(|u| (0.0..f64::INFINITY).contains(&u.value))?;
    match read.dimension {
        found if found == dimension => Some(read.value),
        Dimension::NONE => Some(read.value * value),
        _ => None,
    }
}
