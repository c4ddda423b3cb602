"""SciPy's explicit Runge-Kutta methods with a NumPy force."""

import numpy as np
from scipy.integrate import solve_ivp

from peer import serve


def solve(method, setting, problem):
    n = problem.n
    padded = np.zeros(n + 2)

    def rates(_, y):
        padded[1:-1] = y[:n]
        closed = np.maximum(problem.overlap + padded[:-1] - padded[1:], 0.0)
        force = problem.stiffness * closed * np.sqrt(closed)
        return np.concatenate([y[n:], (force[:-1] - force[1:]) * problem.inverse_mass + problem.load])

    name, _, samples = method.partition("+")
    if samples:
        # What a recording is made of: the forces in the bodies, evenly spaced in time, all along.
        grid = np.linspace(0.0, problem.duration, problem.samples + 1)
        found = solve_ivp(rates, (0.0, problem.duration), problem.start(), name.upper(), t_eval=grid, rtol=max(setting, 3e-14), atol=setting)
        if not found.success:
            raise RuntimeError(found.message)
        return [problem.force_in(body, found.y) for body in problem.bodies]

    state, states = problem.start(), []
    for span in problem.spans():
        found = solve_ivp(rates, span, state, name.upper(), t_eval=[span[1]], rtol=max(setting, 3e-14), atol=setting)
        if not found.success:
            raise RuntimeError(found.message)
        state = found.y[:, -1]
        states.append(state)
    return states


serve(solve)
