//! PDF files of one or more pages: lines, areas and text, so that text can be searched and copied.
//! The program's own font is embedded.
//!
//! [`pdf`] draws a picture on one page of its size; `report/a4.rs` sets text, tables and pictures
//! on pages of A4. Of pictures it reads what [`plot::svg`](super::plot::svg()) writes: `rect`,
//! `path` with the commands `MLHVhZ`, `circle`, `text` and groups with a translation or a clip
//! path. Source: ISO 32000-1:2008.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use roxmltree::{Document, Node};
use ttf_parser::Face;

use super::outlines::FONT;

/// Points to a pixel of 1/96 inch (pt).
const PIXEL: f64 = 0.75;
/// Points to a millimetre (pt).
const MILLIMETRE: f64 = 72.0 / 25.4;
/// Control points of a quarter of a circle over its radius (1).
const QUARTER: f64 = 0.552_284_75;

/// Why a picture could not be written: mistakes of whatever made the SVG.
#[derive(Debug, thiserror::Error)]
pub enum PdfError {
    /// Invalid SVG.
    #[error("found no SVG: {0}")]
    Svg(#[from] roxmltree::Error),
    /// The built-in font cannot be read.
    #[error("cannot read the built-in font: {0}")]
    Font(#[from] ttf_parser::FaceParsingError),
}

/// The picture `svg` as a PDF file of one page of its size.
///
/// # Errors
/// [`PdfError`] where `svg` is not valid SVG.
pub fn pdf(svg: &str) -> Result<Vec<u8>, PdfError> {
    let picture = Picture::parse(svg)?;
    let mut pages = Pages::new()?;
    pages.picture(&picture, (0.0, 0.0), 1.0);
    pages.end_page(picture.size);
    Ok(pages.file(None))
}

/// A picture of this program, read.
pub(super) struct Picture<'a> {
    document: Document<'a>,
    /// Width and height (pt).
    pub(super) size: (f64, f64),
    /// Points to one of its pixels (pt).
    point: f64,
}

impl<'a> Picture<'a> {
    /// # Errors
    /// [`PdfError`] where `svg` is not valid SVG.
    pub(super) fn parse(svg: &'a str) -> Result<Self, PdfError> {
        let document = Document::parse(svg)?;
        let root = document.root_element();
        let sides: Vec<f64> = root.attribute("viewBox").map(numbers).unwrap_or_default();
        let (wide, high) = sides.get(2).copied().zip(sides.get(3).copied()).unwrap_or((1.0, 1.0));
        let millimetres =
            root.attribute("width").and_then(|width| width.strip_suffix("mm")?.parse().ok());
        let point = millimetres.map_or(PIXEL, |width: f64| width * MILLIMETRE / wide);
        Ok(Self { size: (wide * point, high * point), document, point })
    }
}

/// All numbers of a text, whatever is between them.
fn numbers(text: &str) -> Vec<f64> {
    let is_part = |c: char| c.is_ascii_digit() || matches!(c, '.' | '-');
    text.split(|c| !is_part(c)).filter_map(|number| number.parse().ok()).collect()
}

fn number(node: Node<'_, '_>, name: &str) -> Option<f64> {
    node.attribute(name)?.parse().ok()
}

/// Pages in the making. Places on a page are counted from its upper left corner, downwards.
pub(super) struct Pages {
    face: Face<'static>,
    /// Glyphs used, with their characters.
    glyphs: BTreeMap<u16, char>,
    /// Characters that the font lacks.
    missing: BTreeSet<char>,
    /// Operators of the page that is being drawn.
    operators: String,
    /// Size (pt) and operators of the pages before it.
    done: Vec<((f64, f64), String)>,
}

impl Pages {
    /// # Errors
    /// [`PdfError::Font`].
    pub(super) fn new() -> Result<Self, PdfError> {
        let face = Face::parse(FONT, 0)?;
        Ok(Self {
            face,
            glyphs: BTreeMap::new(),
            missing: BTreeSet::new(),
            operators: String::new(),
            done: Vec::new(),
        })
    }

