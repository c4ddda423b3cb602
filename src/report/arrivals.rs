//! Arrivals and speeds as a page of text.

use super::plot::{Plot, Sheet, trace_points};
use super::table;
use super::table::with_expanded;
use crate::measurement::arrivals::{ChannelArrivals, SpeedBetween, Survey};
use crate::quantity::{Uncertain, engineering};
use crate::recording::{Capture, Shot};
use crate::trace::Trace;

/// The page that `arrivals` prints.
pub fn arrivals(survey: &Survey) -> String {
    let mut lines = vec![format!(
        "shot {}: times after the trigger, ± is the expanded uncertainty (95 %)",
        survey.shot
    )];
    let heading = [
        "",
        "sensor",
        "first peak",
        "width",
        "pulses",
        "half-rise",
        "peak at",
        "10 %",
        "max. slope",
    ];
    let rows = table::titled(heading, survey.channels.iter().map(row));
    lines.extend(table::lines(&rows, &[0, 1]));
    if !survey.speeds.is_empty() {
        lines.push(String::new());
        lines.push("pulse speed by each estimator of the arrival".to_owned());
        lines.extend(speeds(survey));
    }
    for decay in &survey.decays {
        let rate = decay.per_metre.map_or(String::new(), |rate| {
            let rate = table::plus_minus(rate.value, rate.expanded(), "Np/m");
            format!(", attenuation {rate}")
        });
        let ratio = table::plus_minus(decay.ratio.value, decay.ratio.expanded(), "");
        lines.push(format!(
            "  first peak at {} over that at {}: {ratio}{rate}",
            decay.to, decay.from
        ));
    }
    let problems = survey.channels.iter().filter_map(|channel| {
        let name = &channel.channel;
        let clipped = || format!("{name}: {} samples may be clipped", channel.clipped);
        let problem = channel.problem.as_ref().map(|problem| format!("{name}: {problem}"));
        problem.or_else(|| (channel.clipped > 0).then(clipped))
    });
    let notes = table::joined(problems.chain(survey.notes.iter().cloned()));
    lines.extend(notes.iter().map(|note| format!("  note  {note}")));
    lines.join("\n")
}

/// The traces of a shot with their arrivals by half-rise and first peak, as a picture.
pub fn arrivals_picture(survey: &Survey, shot: &Shot, title: &str) -> Sheet {
    let panel = |trace: Trace| {
        let found = survey.channels.iter().find(|channel| channel.channel == trace.name);
        let arrivals = found.into_iter().flat_map(|channel| &channel.arrivals);
        let shown = arrivals.filter(|arrival| ["half_rise", "peak"].contains(&arrival.estimator));
        let marks = shown.filter_map(|arrival| {
            let time = arrival.time_s?;
            let name = arrival.estimator.replace('_', " ");
            Some((time.value, format!("{name}: {}", with(Some(time), "s"))))
        });
        let label = [trace.name.as_str(), trace.unit.as_str()];
        Plot::over_time(label, trace_points(&trace), Vec::new()).with_marks(marks.collect())
    };
    let traces = shot.captures.iter().filter_map(Capture::trace);
    Sheet::stack(title, traces.map(panel).collect())
}

fn row(channel: &ChannelArrivals) -> Vec<String> {
    let height = match channel.height_n {
        Some(force) => with(Some(force), "N"),
        None => with(channel.height, &channel.unit),
    };
    let mut row = vec![
        channel.channel.clone(),
        channel.sensor.clone().unwrap_or_else(|| "?".to_owned()),
        height,
        with(channel.width_s, "s"),
        channel.pulses.map_or("-".to_owned(), |count| count.to_string()),
    ];
    row.extend(channel.arrivals.iter().map(|arrival| with(arrival.time_s, "s")));
    row
}

/// The distance, with its expanded uncertainty where the scene states one.
fn distance(speed: &SpeedBetween) -> String {
    if speed.distance_u_m > 0.0 {
        with(Some(Uncertain::normal(speed.distance_m, speed.distance_u_m)), "m")
    } else {
        engineering(speed.distance_m, "m", 5)
    }
}

fn speeds(survey: &Survey) -> Vec<String> {
    let keys = ["half_rise", "peak", "ten_percent", "maximum_slope", "cross_correlation"];
    let heading =
        ["from -> to", "distance", "half-rise", "peak", "10 %", "max. slope", "correlation"];
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    for pair in survey.speeds.chunk_by(|a, b| (&a.from, &a.to) == (&b.from, &b.to)) {
        let Some(first) = pair.first() else { continue };
        let mut row = vec![format!("{} -> {}", first.from, first.to), distance(first)];
        row.extend(keys.map(|key| {
            with(pair.iter().find(|speed| speed.estimator == key).map(|s| s.m_per_s), "m/s")
        }));
        rows.push(row);
    }
    table::lines(&rows, &[0])
}

/// A number with its expanded uncertainty in the same prefix: `309.8 ± 0.7 µs`.
fn with(measure: Option<Uncertain>, unit: &str) -> String {
    let Some(measure) = measure else { return "-".to_owned() };
    with_expanded(measure.value, measure.expanded(), unit)
}
