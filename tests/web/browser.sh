#!/bin/bash
# The site in a browser, from disk; status 77 (skipped) where there is none to drive.
set -euo pipefail
here=$(dirname "$(readlink -f "$0")")
browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome) || {
  echo "skipped: no chromium (scripts/install-packages web)"; exit 77; }
"$here/build"
work=$(mktemp -d)
trap 'rm -rf "$work" || { sleep 2; rm -rf "$work"; }' EXIT
export PATH="$EVO_BIN:$PATH"
"$here/../../scripts/site" "$work/site" > "$work/log" || { cat "$work/log"; exit 1; }
EVO_EXPECTED=$(printf 'VVV\nHHH\nV.V\n' | evo-eval --task Jumper-v0 --sine 0.31,17.5,1.25 | jq .fitness)
export EVO_EXPECTED
node "$here/browser.mjs" "$browser" "$work/site" "$work/profile" ${EVO_PICTURES:+"$EVO_PICTURES"}
