//! `hertzscope view`: the scope's screen in the terminal.

use std::io::IsTerminal as _;
use std::path::PathBuf;

use anyhow::bail;
use clap::Args;

use crate::recording::format::open;
use crate::tui;

/// Look at a recording on the scope's screen, in the terminal
#[derive(Debug, Args)]
pub struct Arguments {
    /// A recording (.mcap), a TDS2000 file (.csv), or a folder of them
    file: PathBuf,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let set = open(&arguments.file)?;
    if !std::io::stdout().is_terminal() {
        bail!(
            "found no terminal on standard output, expected one; `hertzscope info` prints what is in the file"
        );
    }
    let name = arguments.file.file_name().map(|n| n.to_string_lossy().into_owned());
    tui::run(set, name.unwrap_or_default())?;
    Ok(())
}
