//! A plot in a terminal: lines in Braille characters, two dots across and four down in each; maps
//! in shades.

use super::{Axis, Plot, Stroke};
use crate::report::table::width;

/// Characters across and down.
const PLOT_SIZE: (usize, usize) = (72, 14);
/// The same of a map.
const MAP_SIZE: (usize, usize) = (72, 20);
/// Dots in a character.
const DOTS_PER_CELL: (usize, usize) = (2, 4);
/// Bit of each dot in a Braille character, by column and row.
const BRAILLE_BITS: [[u32; 4]; 2] = [[0x01, 0x02, 0x04, 0x40], [0x08, 0x10, 0x20, 0x80]];
/// The Braille character without a dot.
const EMPTY_BRAILLE: u32 = 0x2800;
/// A vertical line at a mark has one dot in this many.
const MARK_SPACING: usize = 3;
/// Shades from nothing to the highest.
const SHADES: [char; 5] = [' ', '░', '▒', '▓', '█'];

/// The plot as lines of text. On a map a named line is drawn as the last character of its name.
pub fn terminal(plot: &Plot) -> Vec<String> {
    let rows = match &plot.map {
        Some(map) => shaded(plot, &map.columns),
        None => braille(plot),
    };
    let mut lines = framed(&rows, plot);
    let named = plot.marks.iter().map(|(_, name)| format!("  ┊ {name}"));
    lines.extend(named);
    lines
}

fn place(axis: &Axis, value: f64, cells: usize) -> usize {
    ((axis.share(value) * (cells - 1) as f64).round().max(0.0) as usize).min(cells - 1)
}

fn braille(plot: &Plot) -> Vec<String> {
    let (across, down) = (PLOT_SIZE.0 * DOTS_PER_CELL.0, PLOT_SIZE.1 * DOTS_PER_CELL.1);
    let mut canvas = Canvas(vec![vec![0; PLOT_SIZE.0]; PLOT_SIZE.1]);
    let dot = |(x, y): (f64, f64)| (place(&plot.x, x, across), down - 1 - place(&plot.y, y, down));
    let (left, right) = (plot.x.from, plot.x.to);
    for (x, _) in plot.marks.iter().filter(|(x, _)| (left..=right).contains(x)) {
        let column = place(&plot.x, *x, across);
        (0..down).step_by(MARK_SPACING).for_each(|row| canvas.set(column, row));
    }
    for series in &plot.lines {
        let dots: Vec<(usize, usize)> = series.points.iter().copied().map(dot).collect();
        match series.stroke {
            // Areas and what is behind a line would hide it.
            Stroke::Filled => {}
            _ if series.colour == super::BACKGROUND_COLOUR => {}
            Stroke::Solid | Stroke::Dashed => {
                dots.windows(2).for_each(|pair| canvas.line(pair[0], pair[1]));
            }
            Stroke::Bars => {
                dots.chunks_exact(2).for_each(|pair| canvas.line(pair[0], pair[1]));
            }
            Stroke::Dots => dots.into_iter().for_each(|(x, y)| {
                canvas.line((x.saturating_sub(1), y), (x + 1, y));
                canvas.line((x, y.saturating_sub(1)), (x, y + 1));
            }),
        }
    }
    canvas.rows()
}

/// The map's shades, each cell the highest share in it.
fn shaded(plot: &Plot, columns: &[Vec<f64>]) -> Vec<String> {
    let (across, down) = MAP_SIZE;
    let mut cells = vec![vec![0.0_f64; across]; down];
    let count = columns.len().max(1);
    for (index, shares) in columns.iter().enumerate() {
        // With fewer columns than cells each fills several.
        let reach = (index * across / count)..((index + 1) * across).div_ceil(count);
        for (bin, share) in shares.iter().enumerate() {
            let rows = (bin * down / shares.len())..((bin + 1) * down).div_ceil(shares.len());
            for cell in cells[rows].iter_mut().flat_map(|row| &mut row[reach.clone()]) {
                *cell = cell.max(*share);
            }
        }
    }
    let shade =
        |share: &f64| SHADES[((share * SHADES.len() as f64) as usize).min(SHADES.len() - 1)];
    let mut rows: Vec<Vec<char>> =
        cells.iter().rev().map(|row| row.iter().map(shade).collect()).collect();
    for series in &plot.lines {
        let Some(sign) = series.name.chars().last() else { continue };
        for (x, y) in &series.points {
            if (0.0..=1.0).contains(&plot.y.share(*y)) {
                rows[down - 1 - place(&plot.y, *y, down)][place(&plot.x, *x, across)] = sign;
            }
        }
    }
    rows.into_iter().map(|row| row.into_iter().collect()).collect()
}

