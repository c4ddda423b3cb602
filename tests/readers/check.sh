#!/usr/bin/env bash
# Holds a recording against other people's readers: a file that only its own writer can read is no recording.
#
#     tests/readers/check.sh [--rerun] RECORDING.mcap
#
# check.py uses the Python readers, check.mjs the JavaScript ones. With --rerun, the Rerun viewer's importer
# reads the file as well (another 170 MB to install). What they need is installed beside this script at the
# first call and again when a lock file changes; that needs the network, a later call does not.
#
# Exit code 0: every reader agrees; 1: at least one check failed; 2: could not check.
set -euo pipefail

here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
environment="$here/.venv"

source "$here/../environment.sh"

usage="usage: check.sh [--rerun] RECORDING.mcap"
with_rerun=no
if [[ "${1-}" == --rerun ]]; then
    with_rerun=yes
    shift
fi
[[ $# -eq 1 ]] || could_not "$usage"
recording="$1"
[[ -f "$recording" && -r "$recording" ]] || could_not "no such file: $recording ($usage)"

for program in python3 node npm; do
    command -v "$program" > /dev/null || could_not "$program is missing: install it, or run where it is there"
done

install_python "$environment" "$here/requirements.txt"
install_node "$here"

failed=no
# A checker's exit code 1 is an answer; any other than 0 and 1 is not.
run() {
    local title="$1" code=0
    shift
    echo "== $title"
    "$@" || code=$?
    case "$code" in
        0) ;;
        1) failed=yes ;;
        *) could_not "$title ended with exit code $code" ;;
    esac
}

run "Python: mcap, mcap-protobuf-support" "$environment/bin/python" "$here/check.py" "$recording"
run "JavaScript: @mcap/core, @mcap/support" node "$here/check.mjs" "$recording"

# Rerun keeps settings and counts its users; both stay out of the user's own.
rerun() {
    XDG_CONFIG_HOME="$environment/config" NO_COLOR=1 "$environment/bin/rerun" "$@"
}

# Rerun 0.41 ends with 0 even when it has found something, so that its words decide as well. `check` looks at
# the order of messages, `convert` decodes them.
rerun_check() {
    local code=0 output
    output="$(rerun mcap check --full "$recording" 2>&1)" || code=1
    echo "$output"
    output="$output
$(rerun mcap convert "$recording" -o "$environment/converted.rrd" 2>&1)" || code=1
    rm -f "$environment/converted.rrd"
    grep -E ' ERROR ' <<< "$output" && code=1
    grep -q 'Processed [1-9][0-9]* messages' <<< "$output" || code=1
    grep -q '^PROBLEM' <<< "$output" && code=1
    return "$code"
}

if [[ "$with_rerun" == yes ]]; then
    install_python "$environment" "$here/requirements-rerun.txt"
    rerun analytics disable > /dev/null 2>&1 || could_not "rerun does not start"
    run "Rerun: mcap check, mcap convert" rerun_check
fi

[[ "$failed" == no ]] || exit 1
echo "all readers agree"
