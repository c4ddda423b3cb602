//! Results as text and pictures for people.

mod arrivals;
mod bands;
pub mod calibration;
pub mod calibration_design;
pub mod certificate;
mod chart;
mod comparison;
mod contents;
pub mod dispersion;
pub mod document;
mod effects;
mod fit;
mod forces;
mod hard_cases;
pub mod magnet;
pub mod plot;
mod screen;
pub mod spectrogram;
pub mod spectrum;
mod summary;
mod table;
mod work_precision;

pub use arrivals::arrivals;
pub use bands::{bands, bands_curve};
pub use chart::{chart, chart_over};
pub use comparison::{comparison, comparison_facts, comparison_parts};
pub use contents::contents;
pub use effects::effects;
pub use fit::{blind, fit, fit_parts};
pub use forces::{force_curve, forces};
pub use hard_cases::hard_cases;
pub use screen::screen;
pub use summary::summary;
pub use work_precision::{work_precision, work_precision_svg};

/// Text as SVG takes it.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
