//! What a system of differential equations `x'' = a(x, v)` provides to the methods: accelerations,
//! scales of errors, switches, and a tangent.

use super::hermite::Interpolant;
use crate::chain::State;

/// A mechanical system of `len` coordinates.
pub trait System {
    /// Number of coordinates.
    fn len(&self) -> usize;

    /// Whether there is nothing to integrate.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Writes the accelerations (m/s²) for the given positions (m) and velocities (m/s).
    fn accelerations(&mut self, position: &[f64], velocity: &[f64], acceleration: &mut [f64]);

    /// The distance (m) and speed (m/s) to which a relative error in this state refers: what the
    /// user reads is a contact's overlap, not the drift of the whole chain.
    fn scales(&self, position: &[f64], velocity: &[f64]) -> Scales;

    /// Whether the law has a kink between two states: a step across it is of low order, and an
    /// estimate of its error may vanish by accident.
    fn has_kink_between(&self, from: &State, to: &State) -> bool {
        let _ = (from, to);
        false
    }

    /// Highest angular frequency, or a bound of it, which decides on the first step: by default,
    /// speeds change distances in a radian (1/s).
    fn highest_frequency(&self, state: &State) -> f64 {
        let Scales { position, velocity } = self.scales(&state.position, &state.velocity);
        velocity / position
    }

    /// The longest step over which what moves it from outside is smooth (s).
    fn longest_step(&self) -> f64 {
        f64::INFINITY
    }

    /// Motion of the wall at an end, 0 at the top and 1 at the bottom, over a step from a start (s)
    /// of a length (s) in which coordinates move by `motion`.
    fn wall(
        &self,
        end: usize,
        step: (f64, f64),
        motion: &dyn Fn(usize) -> Interpolant,
    ) -> Interpolant {
        let _ = (end, step, motion);
        Interpolant::REST
    }

    /// Whether later forces depend on how it has moved, so that [`System::remember`] takes in each
    /// step.
    fn has_memory(&self) -> bool {
        false
    }

    /// Takes in the motion over a step from a start (s) of a length (s); an earlier step that
    /// reaches beyond its start counts up to there.
    fn remember(&mut self, step: (f64, f64), walls: [Interpolant; 2]) {
        let _ = (step, walls);
    }

    /// Its switches, if its law has any.
    fn switching(&mut self) -> Option<&mut dyn Switching> {
        None
    }

    /// Tangent of the system, if it is available.
    fn linearised(&mut self) -> Option<&mut dyn Linearised> {
        None
    }
}

/// Magnitudes by which errors are measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scales {
    /// Typical overlap (m).
    pub position: f64,
    /// Typical speed (m/s).
    pub velocity: f64,
}

impl Scales {
    /// Takes in the present ones: a rebound's speed stays the yardstick for what it left behind.
    pub(crate) fn widen(&mut self, now: Self) {
        self.position = self.position.max(now.position);
        self.velocity = self.velocity.max(now.velocity);
    }

    /// Whether errors can be measured by them.
    pub(super) fn are_finite(&self) -> bool {
        self.position.is_finite() && self.velocity.is_finite()
    }
}

/// What a switch depends on: the motion of two bodies against each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sides {
    /// Index of the body above; none at a wall.
    pub above: Option<usize>,
    /// Index of the body below; none at a wall.
    pub below: Option<usize>,
    /// What users of the system call its place.
    pub place: usize,
}

/// How two bodies stand and move against each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Position of the one above less that of the one below (m).
    pub difference: f64,
    /// Its rate (m/s).
    pub rate: f64,
}

/// What the turn of two bodies, from closing to parting, means for a switch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Turning {
    /// Nothing.
    Irrelevant,
    /// The switch's margin may have the other sign there and nowhere else in the step.
    MayChange,
    /// The switch changes there if the difference of the bodies' positions exceeds this (m).
    Changes(f64),
}

/// A system with switches.
pub trait Switching {
    /// How many there are.
    fn switches(&self) -> usize;

    /// Whether `switch` is on.
    fn is_on(&self, switch: usize) -> bool;

    /// Changes `switch` in `state`, whose accounts book what that moves; another switch may follow.
    fn flip(&mut self, switch: usize, state: &mut State);

    /// What decides about `switch`.
    fn sides(&self, switch: usize) -> Sides;

    /// Relative position and velocity of the two bodies at `switch`, in `state`.
    fn motion(&self, switch: usize, state: &State) -> Motion {
        self.sides(switch).of(state)
    }

    /// Whether `switch` changes where its bodies turn.
    fn turning(&self, switch: usize) -> Turning {
        let _ = switch;
        Turning::Irrelevant
    }

