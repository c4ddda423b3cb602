//! Results as text and pictures for people.

mod contents;
mod screen;
mod summary;
mod table;

pub use contents::contents;
pub use screen::screen;
pub use summary::summary;
