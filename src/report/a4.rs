//! A page of results as PDF on sheets of A4: headings, paragraphs, lists, tables and pictures, with
//! the title and the number of the sheet in each foot.
//!
//! Each part becomes blocks, one below the other: a line of a paragraph, a row of a table, a
//! picture with its caption. A sheet ends above the block that no longer fits. Blocks that stay
//! with the next one, such as headings, move with it. A table goes on below its heading row.

use super::page::{Part, SIGNATURE, is_narrow};
use super::pdf::{Pages, PdfError, Picture};
use super::plot::{Sheet, Theme, svg, with_minus_signs};
use crate::quantity::printable_line;

/// Points to a millimetre (pt).
const MILLIMETRE: f64 = 72.0 / 25.4;
/// Width and height of A4 (pt).
const A4: (f64, f64) = (210.0 * MILLIMETRE, 297.0 * MILLIMETRE);
/// Room at each edge of a sheet (pt).
const MARGIN: f64 = 20.0 * MILLIMETRE;
/// Width and height between the margins (pt).
const ROOM: (f64, f64) = (A4.0 - 2.0 * MARGIN, A4.1 - 2.0 * MARGIN);

/// Size of headings of level 1, of level 2 and of all others (pt).
const HEADINGS: [f64; 3] = [16.0, 11.5, 10.0];
/// Size of paragraphs and lists, of captions, and of the foot (pt).
const TEXT: f64 = 9.0;
const CAPTION: f64 = 7.0;
const FOOT: f64 = 8.0;
/// Sizes of a table's text: the first at which its columns fit (pt).
const TABLE: [f64; 4] = [8.0, 7.0, 6.0, 5.0];
/// Height of a line over the size of its text (1).
const LINE: f64 = 1.3;
/// Room above a paragraph, a table or a picture, and above a heading (pt).
const GAP: f64 = 5.0;
const HEADING_GAP: f64 = 14.0;
/// Room for a signature above its line (pt).
const SIGNATURE_GAP: f64 = 15.0 * MILLIMETRE;
/// Room between the edge of a cell and its text, across and along a line (in sizes of its text).
const PADDING: (f64, f64) = (0.2, 0.45);
/// Room between two pictures side by side (pt).
const GUTTER: f64 = 4.0 * MILLIMETRE;
/// Room left of the words of a list (pt).
const INDENT: f64 = 10.0;
/// A longer word in a column of words is broken if there is no room (in sizes of its text).
const LONG_WORD: f64 = 9.0;
/// Rows of a table higher than this share of a sheet are cut in two (1).
const HIGHEST_ROW: f64 = 0.8;
/// Greys of a table's lines, of its heading row and of its other cells (1).
const LINES: f64 = 0.75;
const HEAD_AREA: f64 = 0.94;
const CELL_AREA: f64 = 1.0;

/// `parts` as a PDF file of A4 sheets, pictures included; and the characters that the built-in font
/// lacks, in whose place there are blanks.
///
/// # Errors
/// [`PdfError`] where a picture is not valid SVG.
pub fn page_pdf(title: &str, parts: &[Part]) -> Result<(Vec<u8>, String), PdfError> {
    let mut setter = Setter { pages: Pages::new()?, blocks: Vec::new() };
    let mut rest = parts;
    while let Some((part, after)) = rest.split_first() {
        rest = after;
        match part {
            Part::Heading(level, words) => setter.heading(*level, words),
            Part::Paragraph(words) => setter.lines(words, 0.0),
            Part::Signature => setter.signature(),
            Part::Fact(label, fact) => setter.lines(&format!("{label}: {fact}"), 0.0),
            Part::List(_, items) => {
                for item in items {
                    setter.lines(item, INDENT);
                }
            }
            Part::Table(rows, left) => setter.table(rows, left),
            Part::Picture(_, caption, sheet) => {
                let mut row = vec![(caption, sheet)];
                if let (true, Some((Part::Picture(_, caption, beside), after))) =
                    (is_narrow(sheet), rest.split_first())
                    && is_narrow(beside)
                {
                    row.push((caption, beside));
                    rest = after;
                }
                setter.pictures(&row)?;
            }
        }
    }
    Ok(setter.file(&typeset(title)))
}

/// Words as they are set: in one line, with signs of numbers.
fn typeset(words: &str) -> String {
    with_minus_signs(&printable_line(words))
}

/// A part of a page that is never split between two sheets: a line, a row, a picture.
struct Block {
    /// Room above it, none at the top of a sheet (pt).
    gap: f64,
    /// Height (pt).
    height: f64,
    /// Operators, from its upper left corner.
    drawn: String,
    /// Whether the next block is on the same sheet.
    stays_with_next: bool,
    /// The heading row that is repeated above it at the top of a sheet, among all blocks.
    head: Option<usize>,
}