    /// By how much the acceleration of a body would be wrong at the `end` of a step if `switch` did
    /// not change where its bodies turned, their positions differing by `turn` (m) (m/s²).
    fn turn_error(&self, switch: usize, turn: f64, end: Motion) -> f64 {
        let _ = (switch, turn, end);
        0.0
    }

    /// What is zero where `switch` should change, and not negative where it should be on (unit).
    fn margin(&self, switch: usize, motion: Motion) -> f64;

    /// Whether `switch` stands wrong and will not be right by itself.
    fn is_wrong(&self, switch: usize, motion: Motion) -> bool;

    /// By how much the acceleration of a body is wrong with `switch` wrong: when its margin's root
    /// is passed at the rate `closing` (m/s), or with the motion found `beyond` it (m/s²).
    fn error(&self, switch: usize, closing: f64, beyond: Motion) -> f64;
}

impl Sides {
    /// How its bodies stand and move in `state`.
    pub(super) fn of(&self, state: &State) -> Motion {
        let difference = |of: &[f64]| {
            self.above.map_or(0.0, |body| of[body]) - self.below.map_or(0.0, |body| of[body])
        };
        Motion { difference: difference(&state.position), rate: difference(&state.velocity) }
    }
}

/// A symmetric tridiagonal matrix.
#[derive(Debug, Clone, Default)]
pub struct Tridiagonal {
    /// Entries on the diagonal (unit).
    pub diagonal: Vec<f64>,
    /// Entries beside it (unit).
    pub off_diagonal: Vec<f64>,
}

impl Tridiagonal {
    /// A matrix of `n` rows, all zero.
    pub fn new(n: usize) -> Self {
        Self { diagonal: vec![0.0; n], off_diagonal: vec![0.0; n.saturating_sub(1)] }
    }

    /// Replaces the matrix by its factors `L D L^T`. Stable without pivoting: chains that repel
    /// make it positive definite.
    pub fn factorise(&mut self) {
        for i in 1..self.diagonal.len() {
            let beside = self.off_diagonal[i - 1];
            let factor = beside / self.diagonal[i - 1];
            self.diagonal[i] -= factor * beside;
            self.off_diagonal[i - 1] = factor;
        }
    }

    /// Replaces `values` by the solution for them as right-hand side. Source: L. H. Thomas, Watson
    /// Sci. Comput. Lab. report (1949).
    pub fn solve(&self, values: &mut [f64]) {
        let n = self.diagonal.len();
        for i in 1..n {
            values[i] -= self.off_diagonal[i - 1] * values[i - 1];
        }
        for (value, pivot) in values.iter_mut().zip(&self.diagonal) {
            *value /= pivot;
        }
        for i in (1..n).rev() {
            values[i - 1] -= self.off_diagonal[i - 1] * values[i];
        }
    }
}

/// A system whose tangent is a chain's: `M a = F(x, v)`, and behind the bodies accounts whose rates
/// follow from the bodies' motion alone.
pub trait Linearised {
    /// Number of bodies; accounts stand behind them.
    fn bodies(&self) -> usize;

    /// Takes the tangent at `state`.
    fn linearise(&mut self, state: &State);

    /// Writes `shift^2 M + shift C + K`, `-C` and `-K` the tangents of the forces against
    /// velocities and positions.
    fn assemble(&mut self, shift: f64, matrix: &mut Tridiagonal);

    /// Masses of the bodies (kg).
    fn masses(&self) -> &[f64];

    /// Writes the forces `-K x` of small displacements `position` (m) (N).
    fn forces_of(&mut self, position: &[f64], out: &mut [f64]);

    /// Writes the changes of the accounts' rates under small changes of positions (m) and
    /// velocities (m/s).
    fn account_rates(&mut self, position: &[f64], velocity: &[f64], out: &mut [f64]);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_solve_what_was_multiplied() {
        let mut matrix =
            Tridiagonal { diagonal: vec![4.0, 5.0, 6.0, 3.0], off_diagonal: vec![-1.0, 2.0, -2.5] };
        let x = [1.0, -2.0, 0.5, 3.0];
        let row = |i: usize| {
            let beside = |j: usize, k: usize| matrix.off_diagonal[j] * x[k];
            let left = if i > 0 { beside(i - 1, i - 1) } else { 0.0 };
            let right = if i < 3 { beside(i, i + 1) } else { 0.0 };
            left + matrix.diagonal[i] * x[i] + right
        };
        let mut values: Vec<f64> = (0..4).map(row).collect();
        matrix.factorise();
        matrix.solve(&mut values);
        for (found, exact) in values.iter().zip(x) {
            assert!((found - exact).abs() < 1e-14);
        }
    }
}
