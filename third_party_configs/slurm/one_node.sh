#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Slurm on this machine alone, as whoever calls it, without touching the system: configuration, key, state and logs all
# lie in one folder. For trying the Snakemake profile. Needs Debian's slurm-wlm and munge.
#
# usage: one_node.sh start FOLDER     then:  export SLURM_CONF=FOLDER/slurm.conf
#        one_node.sh stop FOLDER
#
# environment: SLURM_ONE_NODE_PORT  first of two ports (default 6817)
set -euo pipefail

command=${1:-} folder=${2:-}
if [[ -z $folder || ( $command != start && $command != stop ) ]]; then
  sed -n '/^# usage/,/^set/p' "$0" | sed -e 's/^# \{0,1\}//' -e '$d' >&2
  exit 2
fi
mkdir -p "$folder"
folder=$(realpath "$folder")
export SLURM_CONF=$folder/slurm.conf
port=${SLURM_ONE_NODE_PORT:-6817}

# Ends the daemon whose number the file holds, and waits for it.
end() {
  local pid
  pid=$(cat "$folder/$1.pid" 2>/dev/null) || return 0
  kill "$pid" 2>/dev/null || return 0
  for _ in $(seq 100); do kill -0 "$pid" 2>/dev/null || return 0; sleep 0.1; done
}

stop() { for daemon in slurmd slurmctld munged; do end $daemon; done; }

write_configuration() {
  local node user memory_mb
  node=$(hostname -s) user=$(id -un)
  memory_mb=$(($(awk '/^MemTotal/ {print $2}' /proc/meminfo) / 1024 * 9 / 10))
  cat >"$SLURM_CONF" <<CONF
ClusterName=one_node
SlurmctldHost=$node(127.0.0.1)
SlurmUser=$user
SlurmdUser=$user
SlurmctldPort=$port
SlurmdPort=$((port + 1))
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
CredType=cred/munge
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
SchedulerType=sched/backfill
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
SlurmdParameters=config_overrides
ReturnToService=2
NodeName=$node NodeAddr=127.0.0.1 CPUs=$(nproc) RealMemory=$memory_mb State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
}

start() {
  mkdir -p "$folder/state" "$folder/spool"
  if [[ ! -e $folder/munge.key ]]; then
    (umask 077 && dd if=/dev/urandom of="$folder/munge.key" bs=1024 count=1 status=none)
  fi
  write_configuration
  # Munge looks at who may write to the folders above its socket; here that is the caller's own business.
  munged --force --key-file="$folder/munge.key" --socket="$folder/munge.socket" --pid-file="$folder/munged.pid" \
    --log-file="$folder/munged.log" --seed-file="$folder/munged.seed"
  slurmctld -c
  slurmd
  for _ in $(seq 100); do
    if [[ $(sinfo --noheader --format %T 2>/dev/null) == idle ]]; then
      echo "one node is ready: export SLURM_CONF=$SLURM_CONF"
      return
    fi
    sleep 0.2
  done
  echo "the node is not ready; see the logs in $folder" >&2
  tail -n 5 "$folder"/*.log >&2
  stop
  exit 1
}

"$command"
