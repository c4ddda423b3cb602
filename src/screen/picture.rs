//! Dots in sixteen colours.

use embedded_graphics::Pixel;
use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::geometry::{OriginDimensions, Size};
use embedded_graphics::pixelcolor::PixelColor;
use embedded_graphics::pixelcolor::raw::RawU8;

use crate::scope::Source;

/// Dots across.
pub const WIDTH: usize = 320;
/// Dots down.
pub const HEIGHT: usize = 240;

/// The part of the screen that a dot belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Ink {
    /// Nothing.
    #[default]
    Background,
    /// The graticule.
    Graticule,
    /// Text.
    Text,
    /// Channel 1.
    Channel1,
    /// Channel 2.
    Channel2,
    /// Channel 3.
    Channel3,
    /// Channel 4.
    Channel4,
    /// The math trace.
    Math,
    /// A reference memory.
    Reference,
    /// Behind the menu's title.
    Menu,
    /// Cursors and the window's edges.
    Bar,
}

/// Every ink with its colour on black and on white: red, green, blue.
const COLOURS: [(Ink, [u8; 3], [u8; 3]); 11] = [
    (Ink::Background, [0, 0, 0], [255, 255, 255]),
    (Ink::Graticule, [110, 110, 110], [150, 150, 150]),
    (Ink::Text, [230, 230, 230], [0, 0, 0]),
    (Ink::Channel1, [255, 216, 0], [176, 128, 0]),
    (Ink::Channel2, [0, 208, 255], [0, 96, 224]),
    (Ink::Channel3, [255, 96, 192], [200, 0, 144]),
    (Ink::Channel4, [64, 224, 96], [0, 136, 32]),
    (Ink::Math, [255, 80, 64], [208, 0, 0]),
    (Ink::Reference, [224, 224, 224], [96, 96, 96]),
    (Ink::Menu, [48, 64, 112], [208, 216, 240]),
    (Ink::Bar, [255, 160, 64], [224, 96, 0]),
];

impl PixelColor for Ink {
    type Raw = RawU8;
}

impl Ink {
    /// The ink of a waveform.
    pub fn of(source: Source) -> Self {
        match source {
            Source::Channel(0 | 1) => Self::Channel1,
            Source::Channel(2) => Self::Channel2,
            Source::Channel(3) => Self::Channel3,
            Source::Channel(_) => Self::Channel4,
            Source::Math => Self::Math,
            Source::Reference(_) => Self::Reference,
        }
    }

    /// Its place in the palette.
    fn index(self) -> u8 {
        let place = COLOURS.iter().position(|(ink, ..)| *ink == self);
        place.and_then(|place| u8::try_from(place).ok()).unwrap_or(0)
    }
}

/// A picture of the screen, row by row from the upper left corner.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    dots: Vec<Ink>,
    on_white: bool,
}

impl Picture {
    /// An empty picture, black, or white to save ink.
    pub fn new(on_white: bool) -> Self {
        Self { dots: vec![Ink::Background; WIDTH * HEIGHT], on_white }
    }

    /// The dot at a place, background outside.
    pub fn dot(&self, x: usize, y: usize) -> Ink {
        if x >= WIDTH {
            return Ink::Background;
        }
        self.dots.get(y * WIDTH + x).copied().unwrap_or_default()
    }

    /// The rows from above, as places in the palette.
    pub fn rows(&self) -> impl DoubleEndedIterator<Item = Vec<u8>> + '_ {
        self.dots.chunks(WIDTH).map(|row| row.iter().map(|ink| ink.index()).collect())
    }

    /// Red, green and blue of each place in the palette.
    pub fn palette(&self) -> impl Iterator<Item = [u8; 3]> + '_ {
        COLOURS.iter().map(|(_, black, white)| if self.on_white { *white } else { *black })
    }
}

impl OriginDimensions for Picture {
    fn size(&self) -> Size {
        Size::new(WIDTH as u32, HEIGHT as u32)
    }
}

impl DrawTarget for Picture {
    type Color = Ink;
    type Error = std::convert::Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<Ink>>>(
        &mut self,
        pixels: I,
    ) -> Result<(), Self::Error> {
        for Pixel(at, ink) in pixels {
            let (Ok(x), Ok(y)) = (usize::try_from(at.x), usize::try_from(at.y)) else { continue };
            if x < WIDTH
                && let Some(dot) = self.dots.get_mut(y * WIDTH + x)
            {
                *dot = ink;
            }
        }
        Ok(())
    }
}
