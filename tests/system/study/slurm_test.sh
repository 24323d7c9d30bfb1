#!/usr/bin/env bash
# slurm_test.sh BIN_FOLDER: a study on Slurm gives the tables of the local one, also when a node dies in the middle; so does
# an experiment, a synthesis of data and a sweep of trainings. Starts a controller and two nodes of its own on loopback.
set -euo pipefail
((EUID == 0)) || { printf 'skipped: slurmd needs root\n' && exit 77; }
bin=$(cd "$1" && pwd)
work=$(mktemp -d)
pids=()
cleanup() {
  local name
  for name in n1 n2 slurmctld munged; do [[ ! -s $work/$name.pid ]] || kill "$(<"$work/$name.pid")" 2>/dev/null || true; done
  ((${#pids[@]} == 0)) || kill "${pids[@]}" 2>/dev/null || true
  rm -rf "$work"
}
trap cleanup EXIT
fail() { printf '%s\n' "$*" && exit 1; }
wait_until() {  # wait_until SECONDS COMMAND...
  local end=$((SECONDS + $1))
  shift
  until "$@"; do
    ((SECONDS < end)) || return 1
    read -rt 0.1 <> <(:) || true
  done
}

host=$(uname -n) me=$(id -un) port=$((20000 + RANDOM % 10000))
mkdir -m 700 "$work/munge"
mkdir "$work/state" "$work/n1" "$work/n2"
(umask 077 && head -c 128 /dev/urandom >"$work/munge/key")
munged --force --socket="$work/munge/socket" --key-file="$work/munge/key" --pid-file="$work/munged.pid" \
  --log-file="$work/munge/log" --seed-file="$work/munge/seed"
cat >"$work/slurm.conf" <<CONF
ClusterName=test
SlurmctldHost=${host%%.*}(127.0.0.1)
SlurmctldPort=$port
AuthType=auth/munge
AuthInfo=socket=$work/munge/socket,cred_expire=5
SlurmUser=$me
SlurmdUser=$me
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/%n
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/%n.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SlurmdTimeout=5
ReturnToService=2
SchedulerParameters=batch_sched_delay=0,sched_interval=1
NodeName=n1 NodeHostname=${host%%.*} NodeAddr=127.0.0.1 Port=$((port + 1)) CPUs=1
NodeName=n2 NodeHostname=${host%%.*} NodeAddr=127.0.0.1 Port=$((port + 2)) CPUs=1
PartitionName=all Nodes=n1,n2 Default=YES State=UP
CONF
export SLURM_CONF=$work/slurm.conf
printf 'CgroupPlugin=cgroup/v1\n' >"$work/cgroup.conf"  # or slurmd looks for a file system of cgroups, which not every container has
slurmctld -c
for node in n1 n2; do slurmd -N "$node"; done
idle() { [[ $(sinfo -h -o %t%D) == idle2 ]]; }
wait_until 30 idle || { printf 'skipped: Slurm does not start here: %s\n' "$(tail -n 5 "$work"/*.log)" && exit 77; }

cd "$work"
study=("$bin/conav-study" --operators 2 --layouts 1 --methods 'ig-mcts,instruction' --references none --seed 3)
"${study[@]}" --jobs 2 --out here >here.txt 2>&1 || fail "the local study: $(cat here.txt)"
"${study[@]}" --slurm --out there >there.txt 2>&1 &
pids+=($!)
# Of the job on the second node.
piece_on_n2() {
  for piece in $(pgrep -f "^$bin/conav-study.* --piece"); do
    if grep -qz '^SLURMD_NODENAME=n2$' "/proc/$piece/environ"; then return; fi
  done
  return 1
}
wait_until 30 piece_on_n2 || fail "nothing runs on the second node: $(cat there.txt)"
# As a host that loses its power: the daemon, the job's keeper and the job say no goodbye.
kill -9 "$(<n2.pid)" "$(ps -o ppid= -p "$piece" | tr -d ' ')" "$piece"
wait "${pids[0]}" || fail "the study on Slurm: $(cat there.txt there/slurm/*.out)"
for table in here/measures/*.csv; do
  case $table in *_ms.csv | *time*.csv) continue ;; esac
  diff "$table" "there/${table#here/}" || fail "$table differs"
done
grep -q 'Requeuing JobId' slurmctld.log || fail "no job was queued again: $(cat slurmctld.log)"
grep -q "Slurm job" there.txt || fail "no progress: $(cat there.txt)"

experiment=("$bin/conav-experiment" search --seeds 3 --operators careful --variants single-100 --model glpf)
"${experiment[@]}" --csv here.csv >/dev/null 2>&1 || fail "the local experiment"
"${experiment[@]}" --csv there.csv --records mazes --slurm >mazes.txt 2>&1 || fail "the experiment on Slurm: $(cat mazes.txt)"
diff here.csv there.csv || fail "the experiment on Slurm differs"
grep -q "Slurm job" mazes.txt || fail "no jobs: $(cat mazes.txt)"
(($(find mazes/pieces -name '*.json' | wc -l) == 3)) || fail "records of the jobs are missing"

dataset=("$bin/conav-dataset" synthesize --trajectories 70 --preset 9x9)
"${dataset[@]}" --out here.pb.zst >/dev/null 2>&1 || fail "the local data set"
"${dataset[@]}" --out there.pb.zst --records waves --slurm >waves.txt 2>&1 || fail "the data set on Slurm: $(cat waves.txt)"
cmp here.pb.zst there.pb.zst || fail "the data set of Slurm differs"
(($(find waves/pieces -name '*.pb.zst' | wc -l) == 2)) || fail "records of the data set's jobs are missing"

sweep=("$bin/conav-train" --data here.pb.zst --width 16 --patience 0 --epochs 1 --threads 1 --sweep 'seed=1..2')
"${sweep[@]}" --out here.nhpm --records local >/dev/null 2>&1 || fail "the local sweep"
"${sweep[@]}" --out there.nhpm --records swept --slurm >swept.txt 2>&1 || fail "the sweep on Slurm: $(cat swept.txt)"
cmp here.nhpm there.nhpm || fail "the best weights of Slurm differ"
grep -q "Slurm job" swept.txt || fail "no jobs: $(cat swept.txt)"