/// Rows of characters, from above, with both axes and their round numbers, and the words beside.
fn framed(rows: &[String], plot: &Plot) -> Vec<String> {
    let (x, y) = (&plot.x, &plot.y);
    let across = rows.first().map_or(0, |row| row.chars().count());
    let cell = |axis: &Axis, value: f64, cells: usize| {
        let cell = (axis.share(value) * cells as f64) as usize;
        cell.min(cells.saturating_sub(1))
    };
    let from_above = |value: f64| rows.len() - 1 - cell(y, value, rows.len());
    let names: Vec<(usize, &String)> =
        y.ticks.iter().map(|(value, name)| (from_above(*value), name)).collect();
    let margin = names.iter().map(|(_, name)| width(name)).max().unwrap_or(0);
    let mut lines = vec![format!("  {}", y.label)];
    for (index, row) in rows.iter().enumerate() {
        let named = names.iter().find(|(row, _)| *row == index);
        let (name, edge) = named.map_or(("", '│'), |(_, name)| (name.as_str(), '┤'));
        let beside = plot.beside.iter().filter(|(value, _)| from_above(*value) == index);
        let beside: Vec<&str> = beside.map(|(_, words)| words.as_str()).collect();
        let line = format!("  {name:>margin$} {edge}{row}  {}", beside.join(", "));
        lines.push(line.trim_end().to_owned());
    }
    let (mut edge, mut below) = (vec!['─'; across], String::new());
    for (value, name) in &x.ticks {
        let at = cell(x, *value, across);
        let start = at.saturating_sub(width(name) / 2);
        let end = width(&below);
        if end == 0 || start > end {
            edge[at] = '┬';
            below.push_str(&" ".repeat(start - end));
            below.push_str(name);
        }
    }
    let edge: String = edge.into_iter().collect();
    lines.push(format!("  {:margin$} └{edge}", ""));
    lines.push(format!("  {:margin$}  {below}", "").trim_end().to_owned());
    lines.push(format!("  {:margin$}  {:^across$}", "", x.label).trim_end().to_owned());
    lines
}

struct Canvas(Vec<Vec<u32>>);

impl Canvas {
    fn set(&mut self, x: usize, y: usize) {
        let cell =
            self.0.get_mut(y / DOTS_PER_CELL.1).and_then(|row| row.get_mut(x / DOTS_PER_CELL.0));
        if let Some(cell) = cell {
            *cell |= BRAILLE_BITS[x % DOTS_PER_CELL.0][y % DOTS_PER_CELL.1];
        }
    }

    /// Bresenham's line.
    fn line(&mut self, from: (usize, usize), to: (usize, usize)) {
        let (across, down) = (to.0.abs_diff(from.0), to.1.abs_diff(from.1));
        let steps = across.max(down);
        let between = |a: usize, b: usize, step: usize| {
            if b >= a {
                a + ((b - a) * step + steps / 2) / steps.max(1)
            } else {
                a - ((a - b) * step + steps / 2) / steps.max(1)
            }
        };
        for step in 0..=steps {
            self.set(between(from.0, to.0, step), between(from.1, to.1, step));
        }
    }

    fn rows(&self) -> Vec<String> {
        let character = |dots: &u32| char::from_u32(EMPTY_BRAILLE + dots).unwrap_or(' ');
        self.0.iter().map(|row| row.iter().map(character).collect()).collect()
    }
}
