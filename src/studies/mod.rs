//! Studies: questions that take many runs of scenes, or that examine the program itself.
//!
//! Stands above `experiment`, which runs one scene once: cost over error of methods, cost and
//! change of each effect, difficult scenes with known answers, the paper's figures and tables,
//! tuning of band gaps, uncertain scenes, and the program's examination on the machine at hand.

pub mod cost;
pub mod doctor;
pub mod effects;
pub mod hard_cases;
pub mod paper;
pub mod tunability;
pub mod uncertainty;
