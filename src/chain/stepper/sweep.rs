//! One sweep along the rows: from values over the differences between neighbours to what these push with, and the net of two pushes; mostly from
//! positions over forces to accelerations.
//!
//! Square roots take their time: a few rows are begun while those before are on their way, so that the processor need not look far ahead for
//! work. A sweep may pause between two fours of rows, for another to follow it while what it has left is near.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::forces::{Begun, Cut, Strips, accelerations, begin, finish};
use super::lanes::{Lanes, Row};
use super::layout::Layout;
use super::strip::{At, FOUR};

/// What a sweep does, row by row.
pub trait Sweep<L: Lanes> {
    /// Whether what is begun takes its time.
    const TAKES_TIME: bool;

    /// Values in row `at`.
    fn enter(&mut self, at: At) -> L::V;

    /// Values that row `at` will have when it is entered.
    fn foresee(&self, at: At) -> L::V;

    /// Begins what row `at` pushes with, whose values differ so much from those above.
    fn begin(&mut self, at: At, difference: L::V) -> Begun<L>;

    /// What row `at` pushes with, and what it keeps until it is left.
    fn finish(&mut self, at: At, begun: Begun<L>) -> [L::V; 2];

    /// What stands behind the last row pushes with.
    fn beyond(&self) -> L::V;

    /// What is pushed by row `at` less what the row below pushes back with, and what it has kept.
    fn leave(&mut self, at: At, net: L::V, kept: L::V);
}

/// What a sweep over positions asks for and what becomes of its results, row by row.
pub trait Visit<L: Lanes> {
    /// Positions in row `at` (m).
    fn enter(&mut self, at: At) -> L::V;

    /// The same before it is entered, where rows stand in tiles.
    fn foresee(&self, at: At) -> L::V;

    /// Overlaps in row `at`, and how they have changed (m).
    #[inline(always)]
    fn see(&mut self, at: At, overlap: L::V, change: L::V) {
        let _ = (at, overlap, change);
    }

    /// What the contacts of row `at` are pressed with: forces (N), and two thirds of tangent stiffnesses (N/m).
    #[inline(always)]
    fn press(&mut self, at: At, pressed: [L::V; 2]) {
        let _ = (at, pressed);
    }

    /// Accelerations of row `at` (m/s²), and two thirds of its tangent stiffnesses (N/m).
    fn leave(&mut self, at: At, acceleration: L::V, tangent: L::V);
}

/// The contacts' forces, swept over.
pub struct Forces<'a, 'v, V, const FORM: u8> {
    strips: Strips<'a>,
    visit: &'v mut V,
}

impl<'a, 'v, V, const FORM: u8> Forces<'a, 'v, V, FORM> {
    /// Those of the first `rows` rows of `plan`.
    #[inline(always)]
    pub fn new(plan: Cut<'a>, rows: usize, visit: &'v mut V) -> Self {
        Self { strips: Strips::new(plan, rows), visit }
    }
}

impl<L: Lanes, V: Visit<L>, const FORM: u8> Sweep<L> for Forces<'_, '_, V, FORM> {
    const TAKES_TIME: bool = true;

    #[inline(always)]
    fn enter(&mut self, at: At) -> L::V {
        self.visit.enter(at)
    }

    #[inline(always)]
    fn foresee(&self, at: At) -> L::V {
        self.visit.foresee(at)
    }

    #[inline(always)]
    fn begin(&mut self, at: At, difference: L::V) -> Begun<L> {
        let (begun, overlap) = begin::<L, FORM>(self.strips.contacts(at), at.1, difference);
        self.visit.see(at, overlap, difference);
        begun
    }

    #[inline(always)]
    fn finish(&mut self, at: At, begun: Begun<L>) -> [L::V; 2] {
        let pressed = finish::<L, FORM>(self.strips.contacts(at), at.1, begun);
        self.visit.press(at, pressed);
        pressed
    }

    #[inline(always)]
    fn beyond(&self) -> L::V {
        L::load(&self.strips.beyond)
    }

    #[inline(always)]
    fn leave(&mut self, at: At, net: L::V, tangent: L::V) {
        self.visit.leave(at, accelerations::<L>(self.strips.bodies(at), net), tangent);
    }
}

/// Sweeps over the first `rows` rows of `plan`.
#[inline(always)]
pub fn sweep<L: Lanes, Y: Layout, const FORM: u8>(
    plan: Cut,
    rows: usize,
    visit: &mut impl Visit<L>,
) {
    let mut forces = Forces::<_, FORM>::new(plan, rows, visit);
    stretch::<L, Y, _>(&mut forces, [0, rows], rows, &mut Pause::default());
}

/// Where a sweep pauses.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pause {
    /// Values in the row entered last.
    last: Row,
    /// What the first row of the tile pressed last pushes with.
    first: Row,
    /// What the row pressed last pushes with, and what it keeps.
    pressed: [Row; 2],
    /// What the visit knows of the row left last.
    left: [Row; 2],
}

impl Pause {
    /// What a visit has kept of the row left last.
    #[inline(always)]
    pub fn left<L: Lanes>(&self) -> [L::V; 2] {
        [L::load(&self.left[0]), L::load(&self.left[1])]
    }

