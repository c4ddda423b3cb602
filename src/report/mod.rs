//! Results as text and pictures for people.

mod arrivals;
mod chart;
mod contents;
mod hard_cases;
pub mod magnet;
pub mod plot;
mod screen;
pub mod spectrum;
mod summary;
mod table;
mod work_precision;

pub use arrivals::arrivals;
pub use chart::chart;
pub use contents::contents;
pub use hard_cases::hard_cases;
pub use screen::screen;
pub use summary::summary;
pub use work_precision::{work_precision, work_precision_svg};

/// Text as SVG takes it.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
