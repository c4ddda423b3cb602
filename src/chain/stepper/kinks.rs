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
//! correction itself and the quintic's own uncertainty guard the estimate.
//! Sources: C. W. Gear, O. Osterby, ACM Trans. Math. Softw. 10, 23 (1984), on discontinuities and order; W. Gautschi, Orthogonal
//! Polynomials (Oxford, 2004), section 3.1, on Gauss-Jacobi quadrature. Measured in `tests/it/kinks.rs`.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::lanes::{Row, WIDTH};
use super::plan::{Layout, Plan};
use super::workspace::{Motion, Workspace};
use crate::integrate::nystrom::{NystromPair, Row as Terms};

/// Nodes of the Gauss-Jacobi quadrature for the weight `s^1.5` on 0 to 1, five of them; the rest weighs nothing (1).
const ROOT_NODES: [f64; WIDTH] = [
    0.124_061_505_637_331_54,
    0.336_472_509_340_995_9,
    0.587_491_435_263_399_5,
    0.815_071_707_804_017_6,
    0.962_989_798_475_994_5,
    1.0,
    1.0,
    1.0,
];
/// Their weights (1).
const ROOT_WEIGHTS: [f64; WIDTH] = [
    0.007_609_028_036_605_25,
    0.047_184_038_143_998_46,
    0.112_429_350_380_216_15,
    0.144_130_795_395_627_18,
    0.088_646_788_043_552_97,
    0.0,
    0.0,
    0.0,
];
/// Share of a correction that is counted as error: residuals measured on the shipped scenes stayed below (1).
const CORRECTION_SHARE: f64 = 0.01;
/// Share of the quintic's own uncertainty that is counted as error (1).
const MODEL_SHARE: f64 = 0.1;
/// Most stages of a pair.
const MOST_STAGES: usize = 16;

/// A pair's nodes and weights, one entry a stage.
#[derive(Debug, Clone, PartialEq)]
pub struct Quadrature {
    nodes: [f64; MOST_STAGES],
    velocity: [f64; MOST_STAGES],
    position: [f64; MOST_STAGES],
    velocity_error: [f64; MOST_STAGES],
    position_error: [f64; MOST_STAGES],
    /// Weights of velocity, position error and velocity error, stage by stage (1).
    pub ends: [[f64; 3]; MOST_STAGES],
}

/// What corrections add to the error estimate, lane by lane.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Guard {
    /// Of positions (m).
    pub position: Row,
    /// Of velocities (m/s).
    pub velocity: Row,
    /// Largest change of a position in any lane (m).
    pub moved: f64,
}

impl Quadrature {
    /// Spreads a pair's weights out.
    #[must_use]
    pub fn of(pair: &NystromPair) -> Self {
        let spread = |terms: Terms| {
            let mut weights = [0.0; MOST_STAGES];
            for (stage, weight) in terms {
                weights[*stage] = *weight;
            }
            weights
        };
        let mut nodes = [0.0; MOST_STAGES];
        nodes[..pair.nodes.len()].copy_from_slice(pair.nodes);
        let velocity = spread(pair.velocity);
        let velocity_error = spread(pair.velocity_error);
        let position_error = spread(pair.position_error);
        Self {
            nodes,
            velocity,
            position: spread(pair.position),
            velocity_error,
            position_error,
            ends: std::array::from_fn(|i| [velocity[i], position_error[i], velocity_error[i]]),
        }
    }
}

/// Bits of the contacts in row `row` that changed sides in the step.
#[inline(always)]
fn changed(work: &Workspace, row: usize) -> u8 {
    work.now.closed[row] ^ work.next.closed[row]
}

/// Whether any contact changed sides.
#[inline(always)]
pub fn any(work: &Workspace) -> bool {
    work.now.closed.iter().zip(&work.next.closed).any(|(now, next)| now != next)
}

/// Corrects the step of `h` (s, lane by lane) that `work` holds.
#[inline(always)]
pub fn correct<Y: Layout>(
    plan: &Plan,
    quadrature: &Quadrature,
    work: &mut Workspace,
    h: &Row,
) -> Guard {
    let mut guard = Guard::default();
    for row in 0..plan.rows() {
        let mut bits = changed(work, row);
        while bits != 0 {
            let lane = bits.trailing_zeros() as usize;
            bits &= bits - 1;
            if plan.active[row].0[lane] > 0.0 {
                correct_one::<Y>(plan, quadrature, work, (row, lane), h.0[lane], &mut guard);
            }
        }
    }
    guard
}

/// One contact's overlap over a step, as a quintic in the fraction of the step.
struct Quintic {
    coefficients: [f64; 6],
    /// Where it changes sign (1).
    root: f64,
    /// Half the difference to the cubic at mid-step: what the ends do not know (m).
    uncertainty: f64,
    /// Whether it is positive at the end.
    closes: bool,
}

impl Quintic {
    /// From overlap (m), closing speed and relative acceleration, times `h` and `h^2` (m), at both ends.
    #[inline(always)]
    fn new(from: [f64; 3], to: [f64; 3]) -> Self {
        let [p0, w0, g0] = from;
        let [p1, w1, g1] = to;
        let (p, q, r) = (p1 - p0 - w0 - 0.5 * g0, w1 - w0 - g0, g1 - g0);
        let square = 3.0 * (p1 - p0) - 2.0 * w0 - w1;
        let cube = 2.0 * (p0 - p1) + w0 + w1;
        let mut quintic = Self {
            coefficients: [
                p0,
                w0,
                0.5 * g0,
                10.0 * p - 4.0 * q + 0.5 * r,
                -15.0 * p + 7.0 * q - r,
                6.0 * p - 3.0 * q + 0.5 * r,
            ],
            root: 0.0,
            uncertainty: ((g0 - 2.0 * square) + (g1 - 2.0 * square - 6.0 * cube)).abs() / 64.0,
            closes: p1 > 0.0,
        };
        quintic.root = quintic.find_root(p0, p1);
        quintic
    }

