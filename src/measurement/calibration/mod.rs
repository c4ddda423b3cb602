//! Calibrates a sensor from a plan and its recordings.

mod fill;
mod plausibility;
pub mod words;

pub use fill::{METHOD, report, sensor_file};
pub use plausibility::common;
pub use words::CalibrationReport;

use std::path::Path;

use sha2::{Digest, Sha256};

use crate::analysis::calibration::impact::RawRecord;
use crate::analysis::calibration::model::StrikerMotion;
use crate::analysis::calibration::{self, Calibration, CalibrationError, Draws, PlannedStrike};
use crate::analysis::gate::Gate;
use crate::recording::format::open_with;
use crate::recording::tek_csv::TableColumns;
use crate::recording::{Capture, TraceSet};
use crate::scene::hexadecimal;
use crate::scene::plan::{CalibrationPlan, INPUT, PlanError, PlannedImpact};
use crate::scene::problem::Problem;
use plausibility::speed;
use words::RecordingEvidence;

/// Why there is no calibration.
#[derive(Debug, thiserror::Error)]
pub enum PlanRunError {
    /// The plan, or a recording that it names.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// Too little could be used.
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
}

/// A calibration with all that goes into its certificate.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibrated {
    /// The calibration, with the signals.
    pub calibration: Calibration,
    /// The same in words and numbers.
    pub report: CalibrationReport,
}

/// Calibrates as `plan` says; `columns` tells what those of tables are, where they do not.
///
/// # Errors
/// [`PlanRunError`]: a recording that cannot be read or has no such channel, at its place in the
/// plan; or too few impacts left.
pub fn run(plan: &CalibrationPlan, columns: &TableColumns) -> Result<Calibrated, PlanRunError> {
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
        return Err(PlanError::Problems(problems).into());
    }
    let draws = Draws { seed: plan.seed, count: usize::try_from(plan.draws).unwrap_or(0) };
    let found = calibration::calibrate(&strikes, &common(plan), draws)?;
    let report = report(plan, &found, evidence);
    Ok(Calibrated { calibration: found, report })
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
    Some(RawRecord { trace: capture.trace()?, level, clipped: capture.waveform.clipped(), window })
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
    let sha256 = hash(file, &opened)
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

fn hash(file: &Path, set: &TraceSet) -> std::io::Result<String> {
    let mut hash = Sha256::new();
    if file.is_dir() {
        set.attachments.iter().for_each(|attachment| hash.update(&attachment.data));
    } else {
        hash.update(std::fs::read(file)?);
    }
    Ok(hexadecimal(&hash.finalize()))
}
