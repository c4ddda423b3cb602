#!/usr/bin/env bash
# Lets other people's clients work with the served scope: pyvisa, pylablib, pymeasure and others, as published, and runs a project of tests with the fixture for pytest.
#
#     tests/clients/check.sh HERTZSCOPE [RECORDING.mcap]
#
# check.py does the work with the program HERTZSCOPE, and leaves the session in RECORDING.mcap if it is named. The clients are
# installed beside this script at the first call and again when requirements.txt changes; that needs the network, a later call
# does not.
#
# Exit code 0: every client reads what the recording holds; 1: something differs; 2: could not check.
set -euo pipefail

here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
environment="$here/.venv"

source "$here/../environment.sh"

[[ $# -ge 1 && -x "$1" ]] || could_not "usage: check.sh HERTZSCOPE [RECORDING.mcap]"
install_python "$environment" "$here/requirements.txt"

folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
"$environment/bin/python" -W ignore "$here/check.py" "$1" "${2:-$folder/session.mcap}"
# The package as it stands in the tree; tests/wheel/check.sh takes the installed one.
HERTZSCOPE="$(realpath "$1")" PYTHONPATH="$here/../../python" "$environment/bin/python" "$here/project.py" -p hertzscope.pytest_plugin
