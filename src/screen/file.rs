//! Pictures as files: Windows bitmap and TIFF.
//!
//! Sources: BMP as in the Windows SDK (`BITMAPINFOHEADER`); TIFF 6.0, palette colour, no
//! compression.

use super::picture::{HEIGHT, Picture, WIDTH};

/// Formats of pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PictureFormat {
    /// Windows bitmap, eight bits a dot.
    Bmp,
    /// Tagged image file.
    Tiff,
}

/// Colours that a palette of eight bits has room for.
const PALETTE: usize = 256;
/// Bytes of a bitmap's two headers.
const BMP_HEADERS: usize = 14 + 40;

/// `picture` as a file.
pub fn file(picture: &Picture, format: PictureFormat) -> Vec<u8> {
    match format {
        PictureFormat::Bmp => bmp(picture),
        PictureFormat::Tiff => tiff(picture),
    }
}

fn u32_le(number: usize) -> [u8; 4] {
    (number as u32).to_le_bytes()
}

fn u16_le(number: usize) -> [u8; 2] {
    (number as u16).to_le_bytes()
}

/// Dots of eight bits, lowest row first, behind two headers and the palette.
fn bmp(picture: &Picture) -> Vec<u8> {
    // 72 dots an inch, as others write.
    const DOTS_PER_METRE: usize = 2835;
    let dots: Vec<u8> = picture.rows().rev().flatten().collect();
    let start = BMP_HEADERS + 4 * PALETTE;
    let mut out = b"BM".to_vec();
    for number in [start + dots.len(), 0, start, 40, WIDTH, HEIGHT] {
        out.extend(u32_le(number));
    }
    out.extend(u16_le(1));
    out.extend(u16_le(8));
    for number in [0, dots.len(), DOTS_PER_METRE, DOTS_PER_METRE, PALETTE, 0] {
        out.extend(u32_le(number));
    }
    for [red, green, blue] in full_palette(picture) {
        out.extend([blue, green, red, 0]);
    }
    out.extend_from_slice(&dots);
    out
}

fn full_palette(picture: &Picture) -> impl Iterator<Item = [u8; 3]> + '_ {
    picture.palette().chain(std::iter::repeat([0; 3])).take(PALETTE)
}

/// One strip of eight-bit dots behind the directory and the palette.
fn tiff(picture: &Picture) -> Vec<u8> {
    const SHORT: usize = 3;
    const LONG: usize = 4;
    const HEADER: usize = 8;
    let colours = HEADER + 2 + 12 * 10 + 4;
    let dots = colours + 2 * 3 * PALETTE;
    let entries: [(usize, usize, usize, usize); 10] = [
        (256, SHORT, 1, WIDTH),
        (257, SHORT, 1, HEIGHT),
        (258, SHORT, 1, 8),
        (259, SHORT, 1, 1),
        (262, SHORT, 1, 3),
        (273, LONG, 1, dots),
        (277, SHORT, 1, 1),
        (278, SHORT, 1, HEIGHT),
        (279, LONG, 1, WIDTH * HEIGHT),
        (320, SHORT, 3 * PALETTE, colours),
    ];
    let mut out = b"II*\0".to_vec();
    out.extend(u32_le(HEADER));
    out.extend(u16_le(entries.len()));
    for (tag, kind, count, value) in entries {
        out.extend(u16_le(tag));
        out.extend(u16_le(kind));
        out.extend(u32_le(count));
        out.extend(u32_le(value));
    }
    out.extend(u32_le(0));
    for part in 0..3 {
        for colour in full_palette(picture) {
            let value = colour.get(part).copied().unwrap_or(0);
            out.extend([value, value]);
        }
    }
    out.extend(picture.rows().flatten());
    out
}
