# What happens when processes end that should not, and when make does.
load helpers

small=(POP=4 EVALS=12 SHAPE=4x4)

# Whether a process works on the run.
busy() { pgrep -f "$BATS_TEST_TMPDIR/$1" > /dev/null; }
idle() { ! busy "$1"; }

@test "killing only make leaves no training behind, and the trainings save checkpoints" {
  local name pipeline
  for name in ga-window ga; do
    pipeline_words $name "${small[@]}"
    make "${pipeline[@]}" RUN="$BATS_TEST_TMPDIR/$name" "${settings[@]/STEPS=4096/STEPS=100000000}" \
      "${small[@]}" -s -j3 > /dev/null 2>&1 3>&- &
    make=$!
    training() { [ "$(ls $name/gen-000/*.running 2> /dev/null | wc -l)" -eq 3 ]; }
    within 30 training
    sleep 1
    kill -KILL $make
    within 20 idle $name
    [ "$(find $name/policies -name '*.checkpoint.h5' | wc -l)" -eq 3 ]
    [ -z "$(ls $name/gen-000/*.running 2> /dev/null)" ]
  done
}

@test "a signal to make takes nothing away that is done" {
  local name chunk
  # It has its results and has not ended yet, as a step of a scheduler.
  printf '#!/bin/bash\n"%s" "$@" && exec sleep 60\n' "$stand_in" > lingers
  chmod +x lingers
  results() { [ "$(find run/gen-000 -name '[0-9][0-9].json' 2> /dev/null | wc -l)" -eq "$1" ]; }
  for name in ga-window ga; do
    for chunk in 1 2; do
      evolve_behind $name run "${small[@]}" -j2 CHUNK=$chunk TRAINER="$PWD/lingers"
      within 30 results $((2 * chunk))
      kill -TERM $make
      wait $make || true
      within 10 nobody_works
      results $((2 * chunk))
      rm -r run
    done
  done
}

@test "a training that dies is tried again; one that always dies is recorded, and the run goes on" {
  export SECONDS_EACH=0.01 DIE_ALWAYS=0.3
  for pipeline in ga-window ga; do
    evolve $pipeline calm "${small[@]}" -j3
    DIE_ONCE=0.4 evolve $pipeline lively "${small[@]}" -j3 2> messages
    diff <(essence calm) <(essence lively)
    [ "$(grep -c ^die lively/stand-in.log)" -gt "$(grep -c ^die calm/stand-in.log)" ]
    # Nothing is trained twice; what failed was tried three times.
    [ -z "$(grep ^end lively/stand-in.log | cut -d' ' -f 2 | sort | uniq -d)" ]
    failed=$(jq -r 'select(.fitness == null) | .id' lively/history.jsonl | sort -u)
    [ -n "$failed" ]
    for id in $failed; do
      # No more often even if it survives a generation of worse ones.
      [ "$(grep -c "^die $id" lively/stand-in.log)" -eq 3 ]
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
  cp "$EVO_SOURCE/tasks/training/default.yaml" mine.yaml
  printf '#!/bin/bash\nrm -f mine.yaml\nexec "$@"\n' > vanish
  chmod +x vanish
  run evolve ga-window run "${small[@]}" TRAIN=mine.yaml LAUNCH="$PWD/vanish" TRAINER="evo-run train"
  [ "$status" -ne 0 ]
  [ "$(grep -c "mine.yaml" <<< "$output")" -eq 1 ]
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
  SECONDS_EACH=0 evolve ga-window run "${small[@]}" LAUNCH="$PWD/not-today" 2> messages
  [ "$(jq -s 'map(select(.fitness == null)) | length' run/history.jsonl)" -eq 0 ]
  grep -q "started again" messages
}

@test "a robot that failed is given back as it is by a generation that it survives" {
  evo-run init run method=ga task=Walker-v0 pop=1 evals=2 steps=1000000000 seed=1 algo=ppo train=default physics=task
  mkdir run/gen-001
  evo-sample -n 1 | jq -c '. + {fitness: null, failure: {why: "diverged"}}' > run/gen-001/population.jsonl
  evo-run train run --generation 1 --slot 0
  cmp run/gen-001/population.jsonl run/gen-001/00.json
  [ -z "$(ls run/policies)" ]
}

# Trainings of the generations named by FAILING fail, those of others do not.
failing_trainer() {
  cat > failing << 'END'
#!/bin/bash
case " $FAILING " in *" $3 "*) exec evo-run fail "$1" --generation "$3" --slot "$5" --why "as the test wants" ;; esac
exec "$EVO_SOURCE/tests/cluster/stand-in" "$@"
END
  chmod +x failing
  export EVO_SOURCE SECONDS_EACH=0
}

@test "a generation in which every training fails does not end a run" {
  failing_trainer
  for method in ga neat bo map ga-window neat-window bo-window map-window; do
    read -ra words <<< "$method"
    FAILING=1 run_make "${words[0]}" run "${words[@]:1}" "${small[@]}" -s -j2 TRAINER="$PWD/failing" run/history.jsonl run/best.json
    jq -se '(map(select(.failure.why? == "as the test wants")) | length) > 1 and length == 12' run/history.jsonl
    if [ "$method" != ga ]; then [ "$(cut -f 2 run/gen-001/ranking.tsv | sort -u)" = failed ]; fi
    jq -e '.fitness' run/best.json
    rm -r run
  done
}

@test "a run in which every training fails ends with a line that says why" {
  failing_trainer
  for pipeline in ga ga-window; do
    FAILING="0 1 2 3" run -2 run_make $pipeline run "${small[@]}" -s -j2 TRAINER="$PWD/failing" run/history.jsonl
    [ "$(grep -c "^run: every training of generation 0 has failed (4 x as the test wants)" <<< "$output")" -eq 1 ]
    [ ! -e run/gen-000/ranking.tsv ]
    # As it says.
    eval "$(grep -o 'rm -r [^ ]*\( run/steady.json\)\?' <<< "$output")"
    FAILING="" run_make $pipeline run "${small[@]}" -s -j2 TRAINER="$PWD/failing" run/history.jsonl
    [ "$(wc -l < run/history.jsonl)" -eq 12 ]
    rm -r run
  done
}

@test "a generation that cannot be proposed ends the run" {
  SECONDS_EACH=0 run -2 evolve ga run "${small[@]}" MUTATE=false
  [ -e run/gen-000/ranking.tsv ]
  [ "$(cd run && echo gen-*)" = "gen-000 gen-001" ]
}

@test "results that a file system shows late are waited for; those that never come are made again" {
  cat > late << 'END'
#!/bin/bash
# What the stand-in has written is seen two seconds later; once not at all.
"$EVO_SOURCE/tests/cluster/stand-in" "$@"
file=$(printf '%s/gen-%03d/%s.json' "$1" "$3" "$5")
if mkdir lost 2> /dev/null; then mv "$file" lost; exit; fi
mv "$file" "$file.late"
(sleep 2; mv "$file.late" "$file") > /dev/null 2>&1 3>&- &
END
  chmod +x late
  export SECONDS_EACH=0 EVO_SOURCE
  evolve ga-window calm POP=3 EVALS=4 SHAPE=4x4
  PATIENCE=10 run_make ga-window run -s POP=3 EVALS=4 SHAPE=4x4 -j3 TRAINER="$PWD/late" run/history.jsonl 2> messages
  diff <(essence calm) <(essence run)
  [ "$(grep -c "gave no result within 10 s" messages)" -eq 1 ]
}
