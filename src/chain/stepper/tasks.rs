//! What the stepper asks of the loops, each to be compiled for every instruction set.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use std::marker::PhantomData;
use std::ops::Range;

use super::dispatch::Task;
use super::evaluate::{Found, evaluate};
use super::forces::{self, Cut, EXACT, LINEAR, PLAIN};
use super::kinks::{self, Guard};
use super::lanes::{Lanes, Row};
use super::passes;
use super::plan::{Form, Layout, Plan};
use super::quadrature::Quadrature;
use super::splits;
use super::workspace::{Motion, Workspace};
use crate::integrate::Pair;
use crate::integrate::splitting::Splitting;

/// Counts the static forces, as the loops compute them, among what leaves bodies at rest.
pub struct Settle<'a, Y>(pub &'a mut Plan, pub PhantomData<Y>);

impl<Y: Layout> Task for Settle<'_, Y> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self(plan, _) = self;
        if plan.form != Form::Plain {
            return;
        }
        let (rows, rest) = (plan.rows(), L::splat(0.0));
        let mut next = rest;
        // From behind, so that each force is found once.
        for r in (0..rows).rev() {
            let cut = Cut::new(plan, rows);
            let (here, _) = forces::forces::<L, PLAIN>(cut, r, rest);
            let held = forces::net::<L, Y>([here, next]);
            L::store(L::add(held, L::load(&plan.balanced[r])), &mut plan.balanced[r]);
            L::store(here, &mut plan.static_force[r]);
            next = here;
        }
    }
}

/// Finds closed contacts, forces and accelerations at given positions; returns the largest change of an overlap (m).
pub struct Evaluate<'a, Y> {
    pub plan: &'a Plan,
    pub position: &'a [Row],
    pub out: Found<'a>,
    pub layout: PhantomData<Y>,
}

impl<'a, Y> Evaluate<'a, Y> {
    /// Where `motion` is, kept there.
    pub fn at(plan: &'a Plan, motion: &'a mut Motion) -> Self {
        let Motion { position, closed, force, acceleration, .. } = motion;
        Self { plan, position, out: (closed, force, acceleration), layout: PhantomData }
    }
}

impl<Y: Layout> Task for Evaluate<'_, Y> {
    type Output = Row;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Row {
        let Self { plan, position, out, .. } = self;
        let most = match plan.form {
            Form::Plain => evaluate::<L, Y, PLAIN>(plan, position, out),
            Form::Exact => evaluate::<L, Y, EXACT>(plan, position, out),
            Form::Linear => evaluate::<L, Y, LINEAR>(plan, position, out),
        };
        let mut largest = Row::default();
        L::store(Y::largest::<L>(most), &mut largest);
        largest
    }
}

/// Tries a step, and corrects it where contacts opened or closed.
pub struct Attempt<'a, Y: Layout> {
    pub plan: &'a Plan,
    pub pair: Pair,
    pub quadrature: &'a Quadrature,
    pub work: &'a mut Workspace,
    /// Length of the step (s).
    pub step: Y::Own,
    /// How many tolerated errors an error of 1 m or 1 m/s is.
    pub worth: [Y::Own; 2],
    /// Impulses (N s) and their moments (N s²) that nobody would see.
    pub slack: [Y::Own; 2],
    pub layout: PhantomData<Y>,
}

impl<Y: Layout> Task for Attempt<'_, Y> {
    /// What corrections leave uncertain; none where no contact changed sides.
    type Output = Option<Guard>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Option<Guard> {
        let Self { plan, pair, quadrature, work, step, worth, slack, .. } = self;
        let worth = worth.map(|worth| Y::spread::<L>(worth));
        let h = (Y::spread::<L>(step), worth);
        let sides = match plan.form {
            Form::Plain => passes::attempt::<L, Y, PLAIN>(plan, pair, work, h),
            Form::Exact => passes::attempt::<L, Y, EXACT>(plan, pair, work, h),
            Form::Linear => {
                // These contacts never open.
                passes::attempt::<L, Y, LINEAR>(plan, pair, work, h);
                return None;
            }
        };
        if !sides.changed && !sides.doubtful {
            return None;
        }
        let (step, slack) = (Y::row(step), slack.map(|slack| Y::row(slack)));
        if !slack[0].0.iter().any(|slack| slack.is_finite()) {
            return None;
        }
        let limits = (&step, &slack);
        let corrected = if sides.changed {
            kinks::correct::<L, Y>(plan, quadrature, work, limits)
        } else {
            None
        };
        let mut guard = corrected.unwrap_or_default();
        let missed = kinks::missed::<L, Y>(plan, work, limits, &mut guard);
        if corrected.is_none() && !missed {
            return None;
        }
        let rows = plan.rows();
        let position = largest::<L>(&work.error_position[..rows], &guard.position);
        let velocity = largest::<L>(&work.error_velocity[..rows], &guard.velocity);
        let [position_worth, velocity_worth] = worth;
        let error = L::max(L::mul(position, position_worth), L::mul(velocity, velocity_worth));
        L::store(Y::largest::<L>(error), &mut work.largest.error);
        Some(guard)
    }
}

/// Takes steps of a splitting.
pub struct Split<'a, Y> {
    pub plan: &'a Plan,
    pub method: &'a Splitting,
    pub work: &'a mut Workspace,
    /// Length of a step in each lane (s).
    pub step: Row,
    /// How many.
    pub count: u64,
    pub layout: PhantomData<Y>,
}

impl<Y: Layout> Task for Split<'_, Y> {
    /// Whether all velocities are finite, a bit for each lane.
    type Output = u8;

    #[inline(always)]
    fn run<L: Lanes>(self) -> u8 {
        let Self { plan, method, work, step, count, .. } = self;
        let h = (L::load(&step), count);
        match (plan.form, method.gradients.is_empty()) {
            (Form::Plain, true) => splits::steps::<L, Y, PLAIN, false>(plan, method, work, h),
            (Form::Plain, false) => splits::steps::<L, Y, PLAIN, true>(plan, method, work, h),
            (Form::Exact, true) => splits::steps::<L, Y, EXACT, false>(plan, method, work, h),
            (Form::Exact, false) => splits::steps::<L, Y, EXACT, true>(plan, method, work, h),
            (Form::Linear, true) => splits::steps::<L, Y, LINEAR, false>(plan, method, work, h),
            (Form::Linear, false) => splits::steps::<L, Y, LINEAR, true>(plan, method, work, h),
        }
    }
}

/// Largest magnitudes in `rows`, lane by lane, `least` at least.
#[inline(always)]
fn largest<L: Lanes>(rows: &[Row], least: &Row) -> L::V {
    let mut most = L::load(least);
    for row in rows {
        most = L::max(L::abs(L::load(row)), most);
    }
    most
}

/// Finds the rates of the accelerations (m/s³), or with accelerations in the velocities' place their gradients along themselves (m/s⁴).
pub struct Jerks<'a, Y> {
    pub plan: &'a Plan,
    /// Positions and velocities.
    pub at: (&'a [Row], &'a [Row]),
    /// The rows they are wanted in.
    pub rows: Range<usize>,
    pub out: &'a mut [Row],
    pub layout: PhantomData<Y>,
}

impl<Y: Layout> Task for Jerks<'_, Y> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        forces::jerks::<L, Y>(self.plan, self.at, self.rows, self.out);
    }
}
