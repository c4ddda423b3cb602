//! Lines, dots and text on the picture.

use embedded_graphics::Drawable as _;
use embedded_graphics::Pixel;
use embedded_graphics::geometry::Point;
use embedded_graphics::mono_font::MonoTextStyle;
use embedded_graphics::mono_font::iso_8859_1::FONT_5X8;
use embedded_graphics::primitives::{Line, Primitive as _, PrimitiveStyle};
use embedded_graphics::text::{Baseline, Text};

use super::picture::{Ink, Picture};
use crate::scope::waveform::LEVELS_PER_DIVISION;

/// Levels of the digitiser in a division, each a dot high (1).
pub const LEVELS: f64 = LEVELS_PER_DIVISION;

/// Left and upper edge of the graticule, in dots.
pub(super) const CORNER: (i32, i32) = (11, 17);

/// Dots in a division.
pub(super) const DIVISION: i32 = 25;

/// Width and height of the graticule in dots.
pub(super) const SPAN: (i32, i32) = (10 * DIVISION, 8 * DIVISION);

/// The graticule's centre, the place of level 0.
pub(super) const CENTRE: i32 = CORNER.1 + SPAN.1 / 2;

pub(super) fn line(picture: &mut Picture, from: (i32, i32), to: (i32, i32), ink: Ink) {
    let line = Line::new(Point::new(from.0, from.1), Point::new(to.0, to.1));
    let Ok(()) = line.into_styled(PrimitiveStyle::with_stroke(ink, 1)).draw(picture);
}

pub(super) fn dot(picture: &mut Picture, x: i32, y: i32, ink: Ink) {
    let Ok(()) = Pixel(Point::new(x, y), ink).draw(picture);
}

pub(super) fn text(picture: &mut Picture, (x, y): (i32, i32), words: &str, ink: Ink) {
    let style = MonoTextStyle::new(&FONT_5X8, ink);
    let Ok(_) = Text::with_baseline(words, Point::new(x, y), style, Baseline::Top).draw(picture);
}

/// Text that ends at `right`.
pub(super) fn text_to(picture: &mut Picture, (right, y): (i32, i32), words: &str, ink: Ink) {
    let letters = i32::try_from(words.chars().count()).unwrap_or(0);
    text(picture, (right - 5 * letters, y), words, ink);
}

pub(super) fn dots(number: f64) -> i32 {
    if number.is_nan() { 0 } else { number.round().clamp(-5000.0, 5000.0) as i32 }
}
