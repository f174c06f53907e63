#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Takes a picture of rviz with the overlay, on a machine without a screen. A master and the node
# `overlay` must run. This is how the picture in the README is made.
set -euo pipefail

usage() {
  cat <<EOF
usage: [ROS_NAMESPACE=/ARM] $0 OUT.png [SECONDS [CONFIG.rviz]]
  OUT.png      picture to write, 1280x960
  SECONDS      how long rviz draws before the picture is taken; default 8
  CONFIG.rviz  what it shows, panels included; default: the shipped overlay.rviz without its panels
Needs xvfb (xvfb-run), imagemagick (import, identify), rviz and rostopic.
EOF
}

if [[ $# -lt 1 || $# -gt 3 || $1 == -* ]]; then
  usage >&2
  exit 2
fi
picture=$1
draw_time=${2:-8}
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# The shipped configuration without its panels: the picture shows the scene.
config=$(mktemp --suffix=.rviz)
trap 'rm -f "$config"' EXIT
if [[ -n ${3:-} ]]; then
  cat -- "$3" > "$config"
else
  sed '/^Panels:/,/^Visualization Manager:/{/^Visualization Manager:/!d}' "$here/../rviz/overlay.rviz" > "$config"
fi
overlay=${ROS_NAMESPACE:-}/overlay
overlay=/${overlay#/}

for tool in xvfb-run import identify rviz rostopic; do
  if ! command -v "$tool" > /dev/null; then
    echo "$tool is missing: apt-get install xvfb imagemagick rviz python3-rostopic" >&2
    exit 1
  fi
done
if ! rostopic info "$overlay" > /dev/null 2>&1; then
  echo "nobody publishes $overlay: start a master and the node overlay first" >&2
  exit 1
fi

# Inside the virtual screen: start rviz, wait until it listens to the overlay, let it draw.
take_picture() {
  rviz -d "$1" __name:=rviz_screenshot > /dev/null 2>&1 &
  rviz_pid=$!
  trap 'kill "$rviz_pid" 2> /dev/null || true' EXIT
  for ((i = 0; i < 120; ++i)); do
    if rostopic info "$2" 2> /dev/null | grep -q rviz_screenshot; then
      sleep "$4" # how long the picture shall show, not how long something takes
      import -window root "$3"
      return
    fi
    kill -0 "$rviz_pid" || return 1
    sleep 0.5
  done
  echo "rviz does not listen to $2 after 60 s" >&2
  return 1
}
LIBGL_ALWAYS_SOFTWARE=1 xvfb-run --auto-servernum -s "-screen 0 1280x960x24" \
  bash -c "set -euo pipefail; $(declare -f take_picture); take_picture \"\$@\"" _ "$config" "$overlay" "$picture" "$draw_time"
echo "$picture: $(identify -format '%wx%h' "$picture")"
