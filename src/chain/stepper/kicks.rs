//! What becomes of rows in the sweeps of a splitting's step.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use std::marker::PhantomData;

use super::forces::Begun;
use super::lanes::{Lanes, Row};
use super::layout::Layout;
use super::notes::Notes;
use super::splits::Kick;
use super::strip::{At, FOUR, Strip, StripMut};
use super::sweep::{Sweep, Visit};

/// The kick that ends a part, and what comes after it.
pub struct Kicks<'n, L: Lanes> {
    pub kick: Kick<L>,
    pub after: After<'n, L>,
}

/// What comes after the kick that ends a part.
pub enum After<'n, L: Lanes> {
    /// The next part of the step.
    Part,
    /// The step is over, and what it has come to is kept.
    End,
    /// The next step begins at once, with this kick; before it what somebody wants to know is noted.
    Step(Kick<L>, &'n mut Notes),
}

impl<L: Lanes> Kicks<'_, L> {
    /// Whether what the step has come to is kept.
    #[inline(always)]
    fn keeps(&self) -> bool {
        matches!(self.after, After::End)
    }

    /// Gives them to the `velocity` of row `at`, which stands at `position`, by accelerations and two thirds of their gradients.
    #[inline(always)]
    fn on<const GRADIENT: bool, const LAST: bool>(
        &mut self,
        at: At,
        position: &Row,
        velocity: &mut Row,
        of: [L::V; 2],
    ) {
        let mut speed = self.kick.on::<GRADIENT>(L::load(velocity), of);
        if LAST && let After::Step(next, notes) = &mut self.after {
            if let Some([x, v, a]) = notes.room(at) {
                *x = *position;
                L::store(speed, v);
                L::store(of[0], a);
            }
            speed = next.on::<GRADIENT>(speed, of);
        }
        L::store(speed, velocity);
    }
}

/// Where a step starts, if not in place, and its first kick.
pub struct Start<'a, L: Lanes> {
    pub kick: Kick<L>,
    /// Positions, velocities, accelerations, and gradients where a method asks for them.
    pub of: [Strip<'a, Row>; 4],
}

/// Drift, forces, and where there are no gradients kicks. Accelerations are kept for gradients, and by the last part for the next step. In the
/// `FIRST` part of a step there may be a start, in the `LAST` one an end.
pub struct Push<'a, 'n, L: Lanes, const GRADIENT: bool, const FIRST: bool, const LAST: bool> {
    pub start: Option<Start<'a, L>>,
    pub drift: L::V,
    pub kicks: Kicks<'n, L>,
    pub position: StripMut<'a, Row>,
    pub velocity: StripMut<'a, Row>,
    pub acceleration: StripMut<'a, Row>,
    /// Two thirds of tangent stiffnesses (N/m).
    pub tangent: StripMut<'a, Row>,
}

impl<L: Lanes, const GRADIENT: bool, const FIRST: bool, const LAST: bool>
    Push<'_, '_, L, GRADIENT, FIRST, LAST>
{
    /// Positions and velocities of row `at` after the drift.
    #[inline(always)]
    fn drifted(&self, at: At) -> [L::V; 2] {
        let (here, speed) = match &self.start {
            Some(Start { kick, of: [x, v, a, g] }) if FIRST => {
                let gradient = if GRADIENT { L::load(g.at(at)) } else { L::splat(0.0) };
                let of = [L::load(a.at(at)), gradient];
                (L::load(x.at(at)), kick.on::<GRADIENT>(L::load(v.at(at)), of))
            }
            _ => (L::load(self.position.at(at)), L::load(self.velocity.at(at))),
        };
        [L::mul_add(self.drift, speed, here), speed]
    }
}

impl<L: Lanes, const GRADIENT: bool, const FIRST: bool, const LAST: bool> Visit<L>
    for Push<'_, '_, L, GRADIENT, FIRST, LAST>
{
    #[inline(always)]
    fn enter(&mut self, at: At) -> L::V {
        let [here, speed] = self.drifted(at);
        L::store(here, self.position.at_mut(at));
        if FIRST && self.start.is_some() {
            L::store(speed, self.velocity.at_mut(at));
        }
        here
    }

    #[inline(always)]
    fn foresee(&self, at: At) -> L::V {
        self.drifted(at)[0]
    }

    #[inline(always)]
    fn press(&mut self, at: At, [_, tangent]: [L::V; 2]) {
        if GRADIENT {
            L::store(tangent, self.tangent.at_mut(at));
        }
    }

    #[inline(always)]
    fn leave(&mut self, at: At, acceleration: L::V, _tangent: L::V) {
        if GRADIENT || LAST && self.kicks.keeps() {
            L::store(acceleration, self.acceleration.at_mut(at));
        }
        if !GRADIENT {
            let (position, velocity) = (self.position.at(at), self.velocity.at_mut(at));
            self.kicks.on::<false, LAST>(at, position, velocity, [acceleration; 2]);
        }
    }
}

