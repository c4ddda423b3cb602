//! Certificates and reports as PDF: their words are read back from the file, and nothing is drawn
//! beyond the edges of a sheet.

use std::collections::BTreeMap;
use std::path::Path;

use super::{COULD_NOT, hertzscope, printed, refused, says, temporary};

/// Points to a millimetre (pt).
const MILLIMETRE: f64 = 72.0 / 25.4;
/// A sheet of A4 and its margin (pt).
const A4: (f64, f64) = (210.0 * MILLIMETRE, 297.0 * MILLIMETRE);
const MARGIN: f64 = 20.0 * MILLIMETRE;
/// Places in the file have three decimals, those within pictures one, in pixels of 0.75 points or
/// less (pt).
const ROUNDING: f64 = 0.1;
/// Height of letters over their base line and below it, over the size of the text: the built-in
/// font has 0.93 and 0.24 for all of its letters, accents included (1).
const LETTER: (f64, f64) = (0.8, 0.24);

/// What one sheet shows.
#[derive(Default)]
struct SheetContent {
    /// Texts in the order of the file, with the corners of each (pt).
    texts: Vec<(String, Vec<(f64, f64)>)>,
    /// Corners of each rectangle that is filled with white or grey (pt).
    rectangles: Vec<Vec<(f64, f64)>>,
}

impl SheetContent {
    fn text(&self) -> String {
        self.texts.iter().map(|(text, _)| text.as_str()).collect::<Vec<_>>().join(" ")
    }
}

/// The object `number` of a file of this program.
fn object(file: &str, number: usize) -> &str {
    let (_, object) = file.split_once(&format!("\n{number} 0 obj\n")).expect("an object");
    object.split("\nendobj").next().expect("its end")
}

/// The part of `text` between two marks.
fn between<'a>(text: &'a str, from: &str, to: &str) -> &'a str {
    let (_, rest) = text.split_once(from).expect(from);
    rest.split(to).next().expect(to)
}

/// Numbers of a transformation, `[a b c d e f]`: `x' = a x + c y + e`, `y' = b x + d y + f`.
type Transformation = [f64; 6];

fn at(t: &Transformation, (x, y): (f64, f64)) -> (f64, f64) {
    (t[0] * x + t[2] * y + t[4], t[1] * x + t[3] * y + t[5])
}

/// `inner` first, then `outer`.
fn both(inner: &Transformation, outer: &Transformation) -> Transformation {
    let [a, b, c, d, ..] = *inner;
    let linear = |x: f64, y: f64| (outer[0] * x + outer[2] * y, outer[1] * x + outer[3] * y);
    let ((a, b), (c, d)) = (linear(a, b), linear(c, d));
    let (e, f) = at(outer, (inner[4], inner[5]));
    [a, b, c, d, e, f]
}

/// Reads the sheets of a file.
fn sheets(path: &Path) -> Vec<SheetContent> {
    let bytes = std::fs::read(path).expect("a file");
    assert!(bytes.starts_with(b"%PDF-1.7"));
    // Bytes of the font become other characters; all else is ASCII.
    let file: String = bytes.iter().map(|byte| char::from(*byte)).collect();
    let hexadecimal = |text: &str| u32::from_str_radix(text, 16).expect("digits");
    let fonts = object(&file, 4);
    let widths: BTreeMap<u32, f64> = between(fonts, "/W [", "] >>")
        .split(']')
        .filter_map(|entry| entry.split_once(" ["))
        .map(|(glyph, width)| (glyph.trim().parse().unwrap(), width.parse().unwrap()))
        .collect();
    let characters: BTreeMap<u32, char> = object(&file, 7)
        .lines()
        .filter_map(|line| line.strip_prefix('<')?.strip_suffix('>')?.split_once("> <"))
        .filter(|(_, character)| character.len() == 4)
        .map(|(glyph, c)| (hexadecimal(glyph), char::from_u32(hexadecimal(c)).unwrap()))
        .collect();
    let kids = between(object(&file, 2), "/Kids [", "]");
    let pages = kids.split(" 0 R").filter_map(|number| number.trim().parse().ok());
    let sheet = |page: usize| {
        let page = object(&file, page);
        let sides: Vec<f64> =
            between(page, "/MediaBox [", "]").split(' ').map(|n| n.parse().unwrap()).collect();
        assert!((sides[2] - A4.0).abs() < ROUNDING && (sides[3] - A4.1).abs() < ROUNDING);
        let content: usize = between(page, "/Contents ", " ").parse().unwrap();
        let stream = between(object(&file, content), "stream\n", "\nendstream");
        content_of(stream, &widths, &characters)
    };
    pages.map(sheet).collect()
}

