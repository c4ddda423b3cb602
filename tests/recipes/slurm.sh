#!/usr/bin/env bash
# Runs a command in a Slurm of its own: munged, slurmctld and slurmd of Debian's packages, one node, everything in a folder that is removed.
#
#     tests/recipes/slurm.sh COMMAND [ARGUMENT...]
#
# Needs root, as slurmd does, and the packages slurm-wlm and munge. Exit code: that of the command; 2 where Slurm does not start.
set -euo pipefail

could_not() {
    echo "slurm.sh: $*" >&2
    exit 2
}

[[ "$(id -u)" = 0 ]] || could_not "slurmd starts jobs as root only"
for program in munged slurmctld slurmd sbatch sinfo; do
    PATH="$PATH:/usr/sbin" command -v "$program" > /dev/null || could_not "found no $program: apt-get install slurm-wlm munge"
done
export PATH="$PATH:/usr/sbin"

folder="$(mktemp -d)"
processes=()
stop() {
    # In the order opposite to their start; only what was started here.
    for ((i = ${#processes[@]} - 1; i >= 0; i--)); do
        kill "${processes[i]}" 2> /dev/null || true
        wait "${processes[i]}" 2> /dev/null || true
    done
    rm -rf "$folder"
}
trap stop EXIT

free_port() {
    python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])'
}

mkdir -p "$folder"/{munge,state,spool}
chmod 755 "$folder"
(umask 077 && head -c 1024 /dev/urandom > "$folder/munge/key")
munged --foreground --force --key-file="$folder/munge/key" --socket="$folder/munge/socket" --pid-file="$folder/munge/pid" \
    --log-file="$folder/munge/log" --seed-file="$folder/munge/seed" > "$folder/munge/out" 2>&1 &
processes+=($!)

host="$(hostname -s)"
cat > "$folder/slurm.conf" <<CONF
ClusterName=bench
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$(free_port)
SlurmdPort=$(free_port)
SlurmUser=root
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket=$folder/munge/socket
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
ReturnToService=2
SelectType=select/cons_tres
SchedulerParameters=sched_interval=1,batch_sched_delay=0
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=bench Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF="$folder/slurm.conf"

wait_for() {
    local what="$1"
    shift
    for ((i = 0; i < 300; i++)); do
        "$@" > /dev/null 2>&1 && return
        sleep 0.1
    done
    tail -n 20 "$folder"/*.log "$folder"/munge/log >&2 || true
    could_not "$what did not start"
}
idle() { sinfo --noheader --format=%t | grep -qx idle; }

wait_for munged test -S "$folder/munge/socket"
slurmctld -D -L "$folder/slurmctld.log" > /dev/null 2>&1 &
processes+=($!)
slurmd -D -L "$folder/slurmd.log" > /dev/null 2>&1 &
processes+=($!)
wait_for slurmd idle
"$@"
