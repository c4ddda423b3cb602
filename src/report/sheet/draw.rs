//! A sheet as SVG.

use std::fmt::Write as _;

use super::{Plot, Polyline, Sheet, Stroke};
use crate::report::escape;

/// Room around a panel's frame: left, right, above, below (pixels).
const MARGINS: (f64, f64, f64, f64) = (74.0, 34.0, 30.0, 50.0);
/// Room above all panels for the title (pixels).
const TITLE_HEIGHT: f64 = 34.0;
/// Height of a line of text (pixels).
const LINE_HEIGHT: f64 = 16.0;
/// Estimated width of a character (pixels).
const CHARACTER_WIDTH: f64 = 7.0;
/// Width of the bar of a map's colours (pixels), and its steps.
const COLOUR_BAR_WIDTH: f64 = 100.0;
const COLOUR_BAR_STEPS: u32 = 20;
/// Colour of shaded bands.
const BAND_COLOUR: &str = "#efe6d2";

/// The picture of `sheet`.
pub fn sheet_svg(sheet: &Sheet) -> String {
    let (left, right, above, below) = MARGINS;
    let (w, h) = sheet.size;
    let columns = sheet.columns.clamp(1, sheet.panels.len().max(1));
    let rows = sheet.panels.len().div_ceil(columns);
    let (across, down) = (left + w + right, above + h + below);
    let below_panels = TITLE_HEIGHT + down * rows as f64;
    let legend_rows = sheet.legend.len().div_ceil(columns) + usize::from(!sheet.note.is_empty());
    let width = across * columns as f64;
    let height = below_panels + 1.25 * LINE_HEIGHT * legend_rows as f64;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n<text x=\"{left}\" y=\"22\" font-size=\"15\">{}</text>\n",
        escape(&sheet.title)
    );
    // Pictures share one page in a report, and with it the names in them.
    let name: String = sheet.title.chars().filter(char::is_ascii_alphanumeric).collect();
    for (index, panel) in sheet.panels.iter().enumerate() {
        let (row, column) = (index / columns, index % columns);
        let (x, y) = (left + across * column as f64, TITLE_HEIGHT + above + down * row as f64);
        let _ = writeln!(svg, "<g transform=\"translate({x} {y})\">");
        Drawing { panel, w, h, id: format!("{name}-{index}") }.draw(&mut svg);
        svg.push_str("</g>\n");
    }
    let place = |index: usize| {
        let (row, column) = (index / columns, index % columns);
        (left + across * column as f64, below_panels + 1.25 * LINE_HEIGHT * row as f64)
    };
    for (index, line) in sheet.legend.iter().enumerate() {
        let _ = writeln!(svg, "{}", legend_entry(place(index), &sample(line), &line.name));
    }
    let (x, y) = place(sheet.legend.len().next_multiple_of(columns));
    let _ =
        writeln!(svg, "<text x=\"{x}\" y=\"{y}\" fill=\"#606060\">{}</text>", escape(&sheet.note));
    svg.push_str("</svg>\n");
    svg
}

/// A piece of a line with its name.
fn legend_entry((x, y): (f64, f64), sample: &str, name: &str) -> String {
    let name = escape(name);
    format!(
        "<g transform=\"translate({x:.1} {y:.1})\">{sample}<text x=\"26\" y=\"4\">{name}</text></g>"
    )
}

struct Drawing<'a> {
    panel: &'a Plot,
    w: f64,
    h: f64,
    /// Tells the panel's clip path from all others.
    id: String,
}

