//! The chain in rows of eight: what the kernels read and write, and the sweep over it that all of
//! them share.
//!
//! Entry `j` is contact `j` and the body below it, in row `j / 8`, lane `j % 8`. Entries behind the
//! last contact are padding: no stiffness, no inverse mass. The force is that of
//! [`crate::chain::hertz::force_change`]: the change against the static one without cancellation,
//! exactly zero where nothing has moved, so that a chain at rest stays at rest to the last bit.
#![allow(
    clippy::inline_always,
    reason = "the code has to be inlined into functions compiled for the instruction set"
)]

use super::vector::{Row, Simd, Vector, WIDTH};
use crate::chain::{Chain, Pull};

/// Below this an overlap counts as zero in the square root (m).
const SMALLEST_OVERLAP: f64 = 1e-200;

/// Constants of contacts and bodies.
#[derive(Debug, Clone)]
pub struct ChainRows {
    /// `A` of each contact (N/m^1.5).
    pub stiffness: Vec<Row>,
    /// Static overlap of each contact (m).
    pub static_overlap: Vec<Row>,
    /// Its square root (m^0.5).
    pub static_root: Vec<Row>,
    /// 1 for contacts, 0 where there is nothing to touch (1).
    pub exists: Vec<Row>,
    /// Inverse mass of each body (1/kg).
    pub inverse_mass: Vec<Row>,
    /// Acceleration of each body that statics does not balance: the striker's free fall (m/s²).
    pub residual: Vec<Row>,
    /// A magnet that follows the body of this index.
    pull: Option<(usize, Pull)>,
}

/// Row and lane of entry `index`.
#[inline]
pub fn place(index: usize) -> (usize, usize) {
    (index / WIDTH, index % WIDTH)
}

/// The value of entry `index` (unit).
#[inline]
pub fn entry(rows: &[Row], index: usize) -> f64 {
    let (row, lane) = place(index);
    rows.get(row).map_or(0.0, |row| row.0[lane])
}

/// Value of the body above contact `j` less that of the one below; walls rest (unit).
#[inline]
pub fn difference(rows: &[Row], contact: usize) -> f64 {
    contact.checked_sub(1).map_or(0.0, |above| entry(rows, above)) - entry(rows, contact)
}

impl ChainRows {
    /// The rows of `chain`, whose contacts have no losses.
    pub fn new(chain: &Chain) -> Self {
        let rows = chain.contacts().len().div_ceil(WIDTH);
        let empty = || vec![Row::default(); rows];
        let mut out = Self {
            stiffness: empty(),
            static_overlap: empty(),
            static_root: empty(),
            exists: empty(),
            inverse_mass: empty(),
            residual: empty(),
            pull: chain.pull().map(|(body, pull)| (body, pull.clone())),
        };
        for (j, contact) in chain.contacts().iter().enumerate() {
            let (row, lane) = place(j);
            let (stiffness, static_overlap, static_root) = contact.as_hertz();
            out.stiffness[row].0[lane] = stiffness;
            out.static_overlap[row].0[lane] = static_overlap;
            out.static_root[row].0[lane] = static_root;
            out.exists[row].0[lane] = if contact.stiffness > 0.0 { 1.0 } else { 0.0 };
        }
        for (i, (body, residual)) in chain.bodies().iter().zip(chain.residual().iter()).enumerate()
        {
            let (row, lane) = place(i);
            out.inverse_mass[row].0[lane] = 1.0 / body.mass;
            out.residual[row].0[lane] = residual / body.mass;
        }
        out
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.stiffness.len()
    }

    /// The acceleration that the magnet adds to one of the bodies of row `row`, which are at
    /// `position` (m): the lane of the body, and how much (m/s²).
    fn pull_on(&self, row: usize, position: impl FnOnce() -> Row) -> Option<(usize, f64)> {
        let (body, pull) = self.pull.as_ref()?;
        let (its_row, lane) = place(*body);
        (its_row == row)
            .then(|| (lane, pull.change(position().0[lane]) * self.inverse_mass[row].0[lane]))
    }

