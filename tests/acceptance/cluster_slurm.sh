# Sourced by cluster.sh: many runs on a Slurm of two nodes that is started here, all in $out/slurm, and ended by the ids of its daemons.
#   long_lists   what listing 10^4 runs takes
#   slurm        a calibration in an array of 8 tasks: tasks killed, a node lost, time limits hit, the controller restarted; and what a
#                task takes beyond its runs

grainlaw=$(realpath "$bin/grainlaw")

long_lists() {
  local folder=$out/long-list
  rm -rf "$folder"
  mkdir -p "$folder/runs"
  jq -n '{particles: 1000, seeds: [range(1; 1001)], densities: [range(70; 79) / 100],
          tests: [{mode: "ISO", role: "calibration"}, {mode: "D2", role: "calibration"}]}' >"$folder/spec.json"
  "$grainlaw" runs "$folder/spec.json" -o "$folder" --json >"$folder/list.json"
  figure list.runs "$(jq .runs "$folder/list.json")" ">=10000"
  figure list.seconds "$(seconds_of "$grainlaw" runs "$folder/spec.json" -o "$folder")" "<=1"
  figure list.dealt_to_100_tasks_seconds "$(seconds_of "$grainlaw" runs "$folder/spec.json" -o "$folder" --array 100)" stated
  # half of them finished, as far as a list looks
  jq -r '.list[:5000][].key' "$folder/list.json" | while read -r key; do mkdir "$folder/runs/$key" && : >"$folder/runs/$key/run.json"; done
  figure list.half_finished_seconds "$(seconds_of "$grainlaw" runs "$folder/spec.json" -o "$folder")" "<=1"
}

start_node() { slurmd -N "$1" -f "$SLURM_CONF"; }
start_controller() { slurmctld -f "$SLURM_CONF"; }
pid_in() { cat "$site/$1.pid" 2>/dev/null; }
end_by_pid() { # name of a daemon
  local pid
  pid=$(pid_in "$1") && kill "${2:--TERM}" "$pid" 2>/dev/null || true
}

start_slurm() {
  local host node
  site=$out/slurm
  rm -rf "$site"
  mkdir -p "$site"/{munge,state,spool}
  chmod 700 "$site/munge"
  host=$(hostname -s)
  head -c 1024 /dev/urandom >"$site/munge/key"
  chmod 600 "$site/munge/key"
  export SLURM_CONF=$site/slurm.conf
  cat >"$SLURM_CONF" <<CONF
ClusterName=grainlaw
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=26817
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/munge
AuthInfo=socket=$site/munge/socket,cred_expire=5
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SwitchType=switch/none
MpiDefault=none
ReturnToService=2
SlurmdTimeout=20
KillWait=5
StateSaveLocation=$site/state
SlurmdSpoolDir=$site/spool/%n
SlurmdPidFile=$site/%n.pid
SlurmctldPidFile=$site/controller.pid
SlurmdLogFile=$site/%n.log
SlurmctldLogFile=$site/controller.log
NodeName=n1 NodeHostname=$host NodeAddr=127.0.0.1 Port=27001 CPUs=1 RealMemory=1000
NodeName=n2 NodeHostname=$host NodeAddr=127.0.0.1 Port=27002 CPUs=1 RealMemory=1000
PartitionName=main Nodes=n1,n2 Default=YES State=UP
CONF
  munged --force --key-file="$site/munge/key" --socket="$site/munge/socket" --pid-file="$site/munge.pid" \
    --log-file="$site/munge/log" --seed-file="$site/munge/seed" 2>/dev/null
  trap end_slurm EXIT
  start_controller
  for node in n1 n2; do start_node $node; done
  for ((i = 0; i < 60; ++i)); do
    [[ $(sinfo --noheader --Node --format=%T 2>/dev/null | grep -c idle) == 2 ]] && return
    sleep 1
  done
  echo "slurm did not start; see $site/*.log" >&2
  return 1
}

end_slurm() {
  local name
  scancel --me 2>/dev/null || true
  sleep 2
  for name in n1 n2 controller munge; do end_by_pid $name; done
}

# The processes of grainlaw that make runs of a folder now, by their locks: "PID FOLDER-OF-THE-RUN".
makers() { find "$1/runs" -path '*.lock/*' -printf '%f %h\n' 2>/dev/null | sed -nE 's/^[^,]*,([0-9]+),[^ ]* (.*)\.lock$/\1 \2/p'; }

# Whether a process runs below one of Slurm's on this node (n1, n2).
on_node() { { tr '\0' '\n' <"/proc/$1/environ"; } 2>/dev/null | grep -x "SLURMD_NODENAME=$2" >/dev/null; }

# All of a node dies at once: its daemon, then that of its job, which could still report, the script and grainlaw.
lose_node() { # folder node
  local pid chain
  for ((i = 0; i < 600; ++i)); do
    chain=
    for pid in $(makers "$1" | cut -d' ' -f1); do
      on_node "$pid" "$2" || continue
      for _ in grainlaw script slurmstepd; do
        ((pid > 1)) && chain="$pid $chain"
        pid=$(awk '/^PPid/ { print $2 }' "/proc/$pid/status" 2>/dev/null || echo 1)
      done
    done
    [[ -n $chain ]] && break
    sleep 0.1
  done
  end_by_pid "$2" -KILL
  # shellcheck disable=SC2086
  kill -KILL $chain 2>/dev/null || true
}