impl Drawing<'_> {
    fn x(&self, value: f64) -> f64 {
        self.w * self.panel.x.share(value)
    }

    fn y(&self, value: f64) -> f64 {
        self.h * (1.0 - self.panel.y.share(value))
    }

    fn draw(&self, svg: &mut String) {
        let Self { panel, w, h, id } = self;
        let _ = writeln!(
            svg,
            "<clipPath id=\"c{id}\"><rect width=\"{w}\" height=\"{h}\"/></clipPath>\n<text x=\"0\" y=\"-9\">{}</text>",
            escape(&panel.title)
        );
        self.background(svg);
        self.axes(svg);
        let _ = writeln!(svg, "<g clip-path=\"url(#c{id})\" fill=\"none\">");
        for line in &panel.lines {
            self.line(svg, line);
        }
        svg.push_str("</g>\n");
        let _ =
            writeln!(svg, "<rect width=\"{w}\" height=\"{h}\" fill=\"none\" stroke=\"#303030\"/>");
        for (x, y, words) in &panel.words {
            let (x, y) = (self.x(*x), self.y(*y));
            let _ = writeln!(
                svg,
                "<text x=\"{x:.1}\" y=\"{y:.1}\" fill=\"#303030\">{}</text>",
                escape(words)
            );
        }
        self.legend(svg);
    }

    fn background(&self, svg: &mut String) {
        let Self { panel, w, h, .. } = self;
        if let Some(map) = &panel.map {
            svg.push_str("<g shape-rendering=\"crispEdges\">\n");
            let wide = w / map.columns.len().max(1) as f64;
            for (column, shares) in map.columns.iter().enumerate() {
                let high = h / shares.len().max(1) as f64;
                for (row, share) in shares.iter().enumerate().filter(|(_, share)| **share > 0.0) {
                    let (x, y) = (wide * column as f64, h - high * (row + 1) as f64);
                    let _ = writeln!(
                        svg,
                        "<rect x=\"{x:.2}\" y=\"{y:.2}\" width=\"{:.2}\" height=\"{:.2}\" fill=\"{}\"/>",
                        wide + 0.05,
                        high + 0.05,
                        shade(*share)
                    );
                }
            }
            svg.push_str("</g>\n");
            colour_bar(svg, *w, &map.shades);
        }
        for (from, to, _) in &panel.bands {
            let (x0, x1) = (self.x(*from).max(0.0), self.x(*to).min(*w));
            let width = (x1 - x0).max(0.0);
            let _ = writeln!(
                svg,
                "<rect x=\"{x0:.1}\" width=\"{width:.1}\" height=\"{h}\" fill=\"{BAND_COLOUR}\"/>"
            );
        }
    }

    fn axes(&self, svg: &mut String) {
        let Self { panel, w, h, .. } = self;
        let inside = |at: f64, length: f64| (-0.01..=length + 0.01).contains(&at);
        for (value, name) in &panel.x.ticks {
            let at = self.x(*value);
            if inside(at, *w) {
                let _ = writeln!(
                    svg,
                    "<path d=\"M{at:.1} 0V{h}\" stroke=\"#d8d8d8\" stroke-width=\"0.6\"/><text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
                    h + 17.0,
                    escape(name)
                );
            }
        }
        for (value, name) in &panel.y.ticks {
            let at = self.y(*value);
            if inside(at, *h) {
                let _ = writeln!(
                    svg,
                    "<path d=\"M0 {at:.1}H{w}\" stroke=\"#d8d8d8\" stroke-width=\"0.6\"/><text x=\"-7\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                    at + 4.0,
                    escape(name)
                );
            }
        }
        let _ = writeln!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>\n\
             <text transform=\"translate(-54 {:.1}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            0.5 * w,
            h + 36.0,
            escape(&panel.x.label),
            0.5 * h,
            escape(&panel.y.label)
        );
    }

    fn line(&self, svg: &mut String, line: &Polyline) {
        let Polyline { colour, stroke, .. } = line;
        if *stroke == Stroke::Dots {
            for (x, y) in &line.points {
                let (x, y) = (self.x(*x), self.y(*y));
                let _ = writeln!(
                    svg,
                    "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.6\" fill=\"{colour}\"/>"
                );
            }
            return;
        }
        let places: Vec<(f64, f64)> = line
            .points
            .iter()
            .map(|(x, y)| (self.x(*x), self.y(*y)))
            .filter(|(_, y)| y.is_finite())
            .collect();
        let mut path = String::new();
        let kept = if *stroke == Stroke::Filled {
            // The upper edge comes back from the right.
            let (low, high) = places.split_at(places.len() / 2);
            let forward: Vec<(f64, f64)> = high.iter().rev().copied().collect();
            thinned(low).into_iter().chain(thinned(&forward).into_iter().rev()).collect()
        } else {
            thinned(&places)
        };
        for (index, (x, y)) in kept.into_iter().enumerate() {
            let start = if index == 0 { 'M' } else { 'L' };
            let _ = write!(path, "{start}{x:.1} {y:.1}");
        }
        if *stroke == Stroke::Filled {
            let _ = writeln!(svg, "<path d=\"{path}Z\" fill=\"{colour}\" fill-opacity=\"0.35\"/>");
            return;
        }
        let dashes = if *stroke == Stroke::Dashed { " stroke-dasharray=\"6 4\"" } else { "" };
        let _ = writeln!(
            svg,
            "<path d=\"{path}\" stroke=\"{colour}\" stroke-width=\"1.3\" stroke-linejoin=\"round\"{dashes}/>"
        );
    }

    /// Names of lines and bands: above the frame where no title stands there, else in its upper
    /// right corner, on white.
    fn legend(&self, svg: &mut String) {
        let named = self.panel.lines.iter().filter(|line| !line.name.is_empty());
        let mut entries: Vec<(&str, String)> =
            named.map(|line| (line.name.as_str(), sample(line))).collect();
        let band =
            format!("<rect x=\"0\" y=\"-6\" width=\"20\" height=\"12\" fill=\"{BAND_COLOUR}\"/>");
        entries.extend(self.panel.bands.iter().map(|(.., name)| (name.as_str(), band.clone())));
        let longest = entries.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
        if longest == 0 {
            return;
        }
        if self.panel.title.is_empty() {
            let mut right = self.w;
            for (name, sample) in entries.into_iter().rev() {
                right -= CHARACTER_WIDTH * name.chars().count() as f64 + 40.0;
                let _ = writeln!(svg, "{}", legend_entry((right, -13.0), &sample, name));
            }
            return;
        }
        let width = CHARACTER_WIDTH * longest as f64 + 40.0;
        let (left, height) = (self.w - width - 6.0, LINE_HEIGHT * entries.len() as f64 + 6.0);
        let _ = writeln!(
            svg,
            "<rect x=\"{left:.1}\" y=\"6\" width=\"{width:.1}\" height=\"{height:.1}\" fill=\"#ffffff\" fill-opacity=\"0.85\"/>"
        );
        for (index, (name, sample)) in entries.into_iter().enumerate() {
            let y = 16.0 + LINE_HEIGHT * index as f64;
            let _ = writeln!(svg, "{}", legend_entry((left + 6.0, y), &sample, name));
        }
    }
}

