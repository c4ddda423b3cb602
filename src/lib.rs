//! Digital twin of a physics lab bench: a chain of beads with Hertz contacts is hit by a striker,
//! piezo sensors embedded in beads feel the force, a virtual Tektronix TDS 2014 records it.
//!
//! # Tour
//!
//! - Describe the bench, by an included scene, a file, or text: [`Scene::load`],
//!   [`Scene::from_text`].
//! - Run it, with first peaks and arrivals accurate to the relative error asked for:
//!   [`run_to_accuracy`].
//! - Read forces, times, speeds, energies and the estimated error: [`Outcome::summary`]; what the
//!   scope recorded, and the forces behind it: [`Outcome::shot`].
//! - Run thousands of chains on all processors, with results that are the same to the last bit
//!   whatever the number of threads: [`Ensemble`].
//! - Read and write recordings, files of scopes, and folders of them: [`recording::open`],
//!   [`recording::write`].
//! - Compare a measurement with a scene, and fit numbers of the scene to it:
//!   [`mod@measurement::compare`], [`fit::fit`].
//! - Calibrate a sensor by the plan of a momentum test: [`calibrate::run`].
//! - Serve the scope to clients over TCP: [`server::serve`].
//!
//! ```
//! use hertzscope::{Scene, run_to_accuracy};
//!
//! let scene = Scene::load("magnet-0.61g")?;
//! let outcome = run_to_accuracy(&scene, 1e-6, 1, &mut |_| ())?;
//! let first = &outcome.summary.sensors[0];
//! assert!(first.first_peak.is_some_and(|peak| peak.dynamic_n > 1.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! `examples/` has a program for most of these: `cargo run --release --example run_a_scene`.
//!
//! # Units
//!
//! All numbers are in SI units. The documentation of a number ends with its unit in parentheses,
//! unless its name contains it. Times count from the striker's first contact, those of captures
//! from their trigger. Particles count from 1 at the top, forces are positive where they compress.
//! Uncertainties `u` are standard uncertainties (k = 1), `U95` and `expanded` hold for 95 %.
//!
//! # Errors
//!
//! Errors say what was found, where, and what was expected. [`SceneError`] lists all problems of a
//! file at once, each with its line. Results are finite, or there is an error instead.
//!
//! # Stability
//!
//! What is documented here is for others to build on. Everything else is public for the program's
//! own tests alone, hidden here, and changes without notice.
//!
//! Who builds on this library should have it optimised in development builds as well, by
//! `[profile.dev.package.hertzscope] opt-level = 2`: without, an [`Ensemble`] under error control
//! needs more than 8 MiB of stack.

#![cfg_attr(test, allow(clippy::disallowed_macros, reason = "tests print what they measure"))]

pub mod calibrate;
pub mod experiment;
pub mod fit;
pub mod measurement;
pub mod quantity;
pub mod recording;
pub mod scene;
#[cfg(feature = "server")]
pub mod server;

#[doc(hidden)]
pub mod analysis;
#[doc(hidden)]
pub mod chain;
#[doc(hidden)]
pub mod cli;
#[doc(hidden)]
pub mod client;
#[doc(hidden)]
pub mod data;
#[doc(hidden)]
pub mod files;
#[doc(hidden)]
pub mod hislip;
#[doc(hidden)]
pub mod instrument;
#[doc(hidden)]
pub mod magnet;
#[doc(hidden)]
pub mod motion;
#[doc(hidden)]
pub mod note;
#[doc(hidden)]
pub mod numeric;
#[doc(hidden)]
pub mod predict;
#[doc(hidden)]
pub mod report;
#[doc(hidden)]
pub mod scope;
#[doc(hidden)]
pub mod scpi;
#[doc(hidden)]
pub mod screen;
#[doc(hidden)]
pub mod sensor;
#[doc(hidden)]
pub mod studies;
#[doc(hidden)]
pub mod sweep;
#[doc(hidden)]
pub mod table;
#[doc(hidden)]
pub mod trace;
#[cfg(feature = "tui")]
#[doc(hidden)]
pub mod tui;
#[doc(hidden)]
pub mod vxi11;

pub use experiment::Outcome;
pub use experiment::accuracy::run_to_accuracy;
pub use experiment::ensemble::Ensemble;
pub use scene::{Scene, SceneError};
