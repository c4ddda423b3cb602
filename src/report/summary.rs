//! The summary of a run as a page of text.

use super::table;
use crate::experiment::outcome::ErrorEstimate;
use crate::experiment::outcome::{EnergyLedger, TOLERABLE};
use crate::experiment::outcome::{Reading, Speed, Summary};
use crate::quantity::engineering;

/// The page that `run` prints.
pub fn summary(summary: &Summary) -> String {
    let mut lines = vec![format!("{}: {}", summary.scene, summary.title), String::new()];
    if !summary.sensors.is_empty() || summary.wall.is_some() {
        lines.extend(readings(summary));
    }
    lines.extend(velocities(&summary.final_velocities_m_per_s));
    if !summary.speeds.is_empty() {
        lines.push(String::new());
        lines.extend(speeds(&summary.speeds));
    }
    if let Some(paper) = &summary.paper {
        lines.push(format!(
            "  the paper, 14 -> 27: {} measured, {} calculated (Table {}; estimator not stated)",
            engineering(paper.experiment_m_per_s, "m/s", 3),
            engineering(paper.numerics_m_per_s, "m/s", 3),
            paper.table
        ));
    }
    lines.push(String::new());
    lines.extend(costs(summary));
    for note in &summary.notes {
        lines.push(format!("  note        {note}"));
    }
    lines.join("\n")
}

/// One row a body, where there are no sensors.
fn velocities(velocities: &[f64]) -> Vec<String> {
    if velocities.is_empty() {
        return Vec::new();
    }
    let mut rows = vec![["body", "velocity"].map(str::to_owned).to_vec()];
    let row =
        |(body, velocity): (usize, &f64)| vec![body.to_string(), engineering(*velocity, "m/s", 4)];
    rows.extend((1..).zip(velocities).map(row));
    let mut lines = vec!["velocities at the end, from the top, downward positive".to_owned()];
    lines.extend(table::lines(&rows, &[0]));
    lines
}

fn readings(summary: &Summary) -> Vec<String> {
    let heading = ["where", "static", "first peak", "total", "peak at", "half-rise", "10 %"];
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    let newton = |force: f64| engineering(force, "N", 4);
    let seconds = |time: Option<f64>| table::known(time, "s", 4);
    let row = |reading: &Reading| {
        let place = match reading.particle {
            Some(particle) if reading.offset == 0.0 => format!("particle {particle}"),
            Some(particle) => format!("particle {particle}, offset {}", reading.offset),
            None => "wall".to_owned(),
        };
        let peak = reading.first_peak;
        vec![
            place,
            newton(reading.static_n),
            peak.map_or("-".to_owned(), |p| newton(p.dynamic_n)),
            peak.map_or("-".to_owned(), |p| newton(p.total_n)),
            seconds(peak.map(|p| p.time_s)),
            seconds(reading.half_rise_s),
            seconds(reading.ten_percent_s),
        ]
    };
    rows.extend(summary.sensors.iter().chain(&summary.wall).map(row));
    let mut lines = vec![
        "true force at the sensors, first peak over the static force; times from the striker's first contact"
            .to_owned(),
    ];
    lines.extend(table::lines(&rows, &[0]));
    lines
}

/// One row a pair of neighbouring sensors, one column an estimator.
fn speeds(speeds: &[Speed]) -> Vec<String> {
    let mut rows =
        vec![["from -> to", "distance", "half-rise", "peak", "10 %"].map(str::to_owned).to_vec()];
    for pair in
        speeds.chunk_by(|a, b| (&a.from_sensor, &a.to_sensor) == (&b.from_sensor, &b.to_sensor))
    {
        let Some(first) = pair.first() else { continue };
        let by = |estimator: &str| {
            let found = pair.iter().find(|speed| speed.estimator == estimator);
            found.map_or("-".to_owned(), |speed| engineering(speed.m_per_s, "m/s", 4))
        };
        rows.push(vec![
            format!("{} -> {}", first.from_sensor, first.to_sensor),
            engineering(first.distance_m, "m", 5),
            by("half_rise"),
            by("peak"),
            by("ten_percent"),
        ]);
    }
    let mut lines = vec!["pulse speed by each estimator of the arrival".to_owned()];
    lines.extend(table::lines(&rows, &[0]));
    lines
}

