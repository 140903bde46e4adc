#!/bin/sh
# A Slurm of this one machine, to try slurm.sh without a cluster; as root, with slurm-wlm and munge:
#     slurm_node.sh start DIR    then    export SLURM_CONF=DIR/slurm.conf    and    slurm_node.sh stop DIR
# It uses ports, a key and folders of its own below DIR, and stops no daemon but those that it started.
set -eu
action=$1 dir=$(realpath "$2")
if [ "$action" = stop ]; then
    for name in slurmd slurmctld munged; do
        if [ -e "$dir/$name.pid" ]; then kill "$(cat "$dir/$name.pid")" || true; fi
    done
    exit 0
fi
for name in munged slurmctld slurmd; do command -v "$name" >/dev/null || { echo "no $name" >&2; exit 2; }; done
mkdir -p "$dir/state" "$dir/spool" && chmod 755 "$dir"
(umask 077 && head -c 1024 /dev/urandom >"$dir/key")
munged --force --key-file="$dir/key" --socket="$dir/munge" --pid-file="$dir/munged.pid" \
    --log-file="$dir/munged.log" --seed-file="$dir/seed"
host=$(hostname -s)
cat >"$dir/slurm.conf" <<END
ClusterName=touchstone
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=${SLURM_PORT:-26817}
SlurmdPort=$((${SLURM_PORT:-26817} + 1))
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$dir/munge
CryptoType=crypto/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
StateSaveLocation=$dir/state
SlurmdSpoolDir=$dir/spool
SlurmctldPidFile=$dir/slurmctld.pid
SlurmdPidFile=$dir/slurmd.pid
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=$host Default=YES State=UP
END
slurmctld -f "$dir/slurm.conf" -L "$dir/slurmctld.log"
slurmd -f "$dir/slurm.conf" -L "$dir/slurmd.log"
