//! Calibrates by a plan: reads its recordings, and finds what in its data cannot be.

use std::path::Path;

use sha2::{Digest, Sha256};

use super::equation::{Common, SpeedSource, StrikerMotion};
use super::error::CalibrationError;
use super::record::{Exclusion, RawRecord};
use super::report::CalibrationReport;
use super::result::{Calibration, ImpactResult, PlannedStrike, RecordingEvidence};
use super::{Draws, calibrate};
use crate::analysis::droop::undo_coupling;
use crate::analysis::gate::Gate;
use crate::quantity::Uncertain;
use crate::recording::format::open_with;
use crate::recording::tek_csv::TableColumns;
use crate::recording::{Capture, TraceSet};
use crate::scene::plan::{CalibrationPlan, INPUT, PlannedImpact, SpeedMethod};
use crate::scene::problem::Problem;
use crate::scene::{Scene, SceneError, hexadecimal};
use crate::scope::Coupling;
use crate::scope::front_end::ac_time_constant;

/// Where the limits of the scope's input are taken from.
const BENCH: &str = "momentum-test";

/// Why there is no calibration.
#[derive(Debug, thiserror::Error)]
pub enum PlanRunError {
    /// The plan, or a recording that it names.
    #[error(transparent)]
    Plan(#[from] SceneError),
    /// Too little could be used.
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
}

/// Calibrates as `plan` says; `columns` assigns the columns of tables that do not say it
/// themselves.
///
/// # Errors
/// [`PlanRunError`]: a recording that cannot be read or has no such channel, at its place in the
/// plan; or too few impacts left.
pub fn run(
    plan: &CalibrationPlan,
    columns: &TableColumns,
) -> Result<CalibrationReport, PlanRunError> {
    let mut problems = Vec::new();
    let (mut strikes, mut evidence) = (Vec::new(), Vec::new());
    for impact in &plan.impacts {
        match strike(impact, columns) {
            Ok((strike, proof)) => {
                strikes.push(strike);
                evidence.push(proof);
            }
            Err(problem) => problems.push(problem),
        }
    }
    if plan.gain.is_none() {
        problems.extend(another_chain(plan, &evidence));
    }
    problems.extend(another_load(plan, &evidence));
    if !problems.is_empty() {
        return Err(SceneError::InFile { what: "the plan", problems }.into());
    }
    let draws = Draws { seed: plan.seed, count: usize::try_from(plan.draws).unwrap_or(0) };
    let mut found = calibrate(&strikes, &common(plan), draws)?;
    for (impact, proof) in found.impacts.iter_mut().zip(evidence) {
        impact.evidence = Some(proof);
    }
    found.notes.extend(restitution_note(plan));
    let contradictions = contradictions(plan, &found);
    Ok(CalibrationReport::new(plan, found, contradictions))
}

/// A chain is one channel at one range: the first impact that was taken with another.
fn another_chain(plan: &CalibrationPlan, evidence: &[RecordingEvidence]) -> Option<Problem> {
    let first = evidence.first()?;
    let chain =
        |proof: &RecordingEvidence| (proof.channel.to_ascii_uppercase(), proof.volts_per_div);
    let other = evidence.iter().position(|proof| chain(proof) != chain(first))?;
    let place = &plan.impacts.get(other)?.place;
    let words =
        |proof: &RecordingEvidence| format!("{} at {} V/div", proof.channel, proof.volts_per_div);
    let found = words(evidence.get(other)?);
    let expected =
        format!("{}, as before: in_chain = true holds for one channel at one range", words(first));
    Some(place.problem("impacts.recording", found, expected))
}

/// A dividing probe is another load than the scope's own input, and with it the time constant is
/// another: the first impact with one.
fn another_load(plan: &CalibrationPlan, evidence: &[RecordingEvidence]) -> Option<Problem> {
    let is_own_input = plan.charge_amplifier.is_none() && plan.load == INPUT;
    let divides = |proof: &RecordingEvidence| is_own_input && proof.probe > 1.0;
    let place = evidence.iter().position(divides)?;
    let found = format!("a probe of {} x in the recording", evidence.get(place)?.probe);
    let expected = "input_resistance and input_capacitance of that probe under [scope], e.g. \"10 MOhm\" and \"13 pF\"";
    Some(plan.impacts.get(place)?.place.problem("impacts.recording", found, expected.to_owned()))
}

/// A capture as the calibration takes it; none for a record over frequency or in another unit than
/// volts.
pub fn record(capture: &Capture, window: Option<Gate>) -> Option<RawRecord> {
    let level = capture.waveform.preamble.y_mult.abs();
    if capture.waveform.preamble.y_unit != "V" {
        return None;
    }
    let vertical = &capture.waveform.vertical;
    let model = || Scene::load(BENCH).ok().map(|scene| scene.scope.model);
    let is_coupled = vertical.coupling == Some(Coupling::Ac);
    let ac = is_coupled.then(model).flatten().and_then(|model| ac_time_constant(&model, vertical));
    let trace = undo_coupling(capture.trace()?, ac);
    Some(RawRecord { trace, level, clipped: capture.waveform.clipped(), window })
}

fn strike(
    impact: &PlannedImpact,
    columns: &TableColumns,
) -> Result<(PlannedStrike, RecordingEvidence), Problem> {
    let problem = |found: String, expected: &str| {
        impact.place.problem("impacts.recording", found, expected.to_owned())
    };
    let file = &impact.recording;
    let opened = open_with(file, columns)
        .map_err(|error| problem(format!("{:#}", anyhow::Error::from(error)), "a recording"))?;
    let Some(shot) = opened.shots.iter().find(|shot| shot.number == impact.shot) else {
        let found = format!("{} shots in {}", opened.shots.len(), file.display());
        return Err(problem(found, &format!("one with number {}", impact.shot)));
    };
    let name = |capture: &Capture| capture.waveform.source.to_string();
    let capture = shot.captures.iter().find(|c| name(c).eq_ignore_ascii_case(&impact.channel));
    let Some((capture, record)) = capture.and_then(|c| {
        let window = impact.window.map(|[from, to]| Gate { from, to });
        Some((c, record(c, window)?))
    }) else {
        let names: Vec<String> = shot.captures.iter().map(name).collect();
        let names = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
        let found = format!("channels {names} in {}", file.display());
        return Err(problem(found, &format!("{} over time", impact.channel)));
    };
    let sha256 = recording_hash(file, &opened)
        .map_err(|error| problem(format!("{}: {error}", file.display()), "a file"))?;
    let waveform = &capture.waveform;
    let evidence = RecordingEvidence {
        recording: file.display().to_string(),
        sha256,
        channel: impact.channel.clone(),
        shot: impact.shot,
        volts_per_div: waveform.vertical.scale,
        seconds_per_div: waveform.horizontal_scale,
        probe: waveform.vertical.probe,
        instrument: capture.instrument.as_ref().map(|i| format!("{} {}", i.model, i.serial)),
    };
    let motion = StrikerMotion {
        striker: impact.striker,
        incoming: speed(impact.incoming),
        rebound: speed(impact.rebound),
    };
    Ok((PlannedStrike { record, motion }, evidence))
}

/// SHA-256 of a recording's `file`, or of the files that were read from a folder into `set`, in
/// hexadecimal.
///
/// # Errors
/// The file cannot be read.
pub fn recording_hash(file: &Path, set: &TraceSet) -> std::io::Result<String> {
    let mut hash = Sha256::new();
    if file.is_dir() {
        set.attachments.iter().for_each(|attachment| hash.update(&attachment.data));
    } else {
        hash.update(std::fs::read(file)?);
    }
    Ok(hexadecimal(&hash.finalize()))
}

/// What the impacts of `plan` share.
pub fn common(plan: &CalibrationPlan) -> Common {
    let number = |u: f64| Uncertain::normal(1.0, u);
    Common {
        strikers: plan.strikers.clone(),
        gain: plan.gain.unwrap_or(number(0.0)),
        speed_scale: number(plan.speed_scale_u),
        gate_distance: plan.gate_distance,
        gravity: plan.gravity,
        tau: plan.tau,
        above: plan.above,
    }
}

fn speed((means, value): (SpeedMethod, Uncertain)) -> SpeedSource {
    match means {
        SpeedMethod::Speed => SpeedSource::Speed(value),
        SpeedMethod::Height => SpeedSource::Height(value),
        SpeedMethod::GateTime => SpeedSource::GateTime(value),
        SpeedMethod::FlightTime => SpeedSource::FlightTime(value),
    }
}

/// A scatter that many times what the inputs explain is no chance: with six impacts normal errors
/// exceed it in 2 of 10,000 calibrations (1).
const LARGEST_BIRGE_RATIO: f64 = 2.2;
/// Of so many impacts one may be left out as an outlier.
const MOST_OUTLIERS: usize = 4;
/// A sensitivity with a larger expanded uncertainty over its value is not determined (1).
const MAX_EXPANDED_SHARE: f64 = 0.5;
/// A striker that leaves faster than it came by more standard uncertainties contradicts itself: of
/// ten elastic impacts chance does it in 3 of 10,000 plans (1).
const GAIN_DEVIATIONS: f64 = 4.0;
/// Strikers that keep a smaller share of their speed on average do not hit hard bodies (1).
const LEAST_RESTITUTION: f64 = 0.5;
/// Local gravity at the surface, mountains included (m/s^2).
const GRAVITY: std::ops::RangeInclusive<f64> = 9.76..=9.84;

/// Speed that `plan` gives by one of its means, and its standard uncertainty (m/s).
fn speed_of(plan: &CalibrationPlan, told: (SpeedMethod, Uncertain)) -> (f64, f64) {
    let (common, speed) = (common(plan), speed(told));
    let (gravity, gates) = (common.gravity.value, common.gate_distance);
    let at = |reading| speed.of(reading, gravity, gates.map_or(f64::NAN, |g| g.value));
    (at(told.1.value), (at(told.1.value + told.1.u) - at(told.1.value)).abs())
}

/// Note on strikers that lose most of their speed, as they seem to where a common factor is in all
/// heights or speeds of a plan.
fn restitution_note(plan: &CalibrationPlan) -> Option<String> {
    let ratio = |impact: &PlannedImpact| {
        speed_of(plan, impact.rebound).0 / speed_of(plan, impact.incoming).0
    };
    let mean = plan.impacts.iter().map(ratio).sum::<f64>() / plan.impacts.len() as f64;
    (mean < LEAST_RESTITUTION).then(|| {
        format!(
            "strikers leave with {:.0} % of the speed they came with: hard bodies keep more than half; check heights, speeds and their units",
            100.0 * mean
        )
    })
}

/// What in `plan` cannot be, or cannot be together.
fn contradictions(plan: &CalibrationPlan, found: &Calibration) -> Vec<String> {
    let mut wrong = Vec::new();
    if found.birge_ratio >= LARGEST_BIRGE_RATIO {
        wrong.push(format!(
            "impacts scatter {:.1} times as much as their uncertainties explain: check heights, speeds, masses and their units",
            found.birge_ratio
        ));
    }
    let all = found.impacts.len();
    let is_outlier =
        |impact: &&ImpactResult| matches!(impact.exclusion, Some(Exclusion::Outlier { .. }));
    let outliers = found.impacts.iter().filter(is_outlier).count();
    if outliers * MOST_OUTLIERS > all {
        wrong.push(format!(
            "{outliers} of {all} impacts lie far from the others: check their heights, speeds, masses and units"
        ));
    }
    if !GRAVITY.contains(&plan.gravity.value) {
        wrong.push(format!(
            "free fall of {} m/s^2 is found nowhere on the ground, where it is 9.76 to 9.84 m/s^2",
            plan.gravity.value
        ));
    }
    for (number, impact) in (1..).zip(&plan.impacts) {
        let speeds = [impact.incoming, impact.rebound].map(|told| speed_of(plan, told));
        let [(came, came_u), (left, left_u)] = speeds;
        if left - came > GAIN_DEVIATIONS * came_u.hypot(left_u) {
            wrong.push(format!(
                "impact {number}: the striker leaves at {left:.4} m/s, faster than it came at {came:.4} m/s"
            ));
        }
    }
    let is_determined = found.expanded <= MAX_EXPANDED_SHARE * found.sensitivity.abs();
    if !is_determined {
        let share = 100.0 * found.expanded / found.sensitivity.abs();
        wrong.push(format!("the sensitivity is known to {share:.0} % only: it is not determined"));
    }
    wrong
}
