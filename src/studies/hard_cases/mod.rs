//! The catalogue of hard cases: what breaks integrators of granular chains, and what this one makes
//! of it.
//!
//! Each case holds what the program computes against something from outside: a closed form, a
//! conservation law, or a solution by another family of methods at a tighter tolerance. Nothing but
//! three answers is possible: right within the stated bound, refused with a named cause, or wrong.

mod benches;
mod case;
mod chaos;
mod collisions;
mod edges;
mod ends;
mod endurance;
mod losses;
mod openings;
mod pulses;
mod tally;

pub use case::{CaseResult, CaseVerdict, HardCase};
pub use tally::CaseChecks;

/// All cases, in a fixed order.
pub fn catalogue() -> Vec<HardCase> {
    [
        pulses::CASES,
        collisions::CASES,
        openings::CASES,
        losses::CASES,
        endurance::CASES,
        edges::CASES,
        ends::CASES,
        chaos::CASES,
    ]
    .concat()
}

/// Runs the whole catalogue; `progress` is called with the share of the work done, 0 to 1.
pub fn run_all(progress: &mut dyn FnMut(f64)) -> Vec<CaseResult> {
    let cases = catalogue();
    let mut report = |done: usize| progress(done as f64 / cases.len() as f64);
    let judge = |(done, case): (usize, &HardCase)| {
        report(done);
        case.run()
    };
    cases.iter().enumerate().map(judge).collect()
}
