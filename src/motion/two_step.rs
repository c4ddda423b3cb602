//! Steps of two lengths: long ones by the highest frequency of a system, short ones as long as a
//! contact is closed that is stiffer than all others, or about to close.
//!
//! With `w` the highest angular frequency of all but that contact and `w1` its own, steps last
//! `L/w`, and with the contact closed `S/w1`, shorter by `(tolerance/T)^(1/4)` below `T`, which a
//! method of order 4 wants. If it closes within a long step they last until then, if it opens
//! within a short one or has closed within it as long as that: steps end close to the places where
//! its force has no second derivative. What decides is the state where a step begins.

use super::control::REMAINDER;
use crate::chain::{Chain, hertz};

/// Name of the splitting with force gradients in such steps, as written in options and recordings.
pub const NAME: &str = "two-step-force-gradient";

/// `T`: over the paper's eight scenes first peaks and arrivals are off by less than that.
/// Tolerances beyond it make the same steps (1).
pub const LOOSEST_TOLERANCE: f64 = 1e-3;
/// `L`: a long step in terms of the highest frequency (rad).
pub const LONG_PHASE: f64 = 2.7;
/// `S` (rad).
const SHORT_PHASE: f64 = 1.2;
/// The least step where the stiff contact closes or opens, as a share of those while it is closed
/// (1).
const MIN_STEP_SHARE: f64 = 0.6;
/// The first step as a share of a long one: other contacts may begin at zero overlap, too (1).
const FIRST_STEP_SHARE: f64 = 0.3;
/// A step to where the stiff contact closes is taken in two where it is longer than this share of a
/// long one: until then its bodies are pushed as nobody foresees, and one that ends beyond that
/// place is off by far more (1).
const WHOLE_STEP_SHARE: f64 = 0.8;

/// What of a system decides on the length of steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pacing {
    /// Highest angular frequency, the stiff contact's left out, or a bound of it (1/s).
    pub frequency: f64,
    /// A contact with a higher frequency of its own.
    pub stiff: Option<StiffContact>,
}

/// A contact that wants shorter steps than all others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StiffContact {
    /// Coordinates above and below; none at an end.
    pub bodies: [Option<usize>; 2],
    /// Its overlap where both are zero (m).
    pub static_overlap: f64,
    /// Angular frequency of its two bodies on it (1/s).
    pub frequency: f64,
}

/// How a contact moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactMotion {
    /// By how much it is closed (m).
    pub overlap: f64,
    /// At what speed it closes (m/s).
    pub closing: f64,
    /// At what rate that changes (m/s²).
    pub bend: f64,
}

impl ContactMotion {
    /// Whether it is open and will not close within `time` (s), as far as can be told.
    #[inline]
    fn stays_open(&self, time: f64) -> bool {
        let Self { overlap, closing, bend } = *self;
        closing.max(0.0) * time + 0.5 * bend.max(0.0) * time * time <= -overlap
    }
}

/// The contact of a system without a stiff one: a gap that nothing closes.
pub const NO_CONTACT: ContactMotion = ContactMotion { overlap: -1.0, closing: 0.0, bend: 0.0 };

/// Steps, one after the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoStep {
    /// Length of a long step (s).
    long: f64,
    /// Longest while the stiff contact is closed (s).
    short: f64,
    /// The next (s).
    length: f64,
}

impl TwoStep {
    /// The steps that `tolerance` (1) asks of a system, the first on a given `motion` of its stiff
    /// contact, or [`NO_CONTACT`].
    pub fn new(pacing: &Pacing, tolerance: f64, motion: ContactMotion) -> Self {
        let share = (tolerance / LOOSEST_TOLERANCE).sqrt().sqrt().min(1.0);
        let long = share * LONG_PHASE / pacing.frequency;
        let short = pacing.stiff.map_or(long, |stiff| share * SHORT_PHASE / stiff.frequency);
        let mut steps = Self { long, short, length: 0.0 };
        steps.length = steps.after(motion).min(FIRST_STEP_SHARE * long);
        steps
    }

