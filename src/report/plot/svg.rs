//! A sheet as SVG, dark on white or light on dark.

use std::fmt::Write as _;
use std::sync::atomic::{AtomicU64, Ordering};

use super::{Plot, Series, Sheet, Stroke};
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
/// Height of a bar, as a share of a row (1).
const BAR_SHARE: f64 = 0.65;
/// Colours on white: background, text, words, frame, grid, shaded bands.
const GROUND: &str = "#ffffff";
const TEXT: &str = "#000000";
const WORDS: &str = "#303030";
const NOTE: &str = "#606060";
const GRID: &str = "#d8d8d8";
const BAND: &str = "#efe6d2";
const MARK: &str = super::MARK_COLOUR;
/// Darkest and lightest grey of a dark picture, of 255.
const DARK_ENDS: (f64, f64) = (16.0, 228.0);

/// Colours of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum Theme {
    /// Dark on white
    #[default]
    Light,
    /// Light on dark, for slides
    Dark,
}

impl Theme {
    /// The colour, `#rrggbb` on white, in this theme. On dark its lightness `L` is `1 - L` (HSL) at
    /// the same hue and saturation, `c + 1 - max - min` for each part, scaled to the theme's ends.
    fn colour(self, on_white: &str) -> String {
        let digits = on_white.trim_start_matches('#');
        let number = u32::from_str_radix(digits, 16).unwrap_or_default();
        self.rgb([16, 8, 0].map(|shift| f64::from((number >> shift) & 255)))
    }

    fn rgb(self, parts: [f64; 3]) -> String {
        let high = parts.into_iter().fold(0.0, f64::max);
        let low = parts.into_iter().fold(255.0, f64::min);
        let (dark, light) = DARK_ENDS;
        let [red, green, blue] = match self {
            Self::Light => parts,
            Self::Dark => {
                parts.map(|part| dark + (light - dark) * (part + 255.0 - high - low) / 255.0)
            }
        }
        .map(|part| part.round() as u8);
        format!("#{red:02x}{green:02x}{blue:02x}")
    }
}

/// A picture being written.
struct Pen {
    svg: String,
    theme: Theme,
}

impl Pen {
    fn line(&mut self, element: std::fmt::Arguments<'_>) {
        // Writing to a String cannot fail.
        let _ = writeln!(self.svg, "{element}");
    }

    fn text(&mut self, (x, y): (f64, f64), anchor: &str, colour: &str, words: &str) {
        if words.is_empty() {
            return;
        }
        let (colour, words) = (self.theme.colour(colour), escape(words));
        let anchor =
            if anchor == "start" { String::new() } else { format!(" text-anchor=\"{anchor}\"") };
        self.line(format_args!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\"{anchor} fill=\"{colour}\">{words}</text>"
        ));
    }

    fn rect(&mut self, (x, y): (f64, f64), (width, height): (f64, f64), style: &str) {
        self.line(format_args!(
            "<rect x=\"{x:.2}\" y=\"{y:.2}\" width=\"{width:.2}\" height=\"{height:.2}\"{style}/>"
        ));
    }

    fn fill(&self, colour: &str) -> String {
        format!(" fill=\"{}\"", self.theme.colour(colour))
    }

    fn path(&mut self, path: &str, colour: &str, width: f64, dashes: bool) {
        let colour = self.theme.colour(colour);
        let dashes = if dashes { " stroke-dasharray=\"6 4\"" } else { "" };
        self.line(format_args!(
            "<path d=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"{dashes}/>"
        ));
    }

    fn group(&mut self, (x, y): (f64, f64), content: impl FnOnce(&mut Self)) {
        self.line(format_args!("<g transform=\"translate({x:.1} {y:.1})\">"));
        content(self);
        self.line(format_args!("</g>"));
    }

    /// A piece of a series with its name.
    fn legend_entry(&mut self, place: (f64, f64), series: &Series) {
        self.group(place, |pen| {
            pen.sample(series);
            pen.text((26.0, 4.0), "start", TEXT, &series.name);
        });
    }

    /// A piece of a series, 20 pixels long.
    fn sample(&mut self, series: &Series) {
        let fill = self.fill(series.colour);
        match series.stroke {
            Stroke::Dots => self.line(format_args!("<circle cx=\"10\" r=\"3.6\"{fill}/>")),
            Stroke::Bars => self.rect((0.0, -6.0), (20.0, 12.0), &fill),
            Stroke::Filled => {
                self.rect((0.0, -6.0), (20.0, 12.0), &format!("{fill} fill-opacity=\"0.35\""));
            }
            Stroke::Solid | Stroke::Dashed => {
                let dashed = series.stroke == Stroke::Dashed;
                self.path("M0 0h20", series.colour, 1.6, dashed);
            }
        }
    }
}

