//! What the stepper asks of the loops, each to be compiled for every instruction set.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use std::marker::PhantomData;

use super::evaluate::{Found, evaluate};
use super::forces::{self, ALIKE, ALIKE_SPARSE, Cut, EXACT, LINEAR, PLAIN, PLAIN_SPARSE};
use super::guard::Guard;
use super::kinks;
use super::known::{Known, Pair64, Pair86};
use super::lanes::{Lanes, Row, Task};
use super::layout::Layout;
use super::passes::{self, Sides};
use super::plan::{Form, Plan};
use super::workspace::{Motion, Parts, Workspace};
use crate::integrate::Pair;

/// Finds the roots of static overlaps, and counts the static forces, as the loops compute them, among what leaves bodies at rest.
pub struct Settle<'a, Y>(pub &'a mut Plan, pub PhantomData<Y>);

impl<Y: Layout> Task for Settle<'_, Y> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self(plan, _) = self;
        let ([_, static_overlap, ..], rest) = plan.parts();
        for (rest, overlap) in rest.iter_mut().zip(static_overlap) {
            let root = L::sqrt(L::max(L::load(overlap), L::splat(0.0)));
            L::store(root, &mut rest.static_root);
        }
        if plan.form != Form::Plain {
            return;
        }
        if plan.is_sparse::<L>() {
            settle_both::<L, Y, PLAIN_SPARSE, ALIKE_SPARSE>(plan);
        } else {
            settle_both::<L, Y, PLAIN, ALIKE>(plan);
        }
    }
}

/// Settles a plan in one form, and in that of contacts that are alike if they are.
#[inline(always)]
fn settle_both<L: Lanes, Y: Layout, const FORM: u8, const SHARED: u8>(plan: &mut Plan) {
    settle::<L, Y, FORM>(plan);
    if plan.alike.is_some() {
        settle::<L, Y, SHARED>(plan);
    }
}

#[inline(always)]
fn settle<L: Lanes, Y: Layout, const FORM: u8>(plan: &mut Plan) {
    let (rows, rest) = (plan.rows(), L::splat(0.0));
    let mut next = rest;
    // From behind, so that only the first row of a tile is found twice.
    for r in (0..rows).rev() {
        let cut = Cut::of::<FORM>(plan, rows);
        let (here, _) = forces::forces::<L, FORM>(cut, r, rest);
        let mut below = next;
        let (first, last) = Y::tile(rows, r);
        if r == last {
            let (first, _) = forces::forces::<L, FORM>(cut, first, rest);
            below = Y::below::<L>(first, next);
        }
        let held = L::sub(here, below);
        let (balanced, static_force) = match &mut plan.alike {
            Some(alike) if matches!(FORM, ALIKE | ALIKE_SPARSE) => {
                (&mut alike.balanced[r], &mut alike.static_force[r])
            }
            _ => {
                let ([.., balanced], rest) = plan.parts();
                (&mut balanced[r], &mut rest[r].static_force)
            }
        };
        L::store(L::add(held, L::load(balanced)), balanced);
        L::store(here, static_force);
        next = here;
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
        let Parts { position, closed, force, acceleration, .. } = motion.parts();
        Self { plan, position, out: (closed, force, acceleration), layout: PhantomData }
    }
}

impl<Y: Layout> Task for Evaluate<'_, Y> {
    type Output = Row;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Row {
        let Self { plan, position, out, .. } = self;
        let most = match plan.form {
            Form::Plain if plan.is_sparse::<L>() => {
                evaluate::<L, Y, PLAIN_SPARSE>(plan, position, out)
            }
            Form::Plain => evaluate::<L, Y, PLAIN>(plan, position, out),
            Form::Exact => evaluate::<L, Y, EXACT>(plan, position, out),
            Form::Linear => evaluate::<L, Y, LINEAR>(plan, position, out),
        };
        let mut largest = Row::default();
        L::store(Y::largest::<L>(most), &mut largest);
        largest
    }
}

/// Tries a step.
pub struct Attempt<'a, Y: Layout> {
    pub plan: &'a Plan,
    pub pair: Pair,
    pub work: &'a mut Workspace,
    /// Length of the step (s).
    pub step: Y::Own,
    /// How many tolerated errors an error of 1 m or 1 m/s is.
    pub worth: [Y::Own; 2],
}

