//! Results as text for people.

mod contents;
mod summary;
mod table;

pub use contents::contents;
pub use summary::summary;