/// Numbers of clip paths: several pictures may share one HTML page, and with it their names.
static CLIP_NUMBER: AtomicU64 = AtomicU64::new(1);

/// The picture of `sheet`.
pub fn svg(sheet: &Sheet, theme: Theme) -> String {
    let (_, _, above, below) = MARGINS;
    let (left, right) = side_margins(sheet);
    let (w, h) = sheet.size;
    let columns = sheet.columns.clamp(1, sheet.panels.len().max(1));
    let rows = sheet.panels.len().div_ceil(columns);
    let (across, down) = (left + w + right, above + h + below);
    let below_panels = TITLE_HEIGHT + down * rows as f64;
    let legend_rows = sheet.legend.len().div_ceil(columns) + usize::from(!sheet.note.is_empty());
    let width = across * columns as f64;
    let height = below_panels + 1.25 * LINE_HEIGHT * legend_rows as f64;
    let mut pen = Pen { svg: String::new(), theme };
    pen.line(format_args!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"12\">"
    ));
    let ground = pen.fill(GROUND);
    pen.rect((0.0, 0.0), (width, height), &ground);
    let (text, title) = (theme.colour(TEXT), escape(&sheet.title));
    pen.line(format_args!(
        "<text x=\"{left}\" y=\"22\" font-size=\"15\" fill=\"{text}\">{title}</text>"
    ));
    let place = |index: usize, step: f64, first: f64| {
        let (row, column) = (index / columns, index % columns);
        (left + across * column as f64, first + step * row as f64)
    };
    for (index, panel) in sheet.panels.iter().enumerate() {
        pen.group(place(index, down, TITLE_HEIGHT + above), |pen| {
            Drawing { panel, w, h, left }.draw(pen);
        });
    }
    let line = 1.25 * LINE_HEIGHT;
    for (index, series) in sheet.legend.iter().enumerate() {
        pen.legend_entry(place(index, line, below_panels), series);
    }
    let last = place(sheet.legend.len().next_multiple_of(columns), line, below_panels);
    pen.text(last, "start", NOTE, &sheet.note);
    pen.line(format_args!("</svg>"));
    pen.svg
}

/// Room left and right of the frames, wider where names of rows need it (pixels).
fn side_margins(sheet: &Sheet) -> (f64, f64) {
    fn longest<'a>(names: impl Iterator<Item = &'a String>) -> f64 {
        CHARACTER_WIDTH * names.map(|name| name.chars().count()).max().unwrap_or(0) as f64
    }
    let left = longest(sheet.panels.iter().flat_map(|p| &p.y.ticks).map(|(_, name)| name));
    let right = longest(sheet.panels.iter().flat_map(|p| &p.beside).map(|(_, name)| name));
    ((left + 24.0).max(MARGINS.0), (right + 24.0).max(MARGINS.1))
}

struct Drawing<'a> {
    panel: &'a Plot,
    w: f64,
    h: f64,
    /// Room left of the frame (pixels).
    left: f64,
}

