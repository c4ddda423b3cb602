//! The figures' data as CSV.

use std::fmt::Write as _;

use super::figures::{MAX_FREQUENCY, dispersion_points};
use crate::analysis::spectrum::Spectrum;
use crate::studies::paper::tables::SpeedStudy;
use crate::studies::paper::{Arrangement, Figure, ForceSignal};

/// Tables 1 and 2.
pub(super) fn speeds(study: &SpeedStudy) -> String {
    let mut csv = "scene,paper_experiment_m_per_s,paper_numerics_m_per_s,half_rise_m_per_s,peak_m_per_s,dashpot_half_rise_m_per_s,dashpot_peak_m_per_s\n".to_owned();
    for row in &study.rows {
        let (paper, plain, lossy) = (&row.paper, &row.lossless, &row.with_dashpot);
        let _ = writeln!(
            csv,
            "{},{},{},{},{},{},{}",
            paper.scene,
            paper.experiment_m_per_s,
            paper.numerics_m_per_s,
            plain.half_rise,
            plain.peak,
            lossy.half_rise,
            lossy.peak
        );
    }
    csv
}

/// Forces and spectra of a figure: file names and CSV.
pub(super) fn of_figure(figure: &Figure, stem: &str) -> Vec<(String, String)> {
    if figure.arrangement == Arrangement::Dispersion {
        let mut csv = "phase_rad,acoustic_hz,optical_hz\n".to_owned();
        for (phase, acoustic, optical) in dispersion_points(&figure.chain) {
            let _ = writeln!(csv, "{phase},{acoustic},{optical}");
        }
        return vec![(format!("{stem}.csv"), csv)];
    }
    let signals: Vec<&ForceSignal> = figure.signals.iter().collect();
    let columns: Vec<String> = signals.iter().map(|s| format!("{}_n", s.place.key())).collect();
    let lines: Vec<&Spectrum> = signals.iter().map(|signal| &signal.spectrum).collect();
    let mut files = vec![
        (format!("{stem}-forces.csv"), traces(&signals, &columns)),
        (format!("{stem}-spectra.csv"), spectra(&lines, &columns)),
    ];
    for (number, (name, spectrum)) in (1..).zip(&figure.parts) {
        let column = format!("p101_{}_n", name.replace(' ', "_"));
        files.push((format!("{stem}-curve-{number}.csv"), spectra(&[spectrum], &[column])));
    }
    files
}

/// Forces over time; all have the same times.
pub(super) fn traces(signals: &[&ForceSignal], columns: &[String]) -> String {
    let mut csv = format!("time_s,{}\n", columns.join(","));
    let Some(first) = signals.first() else { return csv };
    for index in 0..first.trace.values.len() {
        let _ = write!(csv, "{:e}", first.trace.time(index));
        for signal in signals {
            let value = signal.trace.values.get(index).copied().unwrap_or(f64::NAN);
            let _ = write!(csv, ",{value:e}");
        }
        csv.push('\n');
    }
    csv
}

/// Amplitudes over frequency; all have the same frequencies.
fn spectra(spectra: &[&Spectrum], columns: &[String]) -> String {
    // Records of one length share their frequencies; others have a column of their own.
    let shared = spectra.windows(2).all(|pair| pair[0].step.to_bits() == pair[1].step.to_bits());
    let frequency = |column: &String| {
        if shared {
            column.clone()
        } else {
            format!("{}_hz,{column}", column.trim_end_matches("_n"))
        }
    };
    let heading: Vec<String> = columns.iter().map(frequency).collect();
    let mut csv = format!("{}{}\n", if shared { "frequency_hz," } else { "" }, heading.join(","));
    let shown = |spectrum: &&Spectrum| {
        (0..spectrum.amplitude.len())
            .take_while(|bin| spectrum.frequency(*bin) <= MAX_FREQUENCY)
            .count()
    };
    for bin in 0..spectra.iter().map(shown).max().unwrap_or(0) {
        let cell = |(place, spectrum): (usize, &&Spectrum)| {
            let value = spectrum.amplitude.get(bin).copied().unwrap_or(f64::NAN);
            if shared && place > 0 {
                format!("{value:e}")
            } else {
                format!("{},{value:e}", spectrum.frequency(bin))
            }
        };
        let cells: Vec<String> = spectra.iter().enumerate().map(cell).collect();
        csv.push_str(&cells.join(","));
        csv.push('\n');
    }
    csv
}
