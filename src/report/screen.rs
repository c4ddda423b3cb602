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

/// Colours of a screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ScreenTheme {
    /// Bright on dark, as on the instrument.
    Dark,
    /// Dark on white, for print.
    Light,
}

impl ScreenTheme {
    fn background(self) -> &'static str {
        if self == Self::Dark { "#101418" } else { "#ffffff" }
    }

    fn text(self) -> &'static str {
        if self == Self::Dark { "#d0d4d8" } else { "#202428" }
    }

    fn graticule(self) -> &'static str {
        if self == Self::Dark { "#3a4148" } else { "#9aa2aa" }
    }

    fn trigger(self) -> &'static str {
        if self == Self::Dark { "#ff9830" } else { "#c05800" }
    }

    /// Colours of the traces, on dark as on the instrument's screen.
    fn trace(self, source: Source) -> &'static str {
        let (dark, light) = match source {
            Source::Channel(1) => ("#ffd800", "#946c00"),
            Source::Channel(2) => ("#00d0ff", "#0068b8"),
            Source::Channel(3) => ("#ff60c0", "#b8187c"),
            Source::Channel(_) => ("#40e060", "#18802c"),
            Source::Math => ("#ff5040", "#c02818"),
            Source::Reference(_) => ("#e0e0e0", "#585c60"),
        };
        if self == Self::Dark { dark } else { light }
    }
}

/// The picture of one shot, titled `title`; captures of a frequency axis are left out.
pub fn screen(shot: &Shot, title: &str, theme: ScreenTheme) -> String {
    let (side, above, below) = MARGINS;
    let (across, down) = (
        f64::from(DIVISIONS.0) * PIXELS_PER_DIVISION,
        f64::from(DIVISIONS.1) * PIXELS_PER_DIVISION,
    );
    let (width, height) = (across + 2.0 * side, down + above + below);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"monospace\" font-size=\"14\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"{}\"/>\n\
         <text x=\"{side}\" y=\"22\" fill=\"{}\">{}</text>\n\
         <clipPath id=\"screen\"><rect width=\"{across}\" height=\"{down}\"/></clipPath>\n\
         <g transform=\"translate({side} {above})\">\n",
        theme.background(),
        theme.text(),
        super::escape(title)
    );
    graticule(&mut svg, theme);
    let captures: Vec<&Capture> =
        shot.captures.iter().filter(|c| c.waveform.preamble.x_unit == "s").collect();
    if let Some(first) = captures.first() {
        let place = first.waveform.trigger_point / points(first) * across;
        if (0.0..=across).contains(&place) {
            let _ = writeln!(
                svg,
                "<path d=\"M{:.1} 2h12l-6 10z\" fill=\"{}\"/>",
                place - 6.0,
                theme.trigger()
            );
        }
    }
    for (index, capture) in captures.iter().enumerate() {
        let colour = theme.trace(capture.waveform.source);
        trace(&mut svg, capture, colour, down);
        readout(&mut svg, capture, colour, (index, down));
    }
    if let Some(first) = captures.first() {
        let base = engineering(first.waveform.horizontal_scale, "s/div", 3);
        let _ = writeln!(
            svg,
            "<text x=\"{across}\" y=\"{}\" text-anchor=\"end\" fill=\"{}\">M {base}</text>",
            down + 48.0,
            theme.text()
        );
    }
    svg.push_str("</g>\n</svg>\n");
    svg
}

fn points(capture: &Capture) -> f64 {
    capture.waveform.codes.len().max(1) as f64
}

fn graticule(svg: &mut String, theme: ScreenTheme) {
    let (columns, rows) = DIVISIONS;
    let (across, down) =
        (f64::from(columns) * PIXELS_PER_DIVISION, f64::from(rows) * PIXELS_PER_DIVISION);
    let _ = writeln!(svg, "<g stroke=\"{}\" stroke-width=\"1\">", theme.graticule());
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
fn trace(svg: &mut String, capture: &Capture, colour: &str, down: f64) {
    let waveform = &capture.waveform;
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

fn readout(svg: &mut String, capture: &Capture, colour: &str, (index, down): (usize, f64)) {
    let waveform = &capture.waveform;
    let unit = format!("{}/div", waveform.preamble.y_unit);
    let scale = engineering(waveform.vertical.scale, &unit, 3);
    let clipped = if waveform.clipped() > 0 { ", clipped" } else { "" };
    let text = super::escape(&format!("{} {scale}{clipped}", waveform.source));
    let place = u8::try_from(index).map_or(0.0, |i| f64::from(i) * 2.5 * PIXELS_PER_DIVISION);
    let _ =
        writeln!(svg, "<text x=\"{place}\" y=\"{}\" fill=\"{colour}\">{text}</text>", down + 26.0);
}