fn content_of(
    stream: &str,
    widths: &BTreeMap<u32, f64>,
    characters: &BTreeMap<u32, char>,
) -> SheetContent {
    let mut found = SheetContent::default();
    let mut now: Transformation = [1.0, 0.0, 0.0, 1.0, 0.0, 0.0];
    let (mut saved, mut numbers) = (Vec::new(), Vec::new());
    let (mut matrix, mut size, mut glyphs) = (now, 0.0, "");
    // Of rectangles: all four numbers, until they are filled or become a clip path.
    let mut rectangle = None;
    for token in stream.split_whitespace() {
        match token {
            "q" => saved.push(now),
            "Q" => now = saved.pop().expect("as many as before"),
            "cm" => now = both(&numbers[..6].try_into().unwrap(), &now),
            "Tf" => size = numbers[0],
            "Tm" => matrix = both(&numbers[numbers.len() - 6..].try_into().unwrap(), &now),
            "re" => rectangle = Some([numbers[0], numbers[1], numbers[2], numbers[3]]),
            "W" => rectangle = None,
            "f" | "B" => {
                if let Some([x, y, wide, high]) = rectangle.take() {
                    let corners = [(x, y), (x + wide, y), (x, y + high), (x + wide, y + high)];
                    found.rectangles.push(corners.iter().map(|place| at(&now, *place)).collect());
                }
            }
            "Tj" => {
                let codes: Vec<u32> = (0..glyphs.len() / 4)
                    .map(|i| u32::from_str_radix(&glyphs[4 * i..4 * i + 4], 16).unwrap())
                    .collect();
                let text = codes.iter().map(|code| characters[code]).collect();
                let wide = size * codes.iter().map(|code| widths[code]).sum::<f64>() / 1000.0;
                let (up, down) = (LETTER.0 * size, -LETTER.1 * size);
                let corners = [(0.0, up), (wide, up), (0.0, down), (wide, down)];
                let corners = corners.iter().map(|place| at(&matrix, *place)).collect();
                found.texts.push((text, corners));
            }
            _ => {}
        }
        match token.parse::<f64>() {
            Ok(number) => numbers.push(number),
            Err(_) if token.starts_with('<') => glyphs = token.trim_matches(['<', '>']),
            // Colours are given within the text's own operators.
            Err(_) => numbers.clear(),
        }
    }
    assert!(saved.is_empty(), "each q has its Q");
    found
}

/// Everything is between the margins, but for the foot; each foot has its number.
fn check(sheets: &[SheetContent], foot: &str) {
    for (number, sheet) in (1..).zip(sheets) {
        let (feet, texts) = sheet.texts.split_at(sheet.texts.len() - 2);
        let (texts, feet) = (feet, texts);
        assert_eq!(feet[0].0, foot);
        assert_eq!(feet[1].0, format!("page {number} of {}", sheets.len()));
        let corners = texts
            .iter()
            .flat_map(|(text, corners)| corners.iter().map(move |corner| (text.as_str(), corner)));
        let rectangles = sheet.rectangles.iter().flatten().map(|corner| ("a rectangle", corner));
        for (what, (x, y)) in corners.chain(rectangles) {
            let inside = |place: f64, end: f64| {
                (MARGIN - ROUNDING..=end - MARGIN + ROUNDING).contains(&place)
            };
            assert!(inside(*x, A4.0) && inside(*y, A4.1), "sheet {number}: {what} at {x}, {y}");
        }
    }
}

