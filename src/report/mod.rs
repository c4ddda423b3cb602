//! Results as text and pictures for people.

mod contents;
mod screen;
mod summary;
mod table;
mod work_precision;

pub use contents::contents;
pub use screen::screen;
pub use summary::summary;
pub use work_precision::{work_precision, work_precision_svg};
