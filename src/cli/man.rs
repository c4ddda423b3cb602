//! `hertzscope man`: manual pages made from the same descriptions as `--help`.

use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args;
use clap_mangen::Man;

use crate::files::NewFolder;

/// Print the manual page, or write one for each command into a folder
#[derive(Debug, Args)]
pub struct Arguments {
    /// Folder for hertzscope.1, hertzscope-run.1, ...
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// Prints or writes the pages.
pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let command = super::output::command_line();
    if let Some(folder) = &arguments.output {
        let write = || {
            let new = NewFolder::replace(folder)?;
            clap_mangen::generate_to(command, new.join(""))?;
            new.complete()
        };
        return write().with_context(|| folder.display().to_string());
    }
    let mut page = Vec::new();
    Man::new(command).render(&mut page)?;
    super::print(String::from_utf8_lossy(&page).trim_end())
}
