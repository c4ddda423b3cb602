//! Files that R&S RTO, RTE and RTP scopes save in pairs: settings in `NAME.csv`, one a row as
//! `SignalResolution:2e-11:`, and values without times in `NAME.Wfm.csv`, a column a channel.
//!
//! Both become the text of one table, which the reader of tables takes. The first value is at
//! `HardwareXStart` where the file has `SignalHardwareRecordLength` rows, and at `XStart` where it
//! has `SignalRecordLength` or `RecordLength` rows. Source: R&S RTO6 User Manual 1801.6687.02,
//! 12.2.1, waveform export files.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use super::error::RecordingError;

/// How the names of files with values end, in small letters.
const VALUES: &str = ".wfm.csv";

/// The files of settings and of values that belong together, if `file` is one of them and both
/// exist.
pub fn pair(file: &Path) -> Option<[PathBuf; 2]> {
    let name = file.file_name()?.to_str()?;
    let small = name.to_ascii_lowercase();
    let stem = small.strip_suffix(VALUES).or_else(|| small.strip_suffix(".csv"))?;
    let stem = name.get(..stem.len())?;
    let named = |endings: &[&str]| {
        let mut files = endings.iter().map(|ending| file.with_file_name(format!("{stem}{ending}")));
        files.find(|file| file.is_file())
    };
    Some([named(&[".csv", ".CSV"])?, named(&[".Wfm.csv", ".wfm.csv", ".WFM.CSV"])?])
}

/// Whether `file` holds the settings of another one.
pub fn is_header(file: &Path) -> bool {
    pair(file).is_some_and(|[header, _]| header.file_name() == file.file_name())
}

/// The table of a pair; `file` is for errors.
pub fn table(header: &[u8], values: &[u8], file: &str) -> Result<Vec<u8>, RecordingError> {
    let header = String::from_utf8_lossy(header);
    let setting = |key: &str| {
        let rows = header.lines().filter_map(|line| line.split_once(':'));
        let mut rows = rows.filter(|(found, _)| found.trim().eq_ignore_ascii_case(key));
        rows.next().map(|(_, value)| value.split(':').next().unwrap_or_default().trim())
    };
    let number = |key: &str| setting(key)?.parse::<f64>().ok();
    let wrong = |found: String, expected: &str| Err(RecordingError::found(file, found, expected));
    let interval = number("SignalResolution").or_else(|| number("Resolution"));
    let Some(interval) = interval.filter(|interval| interval.is_finite() && *interval > 0.0) else {
        return wrong(
            "no SignalResolution above 0 in the file of settings beside it".to_owned(),
            "the time between two samples",
        );
    };
    if number("InterleavedTraceCount").is_some_and(|count| count > 1.0) {
        return wrong("an envelope".to_owned(), "one value a sample: save the waveform itself");
    }
    let rows = String::from_utf8_lossy(values);
    let rows = rows.lines().filter(|line| !line.trim().is_empty()).count() as f64;
    let is = |key: &str| number(key).is_some_and(|stated| (stated - rows).abs() < 0.5);
    let start = if is("SignalHardwareRecordLength") {
        number("HardwareXStart")
    } else if is("SignalRecordLength") || is("RecordLength") {
        number("XStart")
    } else {
        let stated = setting("SignalHardwareRecordLength").or_else(|| setting("RecordLength"));
        let expected = format!("as many as the settings beside it say, {}", stated.unwrap_or("?"));
        return wrong(format!("{rows} rows"), &expected);
    };
    let Some(start) = start else {
        return wrong("no XStart in the file of settings beside it".to_owned(), "the first time");
    };
    let mut text = format!("Sample Interval: {interval}\nX0: {start}\n");
    if let Some(scale) = number("VerticalScale") {
        let _ = writeln!(text, "Vertical Scale: {scale}");
    }
    let first = String::from_utf8_lossy(values.split(|byte| *byte == b'\n').next().unwrap_or(b""));
    let separator = [';', '\t', ','].into_iter().find(|mark| first.contains(*mark));
    let columns = separator.map_or(1, |mark| first.split(mark).count());
    let names: Vec<String> = match setting("Source").filter(|_| columns == 1) {
        Some(source) => vec![source.to_owned()],
        None => (1..=columns).map(|column| format!("Col {column}")).collect(),
    };
    let _ = writeln!(text, "{}", names.join(&separator.unwrap_or(',').to_string()));
    Ok([text.as_bytes(), values].concat())
}
