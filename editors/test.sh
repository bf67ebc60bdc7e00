#!/bin/sh
# Builds and tests what the editors need: `sh editors/test.sh SMC`, where SMC is the path of the program `smc`.
#
# It needs Node.js with npm, and the program `tree-sitter` in PATH or in the variable TREE_SITTER. It says what it leaves
# out where one of them is missing.
set -eu

smc=${1:?"usage: sh editors/test.sh SMC"}
smc=$(cd "$(dirname "$smc")" && pwd)/$(basename "$smc")
here=$(cd "$(dirname "$0")" && pwd)
tree_sitter=${TREE_SITTER:-tree-sitter}
limit=300000

has() { command -v "$1" >/dev/null 2>&1; }
left_out() { echo "left out: $1"; }

if has node && has npm \
  && (cd "$here/vscode" && npm install --no-audit --no-fund --no-package-lock --loglevel=error); then
  (
    cd "$here/vscode"
    npm run --silent check
    npm run --silent build
    npm run --silent test:grammar
    npm run --silent test:client
    if "$smc" lsp --help >/dev/null 2>&1; then
      SMC=$smc npm run --silent test:client
    else
      left_out "the client against \`smc lsp\`, because this program has no such command"
    fi
    npm run --silent pack >/dev/null
    size=$(wc -c <smc.vsix)
    echo "smc.vsix has $size bytes"
    if [ "$size" -ge $limit ]; then
      echo "smc.vsix must have less than $limit bytes" >&2
      exit 1
    fi
  )
  left_out "VS Code itself, which is not started"
  (cd "$here/tree-sitter-smc" && node keywords.mjs --check)
else
  left_out "the extension for VS Code, because Node.js or npm is missing, or packages cannot be installed"
fi

if has "$tree_sitter" && has cc; then
  (
    cd "$here/tree-sitter-smc"
    fresh=$(mktemp -d)
    trap 'rm -rf "$fresh"' EXIT
    "$tree_sitter" generate --abi 14
    "$tree_sitter" test
    "$tree_sitter" build -o "$fresh/smc.so" .
    for query in queries/*.scm; do
      "$tree_sitter" query -q -l "$fresh/smc.so" --lang-name smc "$query" ../../models/corridor.scn
    done
    if has python3; then
      python3 test/mutants.py "$smc" "$tree_sitter"
    else
      left_out "mutants of shipped files, because Python is missing"
    fi
  )
else
  left_out "the tree-sitter grammar, because \`tree-sitter\` or a C compiler is missing"
fi
