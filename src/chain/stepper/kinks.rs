//! Contacts that opened or closed within a step: what the quadrature over the step has missed, put right.
//!
//! At zero overlap the force is only once differentiable, `F ~ (t - t0)^1.5`, and every quadrature of order above 2.5 loses its
//! order there. The overlap itself is smooth: the quintic through both ends of the step (overlap, closing speed and relative
//! acceleration) is integrated exactly up to rounding, by Gauss-Jacobi quadrature with the weight `s^1.5` from the root on. The
//! difference to what the method's own nodes make of the same quintic is added to the velocities, its first moment to the
//! positions:
//!
//! `dv = h/m (int_0^1 F dc - sum b'_i F(c_i))`, `dx = h^2/m (int_0^1 (1 - c) F dc - sum b_i F(c_i))`.
//!
//! The embedded solution gets the same treatment, so the error estimate sees what is left over and not the kink. Both the
//! correction itself and the quintic's own uncertainty guard the estimate. Contacts that change sides so slowly that nobody could
//! see the difference are left alone ([`super::visible`]).
//! Sources: C. W. Gear, O. Osterby, ACM Trans. Math. Softw. 10, 23 (1984), on discontinuities and order; W. Gautschi, Orthogonal
//! Polynomials (Oxford, 2004), section 3.1, on Gauss-Jacobi quadrature. Measured in `tests/it/kinks.rs`.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::lanes::{Lanes, Row, WIDTH};
use super::plan::{Layout, Plan};
use super::quadrature::Quadrature;
use super::quintic::{Quintic, raise};
use super::quintics;
use super::visible::Visible;
use super::workspace::{Motion, Workspace};

/// Share of a correction that is counted as error: residuals measured on the shipped scenes stayed below (1).
const CORRECTION_SHARE: f64 = 0.01;
/// Share of the quintic's own uncertainty that is counted as error (1).
const MODEL_SHARE: f64 = 0.1;
/// An impulse that could move the lightest body by no more than this share of the tolerated error is none (1).
const NEGLIGIBLE: f64 = 0.01;
/// What corrections add to the error estimate, lane by lane.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Guard {
    /// Of positions (m).
    pub position: Row,
    /// Of velocities (m/s).
    pub velocity: Row,
    /// Largest change of a position (m).
    pub moved: Row,
}

/// Impulse (N s) and its moment (N s²) that no body would show, for errors of `tolerance` relative to `scales` (m, m/s) (unit).
#[inline]
pub fn slack(tolerance: f64, scales: (f64, f64), lightest: f64) -> [f64; 2] {
    let share = NEGLIGIBLE * tolerance * lightest;
    [share * scales.1, share * scales.0]
}

/// Bits of the contacts in row `row` that changed sides in the step.
#[inline(always)]
fn changed(work: &Workspace, row: usize) -> u8 {
    work.now.closed[row] ^ work.next.closed[row]
}

/// Corrects the step of `h` (s, lane by lane) that `work` holds; none if there is nothing that could be seen.
#[inline(always)]
pub fn correct<L: Lanes, Y: Layout>(
    plan: &Plan,
    quadrature: &Quadrature,
    work: &mut Workspace,
    (h, slack): (&Row, &[Row; 2]),
) -> Option<Guard> {
    let visible = Visible::<L>::new(h, slack);
    let mut guard = Guard::default();
    let mut corrections = std::mem::take(&mut work.corrections);
    corrections.clear();
    let mut ends = quintics::Ends::default();
    let mut waiting = 0;
    for row in 0..plan.rows() {
        let mut bits = changed(work, row);
        if bits != 0 {
            bits &= visible.among::<Y>(plan, work, row);
        }
        while bits != 0 {
            let lane = bits.trailing_zeros() as usize;
            bits &= bits - 1;
            let contact = Contact::new::<Y>(plan, (row, lane), h.0[lane]);
            for (which, end) in contact.ends(work).into_iter().enumerate() {
                for (row, value) in ends.0[which].iter_mut().zip(end) {
                    row.0[waiting] = value;
                }
            }
            corrections.push(Correction { contact, ..Correction::default() });
            waiting += 1;
            if waiting == WIDTH {
                find::<L>(quadrature, &ends, &mut corrections, waiting);
                waiting = 0;
            }
        }
    }
    if waiting > 0 {
        find::<L>(quadrature, &ends, &mut corrections, waiting);
    }
    // Only now: what is found of a contact must not depend on its neighbours' corrections, nor on which lanes were beside it.
    for correction in &corrections {
        correction.apply(plan, work, &mut guard);
    }
    work.corrections = corrections;
    if work.corrections.is_empty() { None } else { Some(guard) }
}

