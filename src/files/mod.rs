//! Writes files so that a name holds either what it held before or all that is new, whatever ends
//! the program in between.
//!
//! [`NewFile`] is written under a temporary name in the same folder, synchronised and renamed;
//! [`NewFolder`] is filled under a temporary name and renamed when it is complete. [`LiveFile`] is
//! written under its own name, because others read it while it grows; a lock keeps a second writer
//! away. What the user names is replaced by a complete new file. Names that the program chooses,
//! and records of what happened only once, never replace anything: the next free number is taken
//! ([`numbered`]).
//!
//! Temporary names are `.NAME.PID-N.part`. Those of processes that were killed are removed by the
//! next writer of the same name. Limits: where the system has no file locks (some network file
//! systems), two writers are not kept apart: each still writes whole files, and the last one stays.

mod folder;
mod guarded;
mod live;
mod output;
mod part;
mod step;
mod whole;

pub use folder::{NewFolder, write_numbered_folder};
pub use live::LiveFile;
pub use output::{Output, numbered};
pub use whole::{NewFile, write, write_together};