/// The certificate of a simulated test as PDF has its number on each sheet, and the results and the
/// hashes of the JSON.
#[test]
fn a_certificate_is_printed_without_a_browser() {
    let folder = temporary();
    let at = folder.path();
    let design = ["calibrate", "--simulate", "pzt-5a-710pf", "--striker", "ptfe-capped-1.22g"];
    printed(at, &[&design[..], &["-o", "test", "-q"]].concat());
    let plan = at.join("test/plan.toml");
    let mut text = std::fs::read_to_string(&plan).expect("a plan");
    text.push_str("\n[certificate]\nnumber = \"2026-114\"\napproved_by = \"Łucja Ødegård, 北\"\n");
    std::fs::write(&plan, text).expect("a plan");
    let words = ["calibrate", "test/plan.toml", "--certificate", "c.pdf", "-o", "out", "-q"];
    let done = hertzscope(at, &words);
    assert_eq!(done.code, 0, "{}", done.stderr);
    says(&done.stdout, &["certificate out/certificate.html", "certificate c.pdf"]);
    says(&done.stderr, &["note: c.pdf: the built-in font has no 北, left blank there"]);
    let html = std::fs::read_to_string(at.join("out/certificate.html")).expect("a page");
    let json = std::fs::read_to_string(at.join("out/calibration.json")).expect("JSON");
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    let found = sheets(&at.join("c.pdf"));
    assert_eq!(
        std::fs::read(at.join("c.pdf")).unwrap(),
        std::fs::read(at.join("out/certificate.pdf")).unwrap()
    );
    check(&found, "Calibration certificate 2026-114");
    // A cover, the tables of impacts, budget and recordings, and a third of a sheet for each of
    // four rows of pictures.
    assert!((4..=8).contains(&found.len()), "{} sheets", found.len());
    let text = found.iter().map(SheetContent::text).collect::<Vec<_>>().join(" ");
    // The result as the HTML has it.
    let result = between(&html, "sensitivity S</td><td class=\"l\">", "</td>");
    assert!(result.contains(" ± ") && result.contains(" mV/N, "), "{result}");
    says(&text, &[result, "End of certificate 2026-114.", "not stated (sensor.serial)"]);
    says(&text, &["Łucja Ødegård, \u{fffd}"]);
    // A hand needs 15 mm above the line to sign on, which is on the sheet of its name.
    let is_there = |(text, _): &&(String, _)| text.starts_with("Signature");
    let sheet = found.iter().find(|sheet| sheet.texts.iter().any(|text| is_there(&text)));
    let texts = &sheet.expect("a line to sign on").texts;
    let edge = |corners: &[(f64, f64)], of: fn(f64, f64) -> f64| {
        corners.iter().map(|(_, y)| *y).reduce(of).expect("corners")
    };
    let top = edge(&texts.iter().find(is_there).expect("the line").1, f64::max);
    let room = texts.iter().map(|(_, corners)| edge(corners, f64::min) - top);
    let room = room.filter(|room| *room > 0.0).fold(f64::INFINITY, f64::min);
    assert!(room > 15.0 * MILLIMETRE - ROUNDING && room < 30.0 * MILLIMETRE, "{room} pt");
    // Hashes are broken in their narrow column.
    let joined: String = text.split_whitespace().collect();
    for impact in json["impacts"].as_array().expect("impacts") {
        says(&joined, &[impact["sha256"].as_str().expect("a hash")]);
    }
    // The file is never replaced without a word.
    says(&refused(at, &words[..4]), &["c.pdf: exists already"]);
    says(
        &refused(at, &["calibrate", "test/plan.toml", "--certificate", "c.odt"]),
        &[".md, .html, .pdf"],
    );
}

/// Reports of `compare` and `fit` have the numbers that the terminal shows, each fit's second file
/// included.
#[test]
fn reports_are_printed_without_a_browser() {
    let folder = temporary();
    let at = folder.path();
    printed(at, &["run", "magnet-0.61g", "-q", "-o", "a.mcap"]);
    let words =
        ["compare", "a.mcap", "magnet-0.61g", "-o", "a.pdf", "--tolerance", "rms=2lsb", "-q"];
    let shown = printed(at, &words);
    let found = sheets(&at.join("a.pdf"));
    check(&found, "a.mcap against magnet-0.61g");
    let text = found.iter().map(SheetContent::text).collect::<Vec<_>>().join(" ");
    let row = shown.lines().find(|line| line.starts_with("  CH1 p2")).expect("a row");
    // Two or more blanks are between cells.
    for cell in row.split("  ").map(str::trim).filter(|cell| !cell.is_empty()) {
        let cell =
            if cell.starts_with('-') { cell.replacen('-', "−", 1) } else { cell.to_owned() };
        says(&text, &[&cell]);
    }
    says(&text, &["Made from", "measurement, SHA-256", "time after the trigger"]);

    // A table of correlations with a dozen columns.
    let free = "striker.speed,materials.ptfe.youngs_modulus,sensor.*.sensitivity";
    let exact = ["--gain-u", "0", "--exact-inputs", "--to", "1.2 ms", "--starts", "1", "-q"];
    let fit = [&["fit", "a.mcap", "magnet-0.61g", "--free", free][..], &exact].concat();
    let shown = printed(at, &[&fit[..], &["-o", "f.toml", "-o", "f.pdf"]].concat());
    assert!(at.join("f.toml").is_file());
    let found = sheets(&at.join("f.pdf"));
    check(&found, "magnet-0.61g fitted to a.mcap");
    let text = found.iter().map(SheetContent::text).collect::<Vec<_>>().join(" ");
    let row = shown.lines().find(|line| line.starts_with("  striker.speed")).expect("a row");
    for cell in row.split("  ").map(str::trim).filter(|cell| !cell.is_empty()) {
        says(&text, &[cell]);
    }
    let words = [&fit[..], &["-o", "f.html", "--report", "f.pdf"]].concat();
    says(&refused(at, &words), &["f.pdf: found a second file for the report"]);
    let done = hertzscope(at, &[&fit[..], &["-o", "f.odt"]].concat());
    assert_eq!(done.code, COULD_NOT);
    says(&done.stderr, &[".toml, .md, .html, .pdf"]);
}
