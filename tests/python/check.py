"""Tries the Python package against the program: the same numbers to the last digit, on every included scene.

    check.py HERTZSCOPE

HERTZSCOPE is the program. The examples of docs/python.md are executed as they stand there, and once more as the cells of the notebook
docs/recipes/python.ipynb, which is made from that page: `check.py --notebook` writes it again.
"""

import json
import os
import re
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

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGE = DOCS / "python.md"
NOTEBOOK = DOCS / "recipes" / "python.ipynb"
CODE = re.compile(r"^```python tests/python/check.py\n(.*?)^```\n", re.MULTILINE | re.DOTALL)


def program(*words):
    """What the program prints, as JSON."""
    printed = subprocess.run([PROGRAM, *words, "--json"], check=False, capture_output=True, text=True)
    assert printed.returncode in (0, 1), printed.stderr
    return json.loads(printed.stdout)


def page():
    """The blocks of docs/python.md, in order, as they stand there, and what they leave."""
    blocks = CODE.findall(PAGE.read_text(encoding="utf-8"))
    names = {}
    for block in blocks:
        exec(block, names)
    shot, frame, dataset = names["shot"], names["frame"], names["dataset"]
    assert list(frame.columns) == list(dataset.data_vars) == list(shot.captures)
    assert frame.attrs["units"]["CH2"] == dataset["CH2"].attrs["units"] == "V"
    assert dataset["time"].attrs["units"] == "s"
    speed = names["speed"]
    assert abs(speed["value"] - 0.48) < 5 * speed["u"], speed
    assert names["certificate"] == program("calibrate", "test/plan.toml", "--quiet")
    assert len(names["table"]) == 4, names["table"]
    kept, pulse = names["made"][0].captures["CH1"], names["pulse"]
    assert len(kept.values) == 5000 and abs(kept.start + 1e-3) < 1e-12 and abs(kept.interval - 1e-6) < 1e-15
    assert np.abs(kept.values - pulse).max() <= 1 / 64000 * (1 + 1e-9), np.abs(kept.values - pulse).max()


def notebook():
    """The page as a notebook: its text and its examples in turn."""
    cells = []
    for place, text in enumerate(CODE.split(PAGE.read_text(encoding="utf-8"))):
        if not text.strip():
            continue
        # Links of the page lead from its folder.
        text = text.strip() if place % 2 else re.sub(r"\]\((?!http)", "](../", text.strip())
        lines = text.splitlines(keepends=True)
        cell = {"cell_type": "code", "execution_count": None, "id": f"cell-{place}", "metadata": {}, "outputs": [], "source": lines}
        if place % 2 == 0:
            cell = {"cell_type": "markdown", "id": f"cell-{place}", "metadata": {}, "source": lines}
        cells.append(cell)
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    made = {"cells": cells, "metadata": {"kernelspec": kernel}, "nbformat": 4, "nbformat_minor": 5}
    return json.dumps(made, indent=1, ensure_ascii=False) + "\n"


def executed_notebook():
    """The notebook is the page's, and its cells run in Jupyter's kernel."""
    import nbformat
    from nbclient import NotebookClient

    text = NOTEBOOK.read_text(encoding="utf-8")
    assert text == notebook(), f"{NOTEBOOK.name} is not what check.py --notebook makes of {PAGE.name}"
    made = nbformat.reads(text, as_version=4)
    NotebookClient(made, timeout=120, kernel_name="python3").execute()
    print(f"{NOTEBOOK.name}: {sum(cell.cell_type == 'code' for cell in made.cells)} cells executed")


def typed():
    """The page's examples are right for mypy --strict, by the package's own types."""
    Path("examples.py").write_text("\n".join(CODE.findall(PAGE.read_text(encoding="utf-8"))), encoding="utf-8")
    told = subprocess.run([sys.executable, "-m", "mypy", "--strict", "examples.py"], check=False, capture_output=True, text=True)
    assert told.returncode == 0, told.stdout + told.stderr
    print(f"mypy --strict: {told.stdout.strip()}")


def errors():
    """A misspelt path and a missing file are refused by name."""
    for given, name in [
        (lambda: hertzscope.run("magnet-0.61g", {"striker.sped": "0.5 m/s"}), "did you mean `speed`"),
        (lambda: hertzscope.fit("nothing.csv", "magnet-0.61g", free=["striker.speed"]), "nothing.csv"),
    ]:
        try:
            given()
        except hertzscope.HertzscopeError as error:
            assert name in str(error), error
        else:
            raise AssertionError(f"taken: {name}")


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
    """What a thousand runs keep; two threads beside each other."""
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
    if sys.argv[1] == "--notebook":
        NOTEBOOK.write_text(notebook(), encoding="utf-8")
        sys.exit()
    PROGRAM = os.path.abspath(sys.argv[1])
    os.chdir(tempfile.mkdtemp())
    for part in (page, executed_notebook, typed, errors, every_scene, ctrl_c, time_and_memory):
        part()
    print("the Python package and the program agree")
