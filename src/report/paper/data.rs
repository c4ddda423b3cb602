//! The figures' data as tables.

use super::figures::{MAX_FREQUENCY, dispersion_points};
use crate::analysis::spectrum::Spectrum;
use crate::studies::paper::tables::SpeedStudy;
use crate::studies::paper::{Arrangement, Figure, ForceSignal};
use crate::table::{Cell, Column, Table};

fn numbers<T: Into<String>>(names: impl IntoIterator<Item = T>) -> Vec<Column> {
    names.into_iter().map(Column::number).collect()
}

/// Tables 1 and 2.
pub(super) fn speeds(study: &SpeedStudy) -> Table {
    let mut columns = vec![Column::text("scene")];
    columns.extend(numbers([
        "paper_experiment_m_per_s",
        "paper_numerics_m_per_s",
        "half_rise_m_per_s",
        "peak_m_per_s",
        "dashpot_half_rise_m_per_s",
        "dashpot_peak_m_per_s",
        "yielding_half_rise_m_per_s",
    ]));
    let rows = study.rows.iter().map(|row| {
        let (paper, plain, lossy) = (&row.paper, &row.lossless, &row.with_dashpot);
        vec![
            Cell::from(paper.scene.as_str()),
            paper.experiment_m_per_s.into(),
            paper.numerics_m_per_s.into(),
            plain.half_rise.into(),
            plain.peak.into(),
            lossy.half_rise.into(),
            lossy.peak.into(),
            row.yielding.half_rise.into(),
        ]
    });
    Table { columns, rows: rows.collect() }
}

/// Forces and spectra of a figure: file names and tables.
pub(super) fn of_figure(figure: &Figure, stem: &str) -> Vec<(String, Table)> {
    if figure.arrangement == Arrangement::Dispersion {
        let rows = dispersion_points(&figure.chain)
            .into_iter()
            .map(|(phase, acoustic, optical)| [phase, acoustic, optical].map(Cell::from).to_vec());
        let columns = numbers(["phase_rad", "acoustic_hz", "optical_hz"]);
        return vec![(format!("{stem}.csv"), Table { columns, rows: rows.collect() })];
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
pub(super) fn traces(signals: &[&ForceSignal], names: &[String]) -> Table {
    let mut columns = numbers(["time_s"]);
    columns.extend(numbers(names));
    let axis = signals.first().map(|first| &first.trace);
    let rows = (0..axis.map_or(0, |axis| axis.values.len())).map(|index| {
        let mut row: Vec<Cell> = vec![axis.map(|axis| axis.time(index)).into()];
        row.extend(signals.iter().map(|signal| signal.trace.values.get(index).copied().into()));
        row
    });
    let rows = rows.collect();
    Table { columns, rows }
}

/// Amplitudes over frequency; all have the same frequencies.
fn spectra(spectra: &[&Spectrum], names: &[String]) -> Table {
    // Records of one length share their frequencies; others have a column of their own.
    let shared = spectra.windows(2).all(|pair| pair[0].step.to_bits() == pair[1].step.to_bits());
    let mut columns = Vec::new();
    for (place, name) in names.iter().enumerate() {
        if !shared {
            columns.push(Column::number(format!("{}_hz", name.trim_end_matches("_n"))));
        } else if place == 0 {
            columns.push(Column::number("frequency_hz"));
        }
        columns.push(Column::number(name));
    }
    let shown = |spectrum: &&Spectrum| {
        (0..spectrum.amplitude.len())
            .take_while(|bin| spectrum.frequency(*bin) <= MAX_FREQUENCY)
            .count()
    };
    let rows = (0..spectra.iter().map(shown).max().unwrap_or(0)).map(|bin| {
        let mut row: Vec<Cell> = Vec::new();
        for (place, spectrum) in spectra.iter().enumerate() {
            if place == 0 || !shared {
                row.push(spectrum.frequency(bin).into());
            }
            row.push(spectrum.amplitude.get(bin).copied().into());
        }
        row
    });
    let rows = rows.collect();
    Table { columns, rows }
}
