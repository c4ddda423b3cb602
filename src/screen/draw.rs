//! Puts a screen on a picture: graticule and traces.

use super::strokes::{CENTRE, CORNER, DIVISION, LEVELS, SPAN, dot, dots, line, text};
use embedded_graphics::Drawable as _;
use embedded_graphics::geometry::{Point, Size};
use embedded_graphics::primitives::{Primitive as _, PrimitiveStyle, Rectangle};

use super::picture::{Ink, Picture};
use super::surroundings::{above, below, menu};
use super::{Bar, Screen, Zoom};
use crate::instrument::scan::blank;
use crate::scope::{Source, Waveform};
/// The picture of a screen.
pub fn draw(screen: &Screen) -> Picture {
    let mut picture = Picture::new(screen.ink_saver);
    graticule(&mut picture);
    for bar in &screen.bars {
        dashes(&mut picture, *bar);
    }
    if screen.xy {
        against_each_other(&mut picture, &screen.traces);
    } else {
        for waveform in &screen.traces {
            trace(&mut picture, waveform, screen);
        }
    }
    above(&mut picture, screen);
    below(&mut picture, screen);
    menu(&mut picture, &screen.menu);
    picture
}

/// Frame, dotted lines, and the axes with a tick every fifth of a division.
fn graticule(picture: &mut Picture) {
    let ((left, top), (width, height)) = (CORNER, SPAN);
    let ink = Ink::Graticule;
    let frame = Rectangle::new(Point::new(left, top), Size::new(251, 201));
    let Ok(()) = frame.into_styled(PrimitiveStyle::with_stroke(ink, 1)).draw(picture);
    for step in 0..=50 {
        let (x, y) = (left + step * DIVISION / 5, top + step * DIVISION / 5);
        for down in 1..8 {
            dot(picture, x, top + down * DIVISION, ink);
        }
        line(picture, (x, CENTRE - 1), (x, CENTRE + 1), ink);
        if step <= 40 {
            for across in 1..10 {
                dot(picture, left + across * DIVISION, y, ink);
            }
            line(picture, (left + width / 2 - 1, y), (left + width / 2 + 1, y), ink);
        }
    }
    line(picture, (left, CENTRE), (left + width, CENTRE), ink);
    line(picture, (left + width / 2, top), (left + width / 2, top + height), ink);
}

fn dashes(picture: &mut Picture, bar: Bar) {
    let ((left, top), (width, height)) = (CORNER, SPAN);
    let is_gap = |step: &i32| step % 6 >= 4;
    match bar {
        Bar::Vertical(share) => {
            let x = left + dots(share * f64::from(width));
            if (left..=left + width).contains(&x) {
                for step in (0..height).filter(|step| !is_gap(step)) {
                    dot(picture, x, top + step, Ink::Bar);
                }
            }
        }
        Bar::Horizontal(divisions) => {
            let y = CENTRE - dots(divisions * LEVELS);
            if (top..=top + height).contains(&y) {
                for step in (0..width).filter(|step| !is_gap(step)) {
                    dot(picture, left + step, y, Ink::Bar);
                }
            }
        }
    }
}

/// Lowest, highest and last level of a waveform in each column of dots.
type Column = Option<(i32, i32, i32)>;

fn trace(picture: &mut Picture, waveform: &Waveform, screen: &Screen) {
    let ink = Ink::of(waveform.source);
    let zoom = (waveform.preamble.x_unit == "Hz").then_some(screen.zoom);
    let (first, points) = shown(waveform.codes.len(), zoom);
    let heights: Vec<f64> = waveform.heights().collect();
    let height = |level: f64| {
        CENTRE - dots(zoom.map_or(level, |zoom| level * zoom.up + zoom.position * LEVELS))
    };
    let bounded = |y: i32| y.clamp(CORNER.1, CORNER.1 + SPAN.1);
    let blank = blank(waveform);
    let mut before: Option<i32> = None;
    for column in 0..SPAN.0 {
        let range = first + points * f64::from(column) / f64::from(SPAN.0);
        let end = first + points * f64::from(column + 1) / f64::from(SPAN.0);
        let levels = between(&heights, range, end);
        let levels = levels.iter().zip(between(&blank, range, end)).filter(|(_, blank)| !**blank);
        let heights: Vec<i32> = levels.map(|(code, _)| height(*code)).collect();
        let x = CORNER.0 + 1 + column;
        if screen.dots {
            let inside = heights.iter().filter(|y| bounded(**y) == **y);
            inside.for_each(|y| dot(picture, x, *y, ink));
            continue;
        }
        let spread: Column =
            heights.iter().min().zip(heights.iter().max()).zip(heights.last()).map(
                |((high, low), last)| {
                    let from = before.unwrap_or(*high);
                    ((*high).min(from), (*low).max(from), *last)
                },
            );
        if let Some((high, low, _)) = spread
            && low >= CORNER.1
            && high <= CORNER.1 + SPAN.1
        {
            line(picture, (x, bounded(high)), (x, bounded(low)), ink);
        }
        before = spread.map(|(.., last)| last);
    }
    ground(picture, waveform, zoom);
}

/// First point on the screen, and how many are on it (1).
fn shown(points: usize, zoom: Option<Zoom>) -> (f64, f64) {
    let points = points as f64;
    let Some(zoom) = zoom else { return (0.0, points) };
    let seen = points / zoom.across.max(1.0);
    ((points * zoom.centre - 0.5 * seen).clamp(0.0, points - seen), seen)
}

/// The codes of a column, at least one.
fn between<T>(points: &[T], start: f64, end: f64) -> &[T] {
    let start = start.floor() as usize;
    let end = (end.floor() as usize).max(start + 1).min(points.len());
    points.get(start..end).unwrap_or_default()
}

/// An arrow at the left edge at zero volts, with the channel's number.
fn ground(picture: &mut Picture, waveform: &Waveform, zoom: Option<Zoom>) {
    let level = zoom.map_or_else(|| waveform.ground(), |zoom| zoom.position * LEVELS);
    let y = (CENTRE - dots(level)).clamp(CORNER.1 + 3, CORNER.1 + SPAN.1 - 3);
    let ink = Ink::of(waveform.source);
    let name = match waveform.source {
        Source::Channel(number) => number.to_string(),
        Source::Math => "M".to_owned(),
        Source::Reference(letter) => letter.to_string(),
    };
    text(picture, (1, y - 4), &name, ink);
    for step in 0..4 {
        line(picture, (6 + step, y - 3 + step), (6 + step, y + 3 - step), ink);
    }
}

/// Channel 2 upward against channel 1 to the right, both 25 dots a division.
fn against_each_other(picture: &mut Picture, traces: &[Waveform]) {
    let of = |number| traces.iter().find(|trace| trace.source == Source::Channel(number));
    let (Some(x), Some(y)) = (of(1), of(2)) else { return };
    let centre = CORNER.0 + SPAN.0 / 2;
    for (right, up) in x.heights().zip(y.heights()) {
        let (x, y) = (centre + right.round() as i32, CENTRE - up.round() as i32);
        if (CORNER.1..=CORNER.1 + SPAN.1).contains(&y) {
            dot(picture, x, y, Ink::Channel1);
        }
    }
}
