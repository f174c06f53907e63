#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The whole story without a screen and without a robot: visit targets uncorrected, record a session,
# retrain as a user does, visit the same targets corrected, compare. Called by `./run demo`, in the
# built environment. Exit code 0 only if the error is below a fifth of what it was.
set -euo pipefail
shopt -s extglob

usage() {
  cat <<'TEXT'
usage: ./run demo [OPTION...]

  --json J          write the table's numbers to J as JSON
  --output DIR      write bags, model and logs to DIR (default: output/demo-TIME in this package)
  --targets N       targets that are visited before and after (default 20)
  --trajectories N  motions that are recorded for training (default 60)
  --clock-rate K    simulated seconds per real second, at most (default 3)
  --seed S          of the noise and of all motions (default 1)
TEXT
}

refuse() {
  printf 'demo: %s\n' "$*" >&2
  exit 2
}

package=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd -P)
arm=/raven/left
json='' output='' targets=20 trajectories=60 clock_rate=3 seed=1
while (($#)); do
  case $1 in
    --json | --output | --targets | --trajectories | --clock-rate | --seed)
      (($# > 1)) || refuse "$1 needs a value"
      variable=${1#--}
      printf -v "${variable//-/_}" '%s' "$2"
      shift 2
      ;;
    -h | --help)
      usage
      exit 0
      ;;
    *)
      usage >&2
      refuse "unknown option '$1'"
      ;;
  esac
done
for number in "$targets" "$trajectories" "$seed"; do
  [[ $number =~ ^[0-9]{1,6}$ ]] || refuse "'$number' is not a whole number"
done
[[ $clock_rate =~ ^[0-9]+(\.[0-9]+)?$ ]] || refuse "--clock-rate '$clock_rate' is not a number"
command -v roslaunch >/dev/null || refuse "roslaunch is not in PATH; use ./run demo"
if [[ -n $json ]]; then
  [[ -d $(dirname -- "$json") ]] || refuse "--json $json: there is no such folder"
  json=$(cd -- "$(dirname -- "$json")" && pwd -P)/$(basename -- "$json")
fi
output=${output:-$package/output/demo-$(date +%Y%m%dT%H%M%S)}
mkdir -p -- "$output"
output=$(cd -- "$output" && pwd -P)
json=${json:-$output/demo.json}
log=$output/nodes.log
progress=$output/ros/progress.csv

# --- what is shown --------------------------------------------------------------------------------
say() { printf '[%3d s] %s\n' "$SECONDS" "$*"; }
indent() { sed 's/^/        /'; }

fail() {
  say "FAILED: $*"
  say "the last lines of $log:"
  tail -n 20 -- "$log" 2>/dev/null | indent
  exit 1
}

# Passes on what the planner says, and every warning, while LEADER lives.
relay_log() {
  local line severity node message
  tail -n 0 --pid="$1" -F -- "$log" 2>/dev/null | while read -r line; do
    line=${line//$'\e'\[+([0-9])m/} # colours
    read -r severity node message <<<"$line"
    case $severity:$node in
      INFO:*/planner) say "  planner: $message" ;;
      WARN:* | ERROR:* | FATAL:*) say "  ${node##*/}: $severity: $message" ;;
    esac
  done
}

# Passes on the trainer's phases and every tenth of its way, while LEADER lives. The first line of
# the file names the columns of all others.
relay_progress() {
  local i phase fraction tenth last=
  local -a values=()
  local -A column=()
  tail -n +1 --pid="$1" -F -- "$progress" 2>/dev/null |
    while IFS=, read -r -a values; do
      if [[ ${values[0]-} == %* ]]; then
        for i in "${!values[@]}"; do column[${values[i]}]=$i; done
        continue
      fi
      phase=${values[${column[field.phase]}]-}
      fraction=${values[${column[field.fraction]}]-}
      [[ -n $phase ]] || continue # it is idle
      case $fraction in
        0.*) tenth=${fraction:2:1} ;;
        1 | 1.*) tenth=10 ;;
        *) tenth=0 ;; # 0, or as small as 1e-05
      esac
      [[ $phase$tenth != "$last" ]] || continue
      say "  trainer: $phase, $((10 * tenth)) % done"
      last=$phase$tenth
    done
}

# --- processes: roslaunch gets a session of its own, and only what is in it is ever ended -----------
launch=
listener=
preflight=
relays=()

session_members() { # LEADER: process ids
  local stat line fields
  for stat in /proc/[0-9]*/stat; do
    { line=$(<"$stat"); } 2>/dev/null || continue
    # After the name in parentheses: state, parent, group, session.
    read -r -a fields <<<"${line##*) }"
    [[ ${fields[3]} != "$1" ]] || basename -- "${stat%/stat}"
  done
}

end_session() { # LEADER: asks, waits, then insists
  local tries pids
  kill -INT "$1" 2>/dev/null || true
  for ((tries = 0; tries < 100; tries++)); do
    pids=$(session_members "$1")
    [[ -n $pids ]] || return 0
    sleep 0.2
  done
  # shellcheck disable=SC2086 # one word per process
  kill -KILL $pids 2>/dev/null || true
}