    /// The rate at which the magnet changes the acceleration of its body in `motion`, and the body
    /// (m/s³).
    pub fn jerk_by_pull(&self, motion: &Motion) -> Option<(usize, f64)> {
        let (body, pull) = self.pull.as_ref()?;
        let [position, velocity, _] = motion.of(*body);
        Some((*body, pull.slope(position) * velocity * entry(&self.inverse_mass, *body)))
    }
}

/// A row of contacts at given positions.
pub struct Touch<V> {
    /// By how much overlaps have changed, no more than down to zero overlap (m).
    pub change: V,
    /// Change of the forces against the static ones (N).
    pub force: V,
    /// Two thirds of the tangent stiffnesses: `A sqrt(overlap)` (N/m).
    pub tangent: V,
    /// Bits of the contacts that are closed.
    pub closed: u8,
}

/// Contacts of these stiffnesses (N/m^1.5), static overlaps (m) and their roots (m^0.5), when their
/// overlaps have changed by `change` (m).
#[inline(always)]
pub fn force_change<S: Simd>(
    simd: S,
    stiffness: S::V,
    (static_overlap, static_root): (S::V, S::V),
    change: S::V,
) -> Touch<S::V> {
    let overlap = static_overlap + change;
    let closed = (overlap * stiffness).positive();
    // In this order of `max` what is not a number stays.
    let change = (simd.splat(0.0) - static_overlap).max(change);
    let root = simd.splat(SMALLEST_OVERLAP).max(overlap).root();
    let sum = root + static_root;
    let tangent = stiffness * root;
    let force = stiffness * change * (sum - root * static_root / sum);
    Touch { change, force, tangent, closed }
}

/// The constants of the rows in the sweep: slices of one length, so that the compiler sees that
/// rows are inside.
#[derive(Clone, Copy)]
struct Live<'a> {
    stiffness: &'a [Row],
    static_overlap: &'a [Row],
    static_root: &'a [Row],
    inverse_mass: &'a [Row],
    residual: &'a [Row],
}

impl<'a> Live<'a> {
    #[inline(always)]
    fn new(chain: &'a ChainRows, live: usize) -> Self {
        Self {
            stiffness: &chain.stiffness[..live],
            static_overlap: &chain.static_overlap[..live],
            static_root: &chain.static_root[..live],
            inverse_mass: &chain.inverse_mass[..live],
            residual: &chain.residual[..live],
        }
    }
}

/// What a sweep asks and gives, row by row. A trait and no closures: these would be compiled
/// without the instruction set where the compiler does not inline them, and be twenty times as
/// slow. Its methods are to be marked `#[inline(always)]`.
pub trait Visit<S: Simd> {
    /// Positions of row `r` (m).
    fn positions(&mut self, simd: S, r: usize) -> S::V;

    /// The contacts of row `r`.
    #[inline(always)]
    fn contacts(&mut self, simd: S, r: usize, touch: &Touch<S::V>) {
        let _ = (simd, r, touch);
    }

    /// Accelerations of row `r`, once the contacts below it are known (m/s²).
    fn bodies(&mut self, r: usize, acceleration: S::V);
}

/// Computes all contacts and bodies of the first `live` rows, from top to bottom.
#[inline(always)]
pub fn sweep<S: Simd>(simd: S, rows: &ChainRows, live: usize, visit: &mut impl Visit<S>) {
    let none = simd.splat(0.0);
    let chain = Live::new(rows, live);
    let (mut above, mut force) = (none, none);
    for r in 0..live {
        let here = visit.positions(simd, r);
        let statics = (simd.load(&chain.static_overlap[r]), simd.load(&chain.static_root[r]));
        let stiffness = simd.load(&chain.stiffness[r]);
        let found = force_change(simd, stiffness, statics, here.shift_up(above) - here);
        visit.contacts(simd, r, &found);
        if let Some(body) = r.checked_sub(1) {
            let own = accelerations(simd, chain, body, force, found.force);
            visit.bodies(body, pulled(simd, rows, body, above, own));
        }
        (above, force) = (here, found.force);
    }
    if let Some(body) = live.checked_sub(1) {
        let own = accelerations(simd, chain, body, force, none);
        visit.bodies(body, pulled(simd, rows, body, above, own));
    }
}

