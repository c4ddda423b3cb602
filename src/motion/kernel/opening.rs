//! The correction at contact opening and closing.
//!
//! At zero overlap the force is only once differentiable, `F ~ (t - t0)^1.5`, and every quadrature
//! of order above 2.5 loses its order there. The overlap itself is smooth: the quintic through both
//! ends of the step (overlap, closing speed, relative acceleration) is integrated exactly up to
//! rounding, by Gauss-Jacobi quadrature with the weight `s^1.5` from its root on. The difference to
//! what the method's own nodes make of the same quintic is added to the velocities, its first
//! moment to the positions:
//!
//! `dv = h/m (int_0^1 F dc - sum b'_i F(c_i))`,
//! `dx = h^2/m (int_0^1 (1 - c) F dc - sum b_i F(c_i))`.
//!
//! The embedded solution gets the same correction, so that the error estimate shows what is left
//! over. A share of the correction and of the quintic's own uncertainty counts as error. Contacts
//! that open or close so slowly that no body would show it are left out. Sources: C. W. Gear, O.
//! Osterby, ACM Trans. Math. Softw. 10, 23 (1984); W. Gautschi, Orthogonal Polynomials (Oxford,
//! 2004), section 3.1.

use super::rkn86::{
    NODES, POSITION, POSITION_ERROR, STAGES, Trial, VELOCITY, VELOCITY_ERROR, Weights,
};
use super::rows::{ChainRows, Motion, difference, entry, place};
use super::vector::{Row, WIDTH};

/// Nodes of the Gauss-Jacobi quadrature for the weight `s^1.5` on 0 to 1, and their weights (1).
const ROOT_NODES: [(f64, f64); 5] = [
    (0.124_061_505_637_331_54, 0.007_609_028_036_605_25),
    (0.336_472_509_340_995_9, 0.047_184_038_143_998_46),
    (0.587_491_435_263_399_5, 0.112_429_350_380_216_15),
    (0.815_071_707_804_017_6, 0.144_130_795_395_627_18),
    (0.962_989_798_475_994_5, 0.088_646_788_043_552_97),
];
/// Overlap that may be left at the root, as a share of those at both ends: the impulse is off by
/// less than that share of itself (1).
const ROOT_RESIDUE: f64 = 1e-7;
/// Most iterations of the search for a root.
const MAX_ITERATIONS: usize = 30;
/// Times in the step at which an overlap is evaluated that may have changed sides twice (1).
const PROBE_TIMES: [f64; 8] = [0.12, 0.23, 0.34, 0.45, 0.55, 0.66, 0.77, 0.88];
/// Share of a correction that counts as error: larger than the residuals measured on colliding
/// beads (1).
const CORRECTION_SHARE: f64 = 0.01;
/// Share of the quintic's own uncertainty that counts as error (1).
const MODEL_SHARE: f64 = 0.1;
/// Mean time that the quintic's uncertainty has to move bodies, as a share of the step (1).
const MODEL_TIME_SHARE: f64 = 0.3;
/// An impulse that moves the lightest body by less than this share of the tolerated error is
/// negligible (1).
const NEGLIGIBLE_SHARE: f64 = 0.01;
/// The pair's nodes miss at most this much of the impulse of `max(t - t0, 0)^1.5` over a step (1).
const MAX_MISSED_IMPULSE: f64 = 0.0062;
/// A missed impulse below so many negligible ones, 0.3 of the tolerated error, is not corrected
/// (1).
const UNCORRECTED: f64 = 30.0;

/// What corrections add to the error estimates.
#[derive(Debug, Clone, Copy, Default)]
pub struct Guard {
    /// Of positions (m).
    pub position: f64,
    /// Of velocities (m/s).
    pub velocity: f64,
    /// Largest change of a position by the correction (m).
    pub moved: f64,
    /// Whether anything was corrected, or found to be missed.
    pub is_changed: bool,
}

/// Overlap, closing speed and relative acceleration times 1, `h` and `h^2`, at both ends of the
/// step (m).
type Ends = [[f64; 3]; 2];

