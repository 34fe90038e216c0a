# Thousands of trainings, and runs of many robots; here some, all of them with EVO_SLOW.
load helpers

# A row of tests/cluster/scale: nothing is lost, nothing done twice.
all_there() {
  echo "$1"
  [[ $1 == *"never 0"*"twice 0"* ]]
}

@test "no training is lost or done twice" {
  if [ -n "${EVO_SLOW:-}" ]; then size=(100 10000 1000 CHUNK=10); else size=(8 90 30 CHUNK=3); fi
  export SECONDS_EACH=0.1 DIE_ONCE=0.1 DIE_ALWAYS=0.01
  for window in "" WINDOW=${size[2]}; do all_there "$("$EVO_SOURCE/tests/cluster/scale" ga "${size[@]}" $window)"; done
}

@test "a run folder of many robots is resumed, selected from, inspected and reported" {
  command -v /usr/bin/time > /dev/null || skip "the program 'time' is not here (apt-get install time)"
  if [ -n "${EVO_SLOW:-}" ]; then size=(100000 1000); else size=(600 50); fi
  "$EVO_SOURCE/tests/cluster/large" "${size[@]}" "$PWD/run" > table
  cat table
  # Seconds of processor: others may use the machine.
  awk -F'\t' '$3 ~ /processor/ && $3 + 0 > 20 { print "too slow: " $0; exit 1 }' table
  [ "$(evo-run slots run | wc -l)" -eq "$((size[0] + 1))" ]
}

# Seconds of processor that a generation takes, made anew; the least of three times.
cost() {
  local folder k
  folder=$(printf run/gen-%03d "$1")
  for k in 1 2 3; do
    rm -r "$folder"
    TIMEFORMAT='%U %S'
    time for file in population.jsonl ranking.tsv; do
      SECONDS_EACH=0 run_make map run "${long[@]}" -s TRAINER="$stand_in" GEN="$1" "$folder/$file"
    done
  done 2>&1 | awk '{ seconds = $1 + $2 } NR == 1 || seconds < least { least = seconds } END { print least }'
}

@test "the last of thousands of generations takes no longer than the hundredth" {
  generations=${EVO_SLOW:+5000}
  generations=${generations:-40}
  long=(POP=2 EVALS=$((2 * generations)) SHAPE=4x4)
  SECONDS_EACH=0 evolve map run "${long[@]}"
  [ "$(jq -r .id run/history.jsonl | sort -u | wc -l)" -eq $((2 * generations)) ]
  last=$(cost $((generations - 1)))  # first, since ids of later generations are forgotten
  early=$(cost $((generations < 100 ? 10 : 100)))
  echo "seconds of processor: $early early, $last at the end"
  awk -v early="$early" -v last="$last" 'BEGIN { exit !(last < 1.2 * early) }'
}

@test "what make is told to do for a generation does not grow" {
  for pipeline in ga neat bo map race; do
    for gen in 6 6000; do
      folder=$(printf gen-%03d $gen)
      run_make $pipeline run POP=4 EVALS=30000 GEN=$gen -n "run/$folder/population.jsonl" > plan-$gen
    done
    [ -s plan-6 ] && [ "$(wc -c < plan-6000)" -le $(($(wc -c < plan-6) + 100)) ]
  done
}

@test "a generation reads nothing from long ago" {
  for pipeline in ga neat map race; do
    SECONDS_EACH=0 evolve $pipeline whole POP=4 EVALS=44 SHAPE=4x4
    cp -r whole part
    rm -r part/history.jsonl part/gen-009 part/gen-01*
    for gen in 0 1 2 3 4 5; do
      rm part/gen-00$gen/*
      : > part/gen-00$gen/ranking.tsv
    done
    for gen in 9 10; do
      folder=$(printf part/gen-%03d $gen)
      for file in population.jsonl ranking.tsv; do
        SECONDS_EACH=0 run_make $pipeline part POP=4 EVALS=44 SHAPE=4x4 -s TRAINER="$stand_in" GEN=$gen "$folder/$file"
      done
      diff "$folder/scores.jsonl" "whole/${folder#part/}/scores.jsonl"
    done
    rm -r whole part
  done
}