fn costs(summary: &Summary) -> Vec<String> {
    let energy = &summary.energy;
    let setting = match (summary.accuracy, summary.step_s, summary.tolerance) {
        (Some(accuracy), ..) => format!("accuracy {}", short(accuracy)),
        (None, Some(step), _) => format!("step {} by hand", engineering(step, "s", 4)),
        (None, None, Some(tolerance)) => format!("step tolerance {} by hand", short(tolerance)),
        (None, None, None) => String::new(),
    };
    let trigger = match (summary.trigger.time_s, summary.trigger.crossed) {
        (Some(time), true) => {
            format!("triggered {} after the first contact", engineering(time, "s", 4))
        }
        (Some(time), false) => format!("automatic trigger at {}", engineering(time, "s", 4)),
        (None, _) => "not triggered".to_owned(),
    };
    let steps = if summary.steps == 0 {
        "-".to_owned()
    } else {
        let mean = summary.simulated_s / summary.steps as f64;
        format!(
            "{} steps of {} on average, {} repeated",
            summary.steps,
            engineering(mean, "s", 3),
            summary.rejected_steps
        )
    };
    let held = summary.wall_held_s.map_or(String::new(), |wall| {
        format!(", {} including the check runs", engineering(wall, "s", 3))
    });
    let is_rounding = energy.is_rounding() && energy.drift.abs() > TOLERABLE;
    let rounding = if is_rounding { ", rounding of what is stored" } else { "" };
    let mut lines = vec![
        format!("  method      {}, {setting}", summary.method),
        format!("  steps       {steps}"),
        format!("  evaluations {} of all contact forces", summary.force_evaluations),
        format!(
            "  time        {} simulated in {} of computing time{held}",
            engineering(summary.simulated_s, "s", 4),
            engineering(summary.wall_s, "s", 3)
        ),
        format!(
            "  energy      {} at first, {} dissipated, numerical error {:.1e} of that in motion{rounding}",
            engineering(energy.initial, "J", 4),
            engineering(energy.dissipated, "J", 3),
            energy.drift
        ),
    ];
    lines.extend(ledger(energy));
    lines.splice(1..1, errors(summary));
    lines.push(format!("  scope       {trigger}"));
    for (index, effect) in summary.effect_settings.iter().enumerate() {
        let label = if index == 0 { "effects on" } else { "" };
        lines.push(format!("  {label:<11} {effect}"));
    }
    lines
}

/// A small number, rounded to what can be remembered.
fn short(value: f64) -> String {
    format!("{value:.1e}").replace(".0e", "e")
}

/// How far off what is printed above may be.
fn errors(summary: &Summary) -> Vec<String> {
    let Some(estimate) = &summary.error_estimate else { return Vec::new() };
    let ErrorEstimate { peak, arrival, trace, trace_holds_s, how } = estimate;
    let mut lines = vec![format!(
        "  error       first peaks within {peak:.1e}, arrivals within {arrival:.1e} of their values"
    )];
    if let Some(trace) = trace {
        let early = summary.accuracy.zip(*trace_holds_s).map_or(String::new(), |(asked, until)| {
            if until > 0.0 {
                format!("; until {} within {asked:.1e}", engineering(until, "s", 3))
            } else {
                format!("; beyond {asked:.1e} from the start")
            }
        });
        lines
            .push(format!("              traces within {trace:.1e} of their largest value{early}"));
    }
    lines.push(format!("              ({how})"));
    lines
}

/// Where the energy is at the end: what moves, what is stored, what each load holds, and what each
/// loss has taken.
fn ledger(energy: &EnergyLedger) -> Vec<String> {
    let booked = &energy.dissipated_by_kind;
    let end = &energy.final_by_kind;
    let entry = |name: &str, joules: f64| format!("{} {name}", engineering(joules, "J", 4));
    let mut held = vec![entry("kinetic", end.kinetic), entry("elastic", end.elastic)];
    // A load that is not there has done no work.
    let loads = [("gravity", end.gravity), ("magnet", end.magnet), ("end forces", end.end_forces)];
    let loads = loads.into_iter().filter(|(_, joules)| *joules != 0.0);
    held.extend(loads.map(|(name, joules)| entry(name, joules)));
    let mut lines = vec![format!("              at the end of the record {}", held.join(", "))];
    let mut taken: Vec<String> =
        booked.losses.iter().map(|loss| entry(loss.loss, loss.energy)).collect();
    if booked.left_in_contacts > 0.0 {
        taken.push(entry("left in contacts", booked.left_in_contacts));
    }
    if let Some(work) = booked.work_of_drive {
        lines.push(format!("              put in by the drive {}", engineering(work, "J", 4)));
    }
    if !taken.is_empty() {
        lines.push(format!("              taken by losses {}", taken.join(", ")));
    }
    lines
}
