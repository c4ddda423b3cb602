"""However a test ends, its benches end with it; and nothing that a test sends disturbs the fixture."""

import os
import subprocess
import sys
import time
from pathlib import Path

import hertzscope
import pytest

#: A body of a test, with a fixture that starts benches.
ENDINGS = {
    "one bench is killed": "benches[0]._process.kill(); benches[0]._process.wait()",
    "the last bench is killed": "benches[-1]._process.kill()",
    "all benches are killed": "[bench._process.kill() for bench in benches]",
    "the process ends": "os._exit(3)",
    "the process is killed": "os.kill(os.getpid(), 9)",
    "the process aborts": "os.abort()",
    "the test fails": "assert False",
    "the test ends pytest": "pytest.exit('enough')",
    "the connection is closed": "benches[0]._control.close()",
    "a bench does not start": "start_bench('no-such-scene')",
}
TEST = "import os, pytest\ndef test(start_bench):\n    benches = [start_bench() for _ in range(3)]\n    {}\n"


def servers(mark):
    """Processes that have `mark` in their environment, but for this one."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            if mark.encode() in (folder / "environ").read_bytes() and b"serve" in (folder / "cmdline").read_bytes():
                found.append(int(folder.name))
        except OSError:
            pass
    return found


@pytest.mark.skipif(not Path("/proc/self/environ").exists(), reason="needs /proc")
@pytest.mark.parametrize("xdist", [False, True])
@pytest.mark.parametrize("ending", ENDINGS)
def test_no_server_is_left(tmp_path, ending, xdist):
    (tmp_path / "test_crash.py").write_text(TEST.format(ENDINGS[ending]))
    mark = f"ENDINGS_MARK={os.getpid()}-{tmp_path}"
    name, value = mark.split("=")
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"]
    # The package may only be on the path.
    installed = subprocess.run([sys.executable, "-m", "pytest", "--fixtures", "-q"], cwd=tmp_path, capture_output=True, text=True)
    if "start_bench" not in installed.stdout:
        command += ["-p", "hertzscope.pytest_plugin"]
    command += ["-n", "2"] if xdist else []
    subprocess.run(command, cwd=tmp_path, env={**os.environ, name: value}, capture_output=True, timeout=120)
    end = time.monotonic() + 10
    while servers(mark) and time.monotonic() < end:
        time.sleep(0.02)
    assert servers(mark) == []


@pytest.mark.parametrize("command", ["HEADER ON", "FACTORY", "*RST", "VERBOSE OFF;HEADER ON", "BENCH:FAULT \"missing\""])
def test_what_a_test_sends_does_not_disturb_the_fixture(bench, command):
    bench.write(command)
    bench.write("ACQUIRE:STATE RUN")
    assert bench.strike() == 1
    assert bench.forces()


def test_a_strike_that_never_arrives_is_reported(bench, monkeypatch):
    monkeypatch.setattr(bench._control, "query", lambda command: "0")
    with pytest.raises(TimeoutError, match="no signals of impact 1 after 0.2 s; events of the scope: .ESR"):
        bench.strike(timeout=0.2)


def test_a_bench_can_be_stopped_twice():
    bench = hertzscope.Bench()
    bench.stop()
    bench.stop()