    /// Length of the next step from `time` on, and where it ends, not beyond `end` (s).
    #[inline]
    pub fn next(&self, time: f64, end: f64) -> (f64, f64) {
        let next = time + self.length;
        if next + REMAINDER * self.length < end { (self.length, next) } else { (end - time, end) }
    }

    /// A step has brought the stiff contact on this `motion`, [`NO_CONTACT`] if there is none.
    #[inline]
    pub fn advance(&mut self, motion: ContactMotion) {
        self.length = self.after(motion);
    }

    /// The step from there on (s). It branches rather than selects: a step need not wait for what
    /// decides on its length.
    #[inline]
    fn after(&self, motion: ContactMotion) -> f64 {
        let ContactMotion { overlap, closing, .. } = motion;
        if overlap > 0.0 {
            let speed = closing.abs();
            let is_near = overlap < self.short * speed;
            if is_near { (overlap / speed).max(MIN_STEP_SHARE * self.short) } else { self.short }
        } else {
            self.towards(motion)
        }
    }

    /// A long step with the contact open, or up to where it closes.
    #[inline]
    fn towards(&self, motion: ContactMotion) -> f64 {
        let ContactMotion { overlap, closing, bend } = motion;
        let (gap, long) = (-overlap, self.long);
        if motion.stays_open(long) {
            return long;
        }
        // Where `closing t + bend/2 t^2` is the gap.
        let square = closing * closing + 2.0 * bend * gap;
        let sum = closing + square.sqrt();
        let closes = 2.0 * gap / sum;
        if sum > 0.0 && closes < long {
            let length = if closes > WHOLE_STEP_SHARE * long { 0.5 * closes } else { closes };
            length.max(MIN_STEP_SHARE * self.short)
        } else {
            long
        }
    }
}

/// How fast the chain is when its bodies have these velocities (m/s): each contact at its
/// static overlap and that of a collision at the largest speed besides. Decides on the length
/// of steps of two lengths.
///
/// What overlaps do to each other's accelerations, `K_j (1/m_above + 1/m_below)` and
/// `K_(j-1)/m_above`, `K_(j+1)/m_below`, has no eigenvalue above the largest sum of a row's
/// magnitudes, the square of the frequency returned. For a long chain of two kinds of bodies
/// that is the highest.
pub fn pacing(chain: &Chain, velocity: &[f64]) -> Pacing {
    let contacts = chain.contacts();
    let speed = velocity.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let mut springs: Vec<(f64, [f64; 2])> = Vec::with_capacity(contacts.len());
    // Neighbours are mostly alike, and the power that a collision's overlap takes is slow.
    let mut last = ([0; 2], 0.0);
    for (j, contact) in contacts.iter().enumerate() {
        let masses = chain.inverse_masses(j);
        let kind = [contact.stiffness, masses[0] + masses[1]].map(f64::to_bits);
        if kind != last.0 && contact.stiffness > 0.0 {
            let reduced = 1.0 / (masses[0] + masses[1]);
            last = (kind, hertz::collision_overlap(contact.stiffness, reduced, speed));
        }
        springs.push((contact.tangent_stiffness(last.1), masses));
    }
    let squares = springs.iter().map(|(stiffness, [above, below])| stiffness * (above + below));
    let stiffest = squares.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
    let all = highest_square(&springs).sqrt();
    let Some((j, square)) = stiffest else { return Pacing { frequency: all, stiff: None } };
    springs[j].0 = 0.0;
    let (others, own) = (highest_square(&springs).sqrt(), square.sqrt());
    // In a chain of contacts that are all alike it is the root of 1/2 of it.
    if own <= others {
        return Pacing { frequency: all, stiff: None };
    }
    let bodies = [j.checked_sub(1), Some(j).filter(|j| *j < chain.bodies().len())];
    let static_overlap = contacts[j].static_overlap;
    let stiff = StiffContact { bodies, static_overlap, frequency: own };
    Pacing { frequency: others, stiff: Some(stiff) }
}

