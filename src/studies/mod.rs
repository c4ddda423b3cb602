//! Studies: questions that take many runs of scenes, or that examine the program itself.
//!
//! Stands above `experiment`, which runs one scene once: cost over error of methods, cost and
//! change of each effect, difficult scenes with known answers, the paper's figures and tables,
//! and maps over a scene's numbers.

pub mod cost;
pub mod effects;
pub mod hard_cases;
pub mod paper;
pub mod tunability;