    #[inline(always)]
    fn at(&self, t: f64) -> f64 {
        let c = &self.coefficients;
        c[0] + t * (c[1] + t * (c[2] + t * (c[3] + t * (c[4] + t * c[5]))))
    }

    /// Newton's method, kept between the ends by bisection.
    #[inline(always)]
    fn find_root(&self, p0: f64, p1: f64) -> f64 {
        let c = &self.coefficients;
        let (mut low, mut high) = (0.0, 1.0);
        let mut t = p0 / (p0 - p1);
        for _ in 0..12 {
            let value = self.at(t);
            if (value > 0.0) == self.closes {
                high = t;
            } else {
                low = t;
            }
            let slope =
                c[1] + t * (2.0 * c[2] + t * (3.0 * c[3] + t * (4.0 * c[4] + t * 5.0 * c[5])));
            let newton = t - value / slope;
            let next = if newton >= low && newton <= high { newton } else { 0.5 * (low + high) };
            let moved = (next - t).abs();
            t = next;
            if moved < 1e-9 {
                break;
            }
        }
        t
    }

    /// `int overlap^1.5` and `int (1 - t) overlap^1.5` over the closed part (m^1.5).
    #[inline(always)]
    fn impulses(&self) -> (f64, f64) {
        let end = if self.closes { 1.0 } else { 0.0 };
        let length = end - self.root;
        let (mut impulse, mut moment) = (0.0, 0.0);
        let mut values = [0.0; WIDTH];
        for (value, (s, weight)) in values.iter_mut().zip(ROOT_NODES.iter().zip(&ROOT_WEIGHTS)) {
            let t = self.root + s * length;
            // The root is taken out, what remains is smooth.
            let rest = self.at(t) / s;
            let closed = if rest > 0.0 { rest } else { 0.0 };
            *value = weight * closed * closed.sqrt();
        }
        for (value, s) in values.iter().zip(&ROOT_NODES) {
            impulse += value;
            moment += value * (1.0 - (self.root + s * length));
        }
        (impulse * length.abs(), moment * length.abs())
    }
}

#[inline(always)]
fn correct_one<Y: Layout>(
    plan: &Plan,
    quadrature: &Quadrature,
    work: &mut Workspace,
    place: (usize, usize),
    h: f64,
    guard: &mut Guard,
) {
    let (row, lane) = place;
    let upper = Y::upper(row, lane);
    let difference =
        |rows: &[Row]| upper.map_or(0.0, |(row, lane)| rows[row].0[lane]) - rows[row].0[lane];
    let ends = |motion: &Motion, acceleration: &[Row]| {
        let overlap = plan.static_overlap[row].0[lane] + difference(&motion.position);
        [overlap, h * difference(&motion.velocity), h * h * difference(acceleration)]
    };
    let last = work.stages.len() - 1;
    let (from, to) = (ends(&work.now, &work.stages[0]), ends(&work.next, &work.stages[last]));
    let quintic = Quintic::new(from, to);
    let mut powers = [0.0; MOST_STAGES];
    for (power, node) in powers.iter_mut().zip(&quadrature.nodes) {
        let overlap = quintic.at(*node);
        let closed = if overlap > 0.0 { overlap } else { 0.0 };
        *power = closed * closed.sqrt();
    }
    let sum = |weights: &[f64; MOST_STAGES]| -> f64 {
        powers.iter().zip(weights).map(|(power, weight)| power * weight).sum()
    };
    let stiffness = plan.stiffness[row].0[lane];
    let (impulse, moment) = quintic.impulses();
    let kick = h * stiffness * (impulse - sum(&quadrature.velocity));
    let shift = h * h * stiffness * (moment - sum(&quadrature.position));
    let kick_error = h * stiffness * sum(&quadrature.velocity_error);
    let shift_error = h * h * stiffness * sum(&quadrature.position_error);
    let depth = from[0].max(to[0]);
    let model = h * 1.5 * stiffness * depth.sqrt() * quintic.uncertainty;
    for (sign, place) in [(-1.0, upper), (1.0, Some(place))] {
        let Some((row, side)) = place else { continue };
        let per_mass = sign * plan.inverse_mass[row].0[side];
        work.next.velocity[row].0[side] += per_mass * kick;
        work.next.position[row].0[side] += per_mass * shift;
        work.error_velocity[row].0[side] -= per_mass * kick_error;
        work.error_position[row].0[side] -= per_mass * shift_error;
        let (kick, shift) = ((per_mass * kick).abs(), (per_mass * shift).abs());
        let model = MODEL_SHARE * (per_mass * model).abs();
        let velocity = (CORRECTION_SHARE * kick).max(model);
        let position = (CORRECTION_SHARE * shift).max(0.3 * h * model);
        raise(&mut guard.velocity.0[lane], velocity);
        raise(&mut guard.position.0[lane], position);
        raise(&mut guard.moved, shift);
    }
}

/// The larger of both; what is not a number stays none.
#[inline(always)]
fn raise(most: &mut f64, value: f64) {
    if !(*most >= value) {
        *most = value;
    }
}
