//! Pictures as PNG: SVG drawn at twice its size, or with 600 dots per inch if its size is in
//! millimetres; its text with the program's own font, so that they look alike on every machine.

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};

use super::outlines::outline_text;

/// Dots to a pixel of the SVG, 1/96 inch, of a picture with a size on paper and of others (1).
const DOTS_ON_PAPER: f32 = 6.25;
const DOTS: f32 = 2.0;
/// Pixels of an SVG to a metre.
const PIXELS_PER_METRE: f32 = 96.0 / 0.0254;
/// Length of a PNG's signature and first chunk (bytes).
const HEADER_BYTES: usize = 33;

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
    let has_paper = svg.split_once('>').is_some_and(|(root, _)| root.contains("mm\""));
    let dots = if has_paper { DOTS_ON_PAPER } else { DOTS };
    let size = tree.size();
    let whole = size.to_int_size();
    let size = size.scale_by(dots).map_or(whole, |size| size.to_int_size());
    let pixmap = Pixmap::new(size.width(), size.height());
    let mut pixmap = pixmap.ok_or(PngError::Size(size.width(), size.height()))?;
    resvg::render(&tree, Transform::from_scale(dots, dots), &mut pixmap.as_mut());
    let mut file = pixmap.encode_png().map_err(|error| PngError::Encoding(error.to_string()))?;
    let density = (dots * PIXELS_PER_METRE).round() as u32;
    file.splice(HEADER_BYTES..HEADER_BYTES, physical_size(density));
    Ok(file)
}

/// The chunk `pHYs` with `density` dots to a metre both ways (PNG, third edition, 11.3.4.3).
fn physical_size(density: u32) -> Vec<u8> {
    let mut chunk = b"pHYs".to_vec();
    chunk.extend([density.to_be_bytes(), density.to_be_bytes()].concat());
    chunk.push(1);
    let length = (chunk.len() as u32 - 4).to_be_bytes();
    let sum = crc32fast::hash(&chunk).to_be_bytes();
    [&length[..], &chunk, &sum].concat()
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
