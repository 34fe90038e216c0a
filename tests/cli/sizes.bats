# Runs with populations of every size, by a stand-in for training: what works with a few
# robots has to work with thousands, whose scores fill more than a pipe.
load helpers

# A generation and a half of $2 robots by method $1, with further settings; every robot has
# one score, and none is there twice.
evolve() {
  local method=$1 pop=$2 run=run-$1-$2 evals=$(($2 + ($2 + 1) / 2))
  evo-evolve "$method" -q -j2 --run "$run" --pop "$pop" --evals $evals --seed 1 --chunk $(((pop + 1) / 2)) \
    --evaluate "jq -c '.fitness = (.body | tostring | length)'" "${@:3}"
  [ "$(wc -l < "$run/history.jsonl")" -ge $evals ]
  [ "$(jq -r .id "$run/history.jsonl" | sort -u | wc -l)" -eq "$(wc -l < "$run/history.jsonl")" ]
  jq -e '.fitness > 0' "$run/best.json" > /dev/null
}

# CI takes one population whose scores are more than 64 KiB; --full takes all.
larger() { [ -z "${EVO_SLOW:-}" ] || for size in 500 5000; do evolve "$@" "$size"; done; }

@test "the genetic algorithm with populations of every size, plain bodies and CPPN" {
  evolve ga 3
  evolve ga 50 --sample-options '--encoding cppn'
  evolve ga 240
  larger ga
}

@test "CPPN-NEAT with populations of every size" {
  evolve neat 2
  evolve neat 50
  larger neat
}

@test "MAP-Elites and Bayesian optimisation with populations of every size" {
  for size in 1 2 50; do
    evolve map "$size"
    evolve bo "$size"
  done
  larger map
}
