#!/bin/bash
# quick.sh FOLDER: every target in FOLDER takes its seeds, the inputs that once broke
# it, and some thousand damaged ones.
set -euo pipefail
programs=$(realpath "${1:?folder of the targets}")
seeds=$(mktemp -d)
trap 'rm -rf "$seeds"' EXIT
"$EVO_SOURCE/tests/fuzz/seeds.sh" "$seeds/all"
for target in robots world neat_state yaml run npz; do
  "$programs/fuzz_$target" --damaged 500 "$seeds/all/$target"
done
"$programs/fuzz_hdf5" --damaged 100 "$seeds/all/hdf5"
