//! Peaks and edges of a trace, for cursors to snap to.
//!
//! A peak is the farthest point between two crossings of a band of a tenth of the swing around the
//! baseline, which is the value most of the record is nearest to, its median; an edge is where the
//! line to such a peak passes half of its height.

use crate::scope::Waveform;

/// Swings smaller than this share of the largest are no peaks (1).
const MIN_SWING_SHARE: f64 = 0.1;
/// A peak is half as high at its edge (1).
const EDGE_SHARE: f64 = 0.5;

/// Abscissae of all peaks and edges, in order (s; Hz for an FFT).
pub fn features(waveform: &Waveform) -> Vec<f64> {
    let values: Vec<f64> = waveform.codes.iter().map(|code| waveform.volts_of(*code)).collect();
    let mut sorted = values.clone();
    sorted.sort_by(f64::total_cmp);
    let Some(base) = sorted.get(sorted.len() / 2).copied() else { return Vec::new() };
    let swing = values.iter().map(|value| (value - base).abs()).fold(0.0, f64::max);
    let band = MIN_SWING_SHARE * swing;
    let mut places = Vec::new();
    let mut index = 0;
    while let Some(first) = next_outside(&values, index, base, band) {
        let sign = (values.get(first).copied().unwrap_or(base) - base).signum();
        let height = |at: usize| values.get(at).map_or(0.0, |value| sign * (value - base));
        let end = (first..values.len()).find(|at| height(*at) < band).unwrap_or(values.len());
        let peak =
            (first..end).fold(first, |best, at| if height(at) > height(best) { at } else { best });
        let level = EDGE_SHARE * height(peak);
        let from = first.saturating_sub(1);
        let rise = (from..peak).find(|at| height(*at) < level && height(at + 1) >= level);
        places.extend(rise.map(|at| {
            let share = (level - height(at)) / (height(at + 1) - height(at));
            waveform.time(at) + share * waveform.preamble.x_incr
        }));
        places.push(waveform.time(peak));
        index = end;
    }
    places
}

/// The first point from `from` on that lies outside the band (1).
fn next_outside(values: &[f64], from: usize, base: f64, band: f64) -> Option<usize> {
    let outside = |value: &f64| band > 0.0 && (value - base).abs() >= band;
    values.iter().skip(from).position(outside).map(|at| at + from)
}
