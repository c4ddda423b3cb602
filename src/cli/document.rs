//! Documents into files, as PDF, HTML or Markdown by the file's ending.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, anyhow};

use super::overwrite::ending;
use crate::files;
use crate::report::page::{Part, html, markdown};
use crate::report::plot::{Theme, svg};

/// Endings of documents.
pub const ENDINGS: &[&str] =
    if cfg!(feature = "png") { &["md", "html", "pdf"] } else { &["md", "html"] };

/// Writes the document whose parts are `parts`, given the stem of its file's name; pictures of a
/// Markdown one lie beside it.
///
/// # Errors
/// An ending that is not among [`ENDINGS`], a file that cannot be written.
pub fn write(file: &Path, title: &str, parts: &dyn Fn(&str) -> Vec<Part>) -> anyhow::Result<()> {
    let stem = file.file_stem().and_then(OsStr::to_str).unwrap_or("report");
    let parts = parts(stem);
    let shown = || file.display().to_string();
    match ending(file, ENDINGS)? {
        "html" => files::write(file, html(title, &parts)).with_context(shown),
        #[cfg(feature = "png")]
        "pdf" => {
            let document = pdf(&shown(), title, &parts)?;
            files::write(file, document).with_context(shown)
        }
        _ => write_markdown(file, &parts),
    }
}

/// The document as PDF. Characters that it cannot show are noted.
#[cfg(feature = "png")]
pub fn pdf(file: &str, title: &str, parts: &[Part]) -> anyhow::Result<Vec<u8>> {
    let (document, missing) =
        crate::report::page_pdf(title, parts).with_context(|| file.to_owned())?;
    if !missing.is_empty() {
        super::say(&format!(
            "note: {file}: the built-in font has no {missing}, left blank there: .html has all characters"
        ));
    }
    Ok(document)
}

/// Writes a Markdown document and its pictures. The page is last: it names the pictures.
fn write_markdown(file: &Path, parts: &[Part]) -> anyhow::Result<()> {
    let pictures = parts.iter().filter_map(|part| match part {
        Part::Picture(name, _, sheet) => {
            Some((file.with_file_name(name), svg(sheet, Theme::Light)))
        }
        _ => None,
    });
    let all: Vec<(PathBuf, String)> =
        pictures.chain([(file.to_owned(), markdown(parts))]).collect();
    let all: Vec<(PathBuf, &str)> =
        all.iter().map(|(file, text)| (file.clone(), text.as_str())).collect();
    files::write_together(&all)
        .map_err(|(file, error)| anyhow!(error).context(file.display().to_string()))
}
