#!/bin/bash
# A genetic algorithm as a loop over the tools: ga.sh FOLDER TASK ROBOTS GENERATIONS
set -euo pipefail
folder=$1 task=$2 robots=$3 generations=$4
half=$((robots / 2))
mkdir -p "$folder" && cd "$folder"

evo-sample -n "$robots" --seed 1 -o population-0.jsonl
for ((g = 0; g < generations; g++)); do
  # What has a policy is not trained again: survivors keep their fitness.
  evo-train --task "$task" --steps 8192 --seed 1 --out-dir policies --resume "population-$g.jsonl" -o "scores-$g.jsonl"
  evo-select --keep "$half" "scores-$g.jsonl" -o survivors.jsonl
  evo-convert --to ids population-*.jsonl -o seen.txt
  evo-mutate -n $((robots - half)) --seed "$g" --avoid seen.txt survivors.jsonl -o children.jsonl
  evo-convert survivors.jsonl children.jsonl -o "population-$((g + 1)).jsonl"
done
evo-select --keep 1 "scores-$((generations - 1)).jsonl" -o best.json
evo-inspect best.json
