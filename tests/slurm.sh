#!/bin/sh
# slurm.sh FRANA SOURCE FOLDER: an ensemble as a job array of Slurm, whose daemons run in FOLDER for the time of the test. One
# task is put back into the queue while it runs. The maps must have the bytes of a single process. Skipped (77) where Slurm is
# not installed (Debian: slurm-wlm, munge), or not as root.
set -eu
frana=$1 source=$2 work=$3

for program in munged slurmctld slurmd sbatch scontrol squeue; do
    command -v "$program" >/dev/null || { echo "$program is not here; this test is skipped"; exit 77; }
done
[ "$(id -u)" = 0 ] || { echo "Slurm's daemons need root; this test is skipped"; exit 77; }

rm -rf "$work"
mkdir -p "$work/slurm/state" "$work/slurm/spool"
cd "$work"
host=$(hostname -s)
export SLURM_CONF="$work/slurm/slurm.conf"
cat > "$SLURM_CONF" <<CONF
ClusterName=frana
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=26817
SlurmdPort=26818
SlurmUser=root
AuthInfo=socket=$work/slurm/munge.socket
StateSaveLocation=$work/slurm/state
SlurmdSpoolDir=$work/slurm/spool
SlurmctldPidFile=$work/slurm/slurmctld.pid
SlurmdPidFile=$work/slurm/slurmd.pid
SlurmctldLogFile=$work/slurm/slurmctld.log
SlurmdLogFile=$work/slurm/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=2
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
echo "CgroupPlugin=cgroup/v1" > "$work/slurm/cgroup.conf"

stop() {
    for daemon in slurmd slurmctld munged; do
        [ ! -f "slurm/$daemon.pid" ] || kill "$(cat "slurm/$daemon.pid")" 2>/dev/null || true
    done
}
trap stop EXIT
head -c 1024 /dev/urandom > slurm/munge.key
chmod 400 slurm/munge.key
munged --force --key-file="$work/slurm/munge.key" --socket="$work/slurm/munge.socket" --pid-file="$work/slurm/munged.pid" \
       --log-file="$work/slurm/munged.log" --seed-file="$work/slurm/munged.seed" >/dev/null 2>&1
slurmctld -f "$SLURM_CONF"
slurmd -f "$SLURM_CONF" -N "$host"

# The shipped ensemble, shorter; some of its releases are not there.
sed "s#\"\.\./maungawhau/#\"$source/cases/maungawhau/#" "$source/cases/ensemble/case.toml" > case.toml
sed "s/^samples = .*/samples = 120/" "$source/cases/ensemble/ensemble.toml" > ensemble.toml
cat >> ensemble.toml <<TOML
[[ensemble.vary]]
key = "release.0.outline"
distribution = "discrete"
values = ["$source/cases/maungawhau/release.geojson", "gone.geojson"]
weights = [0.98, 0.02]
TOML
"$frana" ensemble ensemble.toml --out array --slurm 4 |
    sed -e "s#exec frana#exec $frana#" -e "s/--cpus-per-task=8/--cpus-per-task=1/" > job.sh
job=$(sbatch --parsable job.sh)

# A task that runs goes back into the queue: the system kills it, and later it goes on.
requeued=no
for second in $(seq 1 600); do
    running=$(squeue -h -r -t R -j "$job" -o %i 2>/dev/null | head -n 1)
    if [ "$requeued" = no ] && [ -n "$running" ] && [ "$second" -gt 2 ]; then
        scontrol requeue "$running" && requeued=$running
    fi
    [ -n "$(squeue -h -j "$job" 2>/dev/null)" ] || break
    scontrol update NodeName="$host" State=RESUME 2>/dev/null || true
    sleep 1
done
[ -z "$(squeue -h -j "$job")" ] || { squeue; echo "the array has not ended" >&2; exit 1; }
[ "$requeued" != no ] || { echo "no task ran for long enough to be put back" >&2; exit 1; }
"$frana" ensemble --join array --quiet
"$frana" ensemble "$work/ensemble.toml" --out single --quiet --threads 2

grep -q '"failed": 0' single/ensemble.json && { echo "no run failed, as some should" >&2; exit 1; }
cmp array/runs.csv single/runs.csv
compared=1
for raster in single/rasters/*.tif; do
    cmp "$raster" "array/rasters/$(basename "$raster")"
    compared=$((compared + 1))
done
echo "task $requeued was put back; $compared files of the array and of a single process have the same bytes"