/// The colour of a share, from white over blue to black: printed in grey it keeps its order.
fn shade(share: f64) -> String {
    let [red, green, blue] = [1.0, 0.85, 0.45].map(|part| 255.0 * (1.0 - share * part));
    format!("rgb({red:.0},{green:.0},{blue:.0})")
}

/// The shades of a map with the values of both ends, above the upper right corner of a frame of
/// width `w` (pixels).
fn colour_bar(svg: &mut String, w: f64, ends: &[String; 2]) {
    let left = w - CHARACTER_WIDTH * ends[1].chars().count() as f64 - COLOUR_BAR_WIDTH - 6.0;
    let step = COLOUR_BAR_WIDTH / f64::from(COLOUR_BAR_STEPS);
    let _ = writeln!(
        svg,
        "<text x=\"{:.1}\" y=\"-9\" text-anchor=\"end\" fill=\"#606060\">{}</text>\n\
         <text x=\"{w}\" y=\"-9\" text-anchor=\"end\" fill=\"#606060\">{}</text>",
        left - 6.0,
        escape(&ends[0]),
        escape(&ends[1])
    );
    for index in 0..COLOUR_BAR_STEPS {
        let _ = writeln!(
            svg,
            "<rect x=\"{:.1}\" y=\"-19\" width=\"{:.1}\" height=\"10\" fill=\"{}\"/>",
            left + step * f64::from(index),
            step + 0.1,
            shade(f64::from(index) / f64::from(COLOUR_BAR_STEPS - 1))
        );
    }
    let _ = writeln!(
        svg,
        "<rect x=\"{left:.1}\" y=\"-19\" width=\"{COLOUR_BAR_WIDTH}\" height=\"10\" fill=\"none\" stroke=\"#303030\" stroke-width=\"0.6\"/>"
    );
}

/// A piece of a line for the legend, 20 pixels long.
fn sample(line: &Polyline) -> String {
    let Polyline { colour, stroke, .. } = line;
    match stroke {
        Stroke::Dots => format!("<circle cx=\"10\" r=\"3.6\" fill=\"{colour}\"/>"),
        Stroke::Filled => {
            format!(
                "<rect y=\"-6\" width=\"20\" height=\"12\" fill=\"{colour}\" fill-opacity=\"0.35\"/>"
            )
        }
        Stroke::Solid => format!("<path d=\"M0 0h20\" stroke=\"{colour}\" stroke-width=\"1.6\"/>"),
        Stroke::Dashed => {
            format!(
                "<path d=\"M0 0h20\" stroke=\"{colour}\" stroke-width=\"1.6\" stroke-dasharray=\"6 4\"/>"
            )
        }
    }
}

/// Of all places within half a dot across the first, the highest, the lowest and the last: more
/// cannot be seen.
fn thinned(places: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut kept = Vec::new();
    for group in places.chunk_by(|a, b| (2.0 * a.0).floor() >= (2.0 * b.0).floor()) {
        if let ([first, _, _, _, .., last], Some(high), Some(low)) = (
            group,
            group.iter().min_by(|a, b| a.1.total_cmp(&b.1)),
            group.iter().max_by(|a, b| a.1.total_cmp(&b.1)),
        ) {
            let between = if high.0 <= low.0 { [high, low] } else { [low, high] };
            kept.extend([first, between[0], between[1], last]);
        } else {
            kept.extend(group);
        }
    }
    kept.dedup();
    kept.into_iter().copied().collect()
}