    /// Ends the page, which has this `size` (pt).
    pub(super) fn end_page(&mut self, size: (f64, f64)) {
        let drawn = std::mem::take(&mut self.operators);
        // In the file, ordinates point up.
        self.done.push((size, format!("1 0 0 -1 0 {:.3} cm\n{drawn}", size.1)));
    }

    /// What has been drawn on the page, which is empty after it.
    pub(super) fn take_drawn(&mut self) -> String {
        std::mem::take(&mut self.operators)
    }

    /// Draws what was taken at another place (pt).
    pub(super) fn draw(&mut self, (x, y): (f64, f64), drawn: &str) {
        self.write(format_args!("q 1 0 0 1 {x:.3} {y:.3} cm\n{drawn}Q"));
    }

    /// Draws a picture with its upper left corner at a place (pt), enlarged by `scale` (1).
    pub(super) fn picture(&mut self, picture: &Picture<'_>, (x, y): (f64, f64), scale: f64) {
        let point = scale * picture.point;
        self.write(format_args!("q {point:.6} 0 0 {point:.6} {x:.3} {y:.3} cm"));
        self.children(picture.document.root_element());
        self.write(format_args!("Q"));
    }

    /// Draws one line of words: `size` and place, the left end of the base line, in points (pt).
    pub(super) fn line_of_text(&mut self, (x, y): (f64, f64), size: f64, words: &str) {
        let glyphs = self.encode(words);
        self.write(format_args!("BT /F {size} Tf 0 g 1 0 0 -1 {x:.3} {y:.3} Tm <{glyphs}> Tj ET"));
    }

    /// Draws a rectangle from its upper left corner (pt), with an edge and an area of greys from 0,
    /// black, to 1 (1).
    pub(super) fn rectangle(
        &mut self,
        (x, y): (f64, f64),
        (width, height): (f64, f64),
        [edge, area]: [f64; 2],
    ) {
        self.write(format_args!(
            "q 0.5 w {edge} G {area} g {x:.3} {y:.3} {width:.3} {height:.3} re B Q"
        ));
    }

    /// Width of `words` at a size of 1 (1).
    pub(super) fn width(&self, words: &str) -> f64 {
        let advance = |character| {
            // Glyph 0 is the font's box for a missing character.
            let glyph = self.face.glyph_index(character).unwrap_or_default();
            f64::from(self.face.glyph_hor_advance(glyph).unwrap_or(0))
        };
        words.chars().map(advance).sum::<f64>() / f64::from(self.face.units_per_em())
    }

    /// The glyphs of `words` as hexadecimal digits.
    fn encode(&mut self, words: &str) -> String {
        let mut hexadecimal = String::new();
        for character in words.chars() {
            let found = self.face.glyph_index(character);
            let glyph = found.unwrap_or_default();
            let character = if found.is_some() {
                character
            } else {
                self.missing.insert(character);
                char::REPLACEMENT_CHARACTER
            };
            self.glyphs.entry(glyph.0).or_insert(character);
            let _ = write!(hexadecimal, "{:04x}", glyph.0);
        }
        hexadecimal
    }

    /// Characters that the font lacks, in whose place there are blanks.
    pub(super) fn missing(&self) -> String {
        self.missing.iter().collect()
    }

    fn write(&mut self, operators: std::fmt::Arguments<'_>) {
        // Writing to a text does not fail.
        let _ = writeln!(self.operators, "{operators}");
    }

    fn children(&mut self, node: Node<'_, '_>) {
        for child in node.children().filter(Node::is_element) {
            match child.tag_name().name() {
                "g" => self.group(child),
                "text" => self.text(child),
                "rect" | "path" | "circle" => self.shape(child),
                _ => {}
            }
        }
    }

    fn group(&mut self, node: Node<'_, '_>) {
        self.write(format_args!("q"));
        if let [x, y] = node.attribute("transform").map(numbers).unwrap_or_default()[..] {
            self.write(format_args!("1 0 0 1 {x} {y} cm"));
        }
        let clip = node
            .attribute("clip-path")
            .and_then(|url| url.strip_prefix("url(#")?.strip_suffix(')'));
        let clip = clip.and_then(|id| {
            node.document().descendants().find(|node| node.attribute("id") == Some(id))
        });
        if let Some(rect) = clip.and_then(|clip| clip.first_element_child()) {
            self.outline(rect);
            self.write(format_args!("W n"));
        }
        self.children(node);
        self.write(format_args!("Q"));
    }

