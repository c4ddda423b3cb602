//! Which wave each frequency travels as: wavenumbers of the same contact in cell after cell.
//!
//! The rows `x_n(t)` of one quantity at equal places of successive cells are multiplied with Hann's
//! window over time and over cells and transformed over both,
//! `X(f, phi) = sum w_n w_t x_n(t) exp(-2 pi i f t + i phi n)`: a wave `cos(2 pi f t - phi n)`,
//! which runs toward higher `n`, is a maximum at `phi`, one that comes back a maximum at `-phi`. At
//! each frequency, `1/T` apart, the highest maximum of either direction is a line if it stands out
//! of the whole plane. Frequencies are separated at `1/T`, phases at `2 pi/cells`; Hann's window
//! doubles both. Source: D. Alleyne, P. Cawley, J. Acoust. Soc. Am. 89, 1159 (1991). Valid for
//! waves that fill many cells; where a signal decays over a few, as in a band gap, there is no
//! wavenumber to be found.

use std::f64::consts::{PI, TAU};

use realfft::num_complex::Complex;

use super::fourier::Fourier;
use super::spectrum::Window;
use crate::numeric::roots::vertex;

/// Phases looked at, in cells.
const PADDING: usize = 8;
/// Fewest cells in which a wavenumber is looked for.
const MIN_CELLS: usize = 8;
/// Fewest samples of a row.
const MIN_SAMPLES: usize = 16;

/// Why no wavenumbers are found.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum WavenumberError {
    /// Too few cells.
    #[error("found {cells} cells in a row, expected at least {MIN_CELLS} for a wavenumber")]
    TooFewCells {
        /// How many.
        cells: usize,
    },
    /// Too few samples, or rows of different lengths.
    #[error(
        "found {samples} samples in the time looked at, expected at least {MIN_SAMPLES} in each row"
    )]
    TooShort {
        /// Of the shortest row.
        samples: usize,
    },
    /// A value is not a number.
    #[error("found a value that is not finite, expected numbers only")]
    NotFinite,
}

/// A wave that was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpectralLine {
    /// Frequency (Hz).
    pub frequency: f64,
    /// Phase from one cell to the next, `k a`, between 0 and pi (rad).
    pub phase: f64,
    /// Whether its phase runs toward higher cells; its energy does so as well on the acoustic
    /// branch, and the other way on the optical one.
    pub onward: bool,
    /// Height over the highest of the plane (1).
    pub height: f64,
}

/// Waves of a field.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectralLines {
    /// The waves, by frequency.
    pub lines: Vec<SpectralLine>,
    /// Half of the least distance of frequencies that the window separates (Hz).
    pub frequency_resolution: f64,
    /// The same of phases (rad).
    pub phase_resolution: f64,
}

/// Waves up to `highest` (Hz) that reach `least` of the highest (1), in rows sampled every
/// `interval` (s), one a cell, without their static part.
///
/// # Errors
/// [`WavenumberError`] for fewer than 8 cells or 16 samples, and for values that are no numbers.
pub fn spectral_lines(
    rows: &[&[f64]],
    interval: f64,
    (highest, least): (f64, f64),
) -> Result<SpectralLines, WavenumberError> {
    let cells = rows.len();
    let samples = rows.iter().map(|row| row.len()).min().unwrap_or(0);
    if cells < MIN_CELLS {
        return Err(WavenumberError::TooFewCells { cells });
    }
    if samples < MIN_SAMPLES {
        return Err(WavenumberError::TooShort { samples });
    }
    if !rows.iter().all(|row| row.iter().all(|x| x.is_finite())) {
        return Err(WavenumberError::NotFinite);
    }
    let mut fourier = Fourier::default();
    let spectra: Vec<Vec<Complex<f64>>> =
        rows.iter().map(|row| over_time(&row[..samples], &mut fourier)).collect();
    let (step, count) = (1.0 / (samples as f64 * interval), cells as f64);
    let places = PADDING * cells;
    let turns: Vec<Complex<f64>> =
        (0..places).map(|i| Complex::from_polar(1.0, TAU * share(i, places))).collect();
    let moduli: Vec<(f64, Vec<f64>)> = (1..=samples / 2)
        .map(|bin| (share(bin, 1) * step, bin))
        .take_while(|(frequency, _)| *frequency <= highest)
        .map(|(frequency, bin)| (frequency, over_cells(&spectra, bin, &turns)))
        .collect();
    let all = moduli.iter().flat_map(|(_, heights)| heights);
    let top = all.copied().fold(0.0, f64::max);
    let mut lines = Vec::new();
    for (frequency, heights) in &moduli {
        for onward in [true, false] {
            let Some((place, height)) = highest_of(heights, onward) else { continue };
            if top > 0.0 && height >= least * top {
                let angle = TAU * place / share(places, 1);
                let phase = if onward { angle } else { TAU - angle };
                let (phase, height) = (phase.clamp(0.0, PI), height / top);
                lines.push(SpectralLine { frequency: *frequency, phase, onward, height });
            }
        }
    }
    Ok(SpectralLines { lines, frequency_resolution: step, phase_resolution: TAU / count })
}

fn share(part: usize, whole: usize) -> f64 {
    part as f64 / whole as f64
}

/// A row's transform over time.
fn over_time(row: &[f64], fourier: &mut Fourier) -> Vec<Complex<f64>> {
    let weighted = |(i, x): (usize, &f64)| x * Window::Hann.weight(i, row.len());
    let mut input: Vec<f64> = row.iter().enumerate().map(weighted).collect();
    fourier.forward(&mut input)
}

/// Moduli over the phase from cell to cell, `turns` the unit circle in equal parts.
fn over_cells(spectra: &[Vec<Complex<f64>>], bin: usize, turns: &[Complex<f64>]) -> Vec<f64> {
    let cells = spectra.len();
    let weighted = |(n, row): (usize, &Vec<Complex<f64>>)| {
        row.get(bin).map_or(Complex::default(), |x| x * Window::Hann.weight(n, cells))
    };
    let column: Vec<Complex<f64>> = spectra.iter().enumerate().map(weighted).collect();
    let at = |place: usize| {
        let turned = column.iter().enumerate().map(|(n, x)| x * turns[place * n % turns.len()]);
        turned.sum::<Complex<f64>>().norm()
    };
    (0..turns.len()).map(at).collect()
}

/// The highest maximum of one direction: its place between the samples, by a parabola through
/// logarithms, and its height.
fn highest_of(heights: &[f64], onward: bool) -> Option<(f64, f64)> {
    let count = heights.len();
    let half = count / 2;
    let range = if onward { 1..=half } else { half..=count - 1 };
    let around =
        |i: usize| [heights[(i + count - 1) % count], heights[i], heights[(i + 1) % count]];
    let is_peak = |i: &usize| {
        let [before, here, after] = around(*i);
        here > before && here >= after
    };
    let best = range.filter(is_peak).max_by(|a, b| heights[*a].total_cmp(&heights[*b]))?;
    let logarithms = around(best).map(|h| h.max(f64::MIN_POSITIVE).ln());
    let off = vertex(logarithms).map_or(0.0, |(off, _)| off);
    Some((share(best, 1) + off, heights[best]))
}