/// A table's columns: size of the text (pt), widths with their padding (pt), and which ones are
/// flush left.
struct Columns<'a> {
    size: f64,
    widths: Vec<f64>,
    left: &'a [usize],
}

/// Sets blocks.
struct Setter {
    pages: Pages,
    blocks: Vec<Block>,
}

impl Setter {
    /// Ends a block whose operators have been drawn.
    fn end_block(&mut self, gap: f64, height: f64, stays_with_next: bool, head: Option<usize>) {
        let drawn = self.pages.take_drawn();
        self.blocks.push(Block { gap, height, drawn, stays_with_next, head });
    }

    fn heading(&mut self, level: u8, words: &str) {
        let size = HEADINGS[usize::from(level).clamp(1, HEADINGS.len()) - 1];
        let lines = self.wrap(&typeset(words), size, ROOM.0);
        self.column((0.0, 0.0), size, &lines);
        self.end_block(HEADING_GAP, LINE * size * lines.len() as f64, true, None);
    }

    /// The line to sign on; the room above it is part of its block, which a sheet's top keeps.
    fn signature(&mut self) {
        self.pages.line_of_text((0.0, SIGNATURE_GAP + TEXT), TEXT, SIGNATURE);
        self.end_block(0.0, SIGNATURE_GAP + LINE * TEXT, false, None);
    }

    /// Lines of a paragraph, or of an item of a list if `indent` is not zero (pt).
    fn lines(&mut self, words: &str, indent: f64) {
        let lines = self.wrap(&typeset(words), TEXT, ROOM.0 - indent);
        for (index, line) in lines.iter().enumerate() {
            if index == 0 && indent > 0.0 {
                self.pages.line_of_text((0.0, TEXT), TEXT, "•");
            }
            self.pages.line_of_text((indent, TEXT), TEXT, line);
            // No line is alone on its sheet.
            let stays = index + 1 < lines.len() && (index == 0 || index + 2 == lines.len());
            let gap = match index {
                0 if indent > 0.0 => 0.4 * GAP,
                0 => GAP,
                _ => 0.0,
            };
            self.end_block(gap, LINE * TEXT, stays, None);
        }
    }

    /// Draws lines below each other.
    fn column(&mut self, (x, y): (f64, f64), size: f64, lines: &[String]) {
        for (index, line) in lines.iter().enumerate() {
            self.pages.line_of_text((x, y + size + LINE * size * index as f64), size, line);
        }
    }

    /// Pictures side by side, each with its caption.
    fn pictures(&mut self, row: &[(&String, &Sheet)]) -> Result<(), PdfError> {
        let (_, first) = row[0];
        let room = if is_narrow(first) { 0.5 * (ROOM.0 - GUTTER) } else { ROOM.0 };
        let (mut x, mut height) = (0.0, 0.0);
        for (caption, sheet) in row {
            let drawing = svg(sheet, Theme::Light);
            let picture = Picture::parse(&drawing)?;
            let caption = self.wrap(&typeset(caption), CAPTION, room);
            let below = LINE * CAPTION * caption.len() as f64;
            let (wide, high) = picture.size;
            let scale = (room / wide).min((ROOM.1 - below) / high).min(1.0);
            self.pages.picture(&picture, (x, 0.0), scale);
            self.column((x, scale * high), CAPTION, &caption);
            height = f64::max(height, scale * high + below);
            x += room + GUTTER;
        }
        self.end_block(GAP, height, false, None);
        Ok(())
    }

    fn table(&mut self, rows: &[Vec<String>], left: &[usize]) {
        let cells = |row: &Vec<String>| row.iter().map(|cell| typeset(cell)).collect();
        let rows: Vec<Vec<String>> = rows.iter().map(cells).collect();
        let Some((heading, rest)) = rows.split_first() else { return };
        let columns = match self.columns(&rows, left) {
            Ok(columns) => columns,
            Err(groups) => {
                // One table below the other.
                for group in groups {
                    let part = |row: &Vec<String>| {
                        let cells = group.iter().map(|at| row.get(*at).cloned());
                        cells.map(Option::unwrap_or_default).collect()
                    };
                    let rows: Vec<Vec<String>> = rows.iter().map(part).collect();
                    let is_left = |place: &usize| left.contains(&group[*place]);
                    let left: Vec<usize> = (0..group.len()).filter(is_left).collect();
                    self.table(&rows, &left);
                }
                return;
            }
        };
        let mut head = None;
        if heading.iter().any(|cell| !cell.is_empty()) {
            self.row(heading, &columns, None, true);
            head = Some(self.blocks.len() - 1);
        }
        let first = self.blocks.len();
        for row in rest {
            self.row(row, &columns, head, false);
        }
        if let (None, Some(first)) = (head, self.blocks.get_mut(first)) {
            first.gap = GAP;
        }
    }

