//! Pictures into files, as SVG or PNG by the file's ending.

use std::path::{Path, PathBuf};

use anyhow::Context as _;
use clap::Args;
use serde::Serialize;

use super::overwrite::OverwriteArguments;
use crate::files;
use crate::report::plot::{Sheet, Theme, svg};

/// Endings that `--plot` takes.
pub const PICTURE_ENDINGS: &str = "FILE.svg|FILE.png";

/// A picture that is drawn beside the answer.
#[derive(Debug, Args)]
pub struct PlotArguments {
    /// Also draw into this file
    #[arg(long, value_name = PICTURE_ENDINGS, value_parser = file)]
    plot: Option<PathBuf>,
    /// Colours of the picture
    #[arg(long, value_enum, default_value_t = Theme::Light, requires = "plot")]
    theme: Theme,
    #[command(flatten)]
    pub overwrite: OverwriteArguments,
}

impl PlotArguments {
    /// Refuses a picture that exists; called before the work.
    pub fn check(&self) -> anyhow::Result<()> {
        self.plot.iter().try_for_each(|file| self.overwrite.check(file))
    }

    /// Draws the picture of `result`, if one is wanted.
    pub fn save<R: Serialize + ?Sized>(
        &self,
        result: &R,
        picture: impl FnOnce() -> Sheet,
    ) -> anyhow::Result<()> {
        crate::report::check_finite(result)?;
        match &self.plot {
            Some(file) => self::save(file, &picture(), self.theme),
            None => Ok(()),
        }
    }
}

/// The name of a picture's file.
pub fn file(text: &str) -> Result<PathBuf, String> {
    let file = PathBuf::from(text);
    match ending(&file) {
        "svg" => in_a_folder(file),
        "png" if cfg!(feature = "png") => in_a_folder(file),
        "png" => Err(format!("found {text}, expected .svg: built without the feature png")),
        _ => Err(format!("found {text}, expected a name that ends in .svg or .png")),
    }
}

/// `file`, if its folder exists: what cannot be written is refused before the work.
pub fn in_a_folder(file: PathBuf) -> Result<PathBuf, String> {
    match file.parent().filter(|folder| !folder.as_os_str().is_empty() && !folder.is_dir()) {
        Some(folder) => Err(format!(
            "found {}, expected a file in a folder that exists: {} does not",
            file.display(),
            folder.display()
        )),
        None => Ok(file),
    }
}

fn ending(file: &Path) -> &str {
    file.extension().and_then(|ending| ending.to_str()).unwrap_or_default()
}

/// Writes the picture.
pub fn save(file: &Path, picture: &Sheet, theme: Theme) -> anyhow::Result<()> {
    let shown = || file.display().to_string();
    let drawn = svg(picture, theme);
    if ending(file) != "png" {
        return files::write(file, drawn).with_context(shown);
    }
    #[cfg(feature = "png")]
    return files::write(file, crate::report::png(&drawn).with_context(shown)?).with_context(shown);
    #[cfg(not(feature = "png"))]
    anyhow::bail!("{}: expected .svg: built without the feature png", file.display())
}
