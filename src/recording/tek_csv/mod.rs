//! The native CSV dialect of Tektronix's TDS1000/2000 family: reader and writer.
//!
//! Stands between files and [`Capture`](super::Capture): an instrument of the family saves one
//! channel, or an FFT, as one such file. What an instrument saved, [`read()`] and [`write()`] give
//! back byte for byte, except for CRLF line ends, which are written as LF.
//!
//! # The format
//! Every row is `key,value,,abscissa,ordinate,` and ends with LF. The first 18 rows carry the
//! header beside the samples (16 rows in the old dialect without `Model Number` and
//! `Serial Number`). With row index `n` from 0, trigger point `tp`, sample interval `si` and
//! digitiser level `k`:
//!
//! - volts `= (k - y_off) y_mult`, `y_mult` = V/div / 25, `y_off` = vertical offset / `y_mult`,
//!   printed `%10.5f`; in an FFT `Yzero + 0.4 k` dB;
//! - time `= (n - tp) si`, printed `%17.12f` beside the header, and `%.12f` without padding below
//!   it, there with an extra leading `0` where the record reaches below the header before the
//!   trigger, and a `-` up to and including the trigger's row;
//! - frequency `= n si`, printed `%17.5f` beside the header; below it the firmware goes on by
//!   adding the interval as printed with five decimals to the frequency as printed: `12.33033` is
//!   added to `184.95502`, not `12.330334596`.
//!
//! An FFT's interval is rounded in the header, but follows from the sampling rate `fs`, which takes
//! the values 1, 2.5, 5 times a power of ten: `si = fs/2048` for `fs` above 1 MS/s, else
//! `si = (100/99) fs/2048`.
//!
//! # Which dialect is written
//! An [`InstrumentIdentity`](super::InstrumentIdentity) with a model gives the 18-row header; one
//! whose model and serial number are empty gives the 16-row header, and reading that leaves both
//! empty.
//!
//! # Sources
//! The project's fact sheet on the TDS2000 family: section 4.2 (the rule for volts and times
//! reproduces 460 of 460 published files), 4.3 (headers as the instruments wrote them), 1.1 (FFT).
//! That frequencies continue from printed numbers is inferred from the old dialect's rows 17 to 20
//! in section 4.3, which a product of double precision misses from row 18 on.
//!
//! # Limits
//! Records of 2500 points, or 1024 for an FFT, in V over s and dB over Hz. Time-domain rows of the
//! old dialect have not been seen; they follow the rule of the newer one from row 17 on. The file
//! tells neither coupling nor bandwidth nor inversion.
//!
//! # What the reader allows
//! [`read_all`] takes native files, and what `OpenChoice`, spreadsheets (`header_columns`), newer
//! models, other makers and people save as tables (`table`, by `names` and `keys`). All of them
//! bring rows to `unscaled_import`, where `times` finds the even spacing, `levels` the digitiser's
//! levels and `rails` the ends of its range. What is odd or guessed is written into the capture's
//! notes; a native file as an instrument saved it has none.

mod abscissa;
mod cells;
mod column;
mod columns;
mod header_columns;
mod keys;
mod layout;
mod levels;
mod names;
mod rails;
mod read;
mod table;
mod table_layout;
mod text;
mod times;
mod unscaled_import;
mod write;

pub use columns::{EXAMPLE as COLUMNS_EXAMPLE, TableColumns};
pub use read::{MAXIMUM_BYTES, read, read_all, read_columns};
pub use write::write;
