#!/bin/bash
# make-run.sh FOLDER METHOD SEED GENERATIONS POPULATION [trained]
# A run folder as the pipelines leave it, with fitness made up from the bodies
# (so that nothing is trained): the more horizontal actuators, the fitter; the
# second robot of all has failed. METHOD is ga, neat or bo. "trained" adds what
# there is of a champion: policy and rollout; "all" the policies of all, too.
set -eu
folder=$1 method=$2 seed=$3 generations=$4 population=$5 champion=${6:-}

mkdir -p "$folder/policies"
cat > "$folder/run.yaml" <<YAML
format: evo/run
version: 1
method: $method
task: Walker-v0
pop: $population
evals: 1000
steps: 512
seed: $seed
shape: 5x5
train: $PWD/fast.yaml
physics: task
train_options: '--note "<img src=x onerror=alert(1)></script>"'
YAML

# shellcheck disable=SC2016  # variables of jq
scored='
  (.body | join("")) as $cells
  | ($cells | gsub("[^H]"; "") | length) as $pulling
  | ($cells | explode | to_entries | map(.key * .value) | add % 1000) as $detail
  | . + {fitness: ($pulling + $detail / 1000), task: "Walker-v0", steps: 512}'
# shellcheck disable=SC2016
failed='if $first and input_line_number == 2
  then .fitness = null | .failure = {why: "numbers left the finite ones at <b>step</b>", step: 512, seed: 0}
  else . end'

previous=
for ((g = 0; g < generations; g++)); do
  generation=$(printf '%s/gen-%03d' "$folder" "$g")
  mkdir -p "$generation"
  case $method-$g in
    neat-0) evo-neat -n "$population" --seed "$seed" --state-out "$generation/species.json" < /dev/null ;;
    neat-*) evo-neat -n "$population" --seed "$seed" --state-in "$previous/species.json" \
              --state-out "$generation/species.json" "$previous/scores.jsonl" ;;
    bo-*|ga-0) evo-sample -n "$population" --seed "$((seed * 100 + g))" ;;
    ga-*) evo-select --keep "$((population / 2))" "$previous/scores.jsonl" > "$generation/survivors.tmp"
          cat "$generation/survivors.tmp"
          evo-mutate -n "$((population - population / 2))" --seed "$((seed * 100 + g))" \
            --avoid "$folder/seen.tmp" "$generation/survivors.tmp" ;;
  esac > "$generation/population.jsonl"
  jq -c --argjson first "$([ "$g" = 0 ] && echo true || echo false)" \
    "(if has(\"fitness\") then . else $scored end) | $failed" \
    "$generation/population.jsonl" > "$generation/scores.jsonl"
  cat "$generation/population.jsonl" >> "$folder/seen.tmp"
  previous=$generation
done
rm -f "$folder"/seen.tmp "$folder"/gen-*/survivors.tmp
evo-convert --unique "$folder"/gen-*/scores.jsonl -o "$folder/history.jsonl"
evo-select --keep 1 "$folder/history.jsonl" -o "$folder/best.json"

[ -n "$champion" ] || exit 0
id=$(jq -r .id "$folder/best.json")
if [ "$champion" = all ]; then
  evo-train -q --task Walker-v0 --train gait --steps 8000 --out-dir "$folder/policies" "$folder/history.jsonl" > /dev/null
fi
evo-train -q --force --task Walker-v0 --steps 8192 --out-dir "$folder/policies" "$folder/best.json" > /dev/null
cp "$folder/policies/$id.policy.h5" "$folder/best.policy.h5"
evo-eval -q --policy "$folder/best.policy.h5" --max-steps 60 --rollout "$folder/best.rollout.h5" \
  "$folder/best.json" > /dev/null
