//! Results as text and pictures for people.

#[cfg(feature = "png")]
mod a4;
mod arrivals;
pub mod calibration;
pub mod calibration_design;
pub mod certificate;
mod comparison;
mod contents;
pub mod dcc;
pub mod dispersion;
mod effects;
mod fit;
mod forces;
mod hard_cases;
mod json;
pub mod magnet;
#[cfg(feature = "png")]
mod outlines;
pub mod page;
mod paper;
#[cfg(feature = "png")]
mod pdf;
pub mod plot;
#[cfg(feature = "png")]
mod png;
mod screen;
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

#[cfg(feature = "png")]
pub use a4::page_pdf;
pub use arrivals::{arrivals, arrivals_picture};
pub use comparison::{comparison_facts, comparison_page};
pub use contents::{contents_after, contents_before, contents_of, utc};
pub use effects::{effects, effects_picture, effects_table};
pub use fit::{blind, fit_page};
pub use forces::{ForcePage, force_picture, forces};
pub use hard_cases::{hard_cases, hard_cases_picture, hard_cases_table};
pub use json::{ResultError, check_finite, to_json};
pub use paper::{PaperPicture, paper, paper_parts, paper_pictures};
#[cfg(feature = "png")]
pub use pdf::{PdfError, pdf};
#[cfg(feature = "png")]
pub use png::{PngError, png};
pub use screen::screen;
pub use statistics::{statistics, statistics_table};
pub use summary::summary;
pub use sweep::{SweepAxes, SweepColumnError, gathering, sweep, sweep_picture};
pub use table::{RowTable, signed_percent, signed_with_expanded, with_expanded};
pub use tunability::{TunabilityPage, transmitted, tunability, tunability_picture};
pub use uncertainty::{
    bands_picture, budget_picture, normalised_error_parts, prediction_intervals, shot_picture,
    uncertain_inputs, uncertainty_budget,
};
pub use work_precision::{WorkMeasure, work_precision, work_precision_picture};

use crate::quantity::printable;

/// Text as SVG and HTML take it.
fn escape(text: &str) -> String {
    printable(text).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
