//! Steps of short chains under a pair where the machine has more arithmetic to do than results to wait for: with the number of rows known to the
//! compiler, and no pause between stages.
//!
//! The loops of [`super::sweep`] end each stage before they begin the next, and while the last roots of five rows are on their way there is nothing left
//! to do. Here the first rows of a stage are begun before the last ones of the stage before are pressed: a row needs that stage's accelerations of its own
//! bodies, which are there once the row below has been pressed. Every number is rounded as it is there.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::evaluate::Largest;
use super::forces::{Begun, Cut, PLAIN, accelerations, begin, finish};
use super::known::{Known, Position, Stage, Sum};
use super::lanes::{Lanes, Row};
use super::layout::{Along, Layout};
use super::passes::{Sides, add_compensated, speed_up};
use super::plan::{FEW, Plan};
use super::workspace::{BETWEEN, Between, Workspace};

/// Rows of the chains that these loops are for.
const R: usize = FEW;
/// Rows that are begun before the first of them is pressed.
const AHEAD: usize = 2;
// When row 0 of a stage is begun, row 1 of the stage before has been pressed.
const _: () = assert!(R >= AHEAD + 2);

/// The first `R` of `of`.
#[inline(always)]
fn first<T>(of: &[T]) -> &[T; R] {
    &of.as_chunks().0[0]
}

/// The same, to be written.
#[inline(always)]
fn first_mut<T>(of: &mut [T]) -> &mut [T; R] {
    &mut of.as_chunks_mut().0[0]
}

/// A step under way.
struct Flow<'a, L: Lanes> {
    plan: Cut<'a>,
    /// (s)
    h: L::V,
    /// Positions, velocities, accelerations, and what rounding took from the positions, where the step starts.
    from: [&'a [Row; R]; 4],
    between: &'a mut [Between; R],
    /// Positions where it ends, and what rounding takes from them.
    to: [&'a mut [Row; R]; 2],
    overlap: &'a mut [Row; R],
    closed: &'a mut [u8; R],
    acceleration: &'a mut [Row; R],
    largest: Largest<L>,
    /// Positions in the row begun last (m).
    last: L::V,
    /// Forces in the row pressed last (N).
    pressed: L::V,
    /// Rows begun that have not been pressed, and one more.
    begun: [Begun<L>; AHEAD + 1],
}

impl<L: Lanes> Flow<'_, L> {
    /// Stage `S`, if there is one before the last, but for the rows that the next one presses. Row by row, for the compiler may leave a loop as it is.
    #[inline(always)]
    fn stage<P: Known<N>, const S: usize, const N: usize>(&mut self) {
        if S + 1 >= N {
            return;
        }
        let sum = Sum::<L, Stage<P, N, S>>::new(L::mul(self.h, self.h));
        let reach = L::mul(self.h, L::splat(P::PAIR.nodes[S]));
        self.row(0, &sum, reach);
        self.row(1, &sum, reach);
        self.row(2, &sum, reach);
        self.row(3, &sum, reach);
        self.row(4, &sum, reach);
    }

    /// Row `r` of stage `S`, as [`super::passes`] has it.
    #[inline(always)]
    fn row<P: Known<N>, const S: usize, const N: usize>(
        &mut self,
        r: usize,
        sum: &Sum<L, Stage<P, N, S>>,
        reach: L::V,
    ) {
        let [x, v, a, _] = self.from;
        let here = L::mul_add(reach, L::load(&v[r]), L::load(&x[r]));
        let here = sum.plus((&a[r], &self.between[r]), S, here);
        self.enter((S, r), here);
        self.follow::<N>((S, r));
    }

    /// The last stage, to its end.
    #[inline(always)]
    fn arrive<P: Known<N>, const N: usize>(&mut self) {
        let sum = Sum::<L, Position<P, N>>::new(L::mul(self.h, self.h));
        self.arrive_in(0, &sum);
        self.arrive_in(1, &sum);
        self.arrive_in(2, &sum);
        self.arrive_in(3, &sum);
        self.arrive_in(4, &sum);
        for ahead in (1..=AHEAD).rev() {
            self.press::<N>((N - 1, R - ahead));
        }
    }

    /// Row `r` of the last stage, as [`super::passes`] has it.
    #[inline(always)]
    fn arrive_in<P: Known<N>, const N: usize>(&mut self, r: usize, sum: &Sum<L, Position<P, N>>) {
        let [x, v, a, lost] = self.from;
        let drift = L::mul(self.h, L::load(&v[r]));
        let rise = sum.plus((&a[r], &self.between[r]), N - 1, drift);
        let (here, rest) = add_compensated::<L>(L::load(&x[r]), L::load(&lost[r]), rise);
        L::store(here, &mut self.to[0][r]);
        L::store(rest, &mut self.to[1][r]);
        let (overlap, change) = self.enter((N - 1, r), here);
        self.closed[r] = L::positive(overlap);
        L::store(overlap, &mut self.overlap[r]);
        self.largest.see(&self.plan.rest[r], change);
        self.follow::<N>((N - 1, r));
    }

    /// Where what is begun in row `r` of stage `s` waits.
    #[inline(always)]
    fn place((s, r): (usize, usize)) -> usize {
        (s * R + r) % (AHEAD + 1)
    }

    /// Begins row `r` of stage `s`, whose bodies are `here`; overlaps, and how they have changed.
    #[inline(always)]
    fn enter(&mut self, at: (usize, usize), here: L::V) -> (L::V, L::V) {
        let (_, r) = at;
        let last = if r == 0 { L::splat(0.0) } else { self.last };
        let change = L::sub(Along::above::<L>(last, here), here);
        let (begun, overlap) = begin::<L, PLAIN>(self.plan.contacts(r), r, change);
        self.begun[Self::place(at)] = begun;
        self.last = here;
        (overlap, change)
    }

    /// Presses the row that was begun `AHEAD` before row `r` of stage `s`.
    #[inline(always)]
    fn follow<const N: usize>(&mut self, (s, r): (usize, usize)) {
        if r >= AHEAD {
            self.press::<N>((s, r - AHEAD));
        } else if s > 1 {
            self.press::<N>((s - 1, R + r - AHEAD));
        }
    }

    /// Presses row `r` of stage `s`, and leaves those whose contacts are all pressed.
    #[inline(always)]
    fn press<const N: usize>(&mut self, at: (usize, usize)) {
        let (s, r) = at;
        let [force, _] = finish::<L, PLAIN>(self.plan.contacts(r), r, self.begun[Self::place(at)]);
        if r > 0 {
            let below = Along::below::<L>(self.pressed, force);
            self.leave::<N>((s, r - 1), L::sub(self.pressed, below));
        }
        if r + 1 == R {
            let below = Along::below::<L>(force, L::load(&self.plan.beyond));
            self.leave::<N>(at, L::sub(force, below));
        }
        self.pressed = force;
    }

    #[inline(always)]
    fn leave<const N: usize>(&mut self, (s, r): (usize, usize), net: L::V) {
        let acceleration = accelerations::<L>(self.plan.bodies(r), net);
        let out = if s + 1 < N { &mut self.between[r][s - 1] } else { &mut self.acceleration[r] };
        L::store(acceleration, out);
    }
}