fn ends(chain: &ChainRows, [from, to]: [&Motion; 2], contact: usize, h: f64) -> Ends {
    let end = |motion: &Motion| {
        [
            entry(&chain.static_overlap, contact) + difference(&motion.position, contact),
            h * difference(&motion.velocity, contact),
            h * h * difference(&motion.acceleration, contact),
        ]
    };
    [end(from), end(to)]
}

/// Corrects the step of `h` (s) from `now` to `next` that `trial` holds, tolerated errors being
/// `tolerated` (m, m/s) and the smallest mass `lightest` (kg).
pub fn correct(
    chain: &ChainRows,
    (now, next): (&Motion, &mut Motion),
    trial: &mut Trial,
    h: f64,
    (tolerated, lightest): ([f64; 2], f64),
) -> Guard {
    let mut guard = Guard::default();
    let moment_limit = NEGLIGIBLE_SHARE * lightest * tolerated[0];
    let impulse_limit = NEGLIGIBLE_SHARE * lightest * tolerated[1];
    for row in 0..trial.changed.len() {
        for contact in set_bits(row, trial.changed[row]) {
            let ends = ends(chain, [now, next], contact, h);
            let whole = h * entry(&chain.stiffness, contact);
            let travel = ends[0][1].abs().max(ends[1][1].abs());
            let limit = UNCORRECTED / MAX_MISSED_IMPULSE * impulse_limit.min(moment_limit / h);
            if whole * travel * travel.sqrt() <= limit {
                continue;
            }
            let missed = Missed::new(&ends);
            let mobility = Mobility::new(chain, contact);
            let (kick, shift) = (whole * missed.impulse, h * whole * missed.moment);
            let model = MODEL_SHARE * whole * missed.uncertainty;
            let lighter = mobility.below.max(mobility.above);
            guard.velocity =
                guard.velocity.max(lighter * (CORRECTION_SHARE * kick.abs()).max(model));
            let position = (CORRECTION_SHARE * shift.abs()).max(MODEL_TIME_SHARE * h * model);
            guard.position = guard.position.max(lighter * position);
            guard.moved = guard.moved.max(lighter * shift.abs());
            guard.is_changed = true;
            mobility.push(&mut next.velocity, kick);
            mobility.push(&mut next.position, shift);
            let [position_error, velocity_error] = &mut trial.errors;
            mobility.push(velocity_error, -whole * missed.velocity_error);
            mobility.push(position_error, -h * whole * missed.position_error);
        }
        for contact in set_bits(row, trial.doubtful[row]) {
            let ends = ends(chain, [now, next], contact, h);
            let whole = h * entry(&chain.stiffness, contact);
            let beyond = overlap_beyond(&ends);
            let impulse = whole * beyond * beyond.sqrt();
            if impulse <= impulse_limit && h * impulse <= moment_limit {
                continue;
            }
            let mobility = Mobility::new(chain, contact);
            let lost = mobility.below.max(mobility.above) * impulse;
            guard.velocity = guard.velocity.max(lost);
            guard.position = guard.position.max(0.5 * h * lost);
            guard.is_changed = true;
        }
    }
    guard
}

/// Entries of row `row` whose bits are set.
fn set_bits(row: usize, bits: u8) -> impl Iterator<Item = usize> {
    (0..WIDTH).filter(move |lane| bits & (1 << lane) != 0).map(move |lane| WIDTH * row + lane)
}

/// The two bodies that a contact pushes apart.
struct Mobility {
    contact: usize,
    /// Inverse mass of the body above, 0 for a wall (1/kg).
    above: f64,
    /// Of the one below (1/kg).
    below: f64,
}

impl Mobility {
    fn new(chain: &ChainRows, contact: usize) -> Self {
        let inverse_mass = |body: usize| entry(&chain.inverse_mass, body);
        Self {
            contact,
            above: contact.checked_sub(1).map_or(0.0, inverse_mass),
            below: inverse_mass(contact),
        }
    }

    /// Adds what an impulse of `push` makes of both bodies.
    fn push(&self, rows: &mut [Row], push: f64) {
        let (row, lane) = place(self.contact);
        rows[row].0[lane] += self.below * push;
        if let Some(above) = self.contact.checked_sub(1) {
            let (row, lane) = place(above);
            rows[row].0[lane] -= self.above * push;
        }
    }
}

