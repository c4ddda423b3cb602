"""Tries the Python package against the program: the same numbers to the last digit, on every included scene.

    check.py HERTZSCOPE

HERTZSCOPE is the program. The examples of docs/python.md are lines of this script.
"""

import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import hertzscope
import numpy as np

PROGRAM = os.path.abspath(sys.argv[1])
os.chdir(tempfile.mkdtemp())


def program(*words):
    """What the program prints, as JSON."""
    printed = subprocess.run([PROGRAM, *words, "--json"], check=False, capture_output=True, text=True)
    assert printed.returncode in (0, 1), printed.stderr
    return json.loads(printed.stdout)


def first_trace():
    recording = hertzscope.run("magnet-0.61g", {"striker.speed": "0.5 m/s"})
    shot = recording[0]
    volts = shot.captures["CH2"].values  # NumPy, shape (2500,), in shot.captures["CH2"].unit
    force = shot.truth["sensor/p14"]  # what no sensor saw: force.times, force.values, force.unit
    print(f"{volts.max():.3f} V, {force.values.max():.3f} {force.unit}")
    print(recording.summary.sensors[0]["first_peak"])
    recording.save("faster.mcap")  # for the program, and for any reader of MCAP

    again = hertzscope.open("faster.mcap")
    assert np.array_equal(again[0].captures["CH2"].codes, shot.captures["CH2"].codes)
    frame = shot.to_pandas()  # a column for each channel over time; frame.attrs["units"]
    dataset = shot.to_xarray()  # a variable for each channel, with attrs["units"]
    shot.plot()  # with matplotlib

    assert list(frame.columns) == list(dataset.data_vars) == list(shot.captures)
    assert frame.attrs["units"]["CH2"] == dataset["CH2"].attrs["units"] == "V"
    assert dataset["time"].attrs["units"] == "s"


def own_chain():
    scene = """
    base = "magnet-0.61g"
    [striker]
    speed = "0.48 m/s"
    """
    measured = hertzscope.run(scene, seed=7)  # stands for hertzscope.open("measured.csv")
    told = hertzscope.compare(measured, "magnet-0.61g", tolerance="peak=5%")
    print(told.is_yes, [channel["name"] for channel in told["channels"]])
    found = hertzscope.fit(measured, "magnet-0.61g", free=["striker.speed"])
    speed = found["parameters"][0]
    print(f"{speed['value']:.6f} ± {speed['u']:.6f} m/s")

    assert abs(speed["value"] - 0.48) < 5 * speed["u"], speed


def calibration():
    hertzscope.calibrate(simulate="pzt-5a-710pf", output="test")
    certificate = hertzscope.calibrate("test/plan.toml")
    print(certificate.is_yes, list(certificate))

    assert certificate == program("calibrate", "test/plan.toml", "--quiet")


def sweep_in_pandas():
    table = hertzscope.sweep("""
    scene = "magnet-0.61g"
    accuracy = 1e-4
    [grid]
    striker.speed = ["0.3 m/s", "0.4 m/s", "0.5 m/s", "0.6 m/s"]
    """)
    print(table.iloc[:, :4])

    assert len(table) == 4, table


def recording_of_arrays():
    times = np.arange(5000) * 1e-6
    pulse = np.exp(-((times - 2e-3) / 50e-6) ** 2)
    made = hertzscope.recording({"CH1": pulse, "CH2": 0.5 * pulse}, 1e-6, start=-1e-3)
    made.save("arrays.mcap")
    print(made[0].captures["CH1"].values.max(), made[0].captures["CH1"].unit)

    kept = made[0].captures["CH1"]
    assert len(kept.values) == 5000 and abs(kept.start + 1e-3) < 1e-12 and abs(kept.interval - 1e-6) < 1e-15
    assert np.abs(kept.values - pulse).max() <= 1 / 64000 * (1 + 1e-9), np.abs(kept.values - pulse).max()


def errors():
    try:
        hertzscope.run("magnet-0.61g", {"striker.sped": "0.5 m/s"})
    except hertzscope.HertzscopeError as error:
        print(error)
    else:
        raise AssertionError("a misspelt path is taken")
    try:
        hertzscope.fit("nothing.csv", "magnet-0.61g", free=["striker.speed"])
    except hertzscope.HertzscopeError as error:
        assert "nothing.csv" in str(error), error
    else:
        raise AssertionError("a file that is not there is taken")


def every_scene():
    """Traces, truth, summaries equal to the program's on every included scene."""
    names = [row["name"] for row in hertzscope.scenes()["rows"]]
    for name in names:
        printed = program("run", name, "--output", f"{name}.mcap")
        printed.pop("recording")
        made = hertzscope.run(name)
        for key in (printed | made.summary).keys() - {"wall_s", "wall_held_s"}:  # times by the clock
            assert made.summary[key] == printed[key], (name, key, made.summary[key], printed[key])
        made.save("made.mcap")
        assert Path("made.mcap").read_bytes() == Path(f"{name}.mcap").read_bytes(), name
        for mine, theirs in zip(made, hertzscope.open(f"{name}.mcap"), strict=True):
            assert mine.captures.keys() == theirs.captures.keys() and mine.truth.keys() == theirs.truth.keys()
            assert all(np.array_equal(mine.captures[key].values, theirs.captures[key].values) for key in mine.captures)
            assert all(np.array_equal(mine.truth[key].values, theirs.truth[key].values) for key in mine.truth)
        if made[0].captures:
            assert hertzscope.arrivals(made)["shots"] == program("arrivals", f"{name}.mcap")["shots"], name
    print(f"{len(names)} scenes as the program has them, to the last bit")


def time_and_memory():
    """Of a run beside the solver's own time; what ten thousand keep; two threads beside each other."""
    spent = []
    for _ in range(21):
        started = time.perf_counter()
        made = hertzscope.run("magnet-0.61g")
        spent.append(time.perf_counter() - started - made.summary["wall_s"])
    print(f"a run takes {sorted(spent)[10] * 1e3:.2f} ms more than the solver")
    runs = int(os.environ.get("HERTZSCOPE_RUNS", "1000"))
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for _ in range(runs):
        hertzscope.run("magnet-0.61g", accuracy=1e-3)[0].captures["CH2"].values.max()
    more = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    print(f"{runs} runs: {more / 1024:.1f} MiB more")
    assert more < 20 * 1024, more

    def some():
        for _ in range(50):
            hertzscope.run("magnet-0.61g")

    started = time.perf_counter()
    some()
    one = time.perf_counter() - started
    threads = [threading.Thread(target=some) for _ in range(2)]
    started = time.perf_counter()
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    print(f"two threads run {2 * one / (time.perf_counter() - started):.2f} times as many as one")


def ctrl_c():
    """Ends a run of an hour."""
    threading.Timer(0.3, signal.raise_signal, [signal.SIGINT]).start()
    started = time.perf_counter()
    try:
        hertzscope.run("magnet-0.61g", shots=1_000_000)
    except KeyboardInterrupt:
        print(f"Ctrl-C: {(time.perf_counter() - started - 0.3) * 1e3:.0f} ms")
    else:
        raise AssertionError("Ctrl-C is not heard")


if __name__ == "__main__":
    for part in (first_trace, own_chain, calibration, sweep_in_pandas, recording_of_arrays, errors, every_scene, ctrl_c, time_and_memory):
        part()
    print("the Python package and the program agree")