impl<Y: Layout> Task for Attempt<'_, Y> {
    /// What contacts have done that asks for more.
    type Output = Sides;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Sides {
        match self.pair {
            Pair::DormandElMikkawyPrince64 => self.by::<L, Pair64, 6>(),
            Pair::DormandElMikkawyPrince86 => self.by::<L, Pair86, 9>(),
        }
    }
}

impl<Y: Layout> Attempt<'_, Y> {
    #[inline(always)]
    fn by<L: Lanes, P: Known<N>, const N: usize>(self) -> Sides {
        match self.plan.form {
            Form::Plain => self.in_form::<L, P, PLAIN, N>(),
            Form::Exact => L::apart(Other::<Y, P, EXACT, N>(self, PhantomData)),
            Form::Linear => {
                L::apart(Other::<Y, P, LINEAR, N>(self, PhantomData));
                // These contacts never open.
                Sides::default()
            }
        }
    }

    #[inline(always)]
    fn in_form<L: Lanes, P: Known<N>, const FORM: u8, const N: usize>(self) -> Sides {
        let Self { plan, work, step, worth, .. } = self;
        let h = (Y::spread::<L>(step), worth.map(|worth| Y::spread::<L>(worth)));
        passes::attempt::<L, Y, P, FORM, N>(plan, work, h)
    }
}

/// Tries a step in another form than the plain one: functions that hold all of them take the compiler long.
struct Other<'a, Y: Layout, P, const FORM: u8, const N: usize>(Attempt<'a, Y>, PhantomData<P>);

impl<Y: Layout, P: Known<N>, const FORM: u8, const N: usize> Task for Other<'_, Y, P, FORM, N> {
    type Output = Sides;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Sides {
        self.0.in_form::<L, P, FORM, N>()
    }
}

/// Corrects the step that was tried last, where contacts opened or closed.
pub struct Correct<'a, Y: Layout> {
    /// That step.
    pub attempt: Attempt<'a, Y>,
    /// What its contacts have done.
    pub sides: Sides,
    /// Impulses (N s) and their moments (N s²) that nobody would see.
    pub slack: [Y::Own; 2],
}

impl<Y: Layout> Task for Correct<'_, Y> {
    /// Whether anything had to be.
    type Output = bool;

    #[inline(always)]
    fn run<L: Lanes>(self) -> bool {
        match self.attempt.pair {
            Pair::DormandElMikkawyPrince64 => self.by::<L, Pair64, 6>(),
            Pair::DormandElMikkawyPrince86 => self.by::<L, Pair86, 9>(),
        }
    }
}

impl<Y: Layout> Correct<'_, Y> {
    #[inline(always)]
    fn by<L: Lanes, P: Known<N>, const N: usize>(self) -> bool {
        let Self { attempt: Attempt { plan, work, step, worth, .. }, sides, slack } = self;
        let limits = (Y::spread::<L>(step), slack.map(|slack| Y::spread::<L>(slack)));
        let mut guard = Guard::none();
        let corrected =
            sides.changed != 0 && kinks::correct::<L, Y, P, N>(plan, work, limits, &mut guard);
        let missed = sides.doubtful != 0 && kinks::missed::<L, Y>(plan, work, limits, &mut guard);
        if !corrected && !missed {
            return false;
        }
        let (rows, worth) = (plan.rows(), worth.map(|worth| Y::spread::<L>(worth)));
        let position = largest::<L>(&work.error_position[..rows], guard.position);
        let velocity = largest::<L>(&work.error_velocity[..rows], guard.velocity);
        let error = L::max(L::mul(position, worth[0]), L::mul(velocity, worth[1]));
        L::store(Y::largest::<L>(error), &mut work.largest.error);
        L::store(Y::largest::<L>(guard.moved), &mut work.largest.moved);
        true
    }
}

/// Largest magnitudes in `rows`, lane by lane, `least` at least.
#[inline(always)]
fn largest<L: Lanes>(rows: &[Row], least: L::V) -> L::V {
    let mut most = least;
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
    pub out: &'a mut [Row],
    pub layout: PhantomData<Y>,
}

impl<Y: Layout> Task for Jerks<'_, Y> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        forces::jerks::<L, Y>(self.plan, self.at, self.out);
    }
}
