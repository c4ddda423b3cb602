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
    let mut csv = format!("frequency_hz,{}\n", columns.join(","));
    let Some(first) = spectra.first() else { return csv };
    let bins = (0..first.amplitude.len()).take_while(|bin| first.frequency(*bin) <= MAX_FREQUENCY);
    for bin in bins {
        let _ = write!(csv, "{}", first.frequency(bin));
        for spectrum in spectra {
            let value = spectrum.amplitude.get(bin).copied().unwrap_or(f64::NAN);
            let _ = write!(csv, ",{value:e}");
        }
        csv.push('\n');
    }
    csv
}