    /// A row of a table: its heading, or one below the heading row `head`, if there is one.
    fn row(
        &mut self,
        cells: &[String],
        columns: &Columns<'_>,
        head: Option<usize>,
        is_heading: bool,
    ) {
        let Columns { size, ref widths, left } = *columns;
        let wrapped: Vec<Vec<String>> = cells
            .iter()
            .zip(widths)
            .map(|(cell, width)| self.wrap(cell, size, width - 2.0 * size * PADDING.1))
            .collect();
        let line = LINE * size;
        let most = (HIGHEST_ROW * ROOM.1 / line).floor() as usize;
        let count = wrapped.iter().map(Vec::len).max().unwrap_or(0).max(1);
        for from in (0..count).step_by(most) {
            let lines = (count - from).min(most);
            let height = line * lines as f64 + 2.0 * size * PADDING.0;
            let mut x = 0.0;
            let area = if is_heading { HEAD_AREA } else { CELL_AREA };
            for (column, width) in widths.iter().enumerate() {
                self.pages.rectangle((x, 0.0), (*width, height), [LINES, area]);
                let cell = wrapped.get(column).map_or(&[][..], Vec::as_slice);
                for (index, words) in cell.iter().skip(from).take(lines).enumerate() {
                    let room = width - size * (2.0 * PADDING.1 + self.pages.width(words));
                    let shift = if left.contains(&column) { 0.0 } else { room };
                    let y = size * (1.0 + PADDING.0) + line * index as f64;
                    self.pages.line_of_text((x + size * PADDING.1 + shift, y), size, words);
                }
                x += width;
            }
            let gap = if is_heading { GAP } else { 0.0 };
            self.end_block(gap, height, is_heading, head);
        }
    }

    /// Chooses the size of a table's text and the widths of its columns: as wide as their content
    /// if there is room. Else columns of words become narrower, the widest ones first.
    ///
    /// # Errors
    /// Groups of columns that fit, the first column in each, where not all do.
    fn columns<'a>(
        &self,
        rows: &[Vec<String>],
        left: &'a [usize],
    ) -> Result<Columns<'a>, Vec<Vec<usize>>> {
        let count = rows.iter().map(Vec::len).max().unwrap_or(0);
        let widest = |column: usize, width: &dyn Fn(&str) -> f64| {
            let cells = rows.iter().filter_map(|row| row.get(column));
            cells.map(|cell| width(cell)).fold(0.0, f64::max)
        };
        let whole = |cell: &str| self.pages.width(cell);
        let word =
            |cell: &str| cell.split(' ').map(|word| self.pages.width(word)).fold(0.0, f64::max);
        let all = |width: &dyn Fn(usize) -> f64| (0..count).map(width).collect::<Vec<f64>>();
        let natural = all(&|column| widest(column, &whole));
        let short = all(&|column| widest(column, &word).min(LONG_WORD));
        // Numbers are not wrapped.
        let least = all(&|column| {
            if left.contains(&column) { short[column] } else { natural[column] }
        });
        let padded = |widths: &[f64], size: f64| -> Vec<f64> {
            widths.iter().map(|width| size * (width + 2.0 * PADDING.1) + 0.01).collect()
        };
        let fits = |size: &f64| padded(&least, *size).iter().sum::<f64>() <= ROOM.0;
        let last = TABLE[TABLE.len() - 1];
        let found = TABLE.into_iter().find(fits);
        if found.is_none() {
            let groups = groups(&padded(&least, last));
            if groups.len() > 1 {
                return Err(groups);
            }
        }
        let (size, least) = found.map_or((last, &short), |size| (size, &least));
        let widths = share(&padded(&natural, size), &padded(least, size), ROOM.0);
        Ok(Columns { size, widths, left })
    }

    /// Lines of `words` that are at most so wide (pt). A word that is wider is broken, behind a
    /// mark if there is one in the second half of the line.
    fn wrap(&self, words: &str, size: f64, room: f64) -> Vec<String> {
        let width = |text: &str| size * self.pages.width(text);
        let mut lines = Vec::new();
        let mut line = String::new();
        for word in words.split(' ') {
            let longer = if line.is_empty() { word.to_owned() } else { format!("{line} {word}") };
            if width(&longer) <= room {
                line = longer;
                continue;
            }
            if !line.is_empty() {
                lines.push(std::mem::take(&mut line));
            }
            let mut rest = word;
            while width(rest) > room {
                let ends = rest.char_indices().map(|(at, character)| at + character.len_utf8());
                let fitting: Vec<usize> =
                    ends.take_while(|end| width(&rest[..*end]) <= room).collect();
                // At least one character, however narrow the line.
                let first = rest.chars().next().map_or(0, char::len_utf8);
                let end = fitting.last().copied().unwrap_or(first);
                let is_mark = |end: &&usize| rest[..**end].ends_with(['/', '.', '_', '-', ',']);
                let mark = fitting.iter().rev().find(is_mark).copied();
                let end = mark.filter(|mark| 2 * mark > end).unwrap_or(end);
                lines.push(rest[..end].to_owned());
                rest = &rest[end..];
            }
            rest.clone_into(&mut line);
        }
        lines.push(line);
        lines
    }

    /// The file, with `title` in each foot, and the characters that it lacks.
    fn file(mut self, title: &str) -> (Vec<u8>, String) {
        let sheets = sheets(&self.blocks);
        let count = sheets.len();
        for (number, sheet) in (1..).zip(sheets) {
            for (y, block) in sheet {
                self.pages.draw((MARGIN, MARGIN + y), &self.blocks[block].drawn);
            }
            let page = format!("page {number} of {count}");
            let from = ROOM.0 - FOOT * self.pages.width(&page);
            let y = A4.1 - 0.5 * MARGIN;
            let lines = self.wrap(title, FOOT, from - 4.0 * FOOT);
            let more = if lines.len() > 1 { "…" } else { "" };
            self.pages.line_of_text((MARGIN, y), FOOT, &format!("{}{more}", lines[0]));
            self.pages.line_of_text((MARGIN + from, y), FOOT, &page);
            self.pages.end_page(A4);
        }
        let missing = self.pages.missing();
        (self.pages.file(Some(title)), missing)
    }
}

