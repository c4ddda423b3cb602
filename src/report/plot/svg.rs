//! A sheet as SVG, dark on white or light on dark.

use std::fmt::Write as _;
use std::sync::atomic::{AtomicU64, Ordering};

use super::{Plot, Series, Sheet, Stroke};
use crate::report::escape;

/// Room above and below a panel's frame (pixels).
const ABOVE: f64 = 14.0;
const BELOW: f64 = 50.0;
/// Room right of a frame without words beside it (pixels).
const RIGHT: f64 = 20.0;
/// Room above all panels for the title (pixels).
const TITLE_HEIGHT: f64 = 30.0;
/// Height of a line of text (pixels).
const LINE_HEIGHT: f64 = 16.0;
/// Size of text and of the title (pixels).
const FONT_SIZE: f64 = 12.0;
const TITLE_SIZE: f64 = 15.0;
/// Size of text where none is asked for, 12 pixels of 1/96 inch, in points (1).
const DEFAULT_POINTS: f64 = 9.0;
/// A point (m): 1/72 inch.
const POINT: f64 = 0.0254 / 72.0;
/// Height of a frame over its width where the width is asked for (1).
const ASPECT: f64 = 0.62;
/// Narrowest frame (pixels).
const MIN_FRAME: f64 = 120.0;
/// Panels stand side by side if their frames are at least this wide (pixels).
const MIN_COLUMN: f64 = 200.0;
/// Narrower frames have their legend above them, and their title above that (pixels).
const MIN_INNER_LEGEND: f64 = 320.0;
/// Length of ticks with and without a name (pixels).
const TICKS: (f64, f64) = (5.0, 3.0);
/// Length of a piece of a series in a legend with the gap behind it (pixels).
const SAMPLE: f64 = 26.0;
/// Gap between two entries of a legend (pixels).
const LEGEND_GAP: f64 = 14.0;
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

/// How a sheet is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Style {
    /// Colours.
    pub theme: Theme,
    /// Width of the whole picture; none for that of the sheet (m).
    pub width: Option<f64>,
    /// Size of its text in points, 1/72 inch (1).
    pub font_size: f64,
}

impl Default for Style {
    fn default() -> Self {
        Self { theme: Theme::default(), width: None, font_size: DEFAULT_POINTS }
    }
}

/// Width of `text` in the font of PNG and PDF, `DejaVu Sans`, which is wider than most (pixels).
fn text_width(text: &str) -> f64 {
    let share = |character: char| match character {
        'i' | 'j' | 'l' | '|' | '\'' | 'I' => 0.29,
        '.' | ',' | ' ' | ':' | ';' | '!' => 0.33,
        'f' | 't' | 'r' | '(' | ')' | '/' | '-' => 0.40,
        'm' | 'w' | 'M' | 'W' | '%' | '@' => 0.97,
        '+' | '=' | '<' | '>' | '±' | '−' | '∞' | '≤' | '≥' => 0.84,
        'A'..='Z' => 0.72,
        _ => 0.64,
    };
    FONT_SIZE * text.chars().map(share).sum::<f64>()
}

