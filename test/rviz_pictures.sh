#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Pictures of rviz with every overlay and with the panel, for eyes: a simulated session is recorded,
# learnt from and corrected, and rviz is photographed while the arm moves, under a screen of its own.
#   ./run exec test/rviz_pictures.sh DIRECTORY [MOTIONS]
set -euo pipefail

if [[ $# -lt 1 || $# -gt 2 || $1 == -* ]]; then
  echo "usage: ./run exec test/rviz_pictures.sh DIRECTORY [MOTIONS, default 30]" >&2
  exit 2
fi
pictures=$1
motions=${2:-30}
package=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
mkdir -p -- "$pictures"
work=$(mktemp -d)
arm=/raven/left
port=$(python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
export ROS_MASTER_URI=http://localhost:$port ROS_HOSTNAME=localhost ROS_LOG_DIR=$work/log

roslaunch raven_correction demo.launch record_directory:="$work" model_directory:="$work" \
  > "$work/nodes.log" 2>&1 &
launch=$!
finish() {
  kill -INT "$launch" 2> /dev/null || true
  wait "$launch" 2> /dev/null || true
  rm -rf -- "$work"
}
trap finish EXIT

ask() {
  local answer
  answer=$(rosservice call "$arm/$1" "${@:2}")
  grep -qx 'success: True' <<< "$answer" || { echo "$1: $answer" >&2; return 1; }
}
for ((i = 0; i < 120; ++i)); do
  if rosservice list 2> /dev/null | grep -qx "$arm/trainer/retrain" &&
    rosservice list | grep -qx "$arm/planner/run"; then break; fi
  kill -0 "$launch" || { cat "$work/nodes.log" >&2; exit 1; }
  sleep 0.5
done

ask recorder/start "{bag: session.bag}"
ask planner/run "{trajectories: $motions, seed: 3}"
ask recorder/stop
ask trainer/retrain "{bags: [session.bag]}"
# Errors before and after in one picture: some motions without, then some with correction.
ask planner/run "{trajectories: 3, seed: 4}"
ask corrector/enable "{data: true}"
rosservice call "$arm/planner/run" "{trajectories: 60, seed: 5}" > /dev/null 2>&1 &
export ROS_NAMESPACE=$arm
"$package/scripts/rviz_screenshot.sh" "$pictures/overlay.png" 10
for config in session training; do
  "$package/scripts/rviz_screenshot.sh" "$pictures/$config.png" 8 "$package/rviz/$config.rviz"
done
