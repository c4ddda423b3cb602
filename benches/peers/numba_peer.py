"""Velocity Verlet and RK4 compiled by numba: as one would write them, and with a force loop that becomes vector code."""

import numba
import numpy as np

from peer import serve

compiled = numba.njit(fastmath=False, error_model="numpy")


@compiled
def plain(x, k, d, w, g, a, _):
    n = x.size
    above = 0.0
    if d[0] - x[0] > 0.0:
        above = k[0] * (d[0] - x[0]) ** 1.5
    for i in range(n):
        closed = d[i + 1] + x[i] - (x[i + 1] if i + 1 < n else 0.0)
        below = k[i + 1] * closed * np.sqrt(closed) if closed > 0.0 else 0.0
        a[i] = (above - below) * w[i] + g[i]
        above = below


@compiled
def rows(x, k, d, w, g, a, f):
    n = x.size
    f[0] = k[0] * max(d[0] - x[0], 0.0) * np.sqrt(max(d[0] - x[0], 0.0))
    for j in range(1, n):
        closed = max(d[j] + x[j - 1] - x[j], 0.0)
        f[j] = k[j] * closed * np.sqrt(closed)
    closed = max(d[n] + x[n - 1], 0.0)
    f[n] = k[n] * closed * np.sqrt(closed)
    for i in range(n):
        a[i] = (f[i] - f[i + 1]) * w[i] + g[i]


def verlet_with(force):
    @compiled
    def verlet(x, v, steps, h, k, d, w, g):
        a = np.empty_like(x)
        f = np.empty(x.size + 1)
        force(x, k, d, w, g, a, f)
        for _ in range(steps):
            for i in range(x.size):
                v[i] += 0.5 * h * a[i]
                x[i] += h * v[i]
            force(x, k, d, w, g, a, f)
            for i in range(x.size):
                v[i] += 0.5 * h * a[i]

    return verlet


def rk4_with(force):
    @compiled
    def rk4(x, v, steps, h, k, d, w, g):
        n = x.size
        a1, a2, a3, a4 = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
        y = np.empty(n)
        f = np.empty(n + 1)
        for _ in range(steps):
            force(x, k, d, w, g, a1, f)
            for i in range(n):
                y[i] = x[i] + 0.5 * h * v[i]
            force(y, k, d, w, g, a2, f)
            for i in range(n):
                y[i] = x[i] + 0.5 * h * (v[i] + 0.5 * h * a1[i])
            force(y, k, d, w, g, a3, f)
            for i in range(n):
                y[i] = x[i] + h * (v[i] + 0.5 * h * a2[i])
            force(y, k, d, w, g, a4, f)
            for i in range(n):
                x[i] += h * v[i] + h * h / 6.0 * (a1[i] + a2[i] + a3[i])
                v[i] += h / 6.0 * (a1[i] + 2.0 * a2[i] + 2.0 * a3[i] + a4[i])

    return rk4


LOOPS = {
    "verlet-plain": verlet_with(plain),
    "verlet-rows": verlet_with(rows),
    "rk4-plain": rk4_with(plain),
    "rk4-rows": rk4_with(rows),
}


def solve(method, setting, problem):
    loop = LOOPS[method]
    x, v = np.zeros(problem.n), problem.velocity.copy()
    states = []
    for span in problem.spans():
        steps, h = problem.steps(span, setting)
        loop(x, v, steps, h, problem.stiffness, problem.overlap, problem.inverse_mass, problem.load)
        states.append(np.concatenate([x, v]))
    return states


serve(solve)