/// Finds the last `count` corrections from the `ends` of their contacts' steps.
#[inline(always)]
fn find<L: Lanes>(
    quadrature: &Quadrature,
    ends: &quintics::Ends,
    corrections: &mut [Correction],
    count: usize,
) {
    let missing = quintics::missing::<L>(quadrature, ends);
    let from = corrections.len() - count;
    for (i, correction) in corrections[from..].iter_mut().enumerate() {
        let Contact { h, stiffness, .. } = correction.contact;
        let (whole, square) = (h * stiffness, h * h * stiffness);
        correction.kick = whole * missing.impulse.0[i];
        correction.shift = square * missing.moment.0[i];
        correction.kick_error = whole * missing.errors[0].0[i];
        correction.shift_error = square * missing.errors[1].0[i];
        let depth = ends.0[0][0].0[i].max(ends.0[1][0].0[i]);
        correction.model = MODEL_SHARE * whole * 1.5 * depth.sqrt() * missing.uncertainty.0[i];
    }
}

/// Contacts that were open at both ends of the step and may have touched in between, or the other way round: the method's nodes may
/// have missed it altogether. What they may have missed counts as error, so that the step is taken again, and shorter.
#[inline(always)]
pub fn missed<L: Lanes, Y: Layout>(
    plan: &Plan,
    work: &Workspace,
    (h, slack): (&Row, &[Row; 2]),
    guard: &mut Guard,
) -> bool {
    let mut any = false;
    let step = L::load(h);
    let rows = plan.rows();
    let static_overlap = &plan.static_overlap[..rows];
    let (x0, v0) = (&work.now.position[..rows], &work.now.velocity[..rows]);
    let (x1, v1) = (&work.next.position[..rows], &work.next.velocity[..rows]);
    let none = L::splat(0.0);
    let mut last = (none, none, none, none);
    for row in 0..rows {
        let here = (L::load(&x0[row]), L::load(&v0[row]), L::load(&x1[row]), L::load(&v1[row]));
        let overlap = L::load(&static_overlap[row]);
        let from = L::add(L::sub(Y::above::<L>(last.0, here.0), here.0), overlap);
        let to = L::add(L::sub(Y::above::<L>(last.2, here.2), here.2), overlap);
        let start = L::mul(step, L::sub(Y::above::<L>(last.1, here.1), here.1));
        let end = L::mul(step, L::sub(Y::above::<L>(last.3, here.3), here.3));
        // The tangents at both ends meet beyond zero overlap.
        let meet = L::sub(L::mul(start, L::sub(to, end)), L::mul(end, from));
        let towards = L::sub(none, L::mul(start, from));
        let mut bits = L::positive(meet)
            & L::positive(L::mul(from, to))
            & L::positive(towards)
            & L::positive(L::mul(end, to));
        while bits != 0 {
            let lane = bits.trailing_zeros() as usize;
            bits &= bits - 1;
            let contact = Contact::new::<Y>(plan, (row, lane), h.0[lane]);
            let limits = [slack[0].0[lane], slack[1].0[lane]];
            any |= contact.stiffness > 0.0 && contact.count_missed::<L>(plan, work, limits, guard);
        }
        last = here;
    }
    any
}

