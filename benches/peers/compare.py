"""Time to accuracy: hertzscope and its peers on the same scenes, in the same rounds.

Error: relative, of the first peak of the force inside particle 14 (P600: the worse of 14 and 400). For every solver the coarsest
setting for which it and all finer ones tried meet the tolerance, to a 16th of an octave of the step or of a decade of the tolerance. Times: medians over rounds of the ratios within a round, CPU time.
"""

import argparse
import json
import math
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
SCENES = ["P37", "G37", "P600", "bench"]
TOLERANCES = [1e-3, 1e-6, 1e-9]
#: CPU time of one solution beyond which a ladder ends (s).
LONGEST = {"P600": 2.0}
LONGEST_ELSEWHERE = 0.3
#: Coarsest fixed step, in the scene's unit of time; methods of high order still do well where others fail. LAMMPS loses its particles
#: there and does not recover.
FIRST_STEP = {"lammps": 0.5}
FIRST_STEP_ELSEWHERE = 4.0
#: Rungs of a ladder in an octave of the step, or in a decade of the tolerance.
RUNGS = 2
#: How often the gap between the coarsest rung that will do and the next is halved.
HALVINGS = 3
#: CPU time of one measurement in a round (s).
SLICE = 0.02
#: From sample to sample of what is recorded (s).
SAMPLE = 1e-6

OURS = "hertzscope"
#: Row of the table: server, methods of which the fastest is taken, and whether the setting is a step.
PEERS = {
    OURS: (
        "rust",
        [
            "rkn86+bare", "two-step-force-gradient+bare", "*velocity-verlet+bare", "*force-gradient+bare",
        ],
        False,
    ),
    "SciPy DOP853": ("scipy", ["dop853"], False),
    "LAMMPS gran/hertz/history": ("lammps", ["hertz/history"], True),
    "LAMMPS granular hertz": ("lammps", ["granular"], True),
    "ode_solvers": ("rust", ["ode_solvers-dop853", "ode_solvers-dopri5"], False),
    "differential-equations": ("rust", ["differential-equations-dop853"], False),
    "velocity Verlet in plain Rust": ("rust", ["verlet"], True),
    "Boost.odeint as written": (
        "odeint",
        ["dopri5-plain", "fehlberg78-plain", "cash-karp54-plain", "*rk4-plain", "*adams5-plain", "*verlet-plain", "*mclachlan4-plain"],
        False,
    ),
    "Boost.odeint, vectorised force loop": (
        "odeint",
        ["dopri5-rows", "fehlberg78-rows", "cash-karp54-rows", "*rk4-rows", "*adams5-rows", "*verlet-rows", "*mclachlan4-rows"],
        False,
    ),
    "numba as written": ("numba", ["verlet-plain", "rk4-plain"], True),
    "numba, vectorised force loop": ("numba", ["verlet-rows", "rk4-rows"], True),
}


#: What hertzscope does besides integrating, in runs of their own.
WATCHING = {
    "peaks": "hertzscope, first peaks followed",
    "sampled": "hertzscope, a sample each us",
    "recorded": "hertzscope, peaks and a sample each us",
}
#: Rows that are timed with samples, too.
RECORDING = ["SciPy DOP853", "Boost.odeint as written", "Boost.odeint, vectorised force loop"]


class Server:
    """A peer that answers line by line."""

    def __init__(self, command, core):
        pin = ["taskset", "-c", str(core)] if core is not None else []
        environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "PYTHONPATH": str(HERE)}
        self.process = subprocess.Popen(
            [*pin, *command], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment
        )

    def ask(self, line):
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()
        answer = self.process.stdout.readline()
        if not answer:
            raise RuntimeError(f"the peer {self.process.args} ended at {line!r}")
        return json.loads(answer)


