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

use std::hint::select_unpredictable;

use super::lanes::Row;
use super::plan::{Plan, Watched};
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

impl Watched {
    /// The share that should be tried instead of a step of `h` (s) from `now` on, of whose errors 1 m/s is `worth` so many tolerated ones; none where
    /// all of it is worth a try (1).
    #[inline]
    pub fn shorter(&self, plan: &Plan, now: &Motion, (h, worth): (f64, f64)) -> Option<f64> {
        let (row, lane) = self.at;
        let difference = |rows: &[Row]| {
            self.above.map_or(0.0, |(row, lane)| rows[row].0[lane]) - rows[row].0[lane]
        };
        let from = difference(now.position()) + plan.constants().static_overlap[row].0[lane];
        let bend = 0.5 * h * difference(now.acceleration());
        let travel = h * (difference(now.velocity()) + bend);
        let to = from + travel;
        let (less, more, way) = (from.min(to), from.max(to), travel.abs());
        let fresh = way - FADES * less;
        if more <= 0.0 || fresh <= 0.0 {
            return None;
        }
        let pulled = self.stiffness * more;
        let most = SCALE * worth * h * h * h * pulled * pulled;
        // Mostly it is little at its most.
        if most <= HOPELESS {
            return None;
        }
        let error = most * (fresh / way).min(1.0);
        let closed = if travel > 0.0 { more / way } else { EVER };
        (error > HOPELESS).then(|| shorter(error, closed))
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
        // Either is as likely as the other: the processor had better not guess.
        let less = middle * middle * middle * beyond * beyond < aim;
        low = select_unpredictable(less, middle, low);
        high = select_unpredictable(less, high, middle);
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
