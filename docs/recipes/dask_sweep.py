"""A sweep on Dask, one shard for each task; then the table.

    python dask_sweep.py grid.toml --shards 7                                      # on this machine
    python dask_sweep.py grid.toml --shards 500 --scheduler tcp://head:8786        # on a cluster

On a cluster, the folder of grid.toml must be one that all workers share, under the same path. What has been finished is kept: start it
again after anything, and only the rest is run. On machines of different kinds add `--instructions AVX2`.
"""

import argparse
import subprocess
import sys
from pathlib import Path

from dask.distributed import Client, LocalCluster, as_completed


def run_shard(arguments):
    """Runs one shard in a process of its own; its error message is the task's."""
    done = subprocess.run(arguments, capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(done.stderr.strip())


def main():
    parser = argparse.ArgumentParser(description="A hertzscope sweep on Dask")
    parser.add_argument("grid", type=Path)
    parser.add_argument("--shards", type=int, required=True)
    parser.add_argument("--scheduler", help="address of a cluster's scheduler; without it, this machine's processors")
    parser.add_argument("--instructions", help="avx512, avx2 or portable")
    parser.add_argument("--hertzscope", default="hertzscope", help="the program")
    options = parser.parse_args()

    grid = options.grid.resolve()
    sweep = [options.hertzscope, "sweep", str(grid), "--threads", "1", "--quiet"]
    if options.instructions:
        sweep += ["--instructions", options.instructions]
    shards = [[*sweep, "--shard", f"{k}/{options.shards}"] for k in range(1, options.shards + 1)]

    cluster = options.scheduler or LocalCluster(threads_per_worker=1, dashboard_address=None)
    with Client(cluster) as client:
        futures = client.map(run_shard, shards, pure=False, retries=2)
        for finished, future in enumerate(as_completed(futures), start=1):
            future.result()
            print(f"{finished} of {options.shards} shards", file=sys.stderr)
    return subprocess.run([options.hertzscope, "gather", str(grid.with_suffix(".sweep"))]).returncode


if __name__ == "__main__":
    sys.exit(main())
