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
# Files to drop, and what they earn.
export EVO_FILES=$work/files
mkdir "$EVO_FILES"
cp "$here/../../records/Walker-v0/policy.h5" "$EVO_FILES/policy.h5"
evo-convert "$EVO_FILES/policy.h5" --to json -o "$EVO_FILES/policy.json"
jq -c 'del(.actor)' "$EVO_FILES/policy.json" > "$EVO_FILES/cut.json"
printf 'HHH\nVSV\nV.V\n' |
  evo-train -q --task Walker-v0 --seed 1 --train modular --steps 8192 --shared "$work/modular.h5" > "$work/scored"
evo-convert "$work/modular.h5" --to json -o "$EVO_FILES/modular.json"
EVO_OTHER_BODY=$(printf 'HVH\nV.V\n' | evo-eval -q --policy "$work/modular.h5" | jq .fitness)
export EVO_OTHER_BODY
node "$here/browser.mjs" "$browser" "$work/site" "$work/profile" ${EVO_PICTURES:+"$EVO_PICTURES"}