    /// The path of a shape.
    fn outline(&mut self, node: Node<'_, '_>) {
        let of = |name| number(node, name).unwrap_or(0.0);
        match node.tag_name().name() {
            "rect" => {
                let [x, y, width, height] = ["x", "y", "width", "height"].map(of);
                self.write(format_args!("{x} {y} {width} {height} re"));
            }
            "circle" => {
                let [x, y, r] = ["cx", "cy", "r"].map(of);
                let k = QUARTER * r;
                self.write(format_args!("{} {y} m", x + r));
                for (sin, cos) in [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)] {
                    // From the angle (cos, sin) a quarter on, to (-sin, cos).
                    let at = |along: f64, aside: f64| {
                        (x + along * cos - aside * sin, y + along * sin + aside * cos)
                    };
                    let [a, b, c] = [at(r, k), at(k, r), at(0.0, r)];
                    self.write(format_args!(
                        "{:.3} {:.3} {:.3} {:.3} {:.3} {:.3} c",
                        a.0, a.1, b.0, b.1, c.0, c.1
                    ));
                }
                self.write(format_args!("h"));
            }
            _ => self.path(node.attribute("d").unwrap_or_default()),
        }
    }

    fn path(&mut self, data: &str) {
        let (mut x, mut y) = (0.0, 0.0);
        let starts = data.char_indices().filter(|(_, c)| c.is_ascii_alphabetic() && *c != 'e');
        let starts: Vec<(usize, char)> = starts.collect();
        let ends = starts.iter().skip(1).map(|(at, _)| *at).chain([data.len()]);
        for ((start, command), end) in starts.iter().zip(ends) {
            let values = numbers(&data[start + 1..end]);
            match (command, &values[..]) {
                ('M' | 'L', [to_x, to_y]) => (x, y) = (*to_x, *to_y),
                ('H', [to]) => x = *to,
                ('h', [by]) => x += by,
                ('V', [to]) => y = *to,
                _ => {
                    self.write(format_args!("h"));
                    continue;
                }
            }
            let operator = if *command == 'M' { 'm' } else { 'l' };
            self.write(format_args!("{x} {y} {operator}"));
        }
    }

    fn shape(&mut self, node: Node<'_, '_>) {
        let colour = |name| node.attribute(name).filter(|colour| *colour != "none").map(rgb);
        let (fill, stroke) = (colour("fill"), colour("stroke"));
        self.write(format_args!("q"));
        if let Some(share) = number(node, "fill-opacity") {
            // The file has a state for each whole percentage that pictures use.
            self.write(format_args!("/A{:.0} gs", 100.0 * share));
        }
        if let Some(fill) = &fill {
            self.write(format_args!("{fill} rg"));
        }
        if let Some(stroke) = &stroke {
            let width = number(node, "stroke-width").unwrap_or(1.0);
            let dashes = node.attribute("stroke-dasharray").unwrap_or_default();
            self.write(format_args!("{stroke} RG {width} w [{dashes}] 0 d"));
        }
        self.outline(node);
        let paint = match (fill, stroke) {
            (Some(_), Some(_)) => "B",
            (Some(_), None) => "f",
            (None, Some(_)) => "S",
            (None, None) => "n",
        };
        self.write(format_args!("{paint} Q"));
    }

