#!/bin/bash
# The WebAssembly module in Node against the tools.
set -euo pipefail
here=$(dirname "$(readlink -f "$0")")
"$here/build"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export PATH="$EVO_BIN:$PATH"
"$here/cases" "$work"
node "$here/module.mjs" "$here/../.." "$here/../../build/wasm" "$work"
