//! A splitting's steps in parts: a drift, the forces, where the method asks for it how they change where they point, and a kick. Each part is a
//! sweep along the rows, where there are gradients two of them.
//!
//! A long chain's rows do not fit into the cache next to the processor: a stretch of them goes through all parts of a step before the next, each
//! sweep a few rows behind the one before.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use std::marker::PhantomData;

use super::forces::Cut;
use super::kicks::{After, Bend, Both, Kicks, Push, Start};
use super::lanes::{Lanes, Row};
use super::layout::Layout;
use super::notes::Notes;
use super::plan::Plan;
use super::splits::Weights;
use super::strip::{FOUR, Strip, StripMut};
use super::sweep::{Forces, Pause, stretch};
use super::workspace::{Parts, Workspace};
use crate::integrate::splitting::Splitting;

/// Positions, velocities, accelerations, and their gradients where a method asks for them: before they are weighed, two thirds of tangent
/// stiffnesses.
type Rows<'a> = [&'a mut [Row]; 4];

/// Rows that a sweep stays behind the one before, for what a row leaves is done once the next is pressed.
const BEHIND: usize = FOUR;
/// Most rows that go through a part all at once: with what moves them 40 kB.
const AT_ONCE: usize = 112;
/// Rows of a stretch where there are more.
const STRETCH: usize = 96;

/// Steps of a splitting.
pub struct Steps<'a> {
    pub method: &'a Splitting,
    /// Length of a step, lane by lane (s).
    pub length: &'a Row,
    /// How many.
    pub count: u64,
    /// What is noted of all but the last two, or of all but the last where the start is kept.
    pub notes: &'a mut Notes,
    /// Whether what moves stays where it was at the start of the first, so that they can be taken again, and not at the start of the last.
    pub keeps_start: bool,
}

/// Pauses that steps of `method` need in so many rows.
pub fn pauses(method: &Splitting, rows: usize) -> usize {
    if rows > AT_ONCE { 2 * method.drifts.len() } else { 0 }
}

/// Takes steps of a chain that does not fit into the registers, as [`super::splits::steps`] does. All but the last are taken in place, or all but the
/// first where the start is kept: less memory is read and written.
#[inline(always)]
pub fn long<L: Lanes, Y: Layout, const FORM: u8, const GRADIENT: bool>(
    plan: &Plan,
    work: &mut Workspace,
    steps: &mut Steps,
) {
    let rows = plan.rows();
    let shown = if GRADIENT { rows } else { 0 };
    let plan = Cut::of::<FORM>(plan, rows);
    let (now, next) = (work.now.parts(), work.next.parts());
    let (mut before, mut after) = (cut(now, (rows, shown)), cut(next, (rows, shown)));
    let keeps_start = steps.keeps_start;
    for left in (0..steps.count).rev() {
        let moves_on = if keeps_start { left + 1 == steps.count } else { left == 0 };
        let mut step = Step::<Y, FORM, GRADIENT> {
            plan,
            method: steps.method,
            length: steps.length,
            from: None,
            moving: &mut after,
            pauses: &mut work.pauses,
            notes: &mut *steps.notes,
            is_begun: left + 1 < steps.count,
            goes_on: left > u64::from(!keeps_start),
            layout: PhantomData,
        };
        if moves_on {
            step.from = Some([&*before[0], &*before[1], &*before[2], &*before[3]]);
        } else if !keeps_start {
            step.moving = &mut before;
        }
        step.take::<L>();
    }
}

/// What moves in the first `rows` rows, and its gradients in `shown` of them.
#[inline(always)]
fn cut(of: Parts, (rows, shown): (usize, usize)) -> Rows {
    let Parts { position, velocity, acceleration, gradient, .. } = of;
    [
        &mut position[..rows],
        &mut velocity[..rows],
        &mut acceleration[..rows],
        &mut gradient[..shown],
    ]
}

/// A step, in place or from elsewhere.
struct Step<'a, 'r, Y, const FORM: u8, const GRADIENT: bool> {
    plan: Cut<'a>,
    method: &'a Splitting,
    /// (s)
    length: &'a Row,
    from: Option<[&'a [Row]; 4]>,
    moving: &'a mut Rows<'r>,
    pauses: &'a mut [Pause],
    notes: &'a mut Notes,
    /// Whether the step before has given the first kick.
    is_begun: bool,
    /// Whether this one gives the next one's: it reads and writes less than both for themselves.
    goes_on: bool,
    layout: PhantomData<Y>,
}

impl<'a, Y: Layout, const FORM: u8, const GRADIENT: bool> Step<'a, '_, Y, FORM, GRADIENT> {
    #[inline(always)]
    fn take<L: Lanes>(&mut self) {
        let (rows, parts) = (self.moving[0].len(), self.method.drifts.len());
        let bends = (0..parts).filter(|part| self.bends(*part)).count();
        let sweeps = if GRADIENT && Y::TILE != 1 { parts + bends } else { parts };
        let behind = sweeps * BEHIND;
        let length = if rows <= AT_ONCE { rows + behind } else { STRETCH };
        let mut end = 0;
        while end < rows + behind {
            let start = end;
            end += length;
            for sweep in 0..sweeps {
                let reached = |at: usize| at.saturating_sub(sweep * BEHIND).min(rows);
                let span = [reached(start), reached(end)];
                if span[0] < span[1] {
                    self.sweep::<L>(sweep, span);
                }
            }
        }
    }

    /// Whether the kick behind drift `part` goes by gradients: all may but the last, and none does in a step whose first does not.
    #[inline(always)]
    fn bends(&self, part: usize) -> bool {
        GRADIENT && (part + 1 < self.method.drifts.len() || self.method.gradients[0] != 0.0)
    }

