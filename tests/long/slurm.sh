#!/usr/bin/env bash
# A dataset run on a real Slurm of one node: four tasks of an array, of which one is killed and requeued.  What is merged is what one run makes.
#
# usage: slurm.sh SHERD      (as root, which starts the daemons; installs Debian's slurm-wlm and munge where they are missing)
set -euo pipefail
sherd=$(realpath "$1")
here=$(realpath "$(dirname "$0")/../..")
if ! command -v slurmctld munged > /dev/null; then
  DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends slurm-wlm munge > /dev/null
fi

work=$(mktemp -d)
chmod 755 "$work"
pids=()
cleanup() {
  status=$?
  [ "$status" -eq 0 ] || tail -n 20 "$work"/*.log >&2
  [ ${#pids[@]} -eq 0 ] || kill "${pids[@]}" 2> /dev/null || true
  pkill -f "$work/munge.socket" 2> /dev/null || true
  rm -rf "$work"
}
trap cleanup EXIT

# munge, with a key, a socket and folders of its own
install -d -o munge -g munge -m 711 "$work/munge"
dd if=/dev/urandom of="$work/munge/key" bs=1024 count=1 status=none
chown munge:munge "$work/munge/key" && chmod 400 "$work/munge/key"
setpriv --reuid=munge --regid=munge --clear-groups munged --force --key-file="$work/munge/key" --socket="$work/munge/munge.socket" \
  --pid-file="$work/munge/pid" --seed-file="$work/munge/seed" --log-file="$work/munge/munged.log"
pids+=("$(cat "$work/munge/pid")")

host=$(hostname -s)
mkdir "$work/spool" "$work/state"
cat > "$work/slurm.conf" << END
ClusterName=sherd
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=16817
SlurmdPort=16818
AuthType=auth/munge
AuthInfo=socket=$work/munge/munge.socket
SlurmUser=root
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=1,sched_interval=2,requeue_delay=1
MpiDefault=none
ReturnToService=2
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=main Nodes=$host Default=YES MaxTime=INFINITE State=UP
END
: > "$work/cgroup.conf"
export SLURM_CONF=$work/slurm.conf
slurmctld -D > "$work/slurmctld.out.log" 2>&1 &
pids+=($!)
slurmd -D -N "$host" > "$work/slurmd.out.log" 2>&1 &
pids+=($!)
for _ in $(seq 60); do
  sinfo -h -o %T 2> /dev/null | grep -q idle && break
  sleep 1
done
sinfo -h -o %T | grep -q idle

# eight balls of different sizes
/usr/bin/python3 - "$here/tests/cli" "$work/library" << 'END'
import os, sys
os.environ.setdefault("SHERD_BIN", "")
sys.path.insert(0, sys.argv[1])
from cli_test import sphere, write_obj
os.mkdir(sys.argv[2])
for i in range(8):
    write_obj(f"{sys.argv[2]}/ball{i}.obj", sphere(rows=24 + 4 * i, columns=48))
END

options=(--resolution 64 --pieces 2..6 --repeats 6..4 --points 64)
export OCL_ICD_VENDORS=pocl.icd SHERD=$sherd
"$sherd" dataset "$work/library" -o "$work/one" "${options[@]}" --quiet
cd "$work"
job=$(sbatch --parsable --array=1-4 --output="$work/task-%a.log" "$here/tools/slurm/dataset.sbatch" "$work/library" "$work/many" "${options[@]}")

# Kill one task once it has done something, as a machine that dies would.
for _ in $(seq 120); do
  task=$(pgrep -f "dataset .*--shard [0-9]*/4" | head -n 1 || true)
  [ -n "$task" ] && [ -n "$(find "$work/many/journal" -size +1k 2> /dev/null | head -n 1)" ] && break
  sleep 0.1
done
shard=$(tr '\0' ' ' < "/proc/$task/cmdline" | grep -oE -- '--shard [0-9]+' | grep -oE '[0-9]+')
kill -KILL "$task"
scontrol requeue "${job}_$shard"
echo "killed and requeued task $shard of job $job"

for _ in $(seq 300); do
  [ -z "$(squeue -h -j "$job" 2> /dev/null)" ] && break
  sleep 1
done
[ -z "$(squeue -h -j "$job")" ]
"$sherd" merge "$work/many"
diff -r --exclude=journal --exclude='run*.json' --exclude=report.html "$work/one" "$work/many"
echo "slurm: four tasks made what one run makes, $(find "$work/many/objects" -type f | wc -l) files"