    fn text(&mut self, node: Node<'_, '_>) {
        let words = node.text().unwrap_or_default();
        let inherited = node.ancestors().find_map(|node| number(node, "font-size"));
        let size = inherited.unwrap_or(12.0);
        let width = size * self.width(words);
        let glyphs = self.encode(words);
        let shift = match node.attribute("text-anchor") {
            Some("middle") => 0.5 * width,
            Some("end") => width,
            _ => 0.0,
        };
        let fill = rgb(node.attribute("fill").unwrap_or("#000000"));
        let of = |name| number(node, name).unwrap_or(0.0);
        let place = match node.attribute("transform").map(numbers).unwrap_or_default()[..] {
            // Turned by -90 degrees: along the text is up.
            [x, y, _] => format!("0 -1 -1 0 {x} {:.3}", y + shift),
            _ => format!("1 0 0 -1 {:.3} {}", of("x") - shift, of("y")),
        };
        self.write(format_args!("BT /F {size} Tf {fill} rg {place} Tm <{glyphs}> Tj ET"));
    }

    /// The file of all pages; a `title` is shown by viewers in the title of their window.
    pub(super) fn file(self, title: Option<&str>) -> Vec<u8> {
        let Self { face, glyphs, done, .. } = self;
        let kids: Vec<String> =
            (0..done.len()).map(|page| format!("{} 0 R", page_object(page))).collect();
        let pages = format!(
            "<< /Type /Pages /Kids [{}] /Count {} /Resources << /Font << /F 3 0 R >> /ExtGState << {STATES} >> >> >>",
            kids.join(" "),
            kids.len()
        );
        let mut objects = vec![b"<< /Type /Catalog /Pages 2 0 R >>".to_vec(), pages.into_bytes()];
        objects.extend(font(&face, &glyphs));
        for (page, ((wide, high), operators)) in done.iter().enumerate() {
            let content = page_object(page) + 1;
            objects.push(
                format!("<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {wide:.3} {high:.3}] /Contents {content} 0 R >>")
                    .into_bytes(),
            );
            objects.push(stream(operators.as_bytes(), ""));
        }
        let mut info = String::new();
        if let Some(title) = title {
            objects.push(format!("<< /Title <feff{}> >>", utf16(title)).into_bytes());
            info = format!(" /Info {} 0 R", objects.len());
        }
        join(&objects, &info)
    }
}

/// `#rrggbb` as three shares.
fn rgb(colour: &str) -> String {
    let number = u32::from_str_radix(colour.trim_start_matches('#'), 16).unwrap_or(0);
    let part = |shift: u32| f64::from((number >> shift) & 255) / 255.0;
    format!("{:.4} {:.4} {:.4}", part(16), part(8), part(0))
}

/// States for the opacities of this program's pictures.
const STATES: &str = "/A35 << /ca 0.35 >> /A85 << /ca 0.85 >>";
/// Objects of a file before those of its pages: catalog, list of pages, and five of the font.
const FIRST_OBJECTS: usize = 7;
/// Characters in one list of a font's characters at most (Adobe Technical Note 5014, 1.4.1).
const LIST_LENGTH: usize = 100;

/// Number of the object of a page, counted from 0; that of its content follows.
fn page_object(page: usize) -> usize {
    FIRST_OBJECTS + 1 + 2 * page
}

/// Text as UTF-16 in hexadecimal digits.
fn utf16(text: &str) -> String {
    text.encode_utf16().map(|unit| format!("{unit:04x}")).collect::<Vec<_>>().concat()
}

fn stream(bytes: &[u8], more: &str) -> Vec<u8> {
    let mut object = format!("<< /Length {}{more} >>\nstream\n", bytes.len()).into_bytes();
    object.extend_from_slice(bytes);
    object.extend_from_slice(b"\nendstream");
    object
}

