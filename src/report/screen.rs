//! The scope's screen as a plot: graticule, traces, readouts, for reports and the README.

use super::plot::{Axis, Plot, Series, Sheet, Stroke};
use crate::quantity::engineering;
use crate::recording::{Capture, Shot};
use crate::scope::Source;
use crate::scope::waveform::LEVELS_PER_DIVISION;

/// Pixels of a division.
const PIXELS_PER_DIVISION: f64 = 80.0;
/// Divisions across and down.
const DIVISIONS: (u8, u8) = (10, 8);

/// Colour of a trace on white: the hues of the instrument's screen.
fn colour(source: Source) -> &'static str {
    match source {
        Source::Channel(1) => "#946c00",
        Source::Channel(2) => "#0068b8",
        Source::Channel(3) => "#b8187c",
        Source::Channel(_) => "#18802c",
        Source::Math => "#c02818",
        Source::Reference(_) => "#585c60",
    }
}

/// The picture of one shot, titled `title`; captures over frequency are left out.
pub fn screen(shot: &Shot, title: &str) -> Sheet {
    let is_over_time = |capture: &&Capture| capture.waveform.preamble.x_unit == "s";
    let captures: Vec<&Capture> = shot.captures.iter().filter(is_over_time).collect();
    let [across, down] = [DIVISIONS.0, DIVISIONS.1].map(f64::from);
    let points = |capture: &Capture| capture.waveform.codes.len().max(1) as f64;
    let grid = |from: i8, to: i8| (from..=to).map(|division| (f64::from(division), String::new()));
    let base =
        captures.first().map(|first| engineering(first.waveform.horizontal_scale, "s/div", 3));
    let axis = |label: String, from: f64, to: f64, ticks| Axis {
        label,
        from,
        to,
        logarithmic: false,
        ticks,
    };
    let grounds = captures.iter().map(|capture| {
        let ground = capture.waveform.ground() / LEVELS_PER_DIVISION;
        (ground.clamp(-0.5 * down, 0.5 * down), capture.waveform.source.to_string())
    });
    let base = base.map_or_else(String::new, |base| format!("M {base}"));
    let x = axis(base, 0.0, across, grid(0, 10).collect());
    let y = axis(String::new(), -0.5 * down, 0.5 * down, grid(-4, 4).chain(grounds).collect());
    let mut plot = Plot::new("", x, y);
    if let Some(first) = captures.first() {
        let place = first.waveform.trigger_point / points(first) * across;
        plot.marks.push((place, "T".to_owned()));
    }
    plot.lines = captures
        .iter()
        .map(|capture| {
            let waveform = &capture.waveform;
            let step = across / points(capture);
            let place =
                |(index, height): (usize, f64)| (step * index as f64, height / LEVELS_PER_DIVISION);
            let unit = format!("{}/div", waveform.preamble.y_unit);
            let scale = engineering(waveform.vertical.scale, &unit, 3);
            let clipped = if waveform.clipped() > 0 { ", clipped" } else { "" };
            let name = format!("{} {scale}{clipped}", waveform.source);
            let points = waveform.heights().enumerate().map(place).collect();
            Series::new(name, points, colour(waveform.source), Stroke::Solid)
        })
        .collect();
    let size = (across * PIXELS_PER_DIVISION, down * PIXELS_PER_DIVISION);
    Sheet { size, ..Sheet::stack(title, vec![plot]) }
}
