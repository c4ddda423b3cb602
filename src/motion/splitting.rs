//! Symplectic methods: kicks and drifts in turn.
//!
//! A method is the list of its kick fractions `b` and drift fractions `a`: `v += b h a(x)`,
//! `x += a h v`, and so on, kick first and last. Kicks may also follow the gradient of the
//! accelerations along themselves, `v += g h^3 (da/dx) a`. The last kick of a step and the first of
//! the next share one force evaluation. All are explicit, time-reversible, and keep the energy
//! error bounded as long as every contact stays closed; where a contact opens or closes the force
//! has no second derivative and all of them fall to about order 2.5.

/// Fractions of a symmetric kick-drift-...-drift-kick method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Splitting {
    /// Name as written in scenes, options and recordings.
    pub name: &'static str,
    /// Publication that defines the method.
    pub source: &'static str,
    /// Order of convergence on smooth problems.
    pub order: u8,
    /// Kick fractions, one more than drifts (1).
    pub kicks: &'static [f64],
    /// Drift fractions (1).
    pub drifts: &'static [f64],
    /// What accelerations' gradients along themselves weigh in each kick, in units of the step
    /// cubed; empty without them (1).
    pub gradients: &'static [f64],
    /// Where the parts of a run's first step end, in steps, the last at 1; empty where it is taken
    /// whole (1).
    pub first_step: &'static [f64],
    /// Longest stable step times the highest angular frequency of a linear chain (1).
    pub stability: f64,
}

/// Velocity Verlet: half a kick, a drift, half a kick. Order 2, one force evaluation a step.
pub static VELOCITY_VERLET: Splitting = Splitting {
    name: "velocity-verlet",
    source: "W. C. Swope, H. C. Andersen, P. H. Berens, K. R. Wilson, J. Chem. Phys. 76, 637 (1982)",
    order: 2,
    kicks: &[0.5, 0.5],
    drifts: &[1.0],
    gradients: &[],
    first_step: &[],
    stability: 2.0,
};

/// First drift, as a fraction of the step (1).
const DRIFT: f64 = 0.289_680_263_734;
/// Drifts lead to 0, `a`, `1 - a` and 1, of whose squares the kicks make 1/3 (1).
const OUTER_KICK: f64 = {
    let squares = DRIFT * DRIFT + (1.0 - DRIFT) * (1.0 - DRIFT);
    (1.0 / 3.0 - 0.5 * squares) / (1.0 - squares)
};
const INNER_KICK: f64 = 0.5 - OUTER_KICK;
/// With all pairs of kicks, each weighed by the drift between them, gradients come to 1/6 (1).
const GRADIENT: f64 = {
    let inner = INNER_KICK * INNER_KICK * (1.0 - 2.0 * DRIFT);
    0.5 * (1.0 / 6.0 - (OUTER_KICK * OUTER_KICK + 2.0 * OUTER_KICK * INNER_KICK + inner))
};

/// A splitting of order 4 with force gradients: three force evaluations a step, two of them with
/// gradients, which cost about as much again.
///
/// The velocity form of Omelyan, Mryglod and Folk with three drifts and gradients in the inner
/// kicks. Two conditions of order 4 fix the kicks and the gradients' weight. The first drift is
/// chosen for stability: steps are stable up to 7.70 rad of a linear oscillator, where both roots
/// of `trace + 2` coincide, at 3.155 rad. The first step of a run is taken in three parts: a
/// striker's contact begins at zero overlap, where its force has no second derivative.
pub static FORCE_GRADIENT: Splitting = Splitting {
    name: "force-gradient",
    source: "I. P. Omelyan, I. M. Mryglod, R. Folk, Phys. Rev. E 66, 026701 (2002); first drift chosen for stability",
    order: 4,
    kicks: &[OUTER_KICK, INNER_KICK, INNER_KICK, OUTER_KICK],
    drifts: &[DRIFT, 1.0 - 2.0 * DRIFT, DRIFT],
    gradients: &[0.0, GRADIENT, GRADIENT, 0.0],
    first_step: &[0.25, 0.5, 1.0],
    stability: 7.70,
};

#[cfg(test)]
mod tests {
    use super::*;

    /// Half the trace of a step of `angle` (rad) of a linear oscillator: motions stay bounded where
    /// it is between -1 and 1.
    fn half_trace(method: &Splitting, angle: f64) -> f64 {
        let square = angle * angle;
        let through = |[mut x, mut v]: [f64; 2]| {
            for (index, kick) in method.kicks.iter().enumerate() {
                let gradient = method.gradients.get(index).unwrap_or(&0.0);
                v += (gradient * square - kick) * square * x;
                x += method.drifts.get(index).unwrap_or(&0.0) * v;
            }
            [x, v]
        };
        0.5 * (through([1.0, 0.0])[0] + through([0.0, 1.0])[1])
    }

    /// Up to the step that each method says, also where one turns the oscillator round, and not
    /// right beyond.
    #[test]
    fn steps_are_stable_as_far_as_is_said() {
        for method in [&VELOCITY_VERLET, &FORCE_GRADIENT] {
            // In shares of a hundred thousandth.
            let most = |shares: std::ops::Range<u32>| {
                let angles = shares.map(|share| 1e-5 * f64::from(share) * method.stability);
                angles.map(|angle| half_trace(method, angle).abs() - 1.0).reduce(f64::max)
            };
            let [below, beyond] = [most(1..100_000), most(100_000..103_000)];
            println!("{}: {below:?} up to {}, {beyond:?}", method.name, method.stability);
            assert!(below.is_some_and(|most| most < 1e-13), "{}: {below:?}", method.name);
            assert!(beyond.is_some_and(|most| most > 1e-9), "{}: {beyond:?}", method.name);
        }
    }
}
