//! Pictures into files, as SVG, PNG or PDF by the file's ending.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use clap::Args;
use serde::Serialize;

use super::overwrite::OverwriteArguments;
use crate::files;
use crate::quantity::{Dimension, Quantity, parse};
use crate::report::plot::{Sheet, Style, Theme, svg_in_style};

/// Endings that `--plot` takes.
pub const PICTURE_ENDINGS: &str = "FILE.svg|FILE.png|FILE.pdf";
/// Limits of a picture's width (m): two columns of A4 landscape at most.
const WIDTH: std::ops::RangeInclusive<f64> = 0.03..=1.0;
/// Limits of its text's size (pt).
const FONT_SIZE: std::ops::RangeInclusive<f64> = 3.0..=72.0;

/// A picture that is drawn beside the answer, and whether it may replace a file.
#[derive(Debug, Args)]
pub struct PlotArguments {
    #[command(flatten)]
    picture: PictureArguments,
    #[command(flatten)]
    pub overwrite: OverwriteArguments,
}

impl PlotArguments {
    /// Refuses a picture that exists; called before the work.
    pub fn check(&self) -> anyhow::Result<()> {
        self.picture.check(self.overwrite)
    }

    /// Draws the picture of `result`, if one is wanted.
    pub fn save<R: Serialize + ?Sized>(
        &self,
        result: &R,
        picture: impl FnOnce() -> Sheet,
    ) -> anyhow::Result<()> {
        self.picture.save(result, picture)
    }
}

/// A picture that is drawn beside the answer.
#[derive(Debug, Args)]
pub struct PictureArguments {
    /// Also draw into this file
    #[arg(long, value_name = PICTURE_ENDINGS, value_parser = file)]
    plot: Option<PathBuf>,
    /// Colours of the picture
    #[arg(long, value_enum, default_value_t = Theme::Light, requires = "plot")]
    theme: Theme,
    /// Width of the picture, e.g. a journal's column: 86mm [default: 235 mm or as its parts need]
    #[arg(long, value_name = "LENGTH", value_parser = width, requires = "plot")]
    width: Option<f64>,
    /// Size of its text in points [default: 9, with --width 8]
    #[arg(long, value_name = "PT", value_parser = font_size, requires = "plot")]
    font_size: Option<f64>,
    /// Part of the abscissa to show, e.g. "0 us..300 us"
    #[arg(long, value_name = "FROM..TO", value_parser = range, requires = "plot", allow_hyphen_values = true)]
    x_range: Option<(f64, f64)>,
    /// Part of the ordinate to show, e.g. "-1 V..5 V"; in all panels
    #[arg(long, value_name = "FROM..TO", value_parser = range, requires = "plot", allow_hyphen_values = true)]
    y_range: Option<(f64, f64)>,
    /// Title of the picture; "" for none
    #[arg(long = "title", value_name = "TEXT", requires = "plot")]
    title: Option<String>,
}

impl PictureArguments {
    /// Whether a picture is wanted.
    pub fn is_wanted(&self) -> bool {
        self.plot.is_some()
    }

    /// Refuses a picture that exists; called before the work.
    pub fn check(&self, overwrite: OverwriteArguments) -> anyhow::Result<()> {
        self.plot.iter().try_for_each(|file| overwrite.check(file))
    }

    /// Draws the picture of `result`, if one is wanted.
    pub fn save<R: Serialize + ?Sized>(
        &self,
        result: &R,
        picture: impl FnOnce() -> Sheet,
    ) -> anyhow::Result<()> {
        crate::report::check_finite(result)?;
        let Some(file) = &self.plot else { return Ok(()) };
        let mut sheet = picture();
        if let Some(title) = &self.title {
            title.clone_into(&mut sheet.title);
        }
        if (self.x_range.is_some() || self.y_range.is_some())
            && !sheet.show(self.x_range, self.y_range)
        {
            bail!(
                "found --x-range or --y-range for a picture of rows or of a map, expected one of curves"
            );
        }
        let usual = Style::default().font_size;
        let font_size = self.font_size.unwrap_or(if self.width.is_some() { 8.0 } else { usual });
        write(file, &sheet, &Style { theme: self.theme, width: self.width, font_size })
    }
}

/// A picture's width (m).
fn width(text: &str) -> Result<f64, String> {
    let width = parse(text, Dimension::LENGTH).map_err(|error| format!("{error}, e.g. 86mm"))?;
    if WIDTH.contains(&width) {
        Ok(width)
    } else {
        Err(format!("found {text}, expected a width from 30 mm to 1 m, e.g. 86mm"))
    }
}

/// Both ends of a part of an axis (unit).
fn range(text: &str) -> Result<(f64, f64), String> {
    let end = |text: &str| text.trim().parse::<Quantity>().ok().map(|quantity| quantity.value);
    let ends = text.split_once("..").and_then(|(from, to)| end(from).zip(end(to)));
    ends.filter(|(from, to)| from < to && (to - from).is_finite()).ok_or_else(|| {
        format!(
            "found {text}, expected two values from the lower to the higher, e.g. \"0 us..300 us\""
        )
    })
}

/// Size of a picture's text (pt).
fn font_size(text: &str) -> Result<f64, String> {
    let size: Option<f64> = text.trim().trim_end_matches("pt").trim().parse().ok();
    size.filter(|size| FONT_SIZE.contains(size))
        .ok_or_else(|| format!("found {text}, expected a size from 3 to 72 points, e.g. 8"))
}

/// The name of a picture's file.
pub fn file(text: &str) -> Result<PathBuf, String> {
    let file = PathBuf::from(text);
    match ending(&file) {
        "svg" => in_a_folder(file),
        "png" | "pdf" if cfg!(feature = "png") => in_a_folder(file),
        "png" | "pdf" => Err(format!("found {text}, expected .svg: built without the feature png")),
        _ => Err(format!("found {text}, expected a name that ends in .svg, .png or .pdf")),
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

/// Writes the picture at its own size.
pub fn save(file: &Path, picture: &Sheet, theme: Theme) -> anyhow::Result<()> {
    write(file, picture, &Style { theme, ..Style::default() })
}

fn write(file: &Path, picture: &Sheet, style: &Style) -> anyhow::Result<()> {
    let shown = || file.display().to_string();
    let drawn = svg_in_style(picture, style);
    match ending(file) {
        #[cfg(feature = "png")]
        "png" => {
            let dots = crate::report::png(&drawn).with_context(shown)?;
            files::write(file, dots).with_context(shown)
        }
        #[cfg(feature = "png")]
        "pdf" => {
            let page = crate::report::pdf(&drawn).with_context(shown)?;
            files::write(file, page).with_context(shown)
        }
        #[cfg(not(feature = "png"))]
        "png" | "pdf" => anyhow::bail!("{}: expected .svg: built without the feature png", shown()),
        _ => files::write(file, drawn).with_context(shown),
    }
}
