//! The scope's screen as an SVG picture: graticule, traces, readouts, for reports and the README.

use std::fmt::Write as _;

use crate::quantity::engineering;
use crate::recording::{Capture, Shot};
use crate::scope::Source;

/// Pixels a division.
const PIXELS_PER_DIVISION: f64 = 80.0;
/// Pixels around the graticule: left and right, above, below.
const MARGINS: (f64, f64, f64) = (30.0, 34.0, 62.0);
/// Divisions across and down.
const DIVISIONS: (u8, u8) = (10, 8);
/// Digitiser levels in a division.
const LEVELS_PER_DIVISION: f64 = crate::scope::waveform::LEVELS_PER_DIVISION;

/// The picture of one shot, titled `title`; captures of a frequency axis are left out.
pub fn screen(shot: &Shot, title: &str) -> String {
    let (side, above, below) = MARGINS;
    let (across, down) = (
        f64::from(DIVISIONS.0) * PIXELS_PER_DIVISION,
        f64::from(DIVISIONS.1) * PIXELS_PER_DIVISION,
    );
    let (width, height) = (across + 2.0 * side, down + above + below);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"monospace\" font-size=\"14\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#101418\"/>\n\
         <text x=\"{side}\" y=\"22\" fill=\"#d0d4d8\">{}</text>\n\
         <clipPath id=\"screen\"><rect width=\"{across}\" height=\"{down}\"/></clipPath>\n\
         <g transform=\"translate({side} {above})\">\n",
        super::escape(title)
    );
    graticule(&mut svg);
    let captures: Vec<&Capture> =
        shot.captures.iter().filter(|c| c.waveform.preamble.x_unit == "s").collect();
    if let Some(first) = captures.first() {
        let place = first.waveform.trigger_point / points(first) * across;
        if (0.0..=across).contains(&place) {
            let _ = writeln!(svg, "<path d=\"M{:.1} 2h12l-6 10z\" fill=\"#ff9830\"/>", place - 6.0);
        }
    }
    for (index, capture) in captures.iter().enumerate() {
        trace(&mut svg, capture, down);
        readout(&mut svg, capture, index, down);
    }
    if let Some(first) = captures.first() {
        let base = engineering(first.waveform.horizontal_scale, "s/div", 3);
        let _ = writeln!(
            svg,
            "<text x=\"{across}\" y=\"{}\" text-anchor=\"end\" fill=\"#d0d4d8\">M {base}</text>",
            down + 48.0
        );
    }
    svg.push_str("</g>\n</svg>\n");
    svg
}

fn points(capture: &Capture) -> f64 {
    capture.waveform.codes.len().max(1) as f64
}

fn graticule(svg: &mut String) {
    let (columns, rows) = DIVISIONS;
    let (across, down) =
        (f64::from(columns) * PIXELS_PER_DIVISION, f64::from(rows) * PIXELS_PER_DIVISION);
    svg.push_str("<g stroke=\"#3a4148\" stroke-width=\"1\">\n");
    for (count, horizontal) in [(columns, false), (rows, true)] {
        for line in 0..=count {
            let at = f64::from(line) * PIXELS_PER_DIVISION;
            let middle = line * 2 == count;
            let dash = if middle || line == 0 || line == count {
                ""
            } else {
                " stroke-dasharray=\"2 14\""
            };
            let path =
                if horizontal { format!("M0 {at}H{across}") } else { format!("M{at} 0V{down}") };
            let _ = writeln!(svg, "<path d=\"{path}\"{dash}/>");
        }
    }
    svg.push_str("</g>\n");
}

/// The trace and the arrow at its ground level.
fn trace(svg: &mut String, capture: &Capture, down: f64) {
    let waveform = &capture.waveform;
    let colour = colour(waveform.source);
    let step = f64::from(DIVISIONS.0) * PIXELS_PER_DIVISION / points(capture);
    let height = |level: f64| 0.5 * down - level / LEVELS_PER_DIVISION * PIXELS_PER_DIVISION;
    let mut path = String::new();
    let mut x = 0.0;
    for (index, code) in waveform.codes.iter().enumerate() {
        let start = if index == 0 { 'M' } else { 'L' };
        let _ = write!(path, "{start}{x:.2} {:.1}", height(f64::from(*code)));
        x += step;
    }
    let _ = writeln!(
        svg,
        "<path d=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.5\" clip-path=\"url(#screen)\"/>"
    );
    let ground = height(waveform.preamble.y_off).clamp(0.0, down);
    let _ = writeln!(svg, "<path d=\"M-16 {}l12 6l-12 6z\" fill=\"{colour}\"/>", ground - 6.0);
}

fn readout(svg: &mut String, capture: &Capture, index: usize, down: f64) {
    let waveform = &capture.waveform;
    let unit = format!("{}/div", waveform.preamble.y_unit);
    let scale = engineering(waveform.vertical.scale, &unit, 3);
    let text = super::escape(&format!("{} {scale}", waveform.source));
    let place = u8::try_from(index).map_or(0.0, |i| f64::from(i) * 2.5 * PIXELS_PER_DIVISION);
    let _ = writeln!(
        svg,
        "<text x=\"{place}\" y=\"{}\" fill=\"{}\">{text}</text>",
        down + 26.0,
        colour(waveform.source)
    );
}

/// Colours of the traces as on the instrument's screen.
fn colour(source: Source) -> &'static str {
    match source {
        Source::Channel(1) => "#ffd800",
        Source::Channel(2) => "#00d0ff",
        Source::Channel(3) => "#ff60c0",
        Source::Channel(_) => "#40e060",
        Source::Math => "#ff5040",
        Source::Reference(_) => "#e0e0e0",
    }
}