/// Tries a step as [`super::passes::attempt`] does, in plain form; none where fewer rows move, or more.
#[inline(always)]
pub fn attempt<L: Lanes, P: Known<N>, const N: usize>(
    plan: &Plan,
    work: &mut Workspace,
    (h, worth): (L::V, [L::V; 2]),
) -> Option<Sides> {
    if plan.rows() != R {
        return None;
    }
    let (now, next, none) = (&*work.now, work.next.parts(), L::splat(0.0));
    let from = [now.position(), now.velocity(), now.acceleration(), now.lost_position()];
    let mut flow = Flow::<L> {
        plan: Cut::new(plan, R),
        h,
        from: from.map(first),
        between: first_mut(&mut work.between),
        to: [next.position, next.lost_position].map(first_mut),
        overlap: first_mut(&mut work.overlap),
        closed: first_mut(next.closed),
        acceleration: first_mut(next.acceleration),
        largest: Largest::none(),
        last: none,
        pressed: none,
        begun: [Begun::none(); AHEAD + 1],
    };
    flow.stage::<P, 1, N>();
    flow.stage::<P, 2, N>();
    flow.stage::<P, 3, N>();
    flow.stage::<P, 4, N>();
    flow.stage::<P, 5, N>();
    flow.stage::<P, 6, N>();
    flow.stage::<P, BETWEEN, N>();
    flow.arrive::<P, N>();
    L::store(Along::largest::<L>(flow.largest.change), &mut work.largest.overlap);
    Some(speed_up::<L, Along, P, N>(R, (h, worth), work))
}