class Scene:
    """A scene as the other peers read it, and what their states mean."""

    def __init__(self, description, folder):
        self.__dict__.update(description)
        self.path = folder / f"{self.name}.txt"
        times = [time for _, time, _ in self.peaks]
        samples = round(self.seconds / SAMPLE)
        rows = [[len(self.inverse_mass), self.duration, len(times), samples], times, [body for body, _, _ in self.peaks]]
        rows += [self.inverse_mass, self.stiffness, self.overlap, self.load, self.velocity]
        self.path.write_text("\n".join(" ".join(map(repr, row)) for row in rows) + "\n", encoding="utf-8")

    def contact(self, x, v, a, j):
        """Force in contact j, its rate and the rate of that."""
        get = lambda row, i: row[i] if 0 <= i < len(row) else 0.0
        overlap = self.overlap[j] + get(x, j - 1) - get(x, j)
        closing, pressing = get(v, j - 1) - get(v, j), get(a, j - 1) - get(a, j)
        if overlap <= 0:
            return 0.0, 0.0, 0.0
        k, root = self.stiffness[j], math.sqrt(overlap)
        return k * overlap * root, 1.5 * k * root * closing, 1.5 * k * (root * pressing + 0.5 * closing**2 / root)

    def peak(self, state, body):
        """Height of the peak next to a state: the parabola through force, rate and curvature (N)."""
        n = len(self.inverse_mass)
        x, v = state[:n], state[n:]
        force = [self.contact(x, v, [], j)[0] for j in range(n + 1)]
        a = [(force[i] - force[i + 1]) * self.inverse_mass[i] + self.load[i] for i in range(n)]
        sides = [self.contact(x, v, a, j) for j in (body, body + 1)]
        value, rate, bend = (0.5 * (above + below) for above, below in zip(*sides))
        static = 0.5 * sum(self.stiffness[j] * self.overlap[j] ** 1.5 for j in (body, body + 1))
        return (value - (0.5 * rate**2 / bend if bend < 0 else 0.0) - static) * self.newton

    def error(self, answer):
        """Relative error of the worst peak; infinite where a run failed or lost one."""
        exact = [height for _, _, height in self.peaks]
        if "peaks_n" in answer:
            found = answer["peaks_n"]
        elif "states" in answer and all(state and None not in state for state in answer["states"]):
            try:
                found = [self.peak(state, body) for state, (body, _, _) in zip(answer["states"], self.peaks)]
            except OverflowError:  # A step far too long has left numbers that no peak can be made of.
                return math.inf
        else:
            return math.inf
        off = [abs(f / e - 1) if f is not None else math.inf for f, e in zip(found, exact)]
        return max(off) if all(map(math.isfinite, off)) else math.inf


def ladder(server, method, first_step, scene, longest):
    """Settings from coarse to fine, tolerances where there is no first step, with their errors and rough CPU times, until the finest tolerance is met three times or a
    solution takes more than `longest` (s)."""
    rungs = []
    for rung in range(60):
        setting = first_step * 2 ** (-rung / RUNGS) if first_step else 10 ** (-(rung + 1) / RUNGS)
        if setting < 1e-14:
            break
        answer, found = at(server, method, setting, scene)
        rungs.append(found)
        failed = ["failed" in answer and rung >= 12]
        met = [error <= TOLERANCES[-1] for _, error, _ in rungs[-3:]]
        if (len(met) == 3 and all(met)) or all(failed) or (rungs[-1][1] < 1 and rungs[-1][2] > longest):
            break
    return rungs


def at(server, method, setting, scene):
    """What a peer answers, and the setting with its error and rough CPU time."""
    answer = server.ask(f"run {method} {setting!r} 0 {target(server, scene)}")
    return answer, (setting, scene.error(answer), answer.get("cpu_s", 0.0))


def finer(server, method, scene, rungs, chosen, tolerance):
    """The coarsest setting that meets `tolerance` between the rung `chosen` and the next coarser one, which does not."""
    place = rungs.index(chosen)
    if place == 0:
        return chosen
    missed = rungs[place - 1][0]
    for _ in range(HALVINGS):
        _, between = at(server, method, math.sqrt(missed * chosen[0]), scene)
        if between[1] <= tolerance:
            chosen = between
        else:
            missed = between[0]
    return chosen


