# What happens when processes end that should not, and when make does.
load helpers

small=(POP=4 EVALS=12 SHAPE=4x4)

# Whether a process works on the run.
busy() { pgrep -f "$BATS_TEST_TMPDIR/$1" > /dev/null; }
idle() { ! busy "$1"; }

@test "killing only make leaves no training behind, and the trainings save checkpoints" {
  for pipeline in steady ga; do
    make -f "$EVO_SOURCE/scripts/$pipeline.mk" RUN="$BATS_TEST_TMPDIR/$pipeline" "${settings[@]/STEPS=4096/STEPS=100000000}" \
      "${small[@]}" -s -j3 > /dev/null 2>&1 3>&- &
    make=$!
    training() { [ "$(ls $pipeline/gen-000/*.running 2> /dev/null | wc -l)" -eq 3 ]; }
    within 30 training
    sleep 1
    kill -KILL $make
    within 20 idle $pipeline
    [ "$(find $pipeline/policies -name '*.checkpoint.h5' | wc -l)" -eq 3 ]
    [ -z "$(ls $pipeline/gen-000/*.running 2> /dev/null)" ]
  done
}

@test "a training that dies is tried again; one that always dies is recorded, and the run goes on" {
  export SECONDS_EACH=0.01 DIE_ALWAYS=0.3
  for pipeline in steady ga; do
    evolve $pipeline calm "${small[@]}" -j3
    DIE_ONCE=0.4 evolve $pipeline lively "${small[@]}" -j3 2> messages
    diff <(essence calm) <(essence lively)
    [ "$(grep -c ^die lively/stand-in.log)" -gt "$(grep -c ^die calm/stand-in.log)" ]
    # Nothing is trained twice; what failed was tried three times.
    [ -z "$(grep ^end lively/stand-in.log | cut -d' ' -f 2 | sort | uniq -d)" ]
    failed=$(jq -r 'select(.fitness == null) | .id' lively/history.jsonl | sort -u)
    [ -n "$failed" ]
    for id in $failed; do
      deaths=$(grep -c "^die $id" lively/stand-in.log)
      # A failed robot may survive a generation of worse ones, and is tried there again.
      [ "$deaths" -eq 3 ] || { [ $pipeline = ga ] && [ "$deaths" -gt 3 ]; }
    done
    jq -se 'map(select(.fitness == null).failure.why) | all(contains("status 137 on here, 3 times"))' lively/history.jsonl
    [ "$(wc -l < lively/history.jsonl)" -eq 12 ]
    # A chunk that dies does not take its other robots with it.
    DIE_ONCE=0.4 evolve $pipeline chunks "${small[@]}" CHUNK=3 2> messages
    diff <(essence calm) <(essence chunks)
    rm -r calm lively chunks
  done
}

@test "what refuses its input is not tried again" {
  run evolve steady run "${small[@]}" TASK=Walker-v9 TRAINER="evo-run train"
  [ "$status" -ne 0 ]
  [ "$(grep -c "unknown task 'Walker-v9'" <<< "$output")" -eq 1 ]
  [[ $output != *train-slots* ]]
}

@test "what cannot be started is not counted against the robot" {
  cat > not-today << 'END'
#!/bin/bash
echo x >> starts
[ "$(wc -l < starts)" -gt 3 ] || exit 1
exec "$@"
END
  chmod +x not-today
  evolve steady run "${small[@]}" LAUNCH="$PWD/not-today" SECONDS_EACH=0 2> messages
  [ "$(jq -s 'map(select(.fitness == null)) | length' run/history.jsonl)" -eq 0 ]
  grep -q "started again" messages
}
