//! The terminal screen: keys to actions, actions to the model, the model to screens.
//!
//! Screens are asked for what matters on them, a readout or the row of a trace, and never compared
//! as a whole. Where a trace has to be follows from its volts: a graticule of 80 x 24 has 2 rows
//! and 7 columns a division.

mod actions;
mod bench;
mod captures;
mod degenerate;
mod keys;
mod live;
mod pages;
mod replay;
mod screens;
#[cfg(feature = "server")]
mod served;
mod snapshots;
#[cfg(unix)]
mod terminal;
