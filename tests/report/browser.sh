#!/bin/bash
# The report in a browser; status 77 (skipped) where there is none to drive.
set -eu
here=$(dirname "$(readlink -f "$0")")
browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome) || {
  echo "skipped: no chromium (scripts/install-packages full)"; exit 77; }
command -v node > /dev/null || {
  echo "skipped: no node (scripts/install-packages full)"; exit 77; }

work=$(mktemp -d)
trap 'rm -rf "$work" || { sleep 2; rm -rf "$work"; }' EXIT
cd "$work"
export PATH="$EVO_BIN:$PATH"
"$here/make-run.sh" run ga 1 4 8 trained
evo-report run -o report.html
node "$here/browser.mjs" "$browser" report.html "$work/profile"
