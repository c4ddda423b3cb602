#!/usr/bin/env bash
# Tries the recipes of docs/recipes and docs/sweeps.md on the engines that they are for: a sweep by one process, by GNU parallel, by a Slurm
# array and by Dask gives the same bytes.
#
#     tests/recipes/check.sh HERTZSCOPE
#
# What is not installed and cannot be is skipped, and said. The Python environment is made beside this script at the first call and again when
# requirements.txt changes. Exit code 0: all that was tried agrees; 1: something differs; 2: could not check.
set -euo pipefail

here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
recipes="$here/../../docs/recipes"
environment="$here/.venv"

source "$here/../environment.sh"

[[ $# -eq 1 && -x "$1" ]] || could_not "usage: check.sh HERTZSCOPE"
"$here/install"
install_python "$environment" "$here/requirements.txt"

folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
# Jobs of another engine's user may have to get in.
chmod 755 "$folder"
mkdir "$folder/bin"
ln -s "$(realpath "$1")" "$folder/bin/hertzscope"
export PATH="$folder/bin:$environment/bin:$PATH"

# A folder of its own for an engine.
fresh() {
    mkdir "$folder/$1"
    # What Python leaves beside them has no dot in its name.
    cp "$here/grid.toml" "$recipes"/*.* "$folder/$1"
    cd "$folder/$1"
}
same() {
    cmp "$folder/one/grid.csv" grid.csv || { echo "check.sh: $1 gives other bytes than one process" >&2; exit 1; }
    echo "$1: the same bytes as one process"
}

fresh one
tables=(-o grid.csv -o grid.jsonl)
if hertzscope sweep grid.toml --quiet "${tables[@]}" -o grid.parquet 2> /dev/null; then
    python "$here/tables.py" grid.csv grid.jsonl grid.parquet
else
    echo "Parquet: skipped, this program was built without it (--features parquet)"
    hertzscope sweep grid.toml --quiet "${tables[@]}"
    python "$here/tables.py" grid.csv grid.jsonl
fi

if command -v parallel > /dev/null; then
    fresh parallel
    parallel hertzscope sweep grid.toml --threads 1 --quiet --shard {}/7 ::: 1 2 3 4 5 6 7
    hertzscope gather grid.sweep --quiet
    same "GNU parallel"
else
    echo "GNU parallel: skipped, not installed"
fi

if [[ "$(id -u)" = 0 ]] && PATH="$PATH:/usr/sbin" command -v slurmctld munged > /dev/null; then
    fresh slurm
    "$here/slurm.sh" bash -euc '
        job=$(sbatch --parsable --array=1-7 sweep.sbatch grid.toml)
        sbatch --dependency=afterany:$job --wrap "hertzscope gather grid.sweep" --wait --output=gather.out > /dev/null
    ' || { cat ./*.out >&2; could_not "Slurm did not do its part"; }
    ls grid.sweep | grep -c -- -of-7.log | grep -qx 7 || could_not "Slurm left other logs than seven: $(ls grid.sweep)"
    same "Slurm"
else
    echo "Slurm: skipped, needs root and the packages slurm-wlm and munge"
fi

fresh notebook
hertzscope run magnet-0.61g --quiet
python "$here/notebook.py" recording.ipynb

fresh dask
python dask_sweep.py grid.toml --shards 7 > /dev/null 2> dask.err || { cat dask.err >&2; exit 1; }
same "Dask"
