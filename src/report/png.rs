//! Pictures as PNG: SVG drawn at twice its size, its text with the program's own font, so that they
//! look alike on every machine.

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};

use super::outlines::outline_text;

/// Dots to a unit of the SVG (1).
const PIXELS_PER_UNIT: f32 = 2.0;

/// Why a picture could not be drawn: mistakes of whatever made the SVG.
#[derive(Debug, thiserror::Error)]
pub enum PngError {
    /// Invalid SVG.
    #[error("found no SVG: {0}")]
    Svg(#[from] resvg::usvg::Error),
    /// The built-in font cannot be read.
    #[error("cannot read the built-in font: {0}")]
    Font(#[from] ttf_parser::FaceParsingError),
    /// Its size is zero or beyond memory.
    #[error("found a picture of {0} x {1} dots, expected one that can be drawn")]
    Size(u32, u32),
    /// It could not be packed.
    #[error("{0}")]
    Encoding(String),
}

/// The picture `svg` as a PNG file.
///
/// # Errors
/// [`PngError`] where `svg` is not valid SVG.
pub fn png(svg: &str) -> Result<Vec<u8>, PngError> {
    let tree = Tree::from_str(&outline_text(svg)?, &Options::default())?;
    let size = tree.size().to_int_size();
    let size = size.scale_by(PIXELS_PER_UNIT).unwrap_or(size);
    let pixmap = Pixmap::new(size.width(), size.height());
    let mut pixmap = pixmap.ok_or(PngError::Size(size.width(), size.height()))?;
    resvg::render(
        &tree,
        Transform::from_scale(PIXELS_PER_UNIT, PIXELS_PER_UNIT),
        &mut pixmap.as_mut(),
    );
    pixmap.encode_png().map_err(|error| PngError::Encoding(error.to_string()))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

    use super::*;

    fn drawn(content: &str) -> Pixmap {
        let svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 60 20\" font-family=\"sans-serif\" font-size=\"14\">\
             <rect width=\"60\" height=\"20\" fill=\"#ffffff\"/>{content}</svg>"
        );
        Pixmap::decode_png(&png(&svg).unwrap()).unwrap()
    }

    fn dark(picture: &Pixmap) -> usize {
        picture.pixels().iter().filter(|dot| dot.red() < 128).count()
    }

    #[test]
    fn pictures_are_drawn_at_twice_their_size_with_their_text() {
        let empty = drawn("");
        assert_eq!((empty.width(), empty.height(), dark(&empty)), (120, 40, 0));
        // Every sign that axes use has a shape of its own: a font without it would draw nothing, or
        // the same box twice.
        let signs = ["1", "k", "Hz", "µ", "·", "²", "−", "±", "γ", "₁", "≤", "…"];
        let shapes: Vec<Vec<u8>> = signs
            .iter()
            .map(|sign| {
                let picture = drawn(&format!("<text x=\"5\" y=\"15\">{sign}</text>"));
                assert!(dark(&picture) > 2, "{sign}");
                picture.data().to_vec()
            })
            .collect();
        for (index, shape) in shapes.iter().enumerate() {
            assert!(!shapes[..index].contains(shape), "{}", signs[index]);
        }
    }

    #[test]
    fn what_is_no_picture_is_refused() {
        assert!(matches!(png("no picture"), Err(PngError::Svg(_))));
    }
}
