//! Rust's solvers as one would call them, and a velocity Verlet as one would write it. Each stops
//! where the reference peaks, and hands over the state there; none records anything else.

use differential_equations::prelude::{ExplicitRungeKutta, IVP, ODE};
use ode_solvers::dop_shared::OutputType;
use ode_solvers::{DVector, Dop853, Dopri5, System};

use crate::problem::Problem;

/// Positions, then velocities.
type State = Vec<f64>;

/// Solves `problem` to its end by `method`, with a tolerance or a step of `setting`; the states at
/// the reference's peaks.
pub fn solve(method: &str, setting: f64, problem: &Problem) -> Result<Vec<State>, String> {
    let mut times: Vec<f64> = problem.peaks.iter().map(|(_, time, _)| *time).collect();
    times.push(problem.duration);
    let mut state = vec![0.0; problem.velocity.len()];
    state.extend(&problem.velocity);
    let mut states = Vec::new();
    let mut start = 0.0;
    for end in times {
        state = match method {
            "verlet" => verlet(setting, problem, state, end - start),
            "ode_solvers-dop853" | "ode_solvers-dopri5" => {
                with_ode_solvers(method, setting, problem, state, end - start)?
            }
            "differential-equations-dop853" => {
                with_differential_equations(setting, problem, &state, end - start)?
            }
            _ => return Err("found no such method".to_owned()),
        };
        start = end;
        states.push(state.clone());
    }
    states.pop();
    Ok(states)
}

fn verlet(step: f64, problem: &Problem, mut state: State, time: f64) -> State {
    let steps = (time / step).ceil();
    let h = time / steps;
    let (x, v) = state.split_at_mut(problem.velocity.len());
    let mut a = vec![0.0; x.len()];
    problem.accelerations(x, &mut a);
    for _ in 0..steps as u64 {
        for ((x, v), a) in x.iter_mut().zip(v.iter_mut()).zip(&a) {
            *v += 0.5 * h * a;
            *x += h * *v;
        }
        problem.accelerations(x, &mut a);
        for (v, a) in v.iter_mut().zip(&a) {
            *v += 0.5 * h * a;
        }
    }
    state
}

impl System<f64, DVector<f64>> for &Problem {
    fn system(&self, _t: f64, y: &DVector<f64>, dy: &mut DVector<f64>) {
        self.rates(y.as_slice(), dy.as_mut_slice());
    }
}

impl ODE<f64, State> for Problem {
    fn diff(&self, _t: f64, y: &State, dy: &mut State) {
        self.rates(y, dy);
    }
}

impl Problem {
    fn rates(&self, y: &[f64], dy: &mut [f64]) {
        let (x, v) = y.split_at(self.velocity.len());
        let (dx, dv) = dy.split_at_mut(x.len());
        dx.copy_from_slice(v);
        self.accelerations(x, dv);
    }
}

/// Most steps before a run is given up.
const MOST_STEPS: u32 = 3_000_000;

fn with_ode_solvers(
    method: &str,
    tolerance: f64,
    problem: &Problem,
    state: State,
    time: f64,
) -> Result<State, String> {
    let y = DVector::from_vec(state);
    // The crate's own defaults but for the number of steps, the stiffness test and the output.
    let last = |ys: &[DVector<f64>]| {
        ys.last().map(|y| y.as_slice().to_vec()).ok_or_else(|| "found no output".to_owned())
    };
    if method == "ode_solvers-dop853" {
        let mut solver = Dop853::from_param(
            problem,
            0.0,
            time,
            time,
            y,
            tolerance,
            tolerance,
            0.9,
            0.0,
            0.333,
            6.0,
            time,
            0.0,
            MOST_STEPS,
            u32::MAX,
            OutputType::Sparse,
        );
        solver.integrate().map_err(|error| error.to_string())?;
        last(solver.y_out())
    } else {
        let mut solver = Dopri5::from_param(
            problem,
            0.0,
            time,
            time,
            y,
            tolerance,
            tolerance,
            0.9,
            0.04,
            0.2,
            10.0,
            time,
            0.0,
            MOST_STEPS,
            u32::MAX,
            OutputType::Sparse,
        );
        solver.integrate().map_err(|error| error.to_string())?;
        last(solver.y_out())
    }
}

fn with_differential_equations(
    tolerance: f64,
    problem: &Problem,
    state: &State,
    time: f64,
) -> Result<State, String> {
    let method =
        ExplicitRungeKutta::dop853().rtol(tolerance).atol(tolerance).max_steps(MOST_STEPS as usize);
    let solution = IVP::ode(problem, 0.0, time, state.clone())
        .t_eval([time])
        .method(method)
        .solve()
        .map_err(|error| format!("{error:?}"))?;
    solution.y.last().cloned().ok_or_else(|| "found no output".to_owned())
}