/// One contact that changed sides.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Contact {
    place: (usize, usize),
    upper: Option<(usize, usize)>,
    stiffness: f64,
    static_overlap: f64,
    /// The step (s).
    h: f64,
}

impl Contact {
    #[inline(always)]
    fn new<Y: Layout>(plan: &Plan, place: (usize, usize), h: f64) -> Self {
        let (row, lane) = place;
        Self {
            place,
            upper: Y::upper(row, lane),
            stiffness: plan.stiffness[row].0[lane],
            static_overlap: plan.static_overlap[row].0[lane],
            h,
        }
    }

    #[inline(always)]
    fn difference(&self, rows: &[Row]) -> f64 {
        let at = |(row, lane): (usize, usize)| rows[row].0[lane];
        self.upper.map_or(0.0, at) - at(self.place)
    }

    /// Counts the impulse that the nodes may have missed, if it could be seen.
    #[inline(always)]
    fn count_missed<L: Lanes>(
        &self,
        plan: &Plan,
        work: &Workspace,
        [velocity, position]: [f64; 2],
        guard: &mut Guard,
    ) -> bool {
        let [from, to] = self.ends(work);
        let beyond = Quintic::new(from, to).beyond::<L>();
        let impulse = self.h * self.stiffness * beyond * beyond.sqrt();
        if impulse <= velocity && impulse * self.h <= position {
            return false;
        }
        for (row, lane) in self.upper.into_iter().chain([self.place]) {
            let kick = impulse * plan.inverse_mass[row].0[lane];
            raise(&mut guard.velocity.0[self.place.1], kick);
            raise(&mut guard.position.0[self.place.1], 0.5 * self.h * kick);
        }
        true
    }

    /// Overlap, closing speed and relative acceleration at one end, in units of the step (m).
    #[inline(always)]
    fn end(&self, motion: &Motion) -> [f64; 3] {
        let h = self.h;
        [
            self.static_overlap + self.difference(&motion.position),
            h * self.difference(&motion.velocity),
            h * h * self.difference(&motion.acceleration),
        ]
    }

    #[inline(always)]
    fn ends(&self, work: &Workspace) -> [[f64; 3]; 2] {
        [self.end(&work.now), self.end(&work.next)]
    }
}

/// What a contact's change of sides makes of a step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Correction {
    contact: Contact,
    /// Impulse that the quadrature has missed (N s), and its moment (N s²).
    kick: f64,
    shift: f64,
    /// What it has put into the error estimates of velocities (N s) and positions (N s²).
    kick_error: f64,
    shift_error: f64,
    /// How far off the overlap's quintic may make the impulse (N s).
    model: f64,
}

impl Correction {
    #[inline(always)]
    fn apply(&self, plan: &Plan, work: &mut Workspace, guard: &mut Guard) {
        let Contact { place, upper, h, .. } = self.contact;
        for (sign, place) in [(-1.0, upper), (1.0, Some(place))] {
            let Some((row, side)) = place else { continue };
            let per_mass = sign * plan.inverse_mass[row].0[side];
            work.next.velocity[row].0[side] += per_mass * self.kick;
            work.next.position[row].0[side] += per_mass * self.shift;
            work.error_velocity[row].0[side] -= per_mass * self.kick_error;
            work.error_position[row].0[side] -= per_mass * self.shift_error;
            let (kick, shift) = ((per_mass * self.kick).abs(), (per_mass * self.shift).abs());
            let model = (per_mass * self.model).abs();
            let lane = self.contact.place.1;
            raise(&mut guard.velocity.0[lane], (CORRECTION_SHARE * kick).max(model));
            raise(&mut guard.position.0[lane], (CORRECTION_SHARE * shift).max(0.3 * h * model));
            raise(&mut guard.moved.0[lane], shift);
        }
    }
}
