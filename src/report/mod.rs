//! Results as text and pictures for people.

mod arrivals;
mod budget_picture;
pub mod calibration;
pub mod calibration_design;
pub mod certificate;
mod chart;
mod comparison;
mod contents;
mod dark;
pub mod dispersion;
pub mod document;
mod dot_chart;
mod effects;
mod fit;
mod forces;
mod hard_cases;
pub mod magnet;
mod number;
#[cfg(feature = "png")]
mod outlines;
mod paper;
pub mod plot;
#[cfg(feature = "png")]
mod png;
mod screen;
pub mod sheet;
pub mod spectrogram;
pub mod spectrum;
mod statistics;
mod summary;
mod sweep;
mod table;
pub mod text;
pub mod transfer;
mod tunability;
mod uncertainty;
mod work_precision;

pub use arrivals::arrivals;
pub use budget_picture::budget_picture;
pub use chart::chart;
pub use comparison::{comparison, comparison_facts, comparison_parts};
pub use contents::{contents_after, contents_before, contents_of};
pub use dark::on_dark;
pub use dispersion::{bands, bands_curve};
pub use effects::{effects, effects_svg, effects_table};
pub use fit::{blind, fit, fit_parts};
pub use forces::{force_picture, forces};
pub use hard_cases::{hard_cases, hard_cases_svg, hard_cases_table};
pub use paper::{PaperPicture, paper, paper_parts, paper_pictures};
#[cfg(feature = "png")]
pub use png::{PngError, png};
pub use screen::{ScreenTheme, screen};
pub use statistics::{statistics, statistics_csv};
pub use summary::summary;
pub use sweep::{gathering, sweep};
pub use table::RowTable;
pub use tunability::{transmitted, tunability, tunability_svg};
pub use uncertainty::{
    bands_picture, normalised_error_lines, prediction_intervals, shot_picture, uncertainty_budget,
};
pub use work_precision::{WorkMeasure, work_precision, work_precision_svg};

use crate::quantity::printable;

/// Text as SVG and HTML take it.
fn escape(text: &str) -> String {
    printable(text).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