    /// Keeps that.
    #[inline(always)]
    pub fn keep<L: Lanes>(&mut self, left: [L::V; 2]) {
        L::store(left[0], &mut self.left[0]);
        L::store(left[1], &mut self.left[1]);
    }
}

/// The same under way.
struct Held<L: Lanes> {
    last: L::V,
    first: L::V,
    pressed: [L::V; 2],
}

/// Rows that are begun and have not been pressed yet.
type Ahead<L> = [Begun<L>; FOUR];

/// Sweeps over the rows from the first to before the second of `span`, out of `rows`, which follow those before `pause`. They begin with a four,
/// and unless they are the last of all end with one.
#[inline(always)]
pub fn stretch<L: Lanes, Y: Layout, S: Sweep<L>>(
    sweep: &mut S,
    [from, to]: [usize; 2],
    rows: usize,
    pause: &mut Pause,
) {
    let none = L::splat(0.0);
    let mut held = Held::<L> { last: none, first: none, pressed: [none; 2] };
    if from > 0 {
        held.last = L::load(&pause.last);
        held.first = L::load(&pause.first);
        held.pressed = [L::load(&pause.pressed[0]), L::load(&pause.pressed[1])];
    }
    let (start, end) = (from / FOUR, to / FOUR);
    if !S::TAKES_TIME {
        for four in start..end {
            for row in 0..FOUR {
                let begun = held.enter::<Y, S>((four, row), 1, sweep);
                held.press::<Y, S>((four, row), begun, 1, sweep);
            }
        }
    } else if start < end {
        let mut begun = held.enter::<Y, S>((start, 0), L::AHEAD, sweep);
        for four in start..end {
            for row in (L::AHEAD..FOUR).step_by(L::AHEAD) {
                let next = held.enter::<Y, S>((four, row), L::AHEAD, sweep);
                held.press::<Y, S>((four, row - L::AHEAD), begun, L::AHEAD, sweep);
                begun = next;
            }
            let mut next = begun;
            if four + 1 < end {
                next = held.enter::<Y, S>((four + 1, 0), L::AHEAD, sweep);
            }
            held.press::<Y, S>((four, FOUR - L::AHEAD), begun, L::AHEAD, sweep);
            begun = next;
        }
    }
    for row in 0..to % FOUR {
        let begun = held.enter::<Y::Alone, S>((end, row), 1, sweep);
        held.press::<Y::Alone, S>((end, row), begun, 1, sweep);
    }
    if to == rows && rows > 0 {
        let last = ((rows - 1) / FOUR, (rows - 1) % FOUR);
        held.leave(last, Y::below::<L>(held.first, sweep.beyond()), sweep);
    }
    if to < rows {
        L::store(held.last, &mut pause.last);
        L::store(held.first, &mut pause.first);
        L::store(held.pressed[0], &mut pause.pressed[0]);
        L::store(held.pressed[1], &mut pause.pressed[1]);
    }
}

impl<L: Lanes> Held<L> {
    /// Begins `count` rows from `row` on.
    #[inline(always)]
    fn enter<Y: Layout, S: Sweep<L>>(
        &mut self,
        (four, row): At,
        count: usize,
        sweep: &mut S,
    ) -> Ahead<L> {
        let mut here = [self.last; FOUR];
        for (i, here) in here.iter_mut().enumerate().take(count) {
            *here = sweep.enter((four, row + i));
        }
        let mut begun = [Begun::none(); FOUR];
        for (i, begun) in begun.iter_mut().enumerate().take(count) {
            let mut above = self.last;
            if Y::TILE == 1 {
                above = Y::above::<L>(above, here[i]);
            } else if row + i == 0 {
                let all = count == FOUR;
                let end = if all { here[FOUR - 1] } else { sweep.foresee((four, FOUR - 1)) };
                above = Y::above::<L>(above, end);
            }
            *begun = sweep.begin((four, row + i), L::sub(above, here[i]));
            self.last = here[i];
        }
        begun
    }

    /// Finishes the `count` rows from `row` on that are `begun`.
    #[inline(always)]
    fn press<Y: Layout, S: Sweep<L>>(
        &mut self,
        (four, row): At,
        begun: Ahead<L>,
        count: usize,
        sweep: &mut S,
    ) {
        for (i, begun) in begun.iter().enumerate().take(count) {
            let at = (four, row + i);
            let pressed = sweep.finish(at, *begun);
            let begins_tile = Y::TILE == 1 || at.1 == 0;
            let below = pressed[0];
            let below = if begins_tile { Y::below::<L>(self.first, below) } else { below };
            if at.1 > 0 {
                self.leave((four, at.1 - 1), below, sweep);
            } else if four > 0 {
                self.leave((four - 1, FOUR - 1), below, sweep);
            }
            if begins_tile {
                self.first = pressed[0];
            }
            self.pressed = pressed;
        }
    }

    #[inline(always)]
    fn leave<S: Sweep<L>>(&self, at: At, below: L::V, sweep: &mut S) {
        sweep.leave(at, L::sub(self.pressed[0], below), self.pressed[1]);
    }
}