def target(server, scene):
    return scene.name if server.knows_scenes else scene.path


def coarsest(rungs, tolerance):
    """The coarsest rung that meets `tolerance` as all finer ones do."""
    chosen = None
    for rung in reversed(rungs):
        if rung[1] > tolerance:
            break
        chosen = rung
    return chosen


def choose(servers, scenes, progress):
    """For each row, scene and tolerance: server, method, setting and error of the fastest method."""
    choice = {}
    for row, (name, methods, steps) in PEERS.items():
        if name not in servers:
            continue
        for scene in scenes:
            rungs = {}
            longest = LONGEST.get(scene.name, LONGEST_ELSEWHERE)
            for method in methods:
                progress(f"{row}, {scene.name}: {method}")
                is_step = steps or method.startswith("*")
                first_step = FIRST_STEP.get(name, FIRST_STEP_ELSEWHERE) if is_step else None
                rungs[method] = ladder(servers[name], method.lstrip("*"), first_step, scene, longest)
                # Rungs that take twice as long as another method of the row for the finest tolerance win nothing; those before count.
                finest = coarsest(rungs[method], TOLERANCES[-1])
                longest = min(longest, 2.0 * finest[2]) if finest else longest
            for tolerance in TOLERANCES:
                found = [(coarsest(r, tolerance), r, m.lstrip("*")) for m, r in rungs.items()]
                found = [(rung, all_rungs, method) for rung, all_rungs, method in found if rung]
                # Times along the ladder are of first runs; those that may be the fastest are timed as they will be.
                likely = 3.0 * min((rung[2] for rung, _, _ in found), default=0.0)
                timed = []
                for rung, all_rungs, method in found:
                    if rung[2] <= likely:
                        setting, error, _ = finer(servers[name], method, scene, all_rungs, rung, tolerance)
                        answer = servers[name].ask(f"run {method} {setting!r} {SLICE} {target(servers[name], scene)}")
                        timed.append((answer["cpu_s"], method, setting, error))
                if timed:
                    _, method, setting, error = min(timed)
                    choice[row, scene.name, tolerance] = servers[name], method, setting, error
    return choice


def rounds(choice, scenes, count, progress):
    """CPU time of every chosen run in every round, hertzscope also with everything recorded (s)."""
    times = {key: [] for key in choice}
    for round_number in range(count):
        for scene in scenes:
            for tolerance in TOLERANCES:
                progress(f"round {round_number + 1} of {count}, {scene.name} at {tolerance:g}")
                for row in PEERS:
                    key = row, scene.name, tolerance
                    if key not in choice:
                        continue
                    server, method, setting, _ = choice[key]
                    time = lambda m: server.ask(f"run {m} {setting!r} {SLICE} {target(server, scene)}")["cpu_s"]
                    times[key].append(time(method))
                    if row == OURS:
                        for watching in WATCHING:
                            other = method.replace("bare", watching)
                            times.setdefault((watching, *key[1:]), []).append(time(other))
                    if row in RECORDING:
                        times.setdefault((recorded(row), *key[1:]), []).append(time(method + "+samples"))
    return times


def recorded(row):
    return f"{row}, a sample each us"


def ratio(times, row, base, scene, tolerance):
    """Median over the rounds of a row's time over another's; none where either is missing."""
    ours, theirs = times.get((base, scene, tolerance)), times.get((row, scene, tolerance))
    if not ours or not theirs:
        return None
    return statistics.median(t / o for t, o in zip(theirs, ours))


def cell(value):
    return "-" if value is None else f"{value:.3g}" if value < 100 else f"{value:.0f}"