cleanup() {
  trap - EXIT INT TERM
  ((${#relays[@]} == 0)) || kill "${relays[@]}" 2>/dev/null || true
  [[ -z $listener ]] || kill "$listener" 2>/dev/null || true
  [[ -z $preflight ]] || kill "$preflight" 2>/dev/null || true
  [[ -z $launch ]] || end_session "$launch"
}
trap cleanup EXIT
trap 'exit 130' INT TERM

start_nodes() {
  local port
  port=$(python3 -c 'import socket; s = socket.socket(); s.bind(("", 0)); print(s.getsockname()[1])')
  export ROS_MASTER_URI=http://localhost:$port ROS_HOSTNAME=localhost
  export ROS_HOME=$output/ros ROS_LOG_DIR=$output/ros/log
  # shellcheck disable=SC2016 # these are rosconsole's variables
  ROSCONSOLE_FORMAT='${severity} ${node} ${message}' ROSCONSOLE_STDOUT_LINE_BUFFERED=1 \
    setsid roslaunch raven_correction demo.launch arm:="$arm" seed:="$seed" \
    clock_rate:="$clock_rate" record_directory:="$output" model_directory:="$output" \
    overlay:=false require_preflight:=true required:=true >"$log" 2>&1 &
  launch=$!
}

alive() { kill -0 "$launch" 2>/dev/null || fail "the nodes have ended"; }

wait_for_services() {
  local missing service tries
  for ((tries = 0; tries < 120; tries++)); do
    alive
    missing=
    rosservice list >"$output/ros/services" 2>/dev/null || true
    for service in recorder/start recorder/stop planner/run trainer/retrain corrector/enable \
      corrector/set_mode corrector/preflight; do
      grep -qxF -- "$arm/$service" "$output/ros/services" || missing+=" $arm/$service"
    done
    [[ -n $missing ]] || return 0
    sleep 0.5
  done
  fail "no such service after a minute:$missing"
}

# --- services ---------------------------------------------------------------------------------------
answer=

# call SERVICE [ARGUMENTS]: as a user would type it; the answer must say success
call() {
  alive
  answer=$(rosservice call "$arm/$1" "${@:2}" 2>&1) || fail "$1: $answer"
  grep -qx 'success: True' <<<"$answer" || fail "$1: $answer"
}

# field KEY: of the answer; the first element if it is a list
field() {
  python3 -c '
import sys, yaml
value = yaml.safe_load(sys.stdin)[sys.argv[1]]
print(value[0] if isinstance(value, list) and value else value)' "$1" <<<"$answer"
}

# record NAME REQUEST: the planner's motions in one bag, $output/NAME.bag
record() {
  call recorder/start "{bag: $1.bag}"
  call planner/run "$2"
  call recorder/stop
  say "  wrote $(field bags): $(field trajectories) trajectories, $(field pairs) pairs"
}

# --- the story --------------------------------------------------------------------------------------
target_seed=$((1000 + seed))
training_seed=$((2000 + seed))
preflight_seed=$((3000 + seed))
# The model learns from where the tool was seen, and is asked about where it is wanted. As the tool
# is half a radian and three centimetres off its commands, the training has to reach further, too.
turn=0.35
margin=0.025

say "starting the nodes; everything is written to $output"
mkdir -p -- "$output/ros"
start_nodes
wait_for_services
PYTHONUNBUFFERED=1 rostopic echo -p "$arm/trainer/progress" >"$progress" 2>/dev/null &
listener=$!
relay_log "$launch" &
relays+=($!)
relay_progress "$launch" &
relays+=($!)

say "1/6 visiting $targets targets without correction"
record before "{trajectories: $targets, seed: $target_seed}"

say "2/6 recording $trajectories other motions to learn from"
record training "{trajectories: $trajectories, seed: $training_seed, turn: $turn, margin: $margin}"
training=$output/training.bag

say "3/6 retraining:"
say "    rosservice call $arm/trainer/retrain \"{bags: [$training]}\""
call trainer/retrain "{bags: [$training]}"
indent <<<"$answer"
model=$(field files)

say "4/6 pre-flight: is the model valid for this robot? Ten moves, with motion capture watching"
rosservice call "$arm/corrector/preflight" '{duration: 120}' >"$output/ros/preflight" 2>&1 &
preflight=$!
call planner/run "{trajectories: 10, seed: $preflight_seed}"
wait "$preflight" || fail "corrector/preflight: $(<"$output/ros/preflight")"
preflight=
answer=$(<"$output/ros/preflight")
indent <<<"$answer"
grep -qx 'passed: True' <<<"$answer" || fail "the model has not passed its pre-flight"

say "5/6 switching the corrector on, visiting the same $targets targets, which it has not learned from"
call corrector/set_mode '{mode: full}'
call corrector/enable '{data: true}'
record after "{trajectories: $targets, seed: $target_seed}"

say "6/6 resting error at the targets, as motion capture saw it:"
status=0
"${CMAKE_PREFIX_PATH%%:*}/lib/raven_correction/offline" compare "$output/before.bag" "$output/after.bag" \
  --bag "$training" --model "$model" --max-ratio 0.2 --json "$json" || status=$?
say "wrote $output/{before,training,after}.bag, $model and $json"
if ((status != 0)); then
  say "FAILED: the corrected error is not below a fifth of the uncorrected one"
  exit "$status"
fi
say "done: the corrected error is below a fifth of the uncorrected one"
