//! Pictures as files: the formats of `HARDCopy` that a computer reads.
//!
//! Sources: BMP and its run lengths as in the Windows SDK (`BITMAPINFOHEADER`, `BI_RLE8`); PCX
//! version 5, the technical reference of its maker; TIFF 6.0, palette colour, no compression;
//! PostScript Language Reference, level 1 and 2, in an EPSF-3.0.

use std::fmt::Write as _;

use super::picture::{HEIGHT, Picture, WIDTH};

/// Formats of pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PictureFormat {
    /// Windows bitmap, eight bits a dot.
    Bmp,
    /// The same with run lengths.
    Rle,
    /// PC Paintbrush.
    Pcx,
    /// Tagged image file.
    Tiff,
    /// Encapsulated PostScript in colour.
    EpsColour,
    /// Encapsulated PostScript in greys.
    EpsMono,
}

/// Colours that a palette of eight bits has room for.
const PALETTE: usize = 256;
/// Bytes of a bitmap's two headers.
const BMP_HEADERS: usize = 14 + 40;
/// Longest run of one byte in a bitmap's run lengths.
const LONGEST_RUN: usize = 255;
/// Longest run in PC Paintbrush, and the mark of one.
const PCX_RUN: (usize, u8) = (63, 0xC0);

/// `picture` as a file.
pub fn file(picture: &Picture, format: PictureFormat) -> Vec<u8> {
    match format {
        PictureFormat::Bmp => {
            let dots: Vec<u8> = picture.rows().rev().flatten().collect();
            bmp(picture, 0, &dots)
        }
        PictureFormat::Rle => bmp(picture, 1, &run_lengths(picture)),
        PictureFormat::Pcx => pcx(picture),
        PictureFormat::Tiff => tiff(picture),
        PictureFormat::EpsColour => eps(picture, true).into_bytes(),
        PictureFormat::EpsMono => eps(picture, false).into_bytes(),
    }
}

fn four(number: usize) -> [u8; 4] {
    (number as u32).to_le_bytes()
}

fn two(number: usize) -> [u8; 2] {
    (number as u16).to_le_bytes()
}

/// A bitmap with this compression and these bytes of dots, lowest row first.
fn bmp(picture: &Picture, compression: usize, dots: &[u8]) -> Vec<u8> {
    // 72 dots an inch, as others write.
    const DOTS_PER_METRE: usize = 2835;
    let start = BMP_HEADERS + 4 * PALETTE;
    let mut out = b"BM".to_vec();
    for number in [start + dots.len(), 0, start, 40, WIDTH, HEIGHT] {
        out.extend(four(number));
    }
    out.extend(two(1));
    out.extend(two(8));
    for number in [compression, dots.len(), DOTS_PER_METRE, DOTS_PER_METRE, PALETTE, 0] {
        out.extend(four(number));
    }
    for [red, green, blue] in full_palette(picture) {
        out.extend([blue, green, red, 0]);
    }
    out.extend_from_slice(dots);
    out
}

fn full_palette(picture: &Picture) -> impl Iterator<Item = [u8; 3]> + '_ {
    picture.palette().chain(std::iter::repeat([0; 3])).take(PALETTE)
}

/// Runs of equal bytes, each no longer than `longest`.
fn runs(row: &[u8], longest: usize) -> impl Iterator<Item = (usize, u8)> + '_ {
    let equal = row.chunk_by(|a, b| a == b);
    equal
        .flat_map(move |run| run.chunks(longest))
        .filter_map(|run| Some((run.len(), *run.first()?)))
}

fn run_lengths(picture: &Picture) -> Vec<u8> {
    let mut out = Vec::new();
    for row in picture.rows().rev() {
        for (length, dot) in runs(&row, LONGEST_RUN) {
            out.extend([two(length)[0], dot]);
        }
        // End of the line.
        out.extend([0, 0]);
    }
    // End of the picture.
    out.extend([0, 1]);
    out
}

fn pcx(picture: &Picture) -> Vec<u8> {
    let mut out = vec![0x0A, 5, 1, 8];
    for number in [0, 0, WIDTH - 1, HEIGHT - 1, 72, 72] {
        out.extend(two(number));
    }
    out.resize(65, 0);
    out.push(1);
    for number in [WIDTH, 1, 0, 0] {
        out.extend(two(number));
    }
    out.resize(128, 0);
    let (longest, mark) = PCX_RUN;
    for row in picture.rows() {
        for (length, dot) in runs(&row, longest) {
            if length > 1 || dot >= mark {
                out.push(mark | two(length)[0]);
            }
            out.push(dot);
        }
    }
    out.push(0x0C);
    out.extend(full_palette(picture).flatten());
    out
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
    out.extend(four(HEADER));
    out.extend(two(entries.len()));
    for (tag, kind, count, value) in entries {
        out.extend(two(tag));
        out.extend(two(kind));
        out.extend(four(count));
        out.extend(four(value));
    }
    out.extend(four(0));
    for part in 0..3 {
        for colour in full_palette(picture) {
            let value = colour.get(part).copied().unwrap_or(0);
            out.extend([value, value]);
        }
    }
    out.extend(picture.rows().flatten());
    out
}

/// A page of 640 x 480 points with the picture on it, each dot in hexadecimal.
fn eps(picture: &Picture, in_colour: bool) -> String {
    let (width, height) = (2 * WIDTH, 2 * HEIGHT);
    let parts = if in_colour { 3 } else { 1 };
    let operator = if in_colour { "false 3 colorimage" } else { "image" };
    let mut out = format!(
        "%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 {width} {height}\n%%EndComments\n\
         gsave\n{width} {height} scale\n/row {} string def\n\
         {WIDTH} {HEIGHT} 8 [{WIDTH} 0 0 -{HEIGHT} 0 {HEIGHT}]\n\
         {{currentfile row readhexstring pop}} {operator}\n",
        parts * WIDTH
    );
    let palette: Vec<[u8; 3]> = full_palette(picture).collect();
    for row in picture.rows() {
        for dot in row {
            let [red, green, blue] = palette.get(usize::from(dot)).copied().unwrap_or_default();
            // Writing to a String cannot fail.
            let _ = if in_colour {
                write!(out, "{red:02x}{green:02x}{blue:02x}")
            } else {
                write!(out, "{:02x}", grey([red, green, blue]))
            };
        }
        out.push('\n');
    }
    out.push_str("grestore\nshowpage\n%%EOF\n");
    out
}

/// Luminance of ITU-R BT.601, in whole numbers.
fn grey([red, green, blue]: [u8; 3]) -> u8 {
    let sum = 299 * u32::from(red) + 587 * u32::from(green) + 114 * u32::from(blue);
    u8::try_from(sum / 1000).unwrap_or(u8::MAX)
}
