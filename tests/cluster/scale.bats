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
  for pipeline in steady ga; do all_there "$("$EVO_SOURCE/tests/cluster/scale" $pipeline "${size[@]}")"; done
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
