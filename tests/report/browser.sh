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
"$here/make-run.sh" run ga 1 4 8 all
evo-report run -o report.html
for method in neat bo; do "$here/make-run.sh" $method $method 1 3 6 trained; done
evo-report run neat bo -o comparison.html
for page in report comparison; do
  echo "$page"
  node "$here/browser.mjs" "$browser" $page.html "$work/profile" ${EVO_PICTURES:+"$EVO_PICTURES"}
done
