//! What the stepper asks of the loops of a splitting, each to be compiled for every instruction set.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use std::marker::PhantomData;

use super::forces::{ALIKE, ALIKE_SPARSE, EXACT, LINEAR, PLAIN, PLAIN_SPARSE};
use super::lanes::{Lanes, Row, Task};
use super::layout::{Layout, Striped};
use super::parts::Steps;
use super::plan::{Form, Plan};
use super::splits;
use super::timing::Paced;
use super::workspace::Workspace;

/// Takes steps of a splitting.
pub struct Split<'a, Y> {
    pub plan: &'a Plan,
    pub work: &'a mut Workspace,
    pub steps: Steps<'a>,
    pub layout: PhantomData<Y>,
}

impl<Y: Layout> Task for Split<'_, Y> {
    /// Whether all velocities are finite, a bit for each lane.
    type Output = u8;

    #[inline(always)]
    fn run<L: Lanes>(self) -> u8 {
        if self.steps.method.gradients.is_empty() {
            self.by::<L, false>()
        } else {
            self.by::<L, true>()
        }
    }
}

impl<Y: Layout> Split<'_, Y> {
    #[inline(always)]
    fn by<L: Lanes, const GRADIENT: bool>(self) -> u8 {
        let (sparse, alike) = (self.plan.is_sparse::<L>(), self.plan.alike.is_some());
        match self.plan.form {
            // What is one tile is in plain form: no need to compile others.
            _ if Y::TILE == 0 && sparse => L::apart(SplitIn::<Y, PLAIN_SPARSE, GRADIENT>(self)),
            _ if Y::TILE == 0 => L::apart(SplitIn::<Y, PLAIN, GRADIENT>(self)),
            _ if alike && sparse => L::apart(SplitIn::<Y, ALIKE_SPARSE, GRADIENT>(self)),
            _ if alike => L::apart(SplitIn::<Y, ALIKE, GRADIENT>(self)),
            Form::Plain if sparse => L::apart(SplitIn::<Y, PLAIN_SPARSE, GRADIENT>(self)),
            Form::Plain => L::apart(SplitIn::<Y, PLAIN, GRADIENT>(self)),
            Form::Exact => L::apart(SplitIn::<Y, EXACT, GRADIENT>(self)),
            Form::Linear => L::apart(SplitIn::<Y, LINEAR, GRADIENT>(self)),
        }
    }
}

/// Sees which contacts are closed.
pub struct Close<'a, Y> {
    pub plan: &'a Plan,
    pub position: &'a [Row],
    /// Those that were, and then those that are, a bit each of a row.
    pub closed: &'a mut [u8],
    pub layout: PhantomData<Y>,
}

impl<Y: Layout> Task for Close<'_, Y> {
    /// Whether any have changed sides.
    type Output = bool;

    #[inline(always)]
    fn run<L: Lanes>(self) -> bool {
        let Self { plan, position, closed, .. } = self;
        let (rows, mut changed) = (plan.rows(), 0);
        let (position, closed) = (&position[..rows], &mut closed[..rows]);
        let static_overlap = &plan.constants().static_overlap[..rows];
        for (r, (here, closed)) in position.iter().zip(closed).enumerate() {
            let change = L::sub(Y::above_in::<L>(position, r), L::load(here));
            let now = L::positive(L::add(change, L::load(&static_overlap[r])));
            changed |= now ^ *closed;
            *closed = now;
        }
        changed != 0
    }
}

/// Takes paced steps of a chain in the registers.
pub struct InPace<'a, 'm> {
    pub plan: &'a Plan,
    pub work: &'a mut Workspace,
    pub paced: Paced<'m>,
}

impl Task for InPace<'_, '_> {
    /// Whether all velocities are finite, a bit for each lane.
    type Output = u8;

    #[inline(always)]
    fn run<L: Lanes>(self) -> u8 {
        if self.plan.is_sparse::<L>() {
            L::apart(InPaceIn::<PLAIN_SPARSE>(self))
        } else {
            L::apart(InPaceIn::<PLAIN>(self))
        }
    }
}

/// Takes them in one form, in a function of its own.
struct InPaceIn<'a, 'm, const FORM: u8>(InPace<'a, 'm>);

impl<const FORM: u8> Task for InPaceIn<'_, '_, FORM> {
    type Output = u8;

    #[inline(always)]
    fn run<L: Lanes>(self) -> u8 {
        let InPace { plan, work, mut paced } = self.0;
        splits::timed::<L, Striped, FORM, true>(plan, work, &mut paced)
    }
}

/// Takes them in one form, in a function of its own.
struct SplitIn<'a, Y, const FORM: u8, const GRADIENT: bool>(Split<'a, Y>);

impl<Y: Layout, const FORM: u8, const GRADIENT: bool> Task for SplitIn<'_, Y, FORM, GRADIENT> {
    type Output = u8;

    #[inline(always)]
    fn run<L: Lanes>(self) -> u8 {
        let Split { plan, work, steps, .. } = self.0;
        splits::steps::<L, Y, FORM, GRADIENT>(plan, work, steps)
    }
}
