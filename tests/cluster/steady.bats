# Evolution without generations: the same run for any number of workers, order of
# finishing and size of chunks, however often it is killed.
load helpers

small=(POP=5 EVALS=22 WINDOW=7 SHAPE=4x4)

# Robot k is proposed from exactly the scores of robots 0 .. k-W-1: with all others
# changed it is the same robot.
@test "ga, neat, bo and map: 1, 2 and 7 workers, any chunks, killed or not, end the same" {
  for method in ga neat bo map; do
    SECONDS_EACH=0 evolve $method one "${small[@]}"
    [ "$(wc -l < one/history.jsonl)" -eq 22 ]
    [ "$(jq -r .id one/history.jsonl | sort -u | wc -l)" -eq 22 ]
    SECONDS_EACH=0.01 evolve $method two "${small[@]}" -j2
    SECONDS_EACH=0.03 evolve $method seven "${small[@]}" -j7 CHUNK=2
    for ((kills = 0; kills < 3; kills++)); do
      SECONDS_EACH=0.03 evolve_behind $method stormy "${small[@]}" -j5 CHUNK=4
      random_pause
      kill_make
    done
    SECONDS_EACH=0 evolve $method stormy "${small[@]}" -j3 CHUNK=3
    for other in two seven stormy; do diff <(essence one) <(essence $other); done
    rm -r one two seven stormy
  done
}

@test "nothing that is not needed is waited for, nothing is trained twice" {
  # The first robot takes long; the others of its window go on meanwhile.
  SECONDS_EACH=0.05 evolve ga-window run "${small[@]}" -j4
  [ "$(grep -c ^end run/stand-in.log)" -eq 22 ]
  [ "$(grep -c ^start run/stand-in.log)" -eq 22 ]
  # A finished generation is four files, whatever its robots were.
  for folder in run/gen-*; do
    [ "$(cd "$folder" && echo *)" = "population.jsonl ranking.tsv scores.jsonl" ]
  done
}

@test "the state may be lost: the same robots are proposed again" {
  for method in ga neat bo map; do
    SECONDS_EACH=0 evolve $method calm "${small[@]}"
    SECONDS_EACH=0.05 evolve_behind $method lost "${small[@]}" -j2
    sleep 2
    kill_make
    rm -f lost/steady.json
    SECONDS_EACH=0 evolve $method lost "${small[@]}"
    diff <(essence calm) <(essence lost)
    rm -r calm lost
  done
}

@test "a mixture of instruction sets ends with the same bytes" {
  isas=()
  for isa in x86-64 x86-64-v2 x86-64-v3 x86-64-v4; do
    if evo-bench --isa $isa --sizes 2 --repetitions 1 --seconds 0.01 > /dev/null 2>&1; then isas+=("$isa"); fi
  done
  [ ${#isas[@]} -ge 2 ] || skip "this processor has one instruction set"
  cat > mixed << 'END'
#!/bin/bash
# mixed ISA .. -- RUN --generation N --slot SLOT: each slot with the next one.
while [ "$1" != -- ]; do isas+=("$1"); shift; done
shift
isa=${isas[$(((10#$5 + $3) % ${#isas[@]}))]}
echo "$isa" >> used
exec evo-run train --isa "$isa" "$@"
END
  chmod +x mixed
  for pipeline in ga-window ga; do
    rm -f used
    run_make $pipeline pure-$pipeline POP=4 EVALS=10 SHAPE=4x4 -s -j2 pure-$pipeline/history.jsonl
    run_make $pipeline mixed-$pipeline POP=4 EVALS=10 SHAPE=4x4 -s -j2 \
      TRAINER="$PWD/mixed ${isas[*]} --" mixed-$pipeline/history.jsonl
    [ "$(sort -u used | wc -l)" -eq ${#isas[@]} ]
    diff <(essence pure-$pipeline | sed s/pure/mixed/) <(essence mixed-$pipeline)
    [ "$(find mixed-$pipeline/policies -name '*.policy.h5' | wc -l)" -eq 10 ]
  done
}
