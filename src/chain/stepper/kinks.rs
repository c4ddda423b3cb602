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
#![allow(clippy::needless_range_loop, reason = "the compiler makes less of iterators side by side")]

use super::forces::Cut;
use super::gathered::{Gathered, alone, spread};
use super::guard::{CORRECTION_SHARE, Guard, LATE, MODEL_SHARE};
use super::known::Known;
use super::lanes::{Lanes, Row};
use super::layout::Layout;
use super::lone::{Lone, Place};
use super::plan::Plan;
use super::quintics::{Missing, Quintics};
use super::tried::Tried;
use super::visible::Visible;
use super::workspace::{Parts, Workspace};

/// Up to so many contacts that change sides in a step are looked at each by itself.
const MOST_ALONE: usize = 4;
/// An impulse that could move the lightest body by no more than this share of the tolerated error is none (1).
const NEGLIGIBLE: f64 = 0.01;

/// Impulse (N s) and its moment (N s²) that no body would show, for errors of `tolerance` relative to `scales` (m, m/s) (unit).
#[inline]
pub fn slack(tolerance: f64, scales: (f64, f64), lightest: f64) -> [f64; 2] {
    let share = NEGLIGIBLE * tolerance * lightest;
    [share * scales.1, share * scales.0]
}

/// What the quadrature has missed at a row of contacts.
#[derive(Clone, Copy)]
struct Kink<L: Lanes> {
    /// Impulses (N s), and their moments (N s²).
    kick: L::V,
    shift: L::V,
    /// What they have put into the error estimates of velocities (N s) and positions (N s²).
    kick_error: L::V,
    shift_error: L::V,
}

impl<L: Lanes> Kink<L> {
    #[inline(always)]
    fn none() -> Self {
        let none = L::splat(0.0);
        Self { kick: none, shift: none, kick_error: none, shift_error: none }
    }
}

/// Contacts, and how long they were followed.
struct Correction<'a, L: Lanes> {
    plan: Cut<'a>,
    h: L::V,
}

/// Inverse mass of the lighter body at each contact of row `r` (1/kg).
#[inline(always)]
fn lighter<L: Lanes, Y: Layout>(plan: Cut, r: usize) -> L::V {
    let before = if r > 0 { L::load(&plan.inverse_mass[r - 1]) } else { L::splat(0.0) };
    let here = L::load(&plan.inverse_mass[r]);
    L::max(Y::above::<L>(before, here), here)
}

impl<L: Lanes> Correction<'_, L> {
    /// What is missing at the contacts of row `r` that change sides.
    #[inline(always)]
    fn kink<Y: Layout>(&self, missing: Missing<L>, r: usize, guard: &mut Guard<L>) -> Kink<L> {
        let Missing { impulse, moment, errors, uncertainty } = missing;
        let whole = L::mul(self.h, L::load(&self.plan.stiffness[r]));
        let square = L::mul(self.h, whole);
        let found = Kink {
            kick: L::mul(whole, impulse),
            shift: L::mul(square, moment),
            kick_error: L::mul(whole, errors[0]),
            shift_error: L::mul(square, errors[1]),
        };
        let (lighter, share) = (lighter::<L, Y>(self.plan, r), L::splat(CORRECTION_SHARE));
        let model = L::mul(L::mul(L::splat(MODEL_SHARE), whole), uncertainty);
        let shift = L::abs(found.shift);
        let velocity = L::max(L::mul(share, L::abs(found.kick)), model);
        let late = L::mul(L::mul(L::splat(LATE), self.h), model);
        let position = L::max(L::mul(share, shift), late);
        guard.velocity = L::max(guard.velocity, L::mul(lighter, velocity));
        guard.position = L::max(guard.position, L::mul(lighter, position));
        guard.moved = L::max(guard.moved, L::mul(lighter, shift));
        found
    }

    /// Puts right the bodies of row `r`, between the contacts above and below; their velocities (m/s).
    #[inline(always)]
    fn apply<Y: Layout>(
        &self,
        [position, velocity, error_position, error_velocity]: &mut [&mut [Row]; 4],
        r: usize,
        (above, below): (Kink<L>, Kink<L>),
    ) -> L::V {
        let inverse_mass = L::load(&self.plan.inverse_mass[r]);
        let net = |above: L::V, below: L::V| {
            L::mul(inverse_mass, L::sub(above, Y::below::<L>(above, below)))
        };
        let speed = L::add(L::load(&velocity[r]), net(above.kick, below.kick));
        L::store(speed, &mut velocity[r]);
        let at = L::add(L::load(&position[r]), net(above.shift, below.shift));
        L::store(at, &mut position[r]);
        let off = L::sub(L::load(&error_velocity[r]), net(above.kick_error, below.kick_error));
        L::store(off, &mut error_velocity[r]);
        let off = L::sub(L::load(&error_position[r]), net(above.shift_error, below.shift_error));
        L::store(off, &mut error_position[r]);
        speed
    }
}

/// Corrects the `contacts` that change sides, few of them, in a step of `h` (s): each by itself, and none waits for another.
#[inline(always)]
fn one_by_one<L: Lanes, Y: Layout, P: Known<N>, const N: usize>(
    plan: Cut,
    work: &mut Workspace,
    (h, contacts): (f64, usize),
    guard: &mut Guard<L>,
) {
    let Workspace { now, next, changed, error_position, error_velocity, finite, .. } = work;
    let mut found = [None; MOST_ALONE];
    let (mut left, mut row) = (0, 0);
    for found in &mut found[..contacts] {
        while left == 0 {
            (left, row) = (changed[row], row + 1);
        }
        let place = Place::new(row - 1, left.trailing_zeros() as usize);
        left &= left - 1;
        *found = Some((place, Lone::new::<L, P, N>((plan, place), [now, next], h)));
    }
    let Parts { position, velocity, .. } = next.parts();
    let (mut rows, mut total) = ([position, velocity, error_position, error_velocity], 0.0);
    for (place, lone) in found.into_iter().flatten() {
        let mobility = place.mobility(plan);
        guard.alone(&lone, mobility, h);
        for (rows, push) in rows.iter_mut().zip(lone.pushes) {
            place.add::<L>(rows, mobility.map(|of| of * push));
        }
        total += lone.pushes[1];
    }
    *finite &= Y::all(L::finite(L::splat(total)));
}

