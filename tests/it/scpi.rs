//! The remote interface: transcripts, byte for byte.
//!
//! Literal replies come from outside: a log of a TDS 2024 (FV:v4.12) on RS-232, replies of a
//! TDS2024C (FV:v24.26), `.SET` files of published repositories, and the strings that pylablib
//! 1.4.5 and pymeasure 0.16 send; all are quoted in the project's fact sheet on the TDS2000 family.

mod acquisition;
mod bench;
mod clients;
mod curve;
mod hard_copy;
mod impact;
mod instrument;
mod list;
mod manual;
mod measurement;
mod preamble;
mod random;
mod settings;
mod setup;
mod status;
mod syntax;