/// Columns in groups whose `widths` (pt) fit on a sheet, each with the first column; none of a
/// table whose first two columns do not fit.
fn groups(widths: &[f64]) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let first = widths.first().copied().unwrap_or(0.0);
    let mut wide = f64::INFINITY;
    for (column, width) in widths.iter().enumerate().skip(1) {
        if first + width > ROOM.0 {
            return Vec::new();
        }
        if wide + width > ROOM.0 {
            groups.push(vec![0]);
            wide = first;
        }
        wide += width;
        if let Some(group) = groups.last_mut() {
            group.push(column);
        }
    }
    groups
}

/// Widths between `least` and `natural` that add up to at most `room` (pt): all that are above a
/// common limit are cut to it. Without room for `least`, shares of it.
fn share(natural: &[f64], least: &[f64], room: f64) -> Vec<f64> {
    let least_sum: f64 = least.iter().sum();
    if least_sum > room {
        return least.iter().map(|width| width * room / least_sum).collect();
    }
    let cut = |limit: f64| -> Vec<f64> {
        natural.iter().zip(least).map(|(natural, least)| natural.min(limit).max(*least)).collect()
    };
    let (mut low, mut high) = (0.0, natural.iter().copied().fold(room, f64::max));
    // Halved to less than a billionth of a point.
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if cut(middle).iter().sum::<f64>() <= room { low = middle } else { high = middle }
    }
    cut(low)
}

/// Blocks of each sheet, with the heights at which they begin (pt).
fn sheets(blocks: &[Block]) -> Vec<Vec<(f64, usize)>> {
    let (mut sheets, mut sheet) = (Vec::new(), Vec::new());
    let mut y = 0.0;
    for (index, block) in blocks.iter().enumerate() {
        let gap = if sheet.is_empty() { 0.0 } else { block.gap };
        let mut end = y + gap + block.height;
        if index == 0 || !blocks[index - 1].stays_with_next {
            // Room for all that stays with it.
            let together = blocks[index..].windows(2).take_while(|pair| pair[0].stays_with_next);
            end += together.map(|pair| pair[1].gap + pair[1].height).sum::<f64>();
        }
        y += gap;
        if end > ROOM.1 && !sheet.is_empty() {
            sheets.push(std::mem::take(&mut sheet));
            y = 0.0;
            if let Some(head) = block.head {
                sheet.push((y, head));
                y += blocks[head].height;
            }
        }
        sheet.push((y, index));
        y += block.height;
    }
    sheets.push(sheet);
    sheets
}
