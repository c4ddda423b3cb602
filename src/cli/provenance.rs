//! What a document was made from: date, program, command, hashes of the inputs, uncertainties of
//! the scene.

use std::path::Path;
use std::time::SystemTime;

use anyhow::Context as _;

use crate::calibrate::recording_hash;
use crate::recording::TraceSet;
use crate::report::page::Part;
use crate::report::uncertain_inputs;
use crate::report::utc;
use crate::scene::Scene;
use crate::scene::random_inputs::RandomInput;

/// The inputs of a document.
pub struct Provenance<'a> {
    /// File or folder of the measurement.
    pub measured: &'a Path,
    /// What was read from it.
    pub set: &'a TraceSet,
    /// The scene, if there is one.
    pub scene: Option<&'a Scene>,
    /// Inputs of the scene that are uncertain, and what that means for the result.
    pub uncertain: (&'a [RandomInput], &'static str),
}

impl Provenance<'_> {
    /// The section of a document.
    ///
    /// # Errors
    /// A measurement that can no longer be read, a `SOURCE_DATE_EPOCH` that is no date.
    pub fn parts(&self) -> anyhow::Result<Vec<Part>> {
        let row = |what: &str, text: String| vec![what.to_owned(), text];
        let command: Vec<String> =
            std::env::args_os().map(|word| quoted(&word.to_string_lossy())).collect();
        let mut rows = vec![
            vec![String::new(); 2],
            row("date (UTC)", now()?),
            row("program", concat!("hertzscope ", env!("CARGO_PKG_VERSION")).to_owned()),
            row("command", command.join(" ")),
        ];
        if self.measured.exists() {
            let hash = recording_hash(self.measured, self.set)
                .with_context(|| self.measured.display().to_string())?;
            rows.push(row("measurement, SHA-256", hash));
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

/// Date and time in UTC, by the clock of this machine or, for documents that come out the same
/// twice, by `SOURCE_DATE_EPOCH` (seconds since 1970):
/// <https://reproducible-builds.org/specs/source-date-epoch/>.
///
/// # Errors
/// A `SOURCE_DATE_EPOCH` that is no such number.
fn now() -> anyhow::Result<String> {
    let Some(set) = std::env::var_os("SOURCE_DATE_EPOCH") else {
        let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        return Ok(utc(u64::try_from(since.as_nanos()).unwrap_or(u64::MAX)));
    };
    let nanoseconds = set
        .to_str()
        .and_then(|seconds| seconds.parse::<u64>().ok())
        .and_then(|seconds| seconds.checked_mul(1_000_000_000))
        .with_context(|| {
            format!(
                "SOURCE_DATE_EPOCH is {:?}, not a whole number of seconds since 1970; set it to one, \
                 or unset it for today's date",
                set.to_string_lossy()
            )
        })?;
    Ok(utc(nanoseconds))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_for_a_shell() {
        assert_eq!(quoted("CH1=s7,CH2"), "CH1=s7,CH2");
        assert_eq!(quoted("it's"), "'it'\\''s'");
        assert_eq!(quoted(""), "''");
    }
}
