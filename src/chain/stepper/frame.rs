//! The whole chain at one time within the stepper's last step.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use std::marker::PhantomData;

use super::force_track::{horner_and_slope, septic};
use super::forces::{self, Cut, EXACT, LINEAR};
use super::lanes::{Lanes, Row, Task, WIDTH};
use super::layout::Layout;
use super::plan::{Form, Plan};

/// Positions, velocities, accelerations and jerks in rows at both ends of a step.
#[derive(Clone, Copy)]
pub struct Ends<'a> {
    pub from: [&'a [Row]; 4],
    pub to: [&'a [Row]; 4],
    /// Start and length of the step (s).
    pub span: (f64, f64),
}

/// Positions (m) and force changes (N) of the whole chain at one time of the step.
pub struct Frame<'a, Y> {
    pub plan: &'a Plan,
    pub ends: Ends<'a>,
    /// Fraction of the step (1).
    pub theta: f64,
    pub position: &'a mut [Row],
    pub force: &'a mut [Row],
    pub layout: PhantomData<Y>,
}

impl<Y: Layout> Task for Frame<'_, Y> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { plan, ends, theta, position, force, .. } = self;
        let weights = basis::<L>(theta, ends.span.1);
        let cut = Cut::new(plan, plan.rows());
        let position = &mut position[..plan.rows()];
        for (r, position) in position.iter_mut().enumerate() {
            let mut here = L::splat(0.0);
            for (weight, rows) in weights.0.iter().zip(ends.from.iter().chain(&ends.to)) {
                here = L::mul_add(L::splat(*weight), L::load(&rows[r]), here);
            }
            L::store(here, position);
        }
        for (r, here) in position.iter().enumerate() {
            let change = L::sub(Y::above_in::<L>(position, r), L::load(here));
            let (row, _) = match plan.form {
                Form::Linear => forces::forces::<L, LINEAR>(cut, r, change),
                Form::Plain | Form::Exact => forces::forces::<L, EXACT>(cut, r, change),
            };
            L::store(row, &mut force[r]);
        }
    }
}

/// What value and derivatives at both ends weigh at `theta` in a step of `length` (s), side by side (unit).
#[inline(always)]
fn basis<L: Lanes>(theta: f64, length: f64) -> Row {
    let mut ends = [[Row::default(); 4]; 2];
    for (which, row) in ends.as_flattened_mut().iter_mut().enumerate() {
        row.0[which] = 1.0;
    }
    let mut alone = [[L::splat(0.0); 4]; 2];
    for which in 0..WIDTH {
        alone[which / 4][which % 4] = L::load(&ends[which / 4][which % 4]);
    }
    let septics = septic::<L>(alone, L::splat(length));
    let mut weights = Row::default();
    L::store(horner_and_slope::<L>(&septics, L::splat(theta)).0, &mut weights);
    weights
}