/// Overlap as a quintic in the fraction of the step: its coefficients (m).
struct Quintic([f64; 6]);

impl Quintic {
    fn new([[p0, w0, g0], [p1, w1, g1]]: &Ends) -> Self {
        let p = p1 - p0 - w0 - 0.5 * g0;
        let (q, r) = (w1 - w0 - g0, 0.5 * (g1 - g0));
        let cubic = [10.0 * p - 4.0 * q + r, -15.0 * p + 7.0 * q - 2.0 * r, 6.0 * p - 3.0 * q + r];
        Self([*p0, *w0, 0.5 * g0, cubic[0], cubic[1], cubic[2]])
    }

    fn at(&self, t: f64) -> f64 {
        self.0.iter().rev().fold(0.0, |sum, c| sum * t + c)
    }

    /// One step of Halley's method from `t`: `t - f f' / (f'^2 - f f''/2)`.
    fn halley(&self, t: f64) -> f64 {
        let c = &self.0;
        let slope = (((5.0 * c[5] * t + 4.0 * c[4]) * t + 3.0 * c[3]) * t + 2.0 * c[2]) * t + c[1];
        let half_curvature = ((10.0 * c[5] * t + 6.0 * c[4]) * t + 3.0 * c[3]) * t + c[2];
        let value = self.at(t);
        t - value * slope / (slope * slope - value * half_curvature)
    }

    /// Where it changes sign (1).
    fn root(&self, [[start, ..], [end, ..]]: &Ends) -> f64 {
        let allowed = ROOT_RESIDUE * (start.abs() + end.abs());
        let (mut low, mut high) = (0.0, 1.0);
        let mut root = (start / (start - end)).clamp(0.0, 1.0);
        for _ in 0..MAX_ITERATIONS {
            let value = self.at(root);
            if value.abs() < allowed {
                break;
            }
            if (value > 0.0) == (*end > 0.0) {
                high = root;
            } else {
                low = root;
            }
            let next = self.halley(root);
            root = if next > low && next < high { next } else { 0.5 * (low + high) };
        }
        root
    }
}

/// What the pair's quadrature misses of `overlap^1.5`.
struct Missed {
    /// Of its integral, in units of the step (m^1.5).
    impulse: f64,
    /// Of its first moment to the end of the step (m^1.5).
    moment: f64,
    /// What it has put into the velocity's error estimate (m^1.5).
    velocity_error: f64,
    /// The same of the position's (m^1.5).
    position_error: f64,
    /// What the integral is off if the overlap is off by what the ends leave open (m^1.5).
    uncertainty: f64,
}

fn power(overlap: f64) -> f64 {
    if overlap > 0.0 { overlap * overlap.sqrt() } else { 0.0 }
}

impl Missed {
    fn new(ends: &Ends) -> Self {
        let quintic = Quintic::new(ends);
        let at_nodes: [f64; STAGES] = std::array::from_fn(|i| power(quintic.at(NODES[i])));
        let weigh =
            |weights: &Weights| weights.iter().zip(&at_nodes).map(|(w, f)| w * f).sum::<f64>();
        let root = quintic.root(ends);
        // The closed part reaches from the root to the end of the step where the contact is closed
        // there, else to the start.
        let length = if ends[1][0] > 0.0 { 1.0 - root } else { -root };
        let (mut impulse, mut moment) = (0.0, 0.0);
        for (node, weight) in ROOT_NODES {
            let t = root + node * length;
            let value = weight * length.abs() * power(quintic.at(t) / node);
            impulse += value;
            moment += (1.0 - t) * value;
        }
        let depth = ends[0][0].max(ends[1][0]).max(0.0);
        Self {
            impulse: impulse - weigh(&VELOCITY),
            moment: moment - weigh(&POSITION),
            velocity_error: weigh(&VELOCITY_ERROR),
            position_error: weigh(&POSITION_ERROR),
            uncertainty: 1.5 * depth.sqrt() * undetermined(ends),
        }
    }
}

