//! The plan of a calibration: which recordings, which strikers, how fast, and how well all that is
//! known.
//!
//! A key that ends in `_u` is the standard uncertainty (k = 1) of the key before it, in its unit or
//! as a share of it.

mod data;
mod impact;
pub mod lab;

pub use data::{CalibrationPlan, Particulars, PlannedImpact, SpeedMethod};

use std::path::Path;

use self::impact::{ImpactContext, impact, uncertain};
use crate::quantity::{Dimension, Uncertain};
use crate::scene::document::Node;
use crate::scene::library;
use crate::scene::problem::{MISSING, Problem, SceneError, listed};
use crate::scene::reader::{Bound, Problems, TableReader};
use crate::sensor::Load;

/// Standard acceleration of free fall, CGPM 1901 (m/s^2).
const FREE_FALL: f64 = 9.806_65;
/// How far it is from there at sea level at most, from 9.780 at the equator to 9.832 at the poles,
/// relative (1).
const LATITUDES: f64 = 0.0027;
/// The input of a scope of this family.
pub const INPUT: Load = Load { resistance: 1e6, capacitance: 20e-12 };
/// What a plan states of the scope's gain.
const GAIN_STATEMENT: &str = "gain_u = \"1 %\" of a calibrated scope, gain_limit = \"3 %\" of its data sheet, or in_chain = true where sensor and scope are calibrated as one";
/// Limits of a relative uncertainty: beyond its value nothing is known.
const SHARE: Bound = Bound::Within(0.0, 1.0);
/// Draws of the Monte-Carlo part.
const DRAWS: u64 = 200_000;
/// Fewest draws that resolve half a unit of the first digit of the standard uncertainty, which may
/// be a twentieth of it: `3 * 2.67/sqrt(n) <= 0.05` (JCGM 101:2008, 7.9.2).
const MIN_DRAWS: u64 = 30_000;

/// Why there is no plan.
#[derive(Debug, thiserror::Error)]
pub enum PlanError {
    /// The file could not be read.
    #[error(transparent)]
    Read(SceneError),
    /// No file of that name.
    #[error("found `{0}`, which is no file, expected the path of a plan, e.g. plan.toml")]
    Unknown(String),
    /// The plan is wrong in at least one place.
    #[error("{}", listed(.0, "the plan"))]
    Problems(Vec<Problem>),
}

/// Loads the plan in `file`.
///
/// # Errors
/// [`PlanError`]: not readable, or every problem found in it, recordings that do not exist
/// included.
pub fn load(file: &Path) -> Result<CalibrationPlan, PlanError> {
    let name = file.display().to_string();
    if !file.is_file() {
        return Err(PlanError::Unknown(name));
    }
    // A bare name is a file here: nothing of the kind ships.
    let named = if name.contains(['/', '\\']) { name } else { format!("./{name}") };
    let node = match library::open("plans", &named) {
        Ok(Some(node)) => node,
        Ok(None) => return Err(PlanError::Unknown(named)),
        Err(SceneError::Problems(problems)) => return Err(PlanError::Problems(problems)),
        Err(error) => return Err(PlanError::Read(error)),
    };
    let problems = Problems::default();
    let plan = read(file, &node, &problems);
    let problems = problems.into_sorted();
    match plan {
        Some(plan) if problems.is_empty() => Ok(plan),
        _ => Err(PlanError::Problems(problems)),
    }
}

fn read(file: &Path, node: &Node, problems: &Problems) -> Option<CalibrationPlan> {
    let root = TableReader::of(node, "", problems)?;
    let gravity = if root.has("gravity") {
        uncertain(&root, ("gravity", "gravity_u"), Dimension::ACCELERATION)
    } else {
        // Somewhere between both, evenly: JCGM 100:2008, 4.3.7.
        Some(Uncertain::normal(FREE_FALL, FREE_FALL * LATITUDES / 3f64.sqrt()))
    };
    let seed = root.count("seed", 0, (1 << 53) - 1).unwrap_or(0);
    let draws = root.count("draws", MIN_DRAWS, 10_000_000).unwrap_or(DRAWS);
    let mut particulars = particulars(&root, file);
    let channel = root.text("channel").unwrap_or("CH1").to_owned();
    let ScopeInput { gain, load, charge_amplifier } = scope(&root);
    let (scale, gates) = root.table("speeds").map_or((Some(0.0), None), |table| {
        let scale = table.quantity("scale_u", Dimension::NONE, SHARE);
        let gates = table
            .has("gate_distance")
            .then(|| uncertain(&table, ("gate_distance", "gate_distance_u"), Dimension::LENGTH));
        let scale = if table.has("scale_u") { scale } else { Some(0.0) };
        table.finish();
        (scale, gates.flatten())
    });
    let (mut tau, mut above) = (None, Uncertain::normal(0.0, 0.0));
    if let Some(table) = root.table("sensor") {
        table.text("item").unwrap_or_default().clone_into(&mut particulars.item);
        table.text("name").unwrap_or("sensor").clone_into(&mut particulars.sensor);
        particulars.host = table.text("host").map(str::to_owned);
        if table.has("tau") {
            tau = uncertain(&table, ("tau", "tau_u"), Dimension::TIME);
        }
        above = above_plate(&table)?;
        table.finish();
    } else if !root.has("sensor") {
        root.problem("sensor", MISSING, "[sensor] with item and name: what is calibrated");
    }
    let mut strikers = Vec::new();
    for (name, table) in root.tables("strikers") {
        let mass = uncertain(&table, ("mass", "mass_u"), Dimension::MASS);
        let _ = table.text("source");
        table.finish();
        // A mass that could not be read has left its problem; impacts may name its striker.
        strikers.push((name.to_owned(), mass.unwrap_or(Uncertain::normal(1.0, 0.0))));
    }
    let context =
        ImpactContext { file, channel: &channel, strikers: &strikers, gates: gates.is_some() };
    let tables = root.list("impacts");
    let count = tables.len();
    let impacts: Vec<PlannedImpact> =
        tables.iter().filter_map(|table| impact(table, &context)).collect();
    tables.into_iter().for_each(TableReader::finish);
    if count == 0 {
        root.problem("impacts", "no impacts", "at least one [[impacts]]");
    }
    root.finish();
    (impacts.len() == count).then_some(())?;
    Some(CalibrationPlan {
        file: file.to_owned(),
        text: node.place.text().to_string(),
        particulars,
        gain,
        charge_amplifier,
        load,
        speed_scale_u: scale?,
        gate_distance: gates,
        gravity: gravity?,
        tau,
        above,
        strikers,
        impacts,
        seed,
        draws,
    })
}

