"""Makes a project of its own and runs its tests with pytest, ten at a time: the pages' code, and `project/`.

Usage: project.py [PYTEST OPTION...]; `-p hertzscope.pytest_plugin` where the package is on the path but not installed.

Prints how long benches take to start. Exit code: pytest's.
"""

import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import hertzscope

HERE = Path(__file__).resolve().parent
PAGE = HERE.parents[1] / "docs" / "lab-code.md"
BLOCK = re.compile(r"```python tests/clients/project.py\n(.*?)```", re.DOTALL)


def main():
    times = []
    for _ in range(20):
        began = time.perf_counter()
        bench = hertzscope.Bench()
        times.append(1e3 * (time.perf_counter() - began))
        bench.stop()
    print(f"a bench starts in {statistics.median(times):.0f} ms, at most {max(times):.0f} ms (20 starts)", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        assert PAGE.name == "lab-code.md"
        blocks = BLOCK.findall(PAGE.read_text())
        (Path(folder) / "test_page.py").write_text("\n\n".join(blocks))
        # The lab code under test, for the other tests.
        (Path(folder) / "lab.py").write_text(blocks[0])
        for file in (HERE / "project").glob("*.py"):
            shutil.copy(file, folder)
        pytest = [sys.executable, "-m", "pytest", "-q", "-n", "10", "--strict-markers", "-p", "no:cacheprovider"]
        return subprocess.run(pytest + sys.argv[1:], cwd=folder).returncode


if __name__ == "__main__":
    sys.exit(main())
