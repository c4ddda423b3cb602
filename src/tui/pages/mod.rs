//! The pages in place of the traces: each is a file with its keys, help, hints, changes of the
//! model and picture.

pub mod accuracy;
pub mod bench;
pub mod compare;
pub mod effects;
pub mod hard_cases;
mod list;
pub mod remote;
pub mod spectrum;
mod study;
pub mod xy;

use super::model::Page;

/// All pages, as the help lists them.
pub const PAGES: &[Page] = &[
    spectrum::SPECTRUM,
    spectrum::MAP,
    xy::PAGE,
    bench::PAGE,
    compare::PAGE,
    accuracy::PAGE,
    effects::PAGE,
    hard_cases::PAGE,
    remote::PAGE,
];