fn particulars(root: &TableReader<'_>, file: &Path) -> Particulars {
    let text = |table: Option<&TableReader<'_>>, key| table?.text(key).map(ToOwned::to_owned);
    let conditions = root.table("conditions");
    let traced = root.table("traceability");
    let stem = file.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let found = Particulars {
        title: text(Some(root), "title").or(stem).unwrap_or_default(),
        date: text(Some(root), "date"),
        laboratory: text(Some(root), "laboratory"),
        customer: text(Some(root), "customer"),
        temperature: conditions.as_ref().and_then(|table| {
            table.quantity("temperature", Dimension::TEMPERATURE, Bound::Positive)
        }),
        mass_traceability: text(traced.as_ref(), "mass"),
        speed_traceability: text(traced.as_ref(), "speed"),
        voltage_traceability: text(traced.as_ref(), "voltage"),
        ..Particulars::default()
    };
    conditions.into_iter().chain(traced).for_each(TableReader::finish);
    found
}

/// The scope as a plan tells it.
struct ScopeInput {
    gain: Option<Uncertain>,
    load: Load,
    charge_amplifier: Option<f64>,
}

/// The gain with its uncertainty, none for a chain calibrated as one, and the input.
fn scope(root: &TableReader<'_>) -> ScopeInput {
    let Some(table) = root.table("scope") else {
        if !root.has("scope") {
            root.problem("scope", MISSING, format!("[scope] with {GAIN_STATEMENT}"));
        }
        return ScopeInput { gain: None, load: INPUT, charge_amplifier: None };
    };
    let gain = gain_of(&table);
    let resistance = table.quantity("input_resistance", Dimension::RESISTANCE, Bound::Positive);
    let capacitance =
        table.quantity("input_capacitance", Dimension::CAPACITANCE, Bound::NotNegative);
    let charge_amplifier =
        table.quantity("charge_amplifier", Dimension::VOLTAGE_PER_CHARGE, Bound::Positive);
    if table.has("charge_amplifier") && (resistance.is_some() || capacitance.is_some()) {
        let found = "both a charge amplifier and the scope's input";
        table.problem("charge_amplifier", found, "one of them as the sensor's load");
    }
    table.finish();
    let load = Load {
        resistance: resistance.unwrap_or(INPUT.resistance),
        capacitance: capacitance.unwrap_or(INPUT.capacitance),
    };
    ScopeInput { gain, load, charge_amplifier }
}

/// Mass above the plate over all that is set in motion (1); none where it is wrong.
fn above_plate(table: &TableReader<'_>) -> Option<Uncertain> {
    let [above, moved] = ["mass_above", "mass_moved"].map(|key| table.has(key));
    if !above && !moved {
        return Some(Uncertain::normal(0.0, 0.0));
    }
    let above = uncertain(table, ("mass_above", "mass_above_u"), Dimension::MASS)?;
    let moved = uncertain(table, ("mass_moved", "mass_moved_u"), Dimension::MASS)?;
    let share = above.over(moved);
    if share.value >= 1.0 {
        let found = "more than all that is moved".to_owned();
        table.problem("mass_above", found, "less than mass_moved");
        return None;
    }
    Some(share)
}

/// What `table` says of the scope's gain; none for a chain calibrated as one.
fn gain_of(table: &TableReader<'_>) -> Option<Uncertain> {
    let in_chain = table.flag("in_chain").unwrap_or(false);
    let gain_u = table.quantity("gain_u", Dimension::NONE, SHARE);
    let limit = table.quantity("gain_limit", Dimension::NONE, SHARE);
    let stated = [in_chain, table.has("gain_u"), table.has("gain_limit")];
    if stated.iter().filter(|is_stated| **is_stated).count() != 1 {
        let several = stated.contains(&true);
        let found = if several { "more than one statement about the gain" } else { "no such key" };
        table.problem("gain_u", found, GAIN_STATEMENT);
    }
    let limited =
        |half_width: f64| Uncertain { value: 1.0, u: half_width / 3f64.sqrt(), half_width };
    gain_u.map(|u| Uncertain::normal(1.0, u)).or_else(|| limit.map(limited)).filter(|_| !in_chain)
}