/// Difference of the quintic and the cubic at mid-step: what the ends leave open (m).
fn undetermined([[p0, w0, g0], [p1, w1, g1]]: &Ends) -> f64 {
    let rise = p1 - p0;
    let (square, cube) = (3.0 * rise - 2.0 * w0 - w1, w0 + w1 - 2.0 * rise);
    let (early, late) = (g0 - 2.0 * square, g1 - 2.0 * square - 6.0 * cube);
    (early + late).abs() / 64.0
}

/// How far an overlap of the same sign at both ends was on the other side of zero in between (m):
/// it moves towards zero at the start and away from it at the end, and the tangents meet beyond.
fn overlap_beyond(ends: &Ends) -> f64 {
    let [[from, start, _], [to, end, _]] = *ends;
    let meets_beyond = start * (to - end) - end * from > 0.0;
    if !(from * to > 0.0 && start * from < 0.0 && end * to > 0.0 && meets_beyond) {
        return 0.0;
    }
    let quintic = Quintic::new(ends);
    let beyond = |t: f64| if to > 0.0 { -quintic.at(t) } else { quintic.at(t) };
    PROBE_TIMES.into_iter().map(beyond).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Parabolas through zero, opening or closing: their integrals against the midpoint rule in
    /// `s^2` from the root on, where they are smooth. The last two are so bent that five nodes
    /// follow them less closely.
    #[test]
    fn integrals_are_those_of_the_overlap() {
        for (root, b, c, allowed) in [
            (0.2, 1.0, 0.1, 1e-6),
            (0.5, -1.0, 0.3, 1e-6),
            (0.8, 2.0, -1.0, 1e-6),
            (0.01, -3.0, 1.0, 1e-6),
            (0.99, 1.0, 0.0, 1e-6),
            (0.4, -0.1, -0.05, 1e-6),
            (0.05, 0.06, 1.0, 1e-2),
            (0.95, -0.06, 1.0, 1e-2),
        ] {
            let end = |t: f64| [b * t + c * t * t, b + 2.0 * c * t, 2.0 * c];
            let ends = [end(0.0 - root), end(1.0 - root)];
            let quintic = Quintic::new(&ends);
            assert!((quintic.root(&ends) - root).abs() < 1e-6, "{root}");
            let length: f64 = if ends[1][0] > 0.0 { 1.0 - root } else { -root };
            let (mut impulse, mut moment) = (0.0, 0.0);
            let count = 20_000;
            for i in 0..count {
                let s = (f64::from(i) + 0.5) / f64::from(count);
                let x = length * s * s;
                let part = 2.0 * s * length.abs() / f64::from(count) * power(b * x + c * x * x);
                impulse += part;
                moment += part * (1.0 - root - x);
            }
            let nodes = |weights: &Weights| {
                NODES.iter().zip(weights).map(|(t, w)| w * power(quintic.at(*t))).sum::<f64>()
            };
            let missed = Missed::new(&ends);
            let (found, found_moment) =
                (missed.impulse + nodes(&VELOCITY), missed.moment + nodes(&POSITION));
            assert!((found / impulse - 1.0).abs() < allowed, "{root}: {found} and {impulse}");
            assert!(
                (found_moment - moment).abs() < allowed * impulse,
                "{root}: {found_moment} and {moment}"
            );
            assert!(undetermined(&ends) < 1e-15, "a parabola is a cubic");
        }
    }

    /// Wherever in the step `max(t - t0, 0)^1.5` or its mirror image begins.
    #[test]
    fn no_opening_is_missed_by_more_than_stated() {
        let mut worst: f64 = 0.0;
        for (root, closes) in
            (0..=1000).flat_map(|i| [(f64::from(i) / 1000.0, true), (f64::from(i) / 1000.0, false)])
        {
            let length = if closes { 1.0 - root } else { root };
            let exact = f64::powf(length, 2.5) / 2.5;
            let overlap = |t: f64| if closes { t - root } else { root - t };
            let sum: f64 = NODES.iter().zip(&VELOCITY).map(|(t, w)| w * power(overlap(*t))).sum();
            worst = worst.max((exact - sum).abs());
        }
        assert!(worst <= MAX_MISSED_IMPULSE, "{worst}");
    }
}
