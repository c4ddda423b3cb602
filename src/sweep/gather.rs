//! Joins the logs of a sweep's shards into tables, and lists missing runs.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry as Slot;
use std::fs::File;
use std::io::{BufReader, Read as _};
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::log::{LogHeader, LoggedRun, Scan, logs, scan};
use super::plan::Column;
use super::work::RunCounts;
use super::{SweepError, at};
use crate::table::{Cell, Table, TableWriter, read_row};

/// The joined logs of a sweep.
#[derive(Debug)]
pub struct GatheredLogs {
    header: LogHeader,
    files: Vec<PathBuf>,
    /// For each finished run: index of its log, and its place in it.
    found: BTreeMap<u64, (u32, LoggedRun)>,
    /// Notes for the user.
    pub notices: Vec<String>,
}

/// A range of consecutive missing runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Gap {
    /// Its first run.
    pub first: u64,
    /// Its last run.
    pub last: u64,
}

impl GatheredLogs {
    /// Reads all logs in `folder`.
    ///
    /// # Errors
    /// [`SweepError`] if there is no log, if the logs belong to different sweeps, or if two logs
    /// disagree on a run.
    pub fn read(folder: &Path) -> Result<Self, SweepError> {
        let no_logs = || SweepError::NothingThere { folder: folder.display().to_string() };
        if !folder.is_dir() {
            return Err(no_logs());
        }
        let mut all: Option<Self> = None;
        for file in logs(folder)? {
            let Some(scan) = scan(&file)? else { continue };
            let all = all.get_or_insert_with(|| Self::empty(&scan.header));
            all.add(&scan)?;
        }
        all.ok_or_else(no_logs)
    }

    fn empty(header: &LogHeader) -> Self {
        let header = header.clone();
        Self { header, files: Vec::new(), found: BTreeMap::new(), notices: Vec::new() }
    }

    fn add(&mut self, scan: &Scan) -> Result<(), SweepError> {
        let LogHeader { instructions, .. } = &scan.header;
        let as_if =
            LogHeader { instructions: self.header.instructions.clone(), ..scan.header.clone() };
        if as_if != self.header {
            return Err(SweepError::OtherSweep { file: scan.file.display().to_string() });
        }
        if *instructions != self.header.instructions {
            self.notices.push(format!(
                "{}: made with {instructions}, others with {}: the last digits of results depend on that",
                scan.file.display(),
                self.header.instructions
            ));
        }
        self.notices.extend(scan.notices());
        let number = u32::try_from(self.files.len()).unwrap_or(u32::MAX);
        self.files.push(scan.file.clone());
        for entry in &scan.entries {
            match self.found.entry(entry.run) {
                Slot::Vacant(slot) => {
                    slot.insert((number, *entry));
                }
                Slot::Occupied(slot) if slot.get().1.checksum == entry.checksum => {}
                Slot::Occupied(slot) => {
                    let shown = |file: &PathBuf| file.display().to_string();
                    let files = [&self.files[slot.get().0 as usize], &scan.file].map(shown);
                    return Err(SweepError::Differ { run: entry.run, files });
                }
            }
        }
        Ok(())
    }

    /// Runs of the whole sweep.
    pub fn runs(&self) -> u64 {
        self.header.runs
    }

    /// Columns of the sweep's table.
    pub fn columns(&self) -> &[Column] {
        &self.header.columns
    }

    /// The logs that were read.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// Missing runs, in order.
    pub fn missing(&self) -> Vec<Gap> {
        let mut gaps = Vec::new();
        let mut next = 0;
        for run in self.found.keys().copied().chain([self.header.runs]) {
            if run > next {
                gaps.push(Gap { first: next, last: run - 1 });
            }
            next = run.saturating_add(1);
        }
        gaps
    }

    /// Writes what there is into each of `tables`, in the order of runs; `progress` is called with
    /// the share that is written.
    ///
    /// # Errors
    /// [`SweepError`] where a log or a table cannot be read or written.
    pub fn write(
        &self,
        tables: &[PathBuf],
        progress: &mut dyn FnMut(f64),
    ) -> Result<RunCounts, SweepError> {
        let columns = &self.header.columns;
        let error = columns.iter().position(|column| column.name == "error").unwrap_or(usize::MAX);
        let create = |file: &PathBuf| TableWriter::create(file, columns);
        let mut tables = tables.iter().map(create).collect::<Result<Vec<_>, _>>()?;
        let mut tally = RunCounts::default();
        let mut index = 0_usize;
        self.each_row(&mut |run, cells| {
            tables.iter_mut().try_for_each(|table| table.row(&cells))?;
            tally.done += 1;
            if let Some(Cell::Text(reason)) = cells.get(error) {
                tally.failed += 1;
                tally.first_failed.get_or_insert_with(|| (run, reason.clone()));
            }
            if index.is_multiple_of(1000) {
                progress(index as f64 / self.found.len() as f64);
            }
            index += 1;
            Ok(())
        })?;
        tables.into_iter().try_for_each(TableWriter::finish)?;
        Ok(tally)
    }

    /// The table in memory.
    ///
    /// # Errors
    /// [`SweepError`] where a log cannot be read.
    pub fn table(&self) -> Result<Table, SweepError> {
        let mut rows = Vec::new();
        self.each_row(&mut |_, cells| {
            rows.push(cells);
            Ok(())
        })?;
        Ok(Table { columns: self.header.columns.clone(), rows })
    }

    /// Calls `act` with each finished run's number and row, in the order of runs.
    fn each_row(
        &self,
        act: &mut dyn FnMut(u64, Vec<Cell>) -> Result<(), SweepError>,
    ) -> Result<(), SweepError> {
        let open = |file: &PathBuf| File::open(file).map(BufReader::new).map_err(at(file));
        let mut readers = self.files.iter().map(open).collect::<Result<Vec<_>, _>>()?;
        // Where each reader stands.
        let mut places = vec![0_u64; readers.len()];
        for (log, entry) in self.found.values() {
            let log = *log as usize;
            let away = entry.offset.wrapping_sub(places[log]).cast_signed();
            let mut text = vec![0; entry.length as usize];
            let reader = &mut readers[log];
            reader
                .seek_relative(away)
                .and_then(|()| reader.read_exact(&mut text))
                .map_err(at(&self.files[log]))?;
            places[log] = entry.offset + u64::from(entry.length);
            let line = String::from_utf8_lossy(&text);
            act(entry.run, read_row(&line, &self.header.columns))?;
        }
        Ok(())
    }
}
