#!/bin/sh
# hooke sweep --slurm against a Slurm of its own on this host: an array runs the cases, their databases are merged, and
# the results are those of the same sweep without Slurm. A sweep of 50 cases is cancelled while it runs and goes on; the same
# plan by GNU parallel gives the same results, and Dask does one, too.
set -u
cd "$(dirname "$0")/../.." || exit 1
PATH=$PATH:/usr/sbin:/sbin
root=$PWD
hooke=$PWD/build/hooke
scene=$PWD/scripts/scenes/circle.lua

skip() { echo "skipped: tests/long/slurm.sh"; echo "($*)"; echo "0 passed, 0 failed, 1 skipped"; exit 0; }
[ "$(id -u)" = 0 ] || skip "slurmd starts as root only"
for program in sbatch squeue sinfo slurmctld slurmd munged parallel; do
  command -v $program >/dev/null 2>&1 || { echo "FAILED: $program is not installed: tools/install-deps systems"; exit 1; }
done

dir=$(mktemp -d /tmp/hooke-slurm-XXXXXX)
chmod 755 "$dir"
started=
stop() {
  for file in "$dir"/*.pid; do
    [ -s "$file" ] && kill "$(cat "$file")" 2>/dev/null
  done
  sleep 1
  # shellcheck disable=SC2086
  [ -n "$started" ] && kill -9 $started 2>/dev/null
  rm -rf "$dir"
}
trap stop EXIT
trap 'exit 1' INT TERM

# ---- munge, the controller and one node, in the folder ----

head -c 1024 /dev/urandom >"$dir/munge.key"
chmod 400 "$dir/munge.key"
munged --force --foreground --key-file="$dir/munge.key" --socket="$dir/munge.socket" --pid-file="$dir/munged.pid" \
  --log-file="$dir/munged.log" --seed-file="$dir/munge.seed" >"$dir/munged.out" 2>&1 &
started="$started $!"

port=$((20000 + $$ % 20000))
node=$(hostname -s)
export SLURM_CONF="$dir/slurm.conf"
cat >"$SLURM_CONF" <<CONF
ClusterName=hooke
SlurmctldHost=$node(127.0.0.1)
SlurmUser=root
SlurmdUser=root
SlurmctldPort=$port
SlurmdPort=$((port + 1))
AuthType=auth/munge
AuthInfo=socket=$dir/munge.socket
CredType=cred/munge
StateSaveLocation=$dir/state
SlurmdSpoolDir=$dir/spool
SlurmctldPidFile=$dir/slurmctld.pid
SlurmdPidFile=$dir/slurmd.pid
SlurmctldLogFile=$dir/slurmctld.log
SlurmdLogFile=$dir/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SwitchType=switch/none
MpiDefault=none
SchedulerParameters=sched_interval=1,batch_sched_delay=0
ReturnToService=2
NodeName=$node NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
mkdir -p "$dir/state" "$dir/spool"

wait_for() { # seconds, command...
  k=$(($1 * 5))
  shift
  while ! "$@" >/dev/null 2>&1; do
    k=$((k - 1))
    [ $k -gt 0 ] || return 1
    sleep 0.2
  done
}
idle() { sinfo -h -o %t | grep -q '^\(idle\|mix\|alloc\)'; }

logs() { (cd "$dir" && tail -n 3 "$@" 2>&1); }
wait_for 10 test -S "$dir/munge.socket" || skip "munged does not start: $(logs munged.out munged.log)"
slurmctld -D >"$dir/slurmctld.out" 2>&1 &
started="$started $!"
slurmd -D -N "$node" >"$dir/slurmd.out" 2>&1 &
started="$started $!"
wait_for 30 idle || skip "Slurm does not start: $(logs slurmctld.out slurmctld.log slurmd.log)"

# ---- the sweep ----

fail() {
  echo "FAILED: $*"
  for log in "$dir"/*.log "$dir"/*.out "$dir"/a.db.parts/*.log; do
    [ -s "$log" ] && echo "== $log" && tail -n 5 "$log"
  done
  echo "0 passed, 1 failed, 0 skipped"
  exit 1
}
cd "$dir" || exit 1
sweep="$hooke sweep $scene --dt 1e-3..1e-2:log:5 --integrators leapfrog,rk4 --quiet"

$sweep --db a.db --slurm --tasks 3 --wait --csv a.csv || fail "exit code $? with --slurm"
$sweep --db b.db --csv b.csv || fail "exit code $? without"
[ "$(wc -l <a.csv)" = 11 ] || fail "$(wc -l <a.csv) lines instead of 11 in a.csv"
# Case, settings, verdict, time reached, and at the end the measure: all but what the clock says.
for file in a b; do cut -d, -f1-8,19 $file.csv >$file.same; done
diff a.same b.same >&2 || fail "other results with Slurm than without"
[ "$(ls a.db.parts/*.db | wc -l)" = 3 ] || fail "not three databases of tasks"

# Nothing is left to do; without the merged database it is in the tasks' ones.
$sweep --db a.db --slurm --wait --resume || fail "exit code $? with nothing to do"
[ "$(ls a.db.parts/*.db | wc -l)" = 3 ] || fail "done cases were submitted again"
rm -f a.db a.db-wal a.db-shm
$sweep --db a.db --report --csv c.csv || fail "exit code $? with --report"
cmp a.csv c.csv >&2 || fail "the tasks' databases do not hold what the merged one held"

# An array that is cancelled at some point: the next one does what is missing.
$sweep --db c.db --slurm --tasks 5 2>c.said || fail "exit code $? of the array to be cancelled"
scancel "$(sed 's/.*Slurm job \([0-9]*\).*/\1/' c.said)" || fail "cannot cancel: $(cat c.said)"
$sweep --db c.db --slurm --tasks 2 --wait --resume --csv d.csv || fail "exit code $? after the cancelled array"
cut -d, -f1-8,19 d.csv >d.same
diff d.same b.same >&2 || fail "other results after a cancelled array"

# ---- fifty cases, cancelled while they run ----

# Some 6 s of a processor, most of it to start them; the first take longest.
fifty="$hooke sweep $scene --dt 5e-5..1e-3:log:25 --integrators leapfrog,rk4 --quiet"
same() { cut -d, -f1-8,19 "$1.csv" >"$1.same" && diff "$1.same" whole.same >&2; }
done_in() { $fifty --db "$1.db" --report --csv "$1.part.csv" >/dev/null && echo $(($(grep -c ',ok,' "$1.part.csv"))); }
$fifty --db whole.db --csv whole.csv || fail "exit code $? of fifty cases without Slurm"
[ "$(wc -l <whole.csv)" = 51 ] || fail "$(wc -l <whole.csv) lines instead of 51"
cut -d, -f1-8,19 whole.csv >whole.same

$fifty --db e.db --slurm --tasks 10 2>e.said || fail "exit code $? of the fifty"
job=$(sed 's/.*Slurm job \([0-9]*\).*/\1/' e.said)
some() { [ "$(done_in e)" -ge 2 ]; }
wait_for 60 some || fail "no case is done after 60 s: $(cat e.said)"
scancel "$job" || fail "cannot cancel: $(cat e.said)"
gone() { [ -z "$(squeue -h)" ]; }
wait_for 30 gone || fail "the array is not gone after 30 s: $(squeue)"
count=$(done_in e)
[ "$count" -lt 50 ] || fail "all of the cases were done before the array was cancelled: $count"
$fifty --db e.db --slurm --tasks 4 --wait --resume --csv e.csv || fail "exit code $? of what was left"
same e || fail "other results after fifty cases were cancelled at $count"

# ---- without a cluster ----

$fifty --db f.db --print-cases | cut -f1 | parallel --jobs 2 "$fifty --db f.db --case {}" >parallel.out 2>&1 || fail "exit code $? of GNU parallel"
$fifty --db f.db --report --csv f.csv || fail "exit code $? of the report"
same f || fail "other results by GNU parallel"

# The program by Dask of scripts/sweeps/README.md, as it stands there.
dask=
for python in python3 /usr/bin/python3; do [ -n "$dask" ] || ! $python -c 'import distributed' 2>/dev/null || dask=$python; done
if [ -n "$dask" ]; then
  sed -n '/^```python$/,/^```$/p' "$root/scripts/sweeps/README.md" | sed '/^```/d' >plan.py
  cp "$scene" .
  echo 'return hooke.sweep { scene = "circle.lua", dt = { 1e-3, 1e-2 }, integrators = { "leapfrog", "rk4" } }' >s.lua
  PATH=$(dirname "$hooke"):$PATH timeout 120 $dask plan.py >dask.out 2>&1 || fail "exit code $? of Dask: $(tail -n 5 dask.out)"
  $hooke sweep s.lua --report --csv dask.csv >/dev/null || fail "exit code $? of the report"
  [ "$(grep -c '^[0-9]*,circle,' dask.csv)" = 4 ] && [ "$(ls part?.db | wc -l)" = 4 ] || fail "not four cases by Dask: $(cat dask.csv)"
  echo "four cases by Dask"
else
  echo "python3 has no Dask: its sweep is not tried"
fi

echo "fifty cases, cancelled when $count were done"
echo "1 passed, 0 failed, 0 skipped"