    /// Takes sweep number `index` over the rows `span`.
    #[inline(always)]
    fn sweep<L: Lanes>(&mut self, index: usize, span: [usize; 2]) {
        if index == 0 && self.from.is_none() && !self.is_begun {
            self.open::<L>(span);
        }
        let mut pause = self.pauses.get(index).copied().unwrap_or_default();
        let apart = GRADIENT && Y::TILE != 1;
        let part = if apart { index / 2 } else { index };
        let starts = part == 0 && self.from.is_some();
        let is_last = part + 1 == self.method.drifts.len();
        match (apart && index % 2 == 1, starts, is_last) {
            (true, _, false) => self.bend::<L, false>(part, span, &mut pause),
            (true, _, true) => self.bend::<L, true>(part, span, &mut pause),
            (false, false, false) => self.push::<L, GRADIENT, false, false>(part, span, &mut pause),
            (false, true, false) => self.push::<L, GRADIENT, true, false>(part, span, &mut pause),
            (false, true, true) => self.push::<L, GRADIENT, true, true>(part, span, &mut pause),
            (false, false, true) if self.bends(part) => {
                self.push::<L, GRADIENT, false, true>(part, span, &mut pause);
            }
            (false, false, true) => self.push::<L, false, false, true>(part, span, &mut pause),
        }
        if let Some(paused) = self.pauses.get_mut(index) {
            *paused = pause;
        }
    }

    #[inline(always)]
    fn weights<L: Lanes>(&self) -> Weights<'a, L> {
        Weights::new(self.method, L::load(self.length))
    }

    /// The first kick over the rows `span`.
    #[inline(always)]
    fn open<L: Lanes>(&mut self, [from, to]: [usize; 2]) {
        let kick = self.weights::<L>().kick::<GRADIENT>(0);
        let [_, velocity, acceleration, gradient] = &mut *self.moving;
        let (velocity, acceleration) = (&mut velocity[from..to], &acceleration[from..to]);
        let gradient = if GRADIENT { &gradient[from..to] } else { acceleration };
        for ((velocity, acceleration), gradient) in
            velocity.iter_mut().zip(acceleration).zip(gradient)
        {
            let of = [L::load(acceleration), L::load(gradient)];
            L::store(kick.on::<GRADIENT>(L::load(velocity), of), velocity);
        }
    }

    /// The kick behind drift `part`, of these weights.
    #[inline(always)]
    fn end<'n, L: Lanes>(
        (weights, part): (Weights<'a, L>, usize),
        goes_on: bool,
        notes: &'n mut Notes,
    ) -> Kicks<'n, L> {
        let after = match (part + 1 == weights.parts(), goes_on) {
            (false, _) => After::Part,
            (true, false) => After::End,
            (true, true) => After::Step(weights.kick::<GRADIENT>(0), notes),
        };
        Kicks { kick: weights.kick::<GRADIENT>(part + 1), after }
    }

    /// Part `part` over the rows `span`, in tiles up to the kick where that goes by gradients.
    #[inline(always)]
    fn push<L: Lanes, const BENDS: bool, const FIRST: bool, const LAST: bool>(
        &mut self,
        part: usize,
        span: [usize; 2],
        pause: &mut Pause,
    ) {
        let (rows, end) = (self.moving[0].len(), span[1]);
        let shown = if GRADIENT { end } else { 0 };
        let weights = self.weights::<L>();
        let kicks = Self::end((weights, part), self.goes_on, self.notes);
        let drift = weights.drift(part);
        let start = self.from.filter(|_| FIRST).map(|[x, v, a, g]| Start {
            kick: weights.kick::<GRADIENT>(0),
            of: [Strip::new(x, end), Strip::new(v, end), Strip::new(a, end), Strip::new(g, shown)],
        });
        let [x, v, a, g] = &mut *self.moving;
        let mut push = Push::<L, BENDS, FIRST, LAST> {
            start,
            drift,
            kicks,
            position: StripMut::new(x, end),
            velocity: StripMut::new(v, end),
            acceleration: StripMut::new(a, end),
            tangent: StripMut::new(g, shown),
        };
        if BENDS && Y::TILE == 1 {
            let mut both = Both::<L, Y, BENDS, FIRST, LAST> {
                push,
                inverse_mass: Strip::new(self.plan.inverse_mass, end),
                bent: if span[0] > 0 { pause.left::<L>() } else { [L::splat(0.0); 2] },
                layout: PhantomData,
            };
            let mut forces = Forces::<_, FORM>::new(self.plan, end, &mut both);
            stretch::<L, Y, _>(&mut forces, span, rows, pause);
            if end == rows {
                both.bend(((rows - 1) / FOUR, (rows - 1) % FOUR), L::splat(0.0));
            }
            pause.keep::<L>(both.bent);
        } else {
            let mut forces = Forces::<_, FORM>::new(self.plan, end, &mut push);
            stretch::<L, Y, _>(&mut forces, span, rows, pause);
        }
    }

    /// The rest of it: gradients and the kick.
    #[inline(always)]
    fn bend<L: Lanes, const LAST: bool>(
        &mut self,
        part: usize,
        span: [usize; 2],
        pause: &mut Pause,
    ) {
        let (rows, end) = (self.moving[0].len(), span[1]);
        let kicks = Self::end((self.weights::<L>(), part), self.goes_on, self.notes);
        let [x, v, a, g] = &mut *self.moving;
        let mut bend = Bend::<L, LAST> {
            inverse_mass: Strip::new(self.plan.inverse_mass, end),
            kicks,
            position: Strip::new(x, end),
            velocity: StripMut::new(v, end),
            acceleration: Strip::new(a, end),
            gradient: StripMut::new(g, end),
        };
        stretch::<L, Y, _>(&mut bend, span, rows, pause);
    }
}
