//! What a document was made from: date, program, command, hashes of the inputs, uncertainties of
//! the scene.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use anyhow::Context as _;
use sha2::{Digest, Sha256};

use crate::report::page::Part;
use crate::report::uncertain_inputs;
use crate::scene::random_inputs::RandomInput;
use crate::scene::{Scene, hexadecimal};

/// The inputs of a document.
pub struct Provenance<'a> {
    /// File or folder of the measurement.
    pub measured: &'a Path,
    /// The scene, if there is one.
    pub scene: Option<&'a Scene>,
    /// Inputs of the scene that are uncertain, and what that means for the result.
    pub uncertain: (&'a [RandomInput], &'static str),
}

impl Provenance<'_> {
    /// The section of a document.
    ///
    /// # Errors
    /// A measurement that can no longer be read.
    pub fn parts(&self) -> anyhow::Result<Vec<Part>> {
        let row = |what: &str, text: String| vec![what.to_owned(), text];
        let command: Vec<String> =
            std::env::args_os().map(|word| quoted(&word.to_string_lossy())).collect();
        let mut rows = vec![
            vec![String::new(); 2],
            row("date (UTC)", now()),
            row("program", concat!("hertzscope ", env!("CARGO_PKG_VERSION")).to_owned()),
            row("command", command.join(" ")),
        ];
        if self.measured.exists() {
            rows.push(row("measurement, SHA-256", hash(self.measured)?));
        }
        if let Some(scene) = self.scene {
            rows.push(row("scene with all its files, SHA-256", scene.texts.hash().to_owned()));
        }
        let mut parts = vec![Part::Heading(2, "Made from".to_owned()), Part::Table(rows, &[0, 1])];
        let (inputs, meaning) = self.uncertain;
        parts.extend(Part::section(meaning, uncertain_inputs(inputs), &[0, 3]));
        Ok(parts)
    }
}

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./=,:+".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

/// SHA-256 of a file, or of the files of a folder in the order of their names, in hexadecimal.
fn hash(path: &Path) -> anyhow::Result<String> {
    let mut hash = Sha256::new();
    let shown = |path: &Path| path.display().to_string();
    let files: Vec<PathBuf> = if path.is_dir() {
        let entries = std::fs::read_dir(path).with_context(|| shown(path))?;
        let mut files: Vec<PathBuf> = entries
            .filter_map(|entry| Some(entry.ok()?.path()))
            .filter(|file| file.is_file())
            .collect();
        files.sort();
        files
    } else {
        vec![path.to_owned()]
    };
    for file in files {
        hash.update(std::fs::read(&file).with_context(|| shown(&file))?);
    }
    Ok(hexadecimal(&hash.finalize()))
}

/// Date and time by the clock of this machine, in UTC.
fn now() -> String {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    date(since.as_secs())
}

/// Date and time so many seconds after 1970-01-01 in the Gregorian calendar.
///
/// Days since 0000-03-01 are 400-year cycles of 146,097 days, in which every fourth year but three
/// of four full centuries has its leap day at the end.
fn date(seconds: u64) -> String {
    /// Days from 0000-03-01 to 1970-01-01.
    const TO_1970: u64 = 719_468;
    let (days, second) = (seconds / 86_400 + TO_1970, seconds % 86_400);
    let (cycle, day) = (days / 146_097, days % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let (month, next) = if month < 10 { (month + 3, 0) } else { (month - 9, 1) };
    let year = 400 * cycle + year + next;
    let (hour, minute) = (second / 3600, second / 60 % 60);
    format!("{year:04}-{month:02}-{day:02} {hour:02}:{minute:02}")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against `date -u -d @SECONDS`.
    #[test]
    fn seconds_become_dates() {
        for (seconds, expected) in [
            (0, "1970-01-01 00:00"),
            (951_782_340, "2000-02-28 23:59"),
            (951_782_400, "2000-02-29 00:00"),
            (951_868_800, "2000-03-01 00:00"),
            (1_735_689_599, "2024-12-31 23:59"),
            (4_107_542_400, "2100-03-01 00:00"),
        ] {
            assert_eq!(date(seconds), expected);
        }
    }

    #[test]
    fn words_are_quoted_for_a_shell() {
        assert_eq!(quoted("CH1=s7,CH2"), "CH1=s7,CH2");
        assert_eq!(quoted("it's"), "'it'\\''s'");
        assert_eq!(quoted(""), "''");
    }
}
