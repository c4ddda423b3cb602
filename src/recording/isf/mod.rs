//! Tektronix ISF: one channel as the instrument sends it, a preamble in words and a block of
//! levels.
//!
//! `WFMPre?` with headers on, `;:CURVE `, and the block `#<n><length><bytes>`. Instruments of the
//! TDS2000 family save no such file; programs that talk to them do, and newer instruments
//! themselves. [`read()`] takes what those write, [`write()`] writes what the family would send.
//! `volts = (level - YOFF) YMULT + YZERO`, `time = XZERO + XINCR (n - PT_OFF)`.
//!
//! # What the reader allows
//! Keys in any order, long, short or in between, later ones winning; 1 or 2 bytes, signed or not,
//! either byte order, or numbers in words (`ENCDG ASC`). Two-byte levels whose lower byte is 0
//! everywhere are those of an 8-bit converter, and become them. What the file does not tell (probe,
//! vertical scale, source) is guessed and noted.
//!
//! # Sources
//! Tektronix programmer manual 071-1075, `WFMPre` and `CURVe`; the project's fact sheet on the
//! TDS2000 family, sections 2.4, 2.5 and 4.4, with heads of files that other families wrote.

mod block;
mod preamble;
mod read;
mod write;

pub use read::{MAXIMUM_BYTES, read};
pub use write::{Width, write};