impl Drawing<'_> {
    fn x(&self, value: f64) -> f64 {
        self.w * self.panel.x.share(value)
    }

    fn y(&self, value: f64) -> f64 {
        self.h * (1.0 - self.panel.y.share(value))
    }

    fn draw(&self, pen: &mut Pen) {
        let Self { panel, w, h, .. } = self;
        let clip = CLIP_NUMBER.fetch_add(1, Ordering::Relaxed);
        pen.line(format_args!(
            "<clipPath id=\"c{clip}\"><rect width=\"{w}\" height=\"{h}\"/></clipPath>"
        ));
        pen.text((0.0, -9.0), "start", TEXT, &panel.title);
        self.background(pen);
        self.axes(pen);
        pen.line(format_args!("<g clip-path=\"url(#c{clip})\">"));
        for series in &panel.lines {
            self.series(pen, series);
        }
        for (place, _) in &panel.marks {
            pen.path(&format!("M{:.1} 0V{h}", self.x(*place)), MARK, 1.3, true);
        }
        pen.line(format_args!("</g>"));
        let frame = format!(" fill=\"none\" stroke=\"{}\"", pen.theme.colour(WORDS));
        pen.rect((0.0, 0.0), (*w, *h), &frame);
        for (x, y, words) in &panel.words {
            pen.text((self.x(*x), self.y(*y)), "start", WORDS, words);
        }
        for (y, words) in &panel.beside {
            pen.text((w + 8.0, self.y(*y) + 4.0), "start", WORDS, words);
        }
        let shown = panel.marks.iter().filter(|(place, _)| (0.0..=*w).contains(&self.x(*place)));
        // Each name is a line lower, so that marks close to each other stay readable.
        for ((place, name), row) in shown.zip(1_u32..) {
            let y = f64::from(row) * LINE_HEIGHT;
            pen.text((self.x(*place) + 4.0, y), "start", WORDS, name);
        }
        self.legend(pen);
    }

    fn background(&self, pen: &mut Pen) {
        let Self { panel, w, h, .. } = self;
        if let Some(map) = &panel.map {
            pen.line(format_args!("<g shape-rendering=\"crispEdges\">"));
            let wide = w / map.columns.len().max(1) as f64;
            for (column, shares) in map.columns.iter().enumerate() {
                let high = h / shares.len().max(1) as f64;
                for (row, share) in shares.iter().enumerate().filter(|(_, share)| **share > 0.0) {
                    let place = (wide * column as f64, h - high * (row + 1) as f64);
                    let fill = shade(pen.theme, *share);
                    pen.rect(place, (wide + 0.05, high + 0.05), &fill);
                }
            }
            pen.line(format_args!("</g>"));
            colour_bar(pen, *w, &map.shades);
        }
        let band = pen.fill(BAND);
        for (from, to, _) in &panel.bands {
            let (x0, x1) = (self.x(*from).max(0.0), self.x(*to).min(*w));
            pen.rect((x0, 0.0), ((x1 - x0).max(0.0), *h), &band);
        }
    }

    fn axes(&self, pen: &mut Pen) {
        let Self { panel, w, h, left } = self;
        let inside = |at: f64, length: f64| (-0.01..=length + 0.01).contains(&at);
        for (value, name) in &panel.x.ticks {
            let at = self.x(*value);
            if inside(at, *w) {
                pen.path(&format!("M{at:.1} 0V{h}"), GRID, 0.6, false);
                pen.text((at, h + 17.0), "middle", TEXT, name);
            }
        }
        for (value, name) in &panel.y.ticks {
            let at = self.y(*value);
            if inside(at, *h) {
                pen.path(&format!("M0 {at:.1}H{w}"), GRID, 0.6, false);
                pen.text((-7.0, at + 4.0), "end", TEXT, name);
            }
        }
        pen.text((0.5 * w, h + 36.0), "middle", TEXT, &panel.x.label);
        if !panel.y.label.is_empty() {
            let (text, label) = (pen.theme.colour(TEXT), escape(&panel.y.label));
            pen.line(format_args!(
                "<text transform=\"translate({:.1} {:.1}) rotate(-90)\" text-anchor=\"middle\" fill=\"{text}\">{label}</text>",
                20.0 - left,
                0.5 * h
            ));
        }
    }

    fn series(&self, pen: &mut Pen, series: &Series) {
        let place = |(x, y): &(f64, f64)| (self.x(*x), self.y(*y));
        let places: Vec<(f64, f64)> =
            series.points.iter().map(place).filter(|(_, y)| y.is_finite()).collect();
        let fill = pen.fill(series.colour);
        match series.stroke {
            Stroke::Dots => {
                for (x, y) in places {
                    // What is beyond an end of the abscissa is at that end.
                    let x = x.clamp(0.0, self.w);
                    pen.line(format_args!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.6\"{fill}/>"));
                }
            }
            Stroke::Bars => {
                let height = BAR_SHARE * self.h / self.panel.y.ticks.len().max(1) as f64;
                for pair in places.chunks_exact(2) {
                    let [(x0, y), (x1, _)] = [pair[0], pair[1]];
                    pen.rect((x0, y - 0.5 * height), ((x1 - x0).max(0.0), height), &fill);
                }
            }
            Stroke::Filled => {
                // The upper edge comes back from the right.
                let (low, high) = places.split_at(places.len() / 2);
                let forward: Vec<(f64, f64)> = high.iter().rev().copied().collect();
                let edges = thinned(low).into_iter().chain(thinned(&forward).into_iter().rev());
                let path = path(edges);
                pen.line(format_args!("<path d=\"{path}Z\"{fill} fill-opacity=\"0.35\"/>"));
            }
            Stroke::Solid | Stroke::Dashed => {
                let dashed = series.stroke == Stroke::Dashed;
                let path = path(thinned(&places).into_iter());
                pen.path(&path, series.colour, 1.3, dashed);
            }
        }
    }

    /// Names of series and bands: above the frame if the panel has no title, else in its upper
    /// right corner, on the background's colour.
    fn legend(&self, pen: &mut Pen) {
        let panel = self.panel;
        let bands = panel.bands.iter();
        let bands = bands.map(|(.., name)| Series::new(name, Vec::new(), BAND, Stroke::Bars));
        let mut entries: Vec<Series> = panel
            .lines
            .iter()
            .map(|line| Series { points: Vec::new(), ..line.clone() })
            .chain(bands)
            .collect();
        entries.retain(|entry| !entry.name.is_empty());
        let width = |entry: &Series| CHARACTER_WIDTH * entry.name.chars().count() as f64 + 40.0;
        let widest = entries.iter().map(width).fold(0.0, f64::max);
        if entries.is_empty() {
            return;
        }
        if panel.title.is_empty() {
            let mut right = self.w;
            for entry in entries.iter().rev() {
                right -= width(entry);
                pen.legend_entry((right, -13.0), entry);
            }
            return;
        }
        let (left, height) = (self.w - widest - 6.0, LINE_HEIGHT * entries.len() as f64 + 6.0);
        let ground = format!("{} fill-opacity=\"0.85\"", pen.fill(GROUND));
        pen.rect((left, 6.0), (widest, height), &ground);
        for (index, entry) in entries.iter().enumerate() {
            pen.legend_entry((left + 6.0, 16.0 + LINE_HEIGHT * index as f64), entry);
        }
    }
}

