//! Text of an SVG picture as outlines of its letters, so that the renderer needs no font.
//!
//! It reads the pictures that this program writes: a `<text>` holds words and no further elements,
//! has one `x`, one `y` and a font size of its own or the picture's, and `text-anchor` is an
//! attribute of the `<text>` itself. Letters are set side by side, by the advance widths of the
//! font, which has no kerning.

use std::fmt::Write as _;

use ttf_parser::{Face, GlyphId, OutlineBuilder};

/// Font of all text; `assets/fonts/LICENSE` says which characters it holds.
pub(super) const FONT: &[u8] = include_bytes!("../../assets/fonts/DejaVuSans.ttf");
/// Size of text where neither the text nor the picture names one, as in CSS (pixels).
const DEFAULT_SIZE: f32 = 16.0;

/// The picture `svg` with a `<path>` in place of every `<text>`.
///
/// # Errors
/// The problem with the built-in font.
pub fn outline_text(svg: &str) -> Result<String, ttf_parser::FaceParsingError> {
    let face = Face::parse(FONT, 0)?;
    let picture_size = svg
        .split_once("<svg")
        .and_then(|(_, rest)| rest.split_once('>'))
        .and_then(|(attributes, _)| number(attributes, "font-size"))
        .unwrap_or(DEFAULT_SIZE);
    let (mut outlined, mut rest) = (String::with_capacity(4 * svg.len()), svg);
    while let Some((before, attributes, words, after)) = next_text(rest) {
        outlined.push_str(before);
        push_path(&mut outlined, &face, attributes, &unescape(words), picture_size);
        rest = after;
    }
    outlined.push_str(rest);
    Ok(outlined)
}

/// Splits `svg` at its first text: what precedes it, its attributes, its words, what follows.
fn next_text(svg: &str) -> Option<(&str, &str, &str, &str)> {
    let (before, text) = svg.split_once("<text")?;
    let (attributes, text) = text.split_once('>')?;
    let (words, after) = text.split_once("</text>")?;
    Some((before, attributes, words, after))
}

/// Value of the attribute `name`.
fn value<'a>(attributes: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) = attributes.split_once(&format!(" {name}=\""))?;
    rest.split_once('"').map(|(value, _)| value)
}

fn number(attributes: &str, name: &str) -> Option<f32> {
    value(attributes, name)?.parse().ok()
}

fn unescape(words: &str) -> String {
    words.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"").replace("&amp;", "&")
}

/// Appends the outlines of `words` as one path with the text's colours and transformation.
fn push_path(svg: &mut String, face: &Face<'_>, attributes: &str, words: &str, picture_size: f32) {
    let size = number(attributes, "font-size").unwrap_or(picture_size);
    let scale = size / f32::from(face.units_per_em());
    let glyphs: Vec<(GlyphId, f32)> = words
        .chars()
        .map(|character| {
            // Glyph 0 is the font's box for a missing character.
            let glyph = face.glyph_index(character).unwrap_or_default();
            (glyph, scale * f32::from(face.glyph_hor_advance(glyph).unwrap_or(0)))
        })
        .collect();
    let width: f32 = glyphs.iter().map(|(_, advance)| advance).sum();
    let shift = match value(attributes, "text-anchor") {
        Some("middle") => 0.5 * width,
        Some("end") => width,
        _ => 0.0,
    };
    let mut x = number(attributes, "x").unwrap_or(0.0) - shift;
    let y = number(attributes, "y").unwrap_or(0.0);
    // A group around it may ask for edges without smoothing, which is not meant for letters.
    svg.push_str("<path shape-rendering=\"geometricPrecision\"");
    for name in ["fill", "fill-opacity", "transform"] {
        if let Some(value) = value(attributes, name) {
            let _ = write!(svg, " {name}=\"{value}\"");
        }
    }
    svg.push_str(" d=\"");
    for (glyph, advance) in glyphs {
        face.outline_glyph(glyph, &mut PathData { svg, x, y, scale });
        x += advance;
    }
    svg.push_str("\"/>");
}

/// Writes a glyph's outline as path data. A font's ordinate points up, a picture's down.
struct PathData<'a> {
    svg: &'a mut String,
    /// Origin of the glyph in the picture (pixels).
    x: f32,
    y: f32,
    /// Pixels to a unit of the font.
    scale: f32,
}

impl PathData<'_> {
    fn push(&mut self, command: char, points: &[(f32, f32)]) {
        self.svg.push(command);
        for (x, y) in points {
            let (x, y) = (self.x + self.scale * x, self.y - self.scale * y);
            let _ = write!(self.svg, "{x:.3} {y:.3} ");
        }
    }
}

impl OutlineBuilder for PathData<'_> {
    fn move_to(&mut self, x: f32, y: f32) {
        self.push('M', &[(x, y)]);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.push('L', &[(x, y)]);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.push('Q', &[(x1, y1), (x, y)]);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.push('C', &[(x1, y1), (x2, y2), (x, y)]);
    }

    fn close(&mut self) {
        self.svg.push('Z');
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

    use super::*;

    /// Smallest and largest abscissa of the outline of `text`.
    fn extent(text: &str) -> (f32, f32) {
        let svg = outline_text(&format!("<svg font-size=\"20\">{text}</svg>")).unwrap();
        let (_, path) = svg.split_once(" d=\"").unwrap();
        let numbers: Vec<f32> = path
            .split(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-'))
            .filter_map(|number| number.parse().ok())
            .collect();
        let abscissae = numbers.iter().step_by(2);
        abscissae.fold((f32::MAX, f32::MIN), |(low, high), x| (low.min(*x), high.max(*x)))
    }

    #[test]
    fn anchors_place_text_left_of_right_of_and_around_its_point() {
        let (left, right) = extent("<text x=\"100\" y=\"9\">HIH</text>");
        // Side bearings of H are a tenth of its height and less.
        assert!((100.0..103.0).contains(&left), "{left}");
        let width = right - left;
        assert!((30.0..40.0).contains(&width), "{width}");
        let (_, end) = extent("<text x=\"100\" y=\"9\" text-anchor=\"end\">HIH</text>");
        assert!((97.0..100.0).contains(&end), "{end}");
        let (from, to) = extent("<text x=\"100\" y=\"9\" text-anchor=\"middle\">HIH</text>");
        assert!((0.5 * (from + to) - 100.0).abs() < 0.1, "{from} to {to}");
        let (from, to) = extent("<text x=\"100\" y=\"9\" font-size=\"40\">HIH</text>");
        assert!((to - from - 2.0 * width).abs() < 0.1, "{from} to {to}");
    }

    #[test]
    fn colour_and_transformation_stay_and_nothing_else_changes() {
        let svg = "<svg font-size=\"9\"><g><text transform=\"rotate(-90)\" fill=\"#555\">a &lt; b</text></g><path d=\"M0 0\"/></svg>";
        let outlined = outline_text(svg).unwrap();
        assert!(
            outlined.starts_with("<svg font-size=\"9\"><g><path shape-rendering"),
            "{outlined}"
        );
        assert!(outlined.contains(" fill=\"#555\" transform=\"rotate(-90)\" d=\"M"), "{outlined}");
        assert!(outlined.ends_with("Z\"/></g><path d=\"M0 0\"/></svg>"), "{outlined}");
        assert!(!outlined.contains("<text"));
        let bracket = outline_text("<svg font-size=\"9\"><text>a&lt;b</text></svg>").unwrap();
        let entity = outline_text("<svg font-size=\"9\"><text>a&amp;lt;b</text></svg>").unwrap();
        assert!(entity.len() > bracket.len(), "an escaped ampersand is one character");
    }
}