/// `text` with U+2212 for each hyphen that is the sign of a number.
pub fn with_minus_signs(text: &str) -> String {
    let characters: Vec<char> = text.chars().collect();
    let at = |index: usize| characters.get(index).copied().unwrap_or(' ');
    let is_sign = |index: usize| {
        let before = index.checked_sub(1).map_or(' ', at);
        let is_exponent = before == 'e' && index >= 2 && at(index - 2).is_ascii_digit();
        at(index + 1).is_ascii_digit() && (is_exponent || matches!(before, ' ' | '(' | '[' | '/'))
    };
    let typeset = |(index, c): (usize, &char)| if *c == '-' && is_sign(index) { '−' } else { *c };
    characters.iter().enumerate().map(typeset).collect()
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
        let (colour, words) = (self.theme.colour(colour), escape(&with_minus_signs(words)));
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
            pen.text((SAMPLE, 4.0), "start", TEXT, &series.name);
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

/// The picture of `sheet` at its own size.
pub fn svg(sheet: &Sheet, theme: Theme) -> String {
    svg_in_style(sheet, &Style { theme, ..Style::default() })
}

/// The picture of `sheet`; its size is in millimetres if a width or a font size is asked for.
pub fn svg_in_style(sheet: &Sheet, style: &Style) -> String {
    let Layout { left, right, w, h, columns, places, below_panels } = Layout::of(sheet, style);
    let width = (left + w + right) * columns as f64;
    let entries: Vec<&Series> = sheet.legend.iter().collect();
    // Below names of rows there is room.
    let legend_left = if is_of_rows(sheet) { 8.0 } else { left };
    let legend = flow(&entries, width - legend_left - 8.0);
    let notes = f64::from(u8::from(!sheet.note.is_empty()));
    let line = 1.25 * LINE_HEIGHT;
    let height = below_panels + line * (rows_of(&legend) + notes);
    let mut pen = Pen { svg: String::new(), theme: style.theme };
    let size = if *style == (Style { theme: style.theme, ..Style::default() }) {
        String::new()
    } else {
        // What is too wide for a narrow picture makes its text smaller.
        let pixel = style.width.map_or(POINT * style.font_size / FONT_SIZE, |asked| asked / width);
        format!(" width=\"{:.3}mm\" height=\"{:.3}mm\"", 1e3 * pixel * width, 1e3 * pixel * height)
    };
    pen.line(format_args!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\"{size} viewBox=\"0 0 {width:.2} {height:.2}\" font-family=\"DejaVu Sans, Verdana, sans-serif\" font-size=\"{FONT_SIZE}\">"
    ));
    let ground = pen.fill(GROUND);
    pen.rect((0.0, 0.0), (width, height), &ground);
    if !sheet.title.is_empty() {
        let (text, title) = (style.theme.colour(TEXT), escape(&with_minus_signs(&sheet.title)));
        let room = (width - left - 6.0) * FONT_SIZE / text_width(&sheet.title);
        let size = TITLE_SIZE.min(room);
        pen.line(format_args!(
            "<text x=\"{left:.1}\" y=\"20\" font-size=\"{size:.2}\" fill=\"{text}\">{title}</text>"
        ));
    }
    for (panel, Placed { place, has_abscissa, has_legend }) in sheet.panels.iter().zip(places) {
        let drawing = Drawing { panel, w, h, left, has_abscissa, has_legend };
        pen.group(place, |pen| drawing.draw(pen));
    }
    for (series, (x, row)) in entries.iter().zip(&legend) {
        pen.legend_entry((legend_left + x, below_panels + line * row), series);
    }
    pen.text((left, below_panels + line * rows_of(&legend)), "start", NOTE, &sheet.note);
    pen.line(format_args!("</svg>"));
    pen.svg
}

/// Whether the ordinates of a sheet count named rows.
fn is_of_rows(sheet: &Sheet) -> bool {
    sheet.panels.iter().all(|panel| panel.y.label.is_empty())
}

/// Sizes and places of a sheet's parts (pixels).
struct Layout {
    left: f64,
    right: f64,
    w: f64,
    h: f64,
    columns: usize,
    places: Vec<Placed>,
    below_panels: f64,
}

/// A panel in its place.
struct Placed {
    /// Upper left corner of its frame (pixels).
    place: (f64, f64),
    /// Whether its abscissa has names; panels above one another share those of the lowest.
    has_abscissa: bool,
    /// Whether it has a legend; the same names are shown once.
    has_legend: bool,
}

