#!/usr/bin/env bash
# Builds the wheel, installs it in an empty Python environment, and lets the program that is there examine itself, run, and execute those
# examples of the README and of docs/ that take long without optimisation; runs the project of tests with the fixtures for pytest, too.
#
#     tests/wheel/check.sh
#
# `tests/run --full` calls it. It compiles for minutes, with the profile `wheel`. Exit code 0: installed and sound; 1: not; 2: could not check.
set -euo pipefail

here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
environment="$here/.venv"
source "$here/../environment.sh"

install_python "$environment" "$here/requirements.txt"
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
(cd "$here/../.." && "$environment/bin/maturin" build --profile wheel --locked --quiet --out "$folder")
python3 -m venv "$folder/venv"
install_python "$here/../python/.venv" "$here/../python/requirements.txt"
"$folder/venv/bin/python" -m pip install --quiet --disable-pip-version-check --no-index --no-deps "$folder"/hertzscope-*.whl
echo "installed $(basename "$folder"/hertzscope-*.whl)"
# What is compiled in travels under its own licences.
ls "$folder"/venv/lib/python3.*/site-packages/hertzscope-*.dist-info/licenses/THIRD-PARTY.txt > /dev/null
mkdir -p "$folder/tests/recipes"
cp "$here/../recipes/hundred-thousand.toml" "$folder/tests/recipes"
# Only what is in the environment, and nothing of the source tree.
cd "$folder"
# NumPy and what else the package takes where it is there.
echo "$(echo "$here"/../python/.venv/lib/python3.*/site-packages)" > "$(echo "$folder"/venv/lib/python3.*/site-packages)/others.pth"
export PATH="$folder/venv/bin:/usr/bin:/bin"
[[ "$(command -v hertzscope)" = "$folder/venv/bin/hertzscope" ]] || could_not "the program is not on the path"
hertzscope doctor
hertzscope run --quiet
[[ -s magnet-0.61g.mcap ]] || { echo "check.sh: no recording" >&2; exit 1; }

MPLBACKEND=Agg "$folder/venv/bin/python" "$here/../python/check.py" "$folder/venv/bin/hertzscope"

# pytest finds the fixtures by the package's entry point, and these the program on the path.
install_python "$here/../clients/.venv" "$here/../clients/requirements.txt"
PYTHONPATH="$(echo "$folder"/venv/lib/python3.*/site-packages)" "$here/../clients/.venv/bin/python" "$here/../clients/project.py"

while read -r command; do
    started=$SECONDS
    $command > printed 2>&1 || { cat printed >&2; echo "check.sh: failed: $command" >&2; exit 1; }
    echo "$((SECONDS - started)) s  $command"
done << 'COMMANDS'
hertzscope paper -o paper
hertzscope tunability --plot map.png
hertzscope hard-cases
hertzscope cost --quiet
hertzscope calibrate --simulate pzt-5a-710pf --repeat 1000
hertzscope sweep tests/recipes/hundred-thousand.toml --folder hundred-thousand.sweep -o hundred-thousand.csv
hertzscope gather hundred-thousand.sweep
COMMANDS
