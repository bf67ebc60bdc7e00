#!/usr/bin/env sh
# Runs the commands of docs/cookbook.md and renews the pictures in docs/cookbook/.
#
#   cargo build --release && sh docs/cookbook.sh [PROGRAM]
#
# PROGRAM is target/release/smc unless given.
set -eu
cd "$(dirname "$0")/.."
program=${1:-target/release/smc}
mkdir -p out docs/cookbook

smc() { "$program" "$@" --color never; }

# The lines of the page between ```sh and ```.
commands=$(mktemp)
trap 'rm -f "$commands"' EXIT
awk '/^```/ { inside = ($0 == "```sh"); next } inside' docs/cookbook.md > "$commands"

while IFS= read -r line <&3; do
  command=${line%% # exit code *}
  expected=0
  if [ "$command" != "$line" ]; then expected=${line##* # exit code }; fi
  echo "\$ $command"
  code=0
  eval "$command" || code=$?
  if [ "$code" -ne "$expected" ]; then
    echo "exit code $code instead of $expected: $command" >&2
    exit 1
  fi
done 3< "$commands"

for picture in $(sed -n 's|.*](cookbook/\(.*\.svg\))$|\1|p' docs/cookbook.md); do
  cp "out/$picture" docs/cookbook/
done
