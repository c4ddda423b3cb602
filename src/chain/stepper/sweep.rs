//! One sweep along the rows, from positions over forces to accelerations.
//!
//! Square roots take their time: a few rows are begun while those before are on their way, so that the processor need not look far ahead for
//! work.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::forces::{Begun, Cut, accelerations, begin, finish};
use super::lanes::Lanes;
use super::layout::Layout;

/// What a sweep asks for and what becomes of its results, row by row.
pub trait Visit<L: Lanes, Y: Layout> {
    /// Positions in row `r` (m).
    fn enter(&mut self, r: usize) -> L::V;

    /// Overlaps in row `r`, and how they have changed (m).
    #[inline(always)]
    fn see(&mut self, r: usize, overlap: L::V, change: L::V) {
        let _ = (r, overlap, change);
    }

    /// Accelerations of row `r` (m/s²), and what its contacts are pressed with: forces (N), and two thirds of tangent stiffnesses (N/m).
    fn leave(&mut self, r: usize, acceleration: L::V, pressed: [L::V; 2]);
}

/// Most rows that are begun ahead.
const MOST_AHEAD: usize = 4;

/// Where a sweep is.
struct Sweep<'a, L: Lanes> {
    plan: Cut<'a>,
    /// Positions of the row entered last (m).
    position: L::V,
    /// Forces (N) and two thirds of tangents (N/m) of the row pressed last.
    pressed: [L::V; 2],
}

/// Sweeps over the first `rows` rows of `plan`.
#[inline(always)]
pub fn sweep<L: Lanes, Y: Layout, const FORM: u8>(
    plan: Cut,
    rows: usize,
    visit: &mut impl Visit<L, Y>,
) {
    let none = L::splat(0.0);
    let mut sweep = Sweep::<L> { plan, position: none, pressed: [none; 2] };
    let blocks = rows / L::AHEAD;
    if blocks > 0 {
        let mut begun = [Begun::none(); MOST_AHEAD];
        for (r, begun) in begun.iter_mut().enumerate().take(L::AHEAD) {
            *begun = sweep.enter::<Y, FORM>(r, visit);
        }
        for block in 1..blocks {
            let (before, here) = ((block - 1) * L::AHEAD, block * L::AHEAD);
            let mut next = begun;
            for (i, next) in next.iter_mut().enumerate().take(L::AHEAD) {
                *next = sweep.enter::<Y, FORM>(here + i, visit);
            }
            for (i, begun) in begun.iter().enumerate().take(L::AHEAD) {
                sweep.press::<Y, FORM>(before + i, *begun, visit);
            }
            begun = next;
        }
        for (i, begun) in begun.iter().enumerate().take(L::AHEAD) {
            sweep.press::<Y, FORM>((blocks - 1) * L::AHEAD + i, *begun, visit);
        }
    }
    for r in blocks * L::AHEAD..rows {
        let begun = sweep.enter::<Y, FORM>(r, visit);
        sweep.press::<Y, FORM>(r, begun, visit);
    }
    if rows > 0 {
        sweep.leave::<Y>(rows - 1, L::load(&plan.beyond), visit);
    }
}

impl<L: Lanes> Sweep<'_, L> {
    #[inline(always)]
    fn enter<Y: Layout, const FORM: u8>(
        &mut self,
        r: usize,
        visit: &mut impl Visit<L, Y>,
    ) -> Begun<L> {
        let here = visit.enter(r);
        let change = L::sub(Y::above::<L>(self.position, here), here);
        self.position = here;
        let (begun, overlap) = begin::<L, FORM>(self.plan, r, change);
        visit.see(r, overlap, change);
        begun
    }

    #[inline(always)]
    fn press<Y: Layout, const FORM: u8>(
        &mut self,
        r: usize,
        begun: Begun<L>,
        visit: &mut impl Visit<L, Y>,
    ) {
        let pressed = finish::<L, FORM>(self.plan, r, begun);
        if r > 0 {
            self.leave::<Y>(r - 1, pressed[0], visit);
        }
        self.pressed = pressed;
    }

    #[inline(always)]
    fn leave<Y: Layout>(&mut self, r: usize, next: L::V, visit: &mut impl Visit<L, Y>) {
        let acceleration = accelerations::<L, Y>(self.plan, r, [self.pressed[0], next]);
        visit.leave(r, acceleration, self.pressed);
    }
}