/// Two thirds of what the differences of accelerations do to the forces (N/s²), and kicks. The last part keeps gradients for the next step.
pub struct Bend<'a, 'n, L: Lanes, const LAST: bool> {
    pub inverse_mass: Strip<'a, Row>,
    pub kicks: Kicks<'n, L>,
    pub position: Strip<'a, Row>,
    pub velocity: StripMut<'a, Row>,
    pub acceleration: Strip<'a, Row>,
    /// At first two thirds of tangent stiffnesses (N/m).
    pub gradient: StripMut<'a, Row>,
}

impl<L: Lanes, const LAST: bool> Sweep<L> for Bend<'_, '_, L, LAST> {
    const TAKES_TIME: bool = false;

    #[inline(always)]
    fn enter(&mut self, at: At) -> L::V {
        self.foresee(at)
    }

    #[inline(always)]
    fn foresee(&self, at: At) -> L::V {
        L::load(self.acceleration.at(at))
    }

    #[inline(always)]
    fn begin(&mut self, at: At, difference: L::V) -> Begun<L> {
        Begun { closed: difference, root: L::load(self.gradient.at(at)) }
    }

    #[inline(always)]
    fn finish(&mut self, _at: At, begun: Begun<L>) -> [L::V; 2] {
        [L::mul(begun.root, begun.closed), L::splat(0.0)]
    }

    #[inline(always)]
    fn beyond(&self) -> L::V {
        L::splat(0.0)
    }

    #[inline(always)]
    fn leave(&mut self, at: At, net: L::V, _kept: L::V) {
        let gradient = L::mul(net, L::load(self.inverse_mass.at(at)));
        if LAST && self.kicks.keeps() {
            L::store(gradient, self.gradient.at_mut(at));
        }
        let of = [L::load(self.acceleration.at(at)), gradient];
        self.kicks.on::<true, LAST>(at, self.position.at(at), self.velocity.at_mut(at), of);
    }
}

/// Both in one sweep, where each row is a tile: a row is kicked once the row below has its acceleration.
pub struct Both<'a, 'n, L: Lanes, Y, const GRADIENT: bool, const FIRST: bool, const LAST: bool> {
    pub push: Push<'a, 'n, L, GRADIENT, FIRST, LAST>,
    pub inverse_mass: Strip<'a, Row>,
    /// Accelerations of the row left last (m/s²), and two thirds of what their differences do to the forces (N/s²).
    pub bent: [L::V; 2],
    pub layout: PhantomData<Y>,
}

impl<L: Lanes, Y: Layout, const GRADIENT: bool, const FIRST: bool, const LAST: bool>
    Both<'_, '_, L, Y, GRADIENT, FIRST, LAST>
{
    /// Kicks row `at`, whose contacts' bends end above `next`.
    #[inline(always)]
    pub fn bend(&mut self, at: At, next: L::V) {
        let [acceleration, bend] = self.bent;
        let held = L::sub(bend, Y::below::<L>(bend, next));
        let gradient = L::mul(held, L::load(self.inverse_mass.at(at)));
        if LAST && self.push.kicks.keeps() {
            L::store(gradient, self.push.tangent.at_mut(at));
        }
        let Push { position, velocity, kicks, .. } = &mut self.push;
        let of = [acceleration, gradient];
        kicks.on::<true, LAST>(at, position.at(at), velocity.at_mut(at), of);
    }
}

impl<L: Lanes, Y: Layout, const GRADIENT: bool, const FIRST: bool, const LAST: bool> Visit<L>
    for Both<'_, '_, L, Y, GRADIENT, FIRST, LAST>
{
    #[inline(always)]
    fn enter(&mut self, at: At) -> L::V {
        Visit::<L>::enter(&mut self.push, at)
    }

    #[inline(always)]
    fn foresee(&self, at: At) -> L::V {
        Visit::<L>::foresee(&self.push, at)
    }

    #[inline(always)]
    fn leave(&mut self, at: At, acceleration: L::V, tangent: L::V) {
        if LAST && self.push.kicks.keeps() {
            L::store(acceleration, self.push.acceleration.at_mut(at));
        }
        let above = Y::above::<L>(self.bent[0], acceleration);
        let bend = L::mul(tangent, L::sub(above, acceleration));
        if at.1 > 0 {
            self.bend((at.0, at.1 - 1), bend);
        } else if at.0 > 0 {
            self.bend((at.0 - 1, FOUR - 1), bend);
        }
        self.bent = [acceleration, bend];
    }
}