/// The objects of the font, from number 3 on.
fn font(face: &Face<'_>, glyphs: &BTreeMap<u16, char>) -> [Vec<u8>; 5] {
    let unit = 1000.0 / f64::from(face.units_per_em());
    let width = |glyph: &u16| {
        let advance = face.glyph_hor_advance(ttf_parser::GlyphId(*glyph)).unwrap_or(0);
        format!("{glyph} [{:.0}]", unit * f64::from(advance))
    };
    let widths = glyphs.keys().map(width).collect::<Vec<_>>().join(" ");
    let named = |(glyph, character): &(&u16, &char)| {
        format!("<{glyph:04x}> <{}>\n", utf16(&character.to_string()))
    };
    let all: Vec<(&u16, &char)> = glyphs.iter().collect();
    let list = |list: &[(&u16, &char)]| {
        let names = list.iter().map(named).collect::<Vec<_>>().concat();
        format!("{} beginbfchar\n{names}endbfchar\n", list.len())
    };
    let lists = all.chunks(LIST_LENGTH).map(list).collect::<Vec<_>>().concat();
    let unicode = format!(
        "/CIDInit /ProcSet findresource begin 12 dict begin begincmap /CMapName /U def /CMapType 2 def\n\
         1 begincodespacerange <0000> <ffff> endcodespacerange\n{lists}\
         endcmap CMapName currentdict /CMap defineresource pop end end"
    );
    let b = face.global_bounding_box();
    let bounds =
        [b.x_min, b.y_min, b.x_max, b.y_max].map(|edge| format!("{:.0}", unit * f64::from(edge)));
    let [rise, fall] = [face.ascender(), face.descender()].map(|edge| unit * f64::from(edge));
    [
        b"<< /Type /Font /Subtype /Type0 /BaseFont /DejaVuSans /Encoding /Identity-H /DescendantFonts [4 0 R] /ToUnicode 7 0 R >>".to_vec(),
        format!(
            "<< /Type /Font /Subtype /CIDFontType2 /BaseFont /DejaVuSans /CIDSystemInfo << /Registry (Adobe) /Ordering (Identity) /Supplement 0 >> /FontDescriptor 5 0 R /CIDToGIDMap /Identity /W [{widths}] >>"
        )
        .into_bytes(),
        format!(
            "<< /Type /FontDescriptor /FontName /DejaVuSans /Flags 4 /FontBBox [{}] /ItalicAngle 0 /Ascent {rise:.0} /Descent {fall:.0} /CapHeight 729 /StemV 90 /FontFile2 6 0 R >>",
            bounds.join(" ")
        )
        .into_bytes(),
        stream(FONT, &format!(" /Length1 {}", FONT.len())),
        stream(unicode.as_bytes(), ""),
    ]
}

/// A file of `objects`, the first of which is the catalog.
fn join(objects: &[Vec<u8>], info: &str) -> Vec<u8> {
    let mut file = b"%PDF-1.7\n%\xe2\xe3\xcf\xd3\n".to_vec();
    let mut places = String::new();
    for (index, object) in objects.iter().enumerate() {
        let _ = writeln!(places, "{:010} 00000 n ", file.len());
        file.extend_from_slice(format!("{} 0 obj\n", index + 1).as_bytes());
        file.extend_from_slice(object);
        file.extend_from_slice(b"\nendobj\n");
    }
    let (start, count) = (file.len(), objects.len() + 1);
    let end = format!(
        "xref\n0 {count}\n0000000000 65535 f \n{places}trailer\n<< /Size {count} /Root 1 0 R{info} >>\nstartxref\n{start}\n%%EOF\n"
    );
    file.extend_from_slice(end.as_bytes());
    file
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

    use super::*;

    /// Offsets of the table of objects lead to the objects, and each character has its code.
    #[test]
    fn a_page_has_its_size_its_objects_and_its_text() {
        let svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"25.4mm\" viewBox=\"0 0 36 18\" font-size=\"12\">\
            <g transform=\"translate(1 2)\"><path d=\"M0 0V5H3h2Z\" fill=\"none\" stroke=\"#ff0000\"/><text x=\"4\" y=\"9\" fill=\"#000000\">−1</text></g></svg>";
        let file = pdf(svg).unwrap();
        let text = String::from_utf8_lossy(&file);
        assert!(text.contains("/MediaBox [0 0 72.000 36.000]"));
        assert!(text.contains("0 0 m\n0 5 l\n3 5 l\n5 5 l\nh\nS Q"), "{text}");
        assert!(text.contains("<2212>") && text.contains("<0031>"));
        let (_, table) = text.split_once("xref\n0 10\n").unwrap();
        for (number, line) in (1..=9).zip(table.lines().skip(1)) {
            let at: usize = line.split(' ').next().unwrap().parse().unwrap();
            assert!(file[at..].starts_with(format!("{number} 0 obj").as_bytes()), "{line}");
        }
    }
}
