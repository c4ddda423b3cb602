//! The stepper's last step as others see it: forces at a few places, or the whole chain at one time.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use std::marker::PhantomData;
use std::ops::Range;

use super::force_track::{COEFFICIENTS, View, horner, septic};
use super::forces::{self, Cut, EXACT, LINEAR};
use super::lanes::{Lanes, Row, Task};
use super::layout::Layout;
use super::plan::{Form, Plan};

/// Positions, velocities, accelerations and jerks in rows at both ends of a step.
#[derive(Clone, Copy)]
pub struct Ends<'a> {
    pub from: [&'a [Row]; 4],
    pub to: [&'a [Row]; 4],
    /// Start and length of the step (s).
    pub span: (f64, f64),
}

/// Value and derivatives, as many as there are `rows`, of the overlap of the contact above body `body`.
#[inline(always)]
fn overlap<Y: Layout, const N: usize>(rows: &[&[Row]; N], body: usize, lane: usize) -> [f64; N] {
    let place = |body| Y::place(rows[0].len(), body, lane);
    let (here, above) = (place(body), body.checked_sub(1).map(place));
    let mut found = [0.0; N];
    for which in 0..N {
        let upper = above.map_or(0.0, |(row, lane)| rows[which][row].0[lane]);
        found[which] = upper - rows[which][here.0].0[here.1];
    }
    found
}

/// Those of all `rows` that the bodies beside `body`, and itself, stand in.
pub fn rows_around<Y: Layout>(rows: usize, body: usize) -> Range<usize> {
    if Y::STRIPED {
        return 0..rows;
    }
    let row = |body| Y::place(rows, body, 0).0;
    row(body.saturating_sub(1))..row(body + 1) + 1
}

/// Brings views up to the end of a step of `length` (s), where bodies stand and move as in `to` (m, m/s).
pub fn glance<Y: Layout>(to: (&[Row], &[Row]), length: f64, lane: usize, views: &mut [View]) {
    let to = [to.0, to.1];
    for view in views {
        let above = overlap::<Y, 2>(&to, view.body, lane);
        let below = overlap::<Y, 2>(&to, view.body + 1, lane);
        (view.end, view.rate) = view.track.feel([above, below]);
        view.length = length;
    }
}

/// Looks into the step for the views that want it.
pub struct Look<'a, Y> {
    pub ends: Ends<'a>,
    /// The chain's lane, where lanes are chains.
    pub lane: usize,
    pub views: &'a mut [View],
    pub layout: PhantomData<Y>,
}

impl<Y: Layout> Task for Look<'_, Y> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { ends, lane, views, .. } = self;
        for view in views.iter_mut().filter(|view| view.wanted) {
            for which in 0..2 {
                let contact = view.body + which;
                let from = overlap::<Y, 4>(&ends.from, contact, lane);
                let to = overlap::<Y, 4>(&ends.to, contact, lane);
                view.track.set(which, ends.span, [from, to]);
            }
            view.looks = view.track.looks::<L>();
        }
    }
}

/// Positions (m) and force changes (N) of the whole chain at one time of the step.
pub struct Frame<'a, Y> {
    pub plan: &'a Plan,
    pub ends: Ends<'a>,
    /// Fraction of the step (1).
    pub theta: f64,
    pub position: &'a mut [Row],
    pub force: &'a mut [Row],
    pub layout: PhantomData<Y>,
}

impl<Y: Layout> Task for Frame<'_, Y> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { plan, ends, theta, position, force, .. } = self;
        let weights = basis(theta, ends.span.1).map(|weight| L::splat(weight));
        let cut = Cut::new(plan, plan.rows());
        let position = &mut position[..plan.rows()];
        for (r, position) in position.iter_mut().enumerate() {
            let mut here = L::splat(0.0);
            for (weight, rows) in weights.iter().zip(ends.from.iter().chain(&ends.to)) {
                here = L::mul_add(*weight, L::load(&rows[r]), here);
            }
            L::store(here, position);
        }
        let last = position.last().map_or(L::splat(0.0), |row| L::load(row));
        let mut last = Y::before_first::<L>(last);
        for (r, position) in position.iter().enumerate() {
            let here = L::load(position);
            let change = L::sub(Y::above::<L>(last, here), here);
            let (row, _) = match plan.form {
                Form::Linear => forces::forces::<L, LINEAR>(cut, r, change),
                Form::Plain | Form::Exact => forces::forces::<L, EXACT>(cut, r, change),
            };
            L::store(row, &mut force[r]);
            last = here;
        }
    }
}

/// What value and derivatives at both ends weigh at `theta` in a step of `length` (s) (unit).
fn basis(theta: f64, length: f64) -> [f64; COEFFICIENTS] {
    std::array::from_fn(|which| {
        let mut ends = [[0.0; 4]; 2];
        ends[which / 4][which % 4] = 1.0;
        horner(&septic(ends, length), theta)
    })
}
