"""What the Python peers share: the scene, and the lines that `compare.py` sends and expects."""

import json
import math
import sys
import time

import numpy as np


class Problem:
    """A scene as plain equations in its own units; see rust/src/problem.rs."""

    def __init__(self, path):
        with open(path, encoding="utf-8") as file:
            numbers = [float(word) for word in file.read().split()]
        n, self.duration, peaks, self.samples = int(numbers[0]), numbers[1], int(numbers[2]), int(numbers[3])
        self.n = n
        rest = iter(numbers[4:])
        row = lambda count: np.array([next(rest) for _ in range(count)])
        self.times = [*row(peaks), self.duration]
        self.bodies = [int(body) for body in row(peaks)]
        self.inverse_mass = row(n)
        self.stiffness = row(n + 1)
        self.overlap = row(n + 1)
        self.load = row(n)
        self.velocity = row(n)

    def start(self):
        return np.concatenate([np.zeros(self.n), self.velocity])

    def force_in(self, body, states):
        """The force in a body that has one above and one below: the mean of its contacts' forces, for a state in each column."""
        beside, contacts = states[body - 1 : body + 2], slice(body, body + 2)
        closed = np.maximum(self.overlap[contacts, None] - np.diff(beside, axis=0), 0.0)
        return 0.5 * (self.stiffness[contacts, None] * closed * np.sqrt(closed)).sum(axis=0)

    def spans(self):
        return zip([0.0, *self.times[:-1]], self.times)

    def steps(self, span, step):
        """The number of steps no longer than `step` in a span, and their length."""
        count = math.ceil((span[1] - span[0]) / step)
        return count, (span[1] - span[0]) / count


def serve(solve):
    """Answers `run METHOD SETTING SECONDS SCENEFILE` lines; `solve(method, setting, problem)` gives the states at `times`."""
    # Coarse settings may blow up: that is an answer, not a warning.
    np.seterr(all="ignore")
    problems = {}
    for line in sys.stdin:
        _, method, setting, seconds, path = line.split()
        if path not in problems:
            problems[path] = Problem(path)
        problem, setting, seconds = problems[path], float(setting), float(seconds)
        try:
            states = solve(method, setting, problem)[:-1]
            start = time.process_time()
            calls = 0
            while True:
                solve(method, setting, problem)
                calls += 1
                spent = time.process_time() - start
                if spent >= seconds:
                    break
            finite = [state.tolist() if np.isfinite(state).all() else [] for state in states]
            answer = {"cpu_s": spent / calls, "states": finite}
        except Exception as why:  # noqa: BLE001: whatever a peer runs into is its answer
            answer = {"failed": f"{type(why).__name__}: {why}"}
        print(json.dumps(answer), flush=True)