fn path(places: impl Iterator<Item = (f64, f64)>) -> String {
    let mut path = String::new();
    for (x, y) in places {
        let start = if path.is_empty() { 'M' } else { 'L' };
        let _ = write!(path, "{start}{x:.1} {y:.1}");
    }
    path
}

/// The fill of a share, from the background over blue to the text's colour: printed in grey it
/// keeps its order.
fn shade(theme: Theme, share: f64) -> String {
    let parts = [1.0, 0.85, 0.45].map(|part| 255.0 * (1.0 - share * part));
    format!(" fill=\"{}\"", theme.rgb(parts))
}

/// The shades of a map with the values of both ends, above the upper right corner of a frame of
/// width `w` (pixels).
fn colour_bar(pen: &mut Pen, w: f64, ends: &[String; 2]) {
    let left = w - CHARACTER_WIDTH * ends[1].chars().count() as f64 - COLOUR_BAR_WIDTH - 6.0;
    let step = COLOUR_BAR_WIDTH / f64::from(COLOUR_BAR_STEPS);
    pen.text((left - 6.0, -9.0), "end", NOTE, &ends[0]);
    pen.text((w, -9.0), "end", NOTE, &ends[1]);
    for index in 0..COLOUR_BAR_STEPS {
        let fill = shade(pen.theme, f64::from(index) / f64::from(COLOUR_BAR_STEPS - 1));
        pen.rect((left + step * f64::from(index), -19.0), (step + 0.1, 10.0), &fill);
    }
    let frame = format!(" fill=\"none\" stroke=\"{}\"", pen.theme.colour(WORDS));
    pen.rect((left, -19.0), (COLOUR_BAR_WIDTH, 10.0), &frame);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::plot::Axis;

    /// By hand: white and black become the ends; 0, 114, 178 become 77, 191, 255, then between the
    /// ends.
    #[test]
    fn hues_stay_and_lightness_is_inverted_on_dark() {
        for (on_white, on_dark) in
            [("#000000", "#e4e4e4"), ("#ffffff", "#101010"), ("#0072b2", "#50afe4")]
        {
            assert_eq!(Theme::Dark.colour(on_white), on_dark);
            assert_eq!(Theme::Light.colour(on_white), on_white);
        }
    }

    /// Bars of half and a quarter of 0 to 1 on a frame of 440 pixels.
    #[test]
    fn bars_are_as_long_as_their_shares() {
        let mut plot = Plot::of_rows(Axis::linear("share", 0.0, 1.0), ["one".to_owned()]);
        for (from, to, colour) in [(0.0, 0.5, "#0072b2"), (0.5, 0.75, "#d55e00")] {
            let points = vec![(from, 0.0), (to, 0.0)];
            plot.lines.push(Series::new("bar", points, colour, Stroke::Bars));
        }
        let picture = svg(&Sheet::rows("bars", plot), Theme::Light);
        for bar in [
            "x=\"0.00\" y=\"3.50\" width=\"220.00\" height=\"13.00\" fill=\"#0072b2\"",
            "x=\"220.00\" y=\"3.50\" width=\"110.00\" height=\"13.00\" fill=\"#d55e00\"",
        ] {
            assert!(picture.contains(bar), "{bar}: {picture}");
        }
    }

    /// Both edges of an area keep their waves: each is thinned by itself, from left to right.
    #[test]
    fn an_area_has_two_edges() {
        let wave = |by: f64| -> Vec<(f64, f64)> {
            (0..5000).map(|i| (f64::from(i), by + (f64::from(i) / 300.0).sin())).collect()
        };
        let plot = Plot::fitted(
            ["time", "s"],
            ["force", "N"],
            vec![Series::area("95 %", &wave(-0.5), &wave(0.5))],
        );
        let picture = svg(&Sheet::stack("an area", vec![plot]), Theme::Light);
        let area = picture.lines().find(|line| line.contains("Z\"")).expect("an area");
        let places =
            area.split(['M', 'L']).filter_map(|place| place.split('Z').next()?.split_once(' '));
        let mut heights: Vec<f64> =
            places.filter_map(|(_, y)| y.split('"').next()?.parse().ok()).collect();
        heights.dedup();
        let turns = heights.windows(3).filter(|h| (h[1] - h[0]) * (h[2] - h[1]) < 0.0).count();
        // 5000 samples of a wave of 2 pi 300 samples have five extremes on each edge.
        assert!((8..=12).contains(&turns), "{turns}");
    }

    #[test]
    fn pictures_of_one_page_have_clip_paths_of_their_own() {
        let sheet = Sheet::stack("左", vec![Plot::fitted(["x", ""], ["y", ""], Vec::new())]);
        let id = |picture: String| {
            let (_, rest) = picture.split_once("clipPath id=\"").expect("a clip path");
            rest.split('"').next().unwrap_or_default().to_owned()
        };
        assert_ne!(id(svg(&sheet, Theme::Light)), id(svg(&sheet, Theme::Light)));
    }
}