impl Layout {
    fn of(sheet: &Sheet, style: &Style) -> Self {
        let mut columns = sheet.columns.clamp(1, sheet.panels.len().max(1));
        let (left, right) = side_margins(sheet);
        let (mut w, mut h) = sheet.size;
        if let Some(width) = style.width {
            let pixel = POINT * style.font_size / FONT_SIZE;
            let frame = |columns: usize| width / pixel / columns as f64 - left - right;
            if frame(columns) < MIN_COLUMN {
                columns = 1;
            }
            w = frame(columns).max(MIN_FRAME);
            // A wide frame keeps the sheet's shape.
            let shaped = (w * sheet.size.1 / sheet.size.0).max(h.min(ASPECT * w));
            h = if is_of_rows(sheet) { h } else { shaped };
        }
        let mut places = Vec::new();
        let mut y = if sheet.title.is_empty() { 0.0 } else { TITLE_HEIGHT };
        let mut shown: Vec<Series> = Vec::new();
        for (row, panels) in sheet.panels.chunks(columns).enumerate() {
            let next = sheet.panels.get((row + 1) * columns);
            let shares = |panel: &Plot| columns == 1 && next.is_some_and(|next| next.x == panel.x);
            let has_abscissa = !panels.first().is_some_and(shares);
            let legends: Vec<Vec<Series>> = panels.iter().map(legend_entries).collect();
            let is_new = |legend: &Vec<Series>| columns > 1 || *legend != shown;
            let has_legend: Vec<bool> = legends.iter().map(is_new).collect();
            let above = |((panel, legend), has): ((&Plot, &Vec<Series>), &bool)| {
                let map = map_height(panel);
                let legend: Vec<&Series> = legend.iter().filter(|_| *has).collect();
                let rows = rows_of(&flow(&legend, w));
                let marks = Drawing::named_marks(panel, w).len() as f64;
                let title = f64::from(u8::from(!panel.title.is_empty()));
                let above = if has_inner_legend(panel, w) {
                    LINE_HEIGHT
                } else {
                    map + LINE_HEIGHT * (rows + title)
                };
                ABOVE + above + LINE_HEIGHT * marks
            };
            let rooms = panels.iter().zip(&legends).zip(&has_legend).map(above);
            y += rooms.fold(ABOVE, f64::max);
            for (column, has_legend) in has_legend.into_iter().enumerate() {
                let place = (left + (left + w + right) * column as f64, y);
                places.push(Placed { place, has_abscissa, has_legend });
            }
            y += h + if has_abscissa { BELOW } else { 0.0 };
            shown = legends.into_iter().next().unwrap_or_default();
        }
        Self { left, right, w, h, columns, places, below_panels: y }
    }
}

/// Places of a legend's entries, as many in a row as fit into `width`: abscissa (pixels) and row.
fn flow(entries: &[&Series], width: f64) -> Vec<(f64, f64)> {
    let (mut x, mut row) = (0.0, 0.0);
    let place = |entry: &&Series| {
        let wide = SAMPLE + text_width(&entry.name);
        if x > 0.0 && x + wide > width {
            (x, row) = (0.0, row + 1.0);
        }
        let place = (x, row);
        x += wide + LEGEND_GAP;
        place
    };
    entries.iter().map(place).collect()
}

/// Whether a panel's legend lies in its frame of this width (pixels).
fn has_inner_legend(panel: &Plot, w: f64) -> bool {
    !panel.title.is_empty() && w >= MIN_INNER_LEGEND
}

/// Height of the bar of a map's shades above its frame (pixels).
fn map_height(panel: &Plot) -> f64 {
    if panel.map.is_some() { LINE_HEIGHT } else { 0.0 }
}

/// `f1, the gap's lower edge: 7.1 kHz` as `f1: 7.1 kHz`.
fn shortened(name: &str) -> String {
    match (name.split_once(", "), name.rsplit_once(": ")) {
        (Some((first, _)), Some((_, last))) => format!("{first}: {last}"),
        _ => name.to_owned(),
    }
}

/// Number of rows of a legend (1).
fn rows_of(places: &[(f64, f64)]) -> f64 {
    places.last().map_or(0.0, |(_, row)| row + 1.0)
}

