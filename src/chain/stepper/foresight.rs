//! Steps that would end too far beyond the closing of a contact, or begin too long before its opening, foreseen before they are tried.
//!
//! A contact that closes at the speed `w`, a time `s` before the end of a step of `h`, throws off the stages in between, and what is put
//! right afterwards ([`super::kinks`]) follows the path between the step's ends only. What is left for the error estimate of the velocities
//! comes to about
//!
//! `1e-3 (A/m)^2 w^2 h^3 s^2`   (m/s)
//!
//! with the contact's stiffness `A` and its bodies' reduced mass `m`. `w s` is how far the contact would be closed at the step's end if nothing
//! held it up. An opening is the same, seen backwards: `w s` is how far it is closed at the start. A contact that has closed just before the
//! step does as much harm; how much less one that closed longer ago does is a straight line.
//!
//! The law is measured: over four shipped scenes and their chain under gravity with one stiffness throughout, both pairs and tolerances of
//! 1e-2, 1e-4 and 1e-6, all 260 steps that it says err by more than three tolerated errors were estimated to err by more than one, and 118 of
//! 161 between one and three.
//!
//! Only the stiffest contacts for their bodies are watched, where they are few ([`Plan::watched`]), as a striker's is: they ask for shorter
//! steps than others while they are closed, and are open most of the time. Where all are alike, looking ahead costs more than it saves.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::lanes::{Lanes, Row, Task};
use super::layout::Layout;
use super::plan::{Plan, Watched};
use super::tried::difference;
use super::workspace::Motion;

/// `1e-3` above (1).
const SCALE: f64 = 1e-3;
/// A contact that has been closed for longer than a step times the inverse of this does no harm (1).
const FADES: f64 = 3.0;
/// A step is not tried whose error is foreseen to be more than this, in multiples of the tolerated one (1).
const HOPELESS: f64 = 1.2;
/// What its error is brought to (1).
const AIM: f64 = 0.35;
/// A step is made shorter so many times at most: another contact may be the worst of what is left of it, or one try may not be enough.
pub const MOST_SHORTENED: usize = 4;
/// After a step that was made shorter, or tried in vain, so many are looked at: a bead that bounces has hit again by then.
const WATCHED: u8 = 16;
/// A time before the step that is as good as ever, in steps (1).
const EVER: f64 = 1e3;
/// Halvings of the interval in which the shorter step is looked for.
const HALVINGS: usize = 6;

/// For how many steps more a chain's are looked at: where none fails it would only cost time.
#[derive(Debug, Clone, Copy)]
pub struct Watch(u8);

impl Watch {
    /// From the start on.
    pub fn new() -> Self {
        Self(WATCHED)
    }

    /// Whether the next step is looked at.
    pub fn is_on(self) -> bool {
        self.0 > 0
    }

    /// Once more: a step was made shorter, or failed.
    pub fn renew(&mut self) {
        self.0 = WATCHED;
    }

    /// A step was taken.
    pub fn pass(&mut self) {
        self.0 = self.0.saturating_sub(1);
    }
}

/// What is foreseen of the steps of chains about to be tried.
pub struct Foresee<'a, Y: Layout> {
    /// The chains.
    pub plan: &'a Plan,
    /// Where the step starts.
    pub now: &'a Motion,
    /// Its length (s).
    pub step: Y::Own,
    /// How many tolerated errors an error of 1 m/s is (s/m).
    pub worth: Y::Own,
}

/// What is foreseen of a step, lane by lane.
#[derive(Debug, Clone, Copy)]
pub struct Foreseen {
    /// The largest error, in multiples of the tolerated one (1).
    error: Row,
    /// For how long the contact that makes it has been closed at the step's end, in steps (1).
    closed: Row,
}

impl<Y: Layout> Task for Foresee<'_, Y> {
    /// Nothing where all steps are worth a try.
    type Output = Option<Foreseen>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Self::Output {
        let Self { plan, now, step, worth } = self;
        let (none, h) = (L::splat(0.0), Y::spread::<L>(step));
        let square = L::mul(h, h);
        let scale = L::mul(L::mul(L::splat(SCALE), Y::spread::<L>(worth)), L::mul(square, h));
        let (mut worst, mut closed) = (none, none);
        for Watched { row: r, bits, stiffness } in &plan.watched {
            let overlap = difference::<L, Y>(now.position(), *r);
            let from = L::add(overlap, L::load(&plan.static_overlap[*r]));
            let bend = difference::<L, Y>(now.acceleration(), *r);
            let bend = L::mul(L::mul(L::splat(0.5), square), bend);
            let travel = L::mul_add(h, difference::<L, Y>(now.velocity(), *r), bend);
            let to = L::add(from, travel);
            let (less, more, way) = (L::min(from, to), L::max(from, to), L::abs(travel));
            let fresh = L::sub(way, L::mul(L::splat(FADES), less));
            let felt = bits & L::positive(L::min(more, fresh));
            if felt == 0 {
                continue;
            }
            let pulled = L::mul(L::load(stiffness), more);
            let share = L::min(L::div(fresh, way), L::splat(1.0));
            let error = L::mul(L::mul(pulled, pulled), L::mul(share, scale));
            let error = L::select(felt, error, none);
            let since = L::select(L::positive(travel), L::div(more, way), L::splat(EVER));
            closed = L::select(L::positive(L::sub(error, worst)), since, closed);
            worst = L::max(error, worst);
        }
        if L::positive(L::sub(worst, L::splat(HOPELESS))) == 0 {
            return None;
        }
        let mut foreseen = Foreseen { error: Row::default(), closed: Row::default() };
        L::store(worst, &mut foreseen.error);
        L::store(closed, &mut foreseen.closed);
        Some(foreseen)
    }
}

impl Foreseen {
    /// The share of its step that lane `lane` should try instead; none where all of it will do (1).
    pub fn shorter(&self, lane: usize) -> Option<f64> {
        let (error, closed) = (self.error.0[lane], self.closed.0[lane]);
        (error > HOPELESS).then(|| shorter(error, closed))
    }

    /// The share that a chain along the rows should try (1).
    pub fn shortest(&self) -> Option<f64> {
        let shares = (0..self.error.0.len()).filter_map(|lane| self.shorter(lane));
        shares.reduce(f64::min)
    }
}

/// The share of a step that brings its `error` to the [`AIM`], when its contact has been `closed` for so many steps at its end (1): it goes as
/// the step's length to the power 3 and that time to the power 2.
fn shorter(error: f64, closed: f64) -> f64 {
    let start = 1.0 - closed;
    let aim = closed * closed * AIM / error;
    let (mut low, mut high) = (start.max(0.0), 1.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        let beyond = middle - start;
        if middle * middle * middle * beyond * beyond < aim {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_tried_instead_errs_as_it_should() {
        // Contacts that close within the step, at its start, a third of it before, and one that opens.
        for closed in [1e-3, 0.5, 1.0, 4.0 / 3.0, EVER] {
            for error in [1.5, 20.0, 1e6] {
                let share = shorter(error, closed);
                let closes = (1.0 - closed).max(0.0);
                assert!(closes < share && share < 1.0, "{closed}, {error}: {share}");
                let errs = |share: f64| {
                    error * share.powi(3) * ((share + closed - 1.0) / closed).max(0.0).powi(2)
                };
                // To the width of the last interval.
                let width = (1.0 - closes) / f64::from(1 << HALVINGS);
                assert!(
                    errs(share) >= AIM && errs(share - 1.01 * width) < AIM,
                    "{closed}, {error}"
                );
            }
        }
    }
}
