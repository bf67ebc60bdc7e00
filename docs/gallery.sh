#!/usr/bin/env sh
# Makes docs/gallery.md and its pictures anew: a plan, the first question, its answer and the time of each model.
#
#   cargo build --release && sh docs/gallery.sh [PROGRAM]
#
# PROGRAM is target/release/smc unless given. A model whose recording is not there says so.
set -eu
cd "$(dirname "$0")/.."
program=${1:-target/release/smc}
data=${SMC_DATA:-../shared/data}/eth-biwi
recordings=
if test -d "$data"; then recordings="--data $data"; fi
mkdir -p docs/gallery
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

{
  echo '# Gallery'
  echo
  echo 'Every model that ships, with its plan, its first question, and the answer. `sh docs/gallery.sh` makes this page; the times are'
  echo 'of two cores, for all queries of the file, and depend on the machine.'
  for model in models/*.scn; do
    name=$(basename "$model" .scn)
    properties=properties/$name.bltl
    test -f "$properties" || continue
    title=$(sed -n 's/^scenario "\(.*\)"/\1/p' "$model" | head -n 1)
    printf '\n## %s\n\n' "${title:-$name}"
    # The comment at the head of the file.
    sed -n '/^\/\//!q; s/^\/\/ *//p' "$model"
    echo
    if "$program" show "$model" $recordings --format svg --width 170mm -o "$work/plan.svg" 2>/dev/null; then
      if grep -q '^scene\|^  wall\|^agent' "$model"; then
        cp "$work/plan.svg" "docs/gallery/$name.svg"
        printf '![The plan of %s](gallery/%s.svg)\n\n' "$name" "$name"
      fi
      from=$(date +%s%N)
      "$program" check "$model" "$properties" $recordings --brief -q > "$work/brief" 2>/dev/null || true
      seconds=$(( ($(date +%s%N) - from) / 100000000 ))
      where=
      if grep -q '^tracks .*"[^"]*/' "$model" || grep -q 'eth_biwi' "$model"; then where=' --data DIR'; fi
      printf '```\nsmc check %s %s --brief%s\n```\n\n```text\n' "$model" "$properties" "$where"
      head -n 1 "$work/brief" | sed 's/  */ /g'
      printf '…\n```\n\n%s queries, %d.%d s.\n' "$(wc -l < "$work/brief" | tr -d ' ')" $((seconds / 10)) $((seconds % 10))
    else
      files=$(sed -n 's/^tracks .*"\(.*\)".*/`\1`/p' "$model" | tr '\n' ' ')
      echo "The recording of this model was not here: ${files}([replay.md](replay.md) says where it is from)."
    fi
  done
} > "$work/gallery.md"
mv "$work/gallery.md" docs/gallery.md