/// Corrects the step of `h` (s, lane by lane) that `work` holds; whether there is anything that could be seen.
#[inline(always)]
pub fn correct<L: Lanes, Y: Layout, P: Known<N>, const N: usize>(
    plan: &Plan,
    work: &mut Workspace,
    (h, slack): (L::V, [L::V; 2]),
    guard: &mut Guard<L>,
) -> bool {
    let (rows, visible) = (plan.rows(), Visible::<L>::new(h, slack));
    let plan = Cut::new(plan, rows);
    let tried = Tried::<L>::new((plan, rows), [&work.now, &work.next], h);
    let changed = &mut work.changed[..rows];
    let (mut count, mut contacts, mut last) = (0, 0, 0);
    for r in 0..rows {
        if changed[r] != 0 {
            changed[r] &= visible.among::<Y>(&tried, r);
        }
        if changed[r] != 0 {
            (count, last) = (count + 1, r);
            contacts += changed[r].count_ones() as usize;
        }
    }
    if count == 0 {
        return false;
    }
    // Mostly they are few.
    if Y::IN_FEW_ROWS && contacts <= MOST_ALONE {
        one_by_one::<L, Y, P, N>(plan, work, (L::first(h), contacts), guard);
        return true;
    }
    let Workspace { now, next, between, changed, error_position, error_velocity, finite, .. } =
        work;
    let tried = Tried::<L>::new((plan, rows), [now, next], h);
    let changed = &changed[..rows];
    // Mostly what changes sides stands in one row.
    let one_row = count == 1;
    let mut gathered = Gathered::<L>::new();
    if one_row {
        gathered.set((changed[last], tried.ends::<Y>(last)));
    } else {
        for r in 0..rows {
            if changed[r] != 0 {
                gathered.add::<P, N>((changed[r], tried.ends::<Y>(r)), between);
            }
        }
    }
    gathered.finish::<P, N>(between);
    let Parts { position, velocity, .. } = next.parts();
    let mut out = [
        &mut position[..rows],
        &mut velocity[..rows],
        &mut error_position[..rows],
        &mut error_velocity[..rows],
    ];
    let correction = Correction::<L> { plan, h };
    let (mut count, mut above, mut total) = (0, None, L::splat(0.0));
    for r in 0..=rows {
        let bits = if r < rows { changed[r] } else { 0 };
        let mut below = None;
        if bits != 0 {
            let missing =
                if one_row { alone(&between[0]) } else { spread::<L>(between, count, bits) };
            below = Some(correction.kink::<Y>(missing, r, guard));
            count += bits.count_ones() as usize;
        }
        if above.is_some() || below.is_some() {
            let both = (above.unwrap_or(Kink::none()), below.unwrap_or(Kink::none()));
            if let Some(body) = r.checked_sub(1) {
                total = L::add(total, correction.apply::<Y>(&mut out, body, both));
            }
        }
        above = below;
    }
    *finite &= Y::all(L::finite(total));
    true
}

/// Contacts that were open at both ends of the step and may have touched in between, or the other way round: the method's nodes may
/// have missed it altogether. What they may have missed counts as error, so that the step is taken again, and shorter.
#[inline(always)]
pub fn missed<L: Lanes, Y: Layout>(
    plan: &Plan,
    work: &Workspace,
    (h, slack): (L::V, [L::V; 2]),
    guard: &mut Guard<L>,
) -> bool {
    let mut any = 0;
    let none = L::splat(0.0);
    let rows = plan.rows();
    let plan = Cut::new(plan, rows);
    let tried = Tried::<L>::new((plan, rows), [&work.now, &work.next], h);
    for (r, doubtful) in work.doubtful[..rows].iter().copied().enumerate() {
        if doubtful == 0 {
            continue;
        }
        let [[from, start], [to, end]] = tried.moves::<Y>(r);
        // The tangents at both ends meet beyond zero overlap.
        let meet = L::sub(L::mul(start, L::sub(to, end)), L::mul(end, from));
        let towards = L::sub(none, L::mul(start, from));
        let stiffness = L::load(&plan.stiffness[r]);
        let bits = doubtful
            & L::positive(meet)
            & L::positive(L::mul(from, to))
            & L::positive(towards)
            & L::positive(L::mul(end, to))
            & L::positive(stiffness);
        if bits == 0 {
            continue;
        }
        let beyond = Quintics::<L>::new(tried.ends::<Y>(r)).beyond(to);
        let impulse = L::mul(L::mul(h, stiffness), L::mul(beyond, L::sqrt(beyond)));
        let seen = L::positive(L::sub(impulse, slack[0]))
            | L::positive(L::sub(L::mul(impulse, h), slack[1]));
        any |= bits & seen;
        let kick = L::select(bits & seen, L::mul(lighter::<L, Y>(plan, r), impulse), none);
        guard.velocity = L::max(guard.velocity, kick);
        guard.position = L::max(guard.position, L::mul(L::mul(L::splat(0.5), h), kick));
    }
    any != 0
}
