#!/usr/bin/env bash
# How long pages of `--report` take to write and to show; the figures of BENCHMARKS.md:
#
#   cargo build --release && benches/page/run.sh [PROGRAM [BROWSER]]
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
smc=$(realpath "${1:-target/release/smc}")
browser=${2:-chromium}
models=$here/../../models
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cd "$place"

# Five calls; the medians of their wall-clock and processor times.
measured() {
  local label=$1 TIMEFORMAT='%R %U %S'
  shift
  for _ in 1 2 3 4 5; do { time "$@" >/dev/null; } 2>>"$label.times"; done
  local wall cpu
  wall=$(awk '{ print $1 }' "$label.times" | sort -n | sed -n 3p)
  cpu=$(awk '{ print $2 + $3 }' "$label.times" | sort -n | sed -n 3p)
  echo "$label: $wall s, processor time $cpu s"
}

# 200 trials of 20 agents for 30 s: with the page, and without one (a table of the first and the last state).
twenty=(simulate "$models/corridor.scn" --set density=0.45 -n 200)
measured trials-and-page "$smc" "${twenty[@]}" --report twenty.html
measured trials-alone "$smc" "${twenty[@]}" --every 1500 -o twenty.csv
echo "size of the page: $(stat -c %s twenty.html) bytes, $(grep -o 'States every [^,]*' twenty.html)"

"$smc" simulate "$here/hall.scn" --report hall.html
echo "page of 200 agents for 30 s: $(stat -c %s hall.html) bytes"
if command -v "$browser" >/dev/null && command -v node >/dev/null; then
  "$browser" --version
  node "$here/frames.mjs" "$browser" hall.html
else
  echo "left out, because there is no $browser or no Node.js: frames"
fi
