#!/bin/bash
# A sweep as a job array of a real Slurm: munged, slurmctld and slurmd on this machine, with all
# their files in a folder of their own. The merged table must equal that of one process.
#
#   slurm.sh PROGRAM FOLDER
#
# Needs root (slurmd starts jobs as other users) and Debian's slurm-wlm and munge; skipped without.
set -eu
program=$1
folder=$2
skip() { echo "skipped: $*"; exit 0; }
[ "$(id -u)" = 0 ] || skip "slurmd needs root"
for tool in munged slurmctld slurmd sbatch squeue; do
    PATH=$PATH:/usr/sbin command -v $tool >/dev/null || skip "$tool is not installed (slurm-wlm, munge)"
done
PATH=$(dirname "$program"):$PATH:/usr/sbin
rm -rf "$folder"
mkdir -p "$folder"/{state,spool,log}
chmod 755 "$folder"
host=$(hostname -s)

finish() {
    for daemon in slurmd slurmctld munged; do
        [ -s "$folder/$daemon.pid" ] && kill "$(cat "$folder/$daemon.pid")" 2>/dev/null || true
    done
}
trap finish EXIT

dd if=/dev/urandom of="$folder/munge.key" bs=128 count=1 status=none
chmod 600 "$folder/munge.key"
munged --force --key-file="$folder/munge.key" --socket="$folder/munge.socket" \
    --pid-file="$folder/munged.pid" --log-file="$folder/log/munged" \
    --seed-file="$folder/munge.seed" || skip "munged does not start here"
cat >"$folder/slurm.conf" <<END
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
CryptoType=crypto/munge
SlurmctldPort=26817
SlurmdPort=26818
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/log/slurmctld
SlurmdLogFile=$folder/log/slurmd
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=2
SchedulerParameters=sched_interval=1
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=main Nodes=$host Default=YES MaxTime=INFINITE State=UP
END
export SLURM_CONF=$folder/slurm.conf
slurmctld -f "$SLURM_CONF" || skip "slurmctld does not start here"
slurmd -f "$SLURM_CONF" || skip "slurmd does not start here: $(tail -1 "$folder/log/slurmd")"
for _ in $(seq 30); do
    sinfo -h -o %t 2>/dev/null | grep -q idle && break
    sleep 1
done
sinfo -h -o %t | grep -q idle || skip "the node does not come up: $(tail -1 "$folder/log/slurmd")"
sinfo

cd "$folder"
cat >sweep.toml <<'END'
outputs = ["plane_albedo", "spherical_albedo"]
chunk = 2
[scene]
base = "hg:{albedo},{g}"
[axes]
albedo = "0.1:0.9:9 linear"
g = [0, 0.3, 0.6]
mu_in = [0.5, 1]
wavelength_nm = 550
END
table=table.csv
[ "${MIEBRDF_TABLE_KIND:-}" = "" ] || table=table.$MIEBRDF_TABLE_KIND
miebrdf sweep sweep.toml -o "one-$table"
miebrdf sweep sweep.toml -o "$table" --sbatch 4 >table.sbatch
job=$(sbatch --parsable --cpus-per-task=1 table.sbatch)
sbatch --array=1 --cpus-per-task=1 --dependency=afterok:"$job" table.sbatch merge
for _ in $(seq 120); do
    [ -z "$(squeue -h)" ] && break
    sleep 1
done
squeue
cat ./*.log
cmp "$table" "one-$table"
echo "4 tasks of Slurm $(sinfo --version) and a merge: the table equals that of one process"
