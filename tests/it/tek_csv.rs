//! Tektronix CSV, native and foreign: rows that real instruments wrote, captures from disk,
//! synthetic round trips, and what the reader and the writer refuse.
//!
//! Reference rows come from files of published repositories, quoted in the project's fact sheet on
//! the TDS2000 family. Whole captures have no licence and stay outside the project: the environment
//! variable `HERTZSCOPE_CAPTURES` names their folder.

mod binary;
mod captures;
mod changed;
mod cut;
mod foreign;
mod foreign_captures;
mod foreign_random;
mod foreign_texts;
mod generated_tables;
mod impact_labs;
mod imports;
mod instrument_variants;
mod made_up;
mod pairs;
mod random;
mod refused;
mod round_trip;
mod rows;
mod variants;

pub(crate) use captures::NATIVE_CAPTURES;
pub(crate) use generated_tables::Draws;