/// A bound of the square of the highest angular frequency of contacts with these stiffnesses (N/m)
/// between bodies of these inverse masses (1/kg) (1/s²).
fn highest_square(springs: &[(f64, [f64; 2])]) -> f64 {
    let beside = |j: Option<usize>| j.and_then(|j| springs.get(j)).map_or(0.0, |s| s.0);
    let sum = |(j, (stiffness, [above, below])): (usize, &(f64, [f64; 2]))| {
        stiffness * (above + below) + beside(j.checked_sub(1)) * above + beside(Some(j + 1)) * below
    };
    springs.iter().enumerate().map(sum).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bounce() -> Pacing {
        let stiff = StiffContact { bodies: [Some(0), None], static_overlap: 0.0, frequency: 24.0 };
        Pacing { frequency: 1.0, stiff: Some(stiff) }
    }

    const LENGTHS: [f64; 2] = [LONG_PHASE, SHORT_PHASE / 24.0];

    /// A body under gravity, thrown into a contact without a force: where steps end.
    #[test]
    fn steps_end_where_the_contact_closes() {
        let [long, short] = LENGTHS;
        let (gap, speed, bend, mut time) = (10.0, 1.0, 0.1, 0.0);
        let motion = |time: f64| ContactMotion {
            overlap: speed * time + 0.5 * bend * time * time - gap,
            closing: speed + bend * time,
            bend,
        };
        let mut steps = TwoStep::new(&bounce(), LOOSEST_TOLERANCE, motion(0.0));
        let mut taken = Vec::new();
        while time < 10.0 {
            let (h, next) = steps.next(time, 10.0);
            steps.advance(motion(next));
            taken.push((time, h));
            time = next;
        }
        assert!((taken[0].1 - FIRST_STEP_SHARE * long).abs() < 1e-12);
        assert!((taken[1].1 - long).abs() < 1e-12);
        let closes = taken.iter().position(|(time, _)| motion(*time).overlap.abs() < 1e-9);
        let closes = closes.expect("a step that ends where the contact closes");
        assert!((taken[closes].1 - MIN_STEP_SHARE * short).abs() < 1e-12);
        // As long each as all since then, until they are as long as may be.
        assert!((taken[closes + 1].1 - MIN_STEP_SHARE * short).abs() < 1e-3 * short);
        assert!((taken[closes + 2].1 - short).abs() < 1e-12);
        assert!(taken[closes + 2..taken.len() - 1].iter().all(|s| (s.1 - short).abs() < 1e-12));
        assert_eq!(time.to_bits(), 10.0_f64.to_bits());
    }

    /// Contacts that open, turn before they close, and are not there.
    #[test]
    fn steps_are_long_with_the_contact_open() {
        let [long, short] = LENGTHS;
        let mut steps = TwoStep::new(
            &bounce(),
            LOOSEST_TOLERANCE,
            ContactMotion { overlap: 1.0, ..NO_CONTACT },
        );
        for (overlap, closing, bend, length) in [
            (1.0, -3.0, 0.0, short),
            (0.8 * short, -1.0, 0.0, 0.8 * short),
            (0.1 * short, -1.0, 0.0, MIN_STEP_SHARE * short),
            (0.0, -1.0, 0.0, long),
            (-1e-3, -1.0, 0.1, long),
            (-1.0, 1.0, -0.6, long),
            (-1.0, 1.0, -0.5, 2.0),
            (-1.0, 0.4, 0.0, 1.25),
            (-1.0, 0.0, 2.0, 1.0),
            (-1.0, -1.0, 4.0, 1.0),
        ] {
            steps.advance(ContactMotion { overlap, closing, bend });
            assert!((steps.length - length).abs() < 1e-12, "{overlap} {closing}: {}", steps.length);
        }
        let none = Pacing { stiff: None, ..bounce() };
        // A hundredth of the tolerance, a good third of the step.
        let mut steps = TwoStep::new(&none, 0.01 * LOOSEST_TOLERANCE, NO_CONTACT);
        assert!((steps.length - FIRST_STEP_SHARE * LONG_PHASE / 10f64.sqrt()).abs() < 1e-12);
        steps.advance(NO_CONTACT);
        assert!((steps.length - LONG_PHASE / 10f64.sqrt()).abs() < 1e-12);
    }
}
