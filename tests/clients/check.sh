#!/usr/bin/env bash
# Lets other people's clients work with the served scope: pyvisa, pylablib and pymeasure, as published.
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

could_not() {
    echo "check.sh: $*" >&2
    exit 2
}

[[ $# -ge 1 && -x "$1" ]] || could_not "usage: check.sh HERTZSCOPE [RECORDING.mcap]"
python3 -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
    || could_not "python3 is older than 3.11, which the clients need"

stamp="$({ python3 --version; cat "$here/requirements.txt"; } | sha256sum)"
# The stamp is written last, so that an interrupted installation does not count.
if [[ "$(cat "$environment/.stamp" 2> /dev/null)" != "$stamp" ]]; then
    python3 -m venv --clear "$environment" || could_not "python3 -m venv failed: install its package (python3-venv)"
    "$environment/bin/python" -m pip install --quiet --disable-pip-version-check --only-binary :all: --no-deps \
        --requirement "$here/requirements.txt" >&2 || could_not "pip could not install requirements.txt"
    echo "$stamp" > "$environment/.stamp"
fi

folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
"$environment/bin/python" -W ignore "$here/check.py" "$1" "${2:-$folder/session.mcap}"
