#!/bin/bash
# seeds.sh FOLDER: valid files for every fuzz target, one folder a target. The tools
# are in $EVO_BIN, the data in $EVO_SOURCE.
set -euo pipefail
folder=$(realpath -m "${1:?folder}")
export PATH="${EVO_BIN:?}:$PATH"
rm -rf "$folder"
mkdir -p "$folder"/{robots,world,neat_state,yaml,run,npz,hdf5}
PYTHONDONTWRITEBYTECODE=1 PYTHONPATH="$EVO_SOURCE/tests/hostile" /usr/bin/python3 -c '
import sys, valid
valid.make(sys.argv[1], sys.argv[2])' "$folder/valid" "$EVO_SOURCE"
cd "$folder/valid"
cp robots.jsonl robot.json robots.yaml letters.txt numbers.txt lists.json world.json scored.jsonl genomes.jsonl trained.json ../robots
cp world.json carrier.json ../world
cp species.json ../neat_state
cp task.yaml ramp.yaml physics.yaml training.yaml neat.yaml neat.cfg ../yaml
cp run.yaml ../run
cp robot.npz body.npy actions.npy model.zip "$EVO_SOURCE"/tests/data/formats/*.npz ../npz
cp rollout.h5 sine.h5 network.h5 actions.csv ../hdf5
cd ..
rm -r valid
for target in *; do
  regressions="$EVO_SOURCE/tests/fuzz/regressions/$target"
  [ ! -d "$regressions" ] || cp "$regressions"/* "$target"
done
