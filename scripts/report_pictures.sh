#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Shows a report as people see it: pictures of the whole page on a wide and on a narrow screen, and
# as PDF. For those who change the room `report`; nothing that a user needs.
set -euo pipefail

usage() {
  cat <<EOF
usage: $0 PAGE.html OUT
Writes OUT_wide_N.png (1400 pixels), OUT_narrow_N.png (420 pixels), 3000 pixels high each, and
OUT.pdf.
Needs chromium and imagemagick.
EOF
}

if [[ $# -ne 2 || $1 == -* ]]; then
  usage >&2
  exit 2
fi
for tool in chromium identify; do
  if ! command -v "$tool" > /dev/null; then
    echo "$tool is missing: apt-get install chromium imagemagick" >&2
    exit 1
  fi
done
page=$(realpath "$1")
out=$2
profile=$(mktemp -d)
trap 'rm -rf "$profile"' EXIT

browser() {
  if ! chromium --headless --no-sandbox --disable-gpu --hide-scrollbars \
    --user-data-dir="$profile" "$@" > "$profile/log" 2>&1; then
    cat "$profile/log" >&2
    exit 1
  fi
}

# picture NAME WIDTH: the page in a frame of that width (chromium's own windows are 500 pixels wide at
# least), piece by piece from top to bottom until a piece is empty.
picture() {
  local piece file frame=$profile/frame.html
  for ((piece = 0; piece < 30; ++piece)); do
    file=${out}_$1_$piece.png
    printf '<body style="margin:0;overflow:hidden"><iframe src="file://%s" style="border:0;width:%dpx;height:90000px;margin-top:-%dpx"></iframe>' \
      "$page" "$2" $((piece * 3000)) > "$frame"
    browser --window-size="$(($2 < 500 ? 500 : $2)),3000" --screenshot="$file" "file://$frame"
    if [[ $(identify -format %k "$file") == 1 ]]; then
      rm "$file"
      return
    fi
  done
}
picture wide 1400
picture narrow 420
browser --no-pdf-header-footer --print-to-pdf="$out".pdf "file://$page"
ls -l "$out"_*.png "$out".pdf