/// Accelerations of row `r` at these positions (m), with that of a magnet if it follows one of the
/// bodies (m/s²).
#[inline(always)]
fn pulled<S: Simd>(simd: S, rows: &ChainRows, r: usize, position: S::V, own: S::V) -> S::V {
    let stored = |values: S::V| {
        let mut row = Row::default();
        values.store(&mut row);
        row
    };
    let Some((lane, added)) = rows.pull_on(r, || stored(position)) else { return own };
    let mut row = stored(own);
    row.0[lane] += added;
    simd.load(&row)
}

/// Accelerations of row `r` between the forces of its contacts and those of the row below (m/s²).
#[inline(always)]
fn accelerations<S: Simd>(simd: S, chain: Live, r: usize, force: S::V, below: S::V) -> S::V {
    let net = force - force.shift_down(below);
    net.mul_add(simd.load(&chain.inverse_mass[r]), simd.load(&chain.residual[r]))
}

/// The second sweep of what changes at a given rate: rates of the contact forces,
/// `3/2 tangent (above - below)`, and what they make of the bodies' accelerations. With velocities
/// for `values` these are jerks (m/s³), with accelerations the gradient of the accelerations along
/// themselves (m/s⁴).
#[inline(always)]
pub fn rates<S: Simd>(
    simd: S,
    chain: &ChainRows,
    live: usize,
    (tangents, values): (&[Row], &[Row]),
    out: &mut [Row],
) {
    let none = simd.splat(0.0);
    let (mut above, mut rate) = (none, none);
    for r in 0..=live {
        let (mut here, mut below) = (none, none);
        if r < live {
            here = simd.load(&values[r]);
            below = simd.load(&tangents[r]) * (here.shift_up(above) - here);
        }
        if let Some(body) = r.checked_sub(1) {
            let net = rate - rate.shift_down(below);
            let scaled = net * simd.load(&chain.inverse_mass[body]) * simd.splat(1.5);
            scaled.store(&mut out[body]);
        }
        (above, rate) = (here, below);
    }
}

/// Positions, velocities and accelerations at one end of a step.
#[derive(Debug, Clone)]
pub struct Motion {
    /// (m)
    pub position: Vec<Row>,
    /// (m/s)
    pub velocity: Vec<Row>,
    /// (m/s²)
    pub acceleration: Vec<Row>,
    /// Two thirds of the tangent stiffnesses of the contacts (N/m).
    pub tangent: Vec<Row>,
    /// What rounding took from positions (m) and velocities (m/s), to be given back by the next
    /// sum.
    pub lost: [Vec<Row>; 2],
    /// Bits of the contacts that are closed, row by row.
    pub closed: Vec<u8>,
}

impl Motion {
    /// A chain of so many rows at rest.
    pub fn at_rest(rows: usize) -> Self {
        let empty = || vec![Row::default(); rows];
        Self {
            position: empty(),
            velocity: empty(),
            acceleration: empty(),
            tangent: empty(),
            lost: [empty(), empty()],
            closed: vec![0; rows],
        }
    }

    /// Position, velocity and acceleration of `body` (m, m/s, m/s²).
    #[inline]
    pub fn of(&self, body: usize) -> [f64; 3] {
        [entry(&self.position, body), entry(&self.velocity, body), entry(&self.acceleration, body)]
    }

    /// Rate of the acceleration of `body` (m/s³).
    pub fn jerk(&self, chain: &ChainRows, body: usize) -> f64 {
        let rate = |contact: usize| {
            1.5 * entry(&self.tangent, contact) * difference(&self.velocity, contact)
        };
        let by_pull = chain.jerk_by_pull(self).filter(|(pulled, _)| *pulled == body);
        let by_contacts = (rate(body) - rate(body + 1)) * entry(&chain.inverse_mass, body);
        by_contacts + by_pull.map_or(0.0, |(_, jerk)| jerk)
    }

    /// First body whose position or velocity is not finite.
    pub fn first_not_finite(&self) -> Option<usize> {
        let bodies = 0..WIDTH * self.position.len();
        let mut bodies = bodies.filter(|body| {
            let [x, v, _] = self.of(*body);
            !(x.is_finite() && v.is_finite())
        });
        bodies.next()
    }
}