/// Named series and bands of a panel, without their points.
fn legend_entries(panel: &Plot) -> Vec<Series> {
    let bands = panel.bands.iter();
    let bands = bands.map(|(.., name)| Series::new(name, Vec::new(), BAND, Stroke::Bars));
    let lines = panel.lines.iter().map(|line| Series { points: Vec::new(), ..line.clone() });
    lines.chain(bands).filter(|entry| !entry.name.is_empty()).collect()
}

/// Room left and right of the frames, for the names beside them (pixels).
fn side_margins(sheet: &Sheet) -> (f64, f64) {
    fn longest<'a>(names: impl Iterator<Item = &'a String>) -> f64 {
        names.map(|name| text_width(name)).fold(0.0, f64::max)
    }
    let left = longest(sheet.panels.iter().flat_map(|p| &p.y.ticks).map(|(_, name)| name));
    let label = if sheet.panels.iter().any(|p| !p.y.label.is_empty()) { 26.0 } else { 8.0 };
    let right = longest(sheet.panels.iter().flat_map(|p| &p.beside).map(|(_, name)| name));
    (left + 8.0 + label, if right > 0.0 { right + 16.0 } else { RIGHT })
}

struct Drawing<'a> {
    panel: &'a Plot,
    w: f64,
    h: f64,
    /// Room left of the frame (pixels).
    left: f64,
    has_abscissa: bool,
    has_legend: bool,
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
        let marks_height = self.marks_height();
        let below_title = if has_inner_legend(panel, *w) { 0.0 } else { self.legend_height() };
        pen.text((0.0, -9.0 - marks_height - below_title), "start", TEXT, &panel.title);
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
        let mut beside: Vec<(f64, &String)> =
            panel.beside.iter().map(|(y, words)| (self.y(*y), words)).collect();
        beside.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut free = f64::NEG_INFINITY;
        for (y, words) in beside {
            let y = y.max(free);
            pen.text((w + 8.0, y + 4.0), "start", WORDS, words);
            free = y + FONT_SIZE + 1.0;
        }
        self.marks(pen);
        if self.has_legend {
            self.legend(pen);
        }
    }

    /// Marks whose names are shown, from the left, each with its place (pixels). Names that have no
    /// room right of their line are shortened.
    fn named_marks(panel: &Plot, w: f64) -> Vec<(f64, String)> {
        let marks = panel.marks.iter().map(|(at, name)| (w * panel.x.share(*at), name));
        let shown = marks.filter(|(x, name)| (0.0..=w).contains(x) && !name.is_empty());
        let fitting = |(x, name): (f64, &String)| {
            let fits = x + 4.0 + text_width(name) <= w;
            (x, if fits { name.clone() } else { shortened(name) })
        };
        let mut shown: Vec<(f64, String)> = shown.map(fitting).collect();
        shown.sort_by(|a, b| a.0.total_cmp(&b.0));
        shown
    }

    /// Names of the marks above the frame, where no data are, a row for each.
    fn marks(&self, pen: &mut Pen) {
        let marks = Self::named_marks(self.panel, self.w);
        let rows = || (0..marks.len()).rev().map(|row| -5.0 - LINE_HEIGHT * row as f64);
        for ((x, _), y) in marks.iter().zip(rows()) {
            pen.path(&format!("M{x:.1} 0V{:.1}", y - 10.0), MARK, 0.8, false);
        }
        for ((x, name), y) in marks.iter().zip(rows()) {
            let start = (x + 4.0).min(self.w - text_width(name)).max(0.0);
            let ground = pen.fill(GROUND);
            pen.rect((start - 2.0, y - 11.0), (text_width(name) + 2.0, 14.0), &ground);
            pen.text((start, y), "start", WORDS, name);
        }
    }

    /// Height of legend and shades above a frame that has no room for them (pixels).
    fn legend_height(&self) -> f64 {
        let entries = legend_entries(self.panel);
        let entries: Vec<&Series> = entries.iter().filter(|_| self.has_legend).collect();
        map_height(self.panel) + LINE_HEIGHT * rows_of(&flow(&entries, self.w))
    }

    /// Height of the marks' names above the frame (pixels).
    fn marks_height(&self) -> f64 {
        LINE_HEIGHT * Self::named_marks(self.panel, self.w).len() as f64
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
        let Self { panel, w, h, left, .. } = self;
        let inside = |at: f64, length: f64| (-0.01..=length + 0.01).contains(&at);
        let length = |name: &str| if name.is_empty() { TICKS.1 } else { TICKS.0 };
        let mut free = f64::NEG_INFINITY;
        for (value, name) in &panel.x.ticks {
            let at = self.x(*value);
            if !inside(at, *w) {
                continue;
            }
            let tick = length(name);
            pen.path(
                &format!("M{at:.1} {h:.1}V{:.1}M{at:.1} 0V{tick}", h - tick),
                WORDS,
                0.8,
                false,
            );
            // Names that would touch the one before are left out.
            let half = 0.5 * text_width(name);
            if self.has_abscissa && at - half > free {
                pen.text((at, h + 17.0), "middle", TEXT, name);
                free = at + half + 4.0;
            }
        }
        let is_of_rows = panel.y.label.is_empty();
        let mut free = f64::INFINITY;
        for (value, name) in &panel.y.ticks {
            let at = self.y(*value);
            if !inside(at, *h) {
                continue;
            }
            if !is_of_rows {
                let tick = length(name);
                let ticks = format!("M0 {at:.1}H{tick}M{w:.1} {at:.1}H{:.1}", w - tick);
                pen.path(&ticks, WORDS, 0.8, false);
            }
            if is_of_rows || at + 6.0 < free {
                pen.text((-7.0, at + 4.0), "end", TEXT, name);
                free = at - 6.0;
            }
        }
        let zero = self.y(0.0);
        if !is_of_rows && panel.y.from < 0.0 && inside(zero, *h) {
            pen.path(&format!("M0 {zero:.1}H{w:.1}"), GRID, 0.8, false);
        }
        let fitted = |label: &str, room: f64| FONT_SIZE.min(room * FONT_SIZE / text_width(label));
        let label = |pen: &mut Pen, label: &str, place: &str, room: f64| {
            let (text, size) = (pen.theme.colour(TEXT), fitted(label, room));
            let size =
                if size < FONT_SIZE { format!(" font-size=\"{size:.2}\"") } else { String::new() };
            let label = escape(&with_minus_signs(label));
            pen.line(format_args!(
                "<text {place} text-anchor=\"middle\"{size} fill=\"{text}\">{label}</text>"
            ));
        };
        let below = format!("x=\"{:.1}\" y=\"{:.1}\"", 0.5 * w, h + 36.0);
        if self.has_abscissa {
            label(pen, &panel.x.label, &below, w + 2.0 * RIGHT);
        }
        if !is_of_rows {
            let (x, y) = (16.0 - left, 0.5 * h);
            let beside = format!("transform=\"translate({x:.1} {y:.1}) rotate(-90)\"");
            label(pen, &panel.y.label, &beside, h + BELOW);
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
        let entries = legend_entries(panel);
        if !has_inner_legend(panel, self.w) {
            let flowed: Vec<&Series> = entries.iter().collect();
            let places = flow(&flowed, self.w);
            let rows = rows_of(&places);
            let below = self.marks_height() + map_height(panel);
            for (entry, (x, row)) in entries.iter().zip(&places) {
                let y = -13.0 - below - LINE_HEIGHT * (rows - 1.0 - row);
                pen.legend_entry((*x, y), entry);
            }
            return;
        }
        let width = |entry: &Series| SAMPLE + text_width(&entry.name) + LEGEND_GAP;
        let widest = entries.iter().map(width).fold(0.0, f64::max);
        if entries.is_empty() {
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
    let left = w - text_width(&ends[1]) - COLOUR_BAR_WIDTH - 6.0;
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
