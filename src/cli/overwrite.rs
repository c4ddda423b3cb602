//! Output files: their endings, and those that exist. None is replaced unless the user named it
//! with `-o` or says `--force`.
//!
//! `run` without `-o`, `serve --record` and `:write` replace nothing either: they take the next
//! free number.

use std::ffi::OsStr;
use std::path::Path;

use anyhow::bail;
use clap::Args;

/// Whether files that exist may be replaced.
#[derive(Debug, Clone, Copy, Args)]
pub struct OverwriteArguments {
    /// Replace existing files (a file named with -o is always replaced)
    #[arg(long)]
    force: bool,
}

impl OverwriteArguments {
    /// Of a command whose own `--force` means more.
    pub fn forced(force: bool) -> Self {
        Self { force }
    }

    /// Whether all may be replaced.
    pub fn is_forced(self) -> bool {
        self.force
    }

    /// Refuses a file that exists; called before the work.
    pub fn check(self, file: &Path) -> anyhow::Result<()> {
        // Devices and pipes hold nothing that could be lost.
        if file.is_file() && !self.force {
            bail!(
                "{}: exists already: choose another name, or replace it with --force",
                file.display()
            );
        }
        Ok(())
    }
}

/// A file's ending, which is to be one of `known`.
pub fn ending<'a>(file: &Path, known: &[&'a str]) -> anyhow::Result<&'a str> {
    let found = file.extension().and_then(OsStr::to_str).map(str::to_ascii_lowercase);
    let Some(ending) = known.iter().find(|known| Some(**known) == found.as_deref()) else {
        bail!("{}: found no known ending, expected .{}", file.display(), known.join(", ."));
    };
    Ok(ending)
}