def print_tables(scenes, choice, times):
    heads = [f"{scene.name} {tolerance:.0e}".replace("e-0", "e-") for scene in scenes for tolerance in TOLERANCES]
    keys = [(scene.name, tolerance) for scene in scenes for tolerance in TOLERANCES]
    lines = [["their time / hertzscope's, integration alone", *heads], ["---"] * (len(heads) + 1)]
    for row in [*PEERS][1:]:
        lines.append([row, *(cell(ratio(times, row, OURS, *key)) for key in keys)])
    for watching, words in WATCHING.items():
        lines.append([words, *(cell(ratio(times, watching, OURS, *key)) for key in keys)])
    lines.append(["**their time / hertzscope's, both with a sample each us**", *("" for _ in keys)])
    for row in RECORDING:
        lines.append([row, *(cell(ratio(times, recorded(row), "sampled", *key)) for key in keys)])
    microseconds = lambda row, key: statistics.median(times[row, *key]) * 1e6 if times.get((row, *key)) else None
    lines.append(["**hertzscope, us**", *(cell(microseconds(OURS, key)) for key in keys)])
    simulated = {scene.name: scene.seconds for scene in scenes}
    speed = lambda key: simulated[key[0]] * 1e6 / microseconds(OURS, key) if microseconds(OURS, key) else None
    lines.append(["simulated / CPU time", *(cell(speed(key)) for key in keys)])
    for line in lines:
        print("| " + " | ".join(line) + " |")
    print()
    print_floors(times)
    print("\nMethods and settings, in each scene's own units (a tolerance, or a step in units of overlap over striker's speed):\n")
    for row in (OURS, "Boost.odeint, vectorised force loop"):
        used = [f"{k[1]} {k[2]:g}: {choice[k][1]} {choice[k][2]:.3g}" for k in choice if k[0] == row]
        print(f"- {row}: " + "; ".join(used))


#: What is demanded of their time over hertzscope's, by peer and scene.
FLOORS = {
    "SciPy DOP853": {"P37": 300, "G37": 300, "bench": 300, "P600": 100},
    "Boost.odeint, vectorised force loop": dict.fromkeys(SCENES, 2),
    "numba, vectorised force loop": dict.fromkeys(SCENES, 2),
}


def print_floors(times):
    """Prints the demands, each with what was reached at the three tolerances, integration alone and with samples in both times."""
    print("| demanded, at 1e-3 / 1e-6 / 1e-9 | at least | reached | | with a sample each us in both |")
    print("|---|---|---|---|---|")
    for row, scenes in FLOORS.items():
        for scene, least in scenes.items():
            reached = [ratio(times, row, OURS, scene, t) for t in TOLERANCES]
            if all(value is None for value in reached):
                continue
            sampled = [ratio(times, recorded(row), "sampled", scene, t) for t in TOLERANCES] if row in RECORDING else []
            met = [value >= least for value in reached if value is not None]
            verdict = "met" if all(met) else "missed" if not any(met) else "partly"
            words = lambda values: " / ".join(map(cell, values))
            print(f"| {scene} against {row} | {least} | {words(reached)} | {verdict} | {words(sampled)} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rust", required=True, help="the program of benches/peers/rust")
    parser.add_argument("--odeint", help="the program of odeint.cpp")
    parser.add_argument("--without", nargs="*", default=[], choices=["scipy", "numba", "lammps", "odeint"])
    parser.add_argument("--scenes", nargs="*", default=SCENES, choices=SCENES)
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--core", type=int, help="the processor that everything is pinned to")
    options = parser.parse_args()
    watched = sys.stderr.isatty()
    progress = lambda text: watched and print(f"\r\033[K{text}", end="", file=sys.stderr, flush=True)
    commands = {"rust": [options.rust], "odeint": [options.odeint]}
    commands.update({name: [sys.executable, str(HERE / f"{name}_peer.py")] for name in ("scipy", "numba", "lammps")})
    servers = {name: Server(command, options.core) for name, command in commands.items() if name not in options.without}
    for name, server in servers.items():
        server.knows_scenes = name == "rust"
    with tempfile.TemporaryDirectory() as folder:
        scenes = [Scene(servers["rust"].ask(f"scene {name}"), Path(folder)) for name in options.scenes]
        choice = choose(servers, scenes, progress)
        times = rounds(choice, scenes, options.rounds, progress)
    progress("")
    print_tables(scenes, choice, times)


main()