# Until so many runs are finished, or the watcher has ended.
until_finished() { # folder number
  until (($(find "$1/runs" -name run.json 2>/dev/null | wc -l) >= $2)) || ! kill -0 "$watcher" 2>/dev/null; do sleep 0.2; done
}

kill_one() { # folder
  local pids
  for ((i = 0; i < 300; ++i)); do
    mapfile -t pids < <(makers "$1" | cut -d' ' -f1)
    if ((${#pids[@]} > 0)) && kill -KILL "${pids[RANDOM % ${#pids[@]}]}" 2>/dev/null; then
      killed=$((killed + 1))
      return
    fi
    sleep 0.1
  done
}

slurm() {
  local folder=$out/array alone=$out/alone code=0 runs seconds
  PATH=$PATH:/usr/sbin
  if ! { command -v munged && command -v slurmctld && command -v slurmd; } >/dev/null; then
    figure slurm.installed missing stated
    return
  fi
  rm -rf "$folder" "$alone"
  # tasks of some 25 s: Slurm looks for time limits twice a minute, and warns a minute before, so half a minute after the start
  jq -n '{particles: 3000, seeds: [range(1; 6)], strain_rate: 200, densities: [0.70, 0.74, 0.78],
    tests: [{mode: "ISO", role: "calibration"}, {mode: "D2", role: "calibration"}, {mode: "UNI", density: 0.70, role: "validation"}]}' >"$out/spec.json"
  "$grainlaw" calibrate "$out/spec.json" -o "$alone" --threads 2 --quiet --json >"$out/alone.json"
  runs=$(jq .runs "$out/alone.json")
  figure slurm.alone_seconds "$(jq .seconds "$out/alone.json")" stated

  # one task with nobody else: its time, that of the process included, beyond that of its runs
  rm -rf "$out/one"
  "$grainlaw" runs "$out/spec.json" -o "$out/one" --array 8 >/dev/null
  seconds=$(seconds_of "$grainlaw" task "$out/one" 2 --threads 1)
  jq -s 'map(.cost.seconds) | add' "$out/one/runs"/*/run.json | awk -v taken="$seconds" '{ printf "%.3f", 100 * (taken / $1 - 1) }' >"$out/overhead.txt"
  figure slurm.task_seconds "$seconds" ">=5"
  figure slurm.overhead_percent "$(cat "$out/overhead.txt")" "<=2"

  start_slurm
  RANDOM=34
  local killed=0 begun=$SECONDS
  "$grainlaw" runs "$out/spec.json" -o "$folder" --array 8 --json >"$out/dealt.json"
  figure slurm.tasks "$(jq .tasks "$out/dealt.json")" ">=8"
  "$grainlaw" submit "$folder" --slurm --time 1 --json >"$out/submitted.json" 2>"$out/submit.log" &
  watcher=$!
  (while kill -0 $watcher 2>/dev/null; do find "$folder/runs" -name run.json -printf '%h %i\n' 2>/dev/null; sleep 0.5; done) >"$out/seen.txt" &

  until_finished "$folder" 2
  kill_one "$folder"
  until_finished "$folder" $((runs / 4))
  end_by_pid controller -KILL
  sleep 5
  start_controller
  until_finished "$folder" $((runs / 3))
  kill_one "$folder"
  lose_node "$folder" n2
  for ((i = 0; i < 60; ++i)); do [[ $(sinfo --noheader --nodes n2 --format=%T) == down* ]] && break; sleep 1; done
  figure slurm.lost_node_seen_seconds $i "<=59"
  start_node n2
  until_finished "$folder" $((runs / 2))
  kill_one "$folder"
  until_finished "$folder" $((2 * runs / 3))
  kill_one "$folder"
  wait $watcher || code=$?
  figure slurm.submit_exit_code $code "<=0"
  figure slurm.seconds $((SECONDS - begun)) stated
  figure slurm.killed $killed ">=4"
  figure slurm.time_limits_hit "$(cat "$folder"/tasks/task-*.log | grep -c 'grainlaw: interrupted' || true)" ">=1"
  figure slurm.starts_after_the_first "$(cat "$folder"/tasks/task-*.log | grep -c ', start [2-9]' || true)" ">=$((killed + 1))"
  figure slurm.nodes "$(sed -nE 's/^job .* \((n[12])\), start .*/\1/p' "$folder"/tasks/task-*.log | sort -u | wc -l)" ">=2"
  figure slurm.differing_parameters "$(diff <(jq 'del(.provenance)' "$alone/parameters.json") \
    <(jq 'del(.provenance)' "$folder/parameters.json") | grep -c '^[<>]' || true)" "<=0"
  figure slurm.differing_series "$(diff <(cd "$alone/dataset" && sha256sum -- *.csv) <(cd "$folder/dataset" && sha256sum -- *.csv) |
    grep -c '^[<>]' || true)" "<=0"
  figure slurm.runs "$(find "$folder/runs" -name run.json | wc -l)" ">=$runs"
  # a run that is made again gets another file
  find "$folder/runs" -name run.json -printf '%h %i\n' >>"$out/seen.txt"
  figure slurm.simulated_twice "$(sort -u "$out/seen.txt" | cut -d' ' -f1 | uniq -d | wc -l)" "<=0"
  figure slurm.locks_left "$(find "$folder" -name '*.lock' -o -name '.lock-*' | wc -l)" "<=0"
}
