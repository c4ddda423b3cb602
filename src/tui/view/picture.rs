//! A screen as a picture: the terminal's cells as an SVG.
//!
//! Braille and block characters are drawn, not written, so that the picture is the same with every
//! font.

use std::fmt::Write as _;

use ratatui::buffer::{Buffer, Cell};
use ratatui::style::{Color, Modifier};

/// Width of a cell (px).
const CELL_WIDTH: u16 = 8;
/// Height of a cell (px).
const CELL_HEIGHT: u16 = 16;
/// The terminal's own colours: text and background.
const DEFAULT_COLOURS: (&str, &str) = ("#d0d0d0", "#101010");

/// The sixteen colours as most terminals show them.
fn hexadecimal(colour: Color, own: &'static str) -> &'static str {
    match colour {
        Color::Black => "#000000",
        Color::Red => "#cd3131",
        Color::Green => "#0dbc79",
        Color::Yellow => "#e5c510",
        Color::Blue => "#2472c8",
        Color::Magenta => "#d152d1",
        Color::Cyan => "#11a8cd",
        Color::Gray => "#b0b0b0",
        Color::DarkGray => "#666666",
        Color::LightRed => "#f14c4c",
        Color::LightGreen => "#23d18b",
        Color::LightYellow => "#f5f543",
        Color::LightBlue => "#3b8eea",
        Color::LightMagenta => "#d670d6",
        Color::LightCyan => "#29b8db",
        Color::White => "#ffffff",
        _ => own,
    }
}

/// Text and background of a cell.
fn colours(cell: &Cell) -> (&'static str, &'static str) {
    let (text, behind) =
        (hexadecimal(cell.fg, DEFAULT_COLOURS.0), hexadecimal(cell.bg, DEFAULT_COLOURS.1));
    if cell.modifier.contains(Modifier::REVERSED) { (behind, text) } else { (text, behind) }
}

/// The picture of `buffer`.
pub fn svg(buffer: &Buffer) -> String {
    let area = buffer.area;
    let (width, height) = (
        u32::from(area.width) * u32::from(CELL_WIDTH),
        u32::from(area.height) * u32::from(CELL_HEIGHT),
    );
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" font-family=\"monospace\" font-size=\"13\">\n<rect width=\"{width}\" height=\"{height}\" fill=\"{}\"/>\n",
        DEFAULT_COLOURS.1
    );
    for y in 0..area.height {
        row(buffer, y, &mut text);
    }
    text.push_str("</svg>\n");
    text
}

fn row(buffer: &Buffer, y: u16, text: &mut String) {
    let top = u32::from(y) * u32::from(CELL_HEIGHT);
    let mut run: Option<(u16, String, &Cell)> = None;
    for x in 0..buffer.area.width {
        let Some(cell) = buffer.cell((buffer.area.x + x, buffer.area.y + y)) else { continue };
        let (ink, behind) = colours(cell);
        let left = u32::from(x) * u32::from(CELL_WIDTH);
        if behind != DEFAULT_COLOURS.1 {
            let _ = writeln!(
                text,
                "<rect x=\"{left}\" y=\"{top}\" width=\"{CELL_WIDTH}\" height=\"{CELL_HEIGHT}\" fill=\"{behind}\"/>"
            );
        }
        let symbol = cell.symbol();
        let drawn = drawn(symbol, (left, top), ink, text);
        let alike = |last: &Cell| last.style() == cell.style();
        match &mut run {
            Some((_, words, last)) if !drawn && alike(last) => words.push_str(symbol),
            _ => {
                flush(run.take(), top, text);
                if !drawn && !symbol.trim().is_empty() {
                    run = Some((x, symbol.to_owned(), cell));
                }
            }
        }
    }
    flush(run, top, text);
}

/// Writes a run of letters of one style.
fn flush(run: Option<(u16, String, &Cell)>, top: u32, text: &mut String) {
    let Some((x, words, cell)) = run else { return };
    let weight = if cell.modifier.contains(Modifier::BOLD) { " font-weight=\"bold\"" } else { "" };
    let words = words.trim_end();
    let length = words.chars().count() * usize::from(CELL_WIDTH);
    let escaped = words.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    let _ = writeln!(
        text,
        "<text x=\"{}\" y=\"{}\" fill=\"{}\" textLength=\"{length}\" xml:space=\"preserve\"{weight}>{escaped}</text>",
        u32::from(x) * u32::from(CELL_WIDTH),
        top + 12,
        colours(cell).0
    );
}

/// Draws a Braille or block character; whether it was one.
fn drawn(symbol: &str, (left, top): (u32, u32), ink: &str, text: &mut String) -> bool {
    /// Column and row of each bit of a Braille pattern.
    const BRAILLE_POSITIONS: [(u32, u32); 8] =
        [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2), (0, 3), (1, 3)];
    let Some(letter) = symbol.chars().next() else { return false };
    let code = u32::from(letter);
    match code {
        0x2800..=0x28ff => {
            let mut path = String::new();
            for (bit, (column, row)) in (0..).zip(BRAILLE_POSITIONS) {
                if ((code - 0x2800) >> bit) & 1 == 1 {
                    let _ = write!(path, "M{} {}h3v3h-3z", left + column * 4, top + row * 4);
                }
            }
            if !path.is_empty() {
                let _ = writeln!(text, "<path d=\"{path}\" fill=\"{ink}\"/>");
            }
            true
        }
        // Eighths from below.
        0x2581..=0x2588 => {
            let height = (code - 0x2580) * 2;
            let y = top + 16 - height;
            let _ = writeln!(
                text,
                "<rect x=\"{left}\" y=\"{y}\" width=\"8\" height=\"{height}\" fill=\"{ink}\"/>"
            );
            true
        }
        // Shades.
        0x2591..=0x2593 => {
            let opacity = (code - 0x2590) * 25;
            let _ = writeln!(
                text,
                "<rect x=\"{left}\" y=\"{top}\" width=\"8\" height=\"16\" fill=\"{ink}\" fill-opacity=\"{opacity}%\"/>"
            );
            true
        }
        _ => false,
    }
}
