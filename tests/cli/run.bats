# evo-run: what a scheduler's array needs of a run folder.
load helpers

settings=(method=ga task=Walker-v0 pop=3 evals=3 steps=4096 seed=1 shape=3x3 algo=ppo train=default physics=task)

begin() { evo-run init run "${settings[@]}" "$@"; }
populate() { mkdir -p run/gen-000 && evo-sample -n 3 --shape 3x3 --seed 1 -o run/gen-000/population.jsonl; }

@test "init: the same settings go on, others are refused, what is no setting too" {
  begin train_options=
  cp run/run.yaml before
  begin train_options=
  cmp before run/run.yaml
  fails_with 73 "other settings" "seed: 1 there, seed: 2 asked for" -- \
    evo-run init run "${settings[@]/seed=1/seed=2}" train_options=
  cmp before run/run.yaml
  fails_with 2 "Seed" -- evo-run init other Seed=1
  # What could train nothing is refused before anything is there to stand in the way.
  fails_with 2 "unknown training profile 'nope'" -- evo-run init other "${settings[@]/train=default/train=nope}"
  fails_with 2 "unknown task" -- evo-run init other "${settings[@]/Walker-v0/Walker-v9}"
  fails_with 2 "founder_steps is a number from 1, not '0'" -- evo-run init other "${settings[@]}" founder_steps=0
  fails_with 2 "inherit is yes, no or all, not 'maybe'" -- evo-run init other "${settings[@]}" inherit=maybe
  fails_with 2 "'population' is called 'pop'" -- evo-run init other "${settings[@]/pop=/population=}"
  fails_with 2 "nothing" -- evo-run init other "${settings[@]}" train_options="--train-set nothing=1"
  fails_with 65 "train_options" -- evo-run init other "${settings[@]}" train_options="--train-set 'hidden=8"
  [ ! -e other ]
  evo-run init other "${settings[@]/Walker-v0/my-own-task}" evaluate=./score
}

@test "settings: what pipelines have, each with its default; runs of earlier versions have them" {
  evo-run settings race > race
  grep -q '^RUNGS=N .*how often' race
  run ! grep -q '^FEATURES' race
  make -s -f "$EVO_SOURCE/scripts/race.mk" help | cmp - race
  make -s -f "$EVO_SOURCE/scripts/compare.mk" help | grep -q '^SEEDS=LIST .*\[1 2 3\]$'
  run ! grep -E '^.{81}' <(evo-run settings)
  [ "$(evo-run settings | grep -c '^[A-Z]')" -eq "$(grep -vc '^#\|^name' "$EVO_SOURCE/scripts/settings.tsv")" ]
  fails_with 2 "rase" "did you mean 'race'" -- evo-run settings rase
  begin
  sed -i 's/^pop:/population:/; s/^evals:/evaluations:/' run/run.yaml
  begin
  evo-inspect run | grep -q '0 of 3 trained'
  [[ $(evo-run command run) == *" POP=3 EVALS=3 "* ]]
}

@test "train: a slot, then those that are left, as evo-train does" {
  begin train_options="--train-set 'hidden=8,8'"
  fails_with 66 "no population" -- evo-run train run --slot 0
  populate
  evo-run train run --generation 0 --slot 01
  [ "$(cd run/gen-000 && echo ??.json)" = 01.json ]
  mkdir policies
  sed -n 2p run/gen-000/population.jsonl |
    evo-train --task Walker-v0 --steps 4096 --seed 1 --train-set hidden=8,8 --out-dir policies > /dev/null
  cmp policies/*.policy.h5 run/policies/"$(jq -r .id run/gen-000/01.json)".policy.h5
  evo-eval run/gen-000/01.json | jq -e ".fitness == $(jq .fitness run/gen-000/01.json)"
  cp run/gen-000/01.json before
  evo-run train run -j2
  cmp before run/gen-000/01.json
  [ "$(cat run/gen-000/*.json | jq -r .id)" = "$(jq -r .id run/gen-000/population.jsonl)" ]
  # Three trainings, each with its time; the one that was done was not timed again.
  [ "$(cat run/timings/*.jsonl | jq -s 'map(select(.finished and .seconds > 0 and .steps == 4096)) | length')" -eq 3 ]
  evo-run train run --slot 0-2
  [ "$(cat run/timings/*.jsonl | wc -l)" -eq 3 ]
  fails_with 2 "no slot 7" -- evo-run train run --slot 7
  fails_with 2 "3-x" -- evo-run train run --slot 3-x
}

@test "train: interrupted, it says how to go on and ends with the same bytes" {
  settings=("${settings[@]/steps=4096/steps=65536}")
  begin train_options="--checkpoint-every 8192"
  populate
  evo-run train run --slot 0 && cp run/gen-000/00.json calm.json && cp run/policies/*.policy.h5 calm.h5
  rm run/gen-000/00.json run/policies/* run/timings/* run/logs/*
  evo-run train run --slot 0 2> said &
  local training=$!
  until grep -qs global_step run/logs/*.log; do kill -0 $training && sleep 0.05; done
  kill -TERM $training || true
  status=0
  wait $training || status=$?
  if [ "$status" -ne 0 ]; then
    [ "$status" -eq 143 ]
    grep -q 'evo-run: .*same command again' said
    [ ! -e run/gen-000/00.json ]
    cat run/timings/*.jsonl | jq -e '.finished | not'
  fi
  evo-run train run --slot 0
  cmp calm.json run/gen-000/00.json
  cmp calm.h5 run/policies/*.policy.h5
  [ "$(cat run/timings/*.jsonl | jq -s 'map(.steps) | add')" -eq 65536 ]
}

@test "slots: waiting, done and failed, and evo-inspect knows the time" {
  begin train_options=
  populate
  evo-run train run --slot 2
  [ "$(evo-run slots run | cut -f 4 | tr '\n' ' ')" = "state waiting waiting done " ]
  [ "$(evo-run slots run | awk '$2 == 2 { print $5 }')" = "$(jq .fitness run/gen-000/02.json)" ]
  evo-inspect run | grep -q '^training .* per robot on average'
  evo-run init bad "${settings[@]}" train_options="--train-set learning_rate=1e30"
  cp -r run/gen-000 bad/ && rm bad/gen-000/02.json
  evo-run train bad
  [ "$(evo-run slots bad | awk -F'\t' '$4 == "failed" && $5 != ""' | wc -l)" -eq 3 ]
}

@test "train: options with an open quote are refused, and no shell reads them" {
  begin train_options=
  populate
  sed -i "s/^train_options:.*/train_options: --train-set 'hidden=8/" run/run.yaml
  fails_with 65 "run.yaml" "train_options" -- evo-run train run --slot 0
  sed -i 's/^train_options:.*/train_options: $(touch here)/' run/run.yaml
  fails_with 2 "train_options" -- evo-run train run --slot 0
  [ ! -e here ]
}

@test "train: one process at a time per slot, slots side by side; one that was killed lets go" {
  settings=("${settings[@]/steps=4096/steps=51200000}")
  begin train_options=
  populate
  evo-run train run --slot 0 -j1 3>&- &
  local first=$!
  evo-run train run --slot 1 -j1 3>&- &
  local beside=$!
  until [ "$(cat run/logs/*.log 2> /dev/null | grep -c global_step)" -ge 2 ] && [ "$(ls run/logs | wc -l)" -eq 2 ]; do
    kill -0 $first && kill -0 $beside && sleep 0.1
  done
  fails_with 1 "another process is training slot 0" "same command" -- evo-run train run --slot 0
  kill -KILL $first $beside
  wait $first $beside || true
  run timeout --preserve-status -s TERM 2 evo-run train run --slot 0
  [ "$status" -eq 143 ]
  # Without a lock nobody is kept from work.
  rm run/lock && mkdir run/lock
  run timeout --preserve-status -s TERM 1 evo-run train run --slot 1
  [ "$status" -eq 143 ]
}

@test "command: make begins the same run again, or another one" {
  begin_by_make() { (cd "$EVO_SOURCE" && eval "$* -s"); }
  begin_by_make make -f scripts/ga.mk RUN="$PWD/run" TASK=Carrier-v0 POP=3 EVALS=7 STEPS=4096 SEED=5 TRAIN=lineage \
    "TRAIN_OPTIONS='--train-set \"hidden=8,8\"'" "'MUTATE_OPTIONS=--attempts 1'" FOUNDER_STEPS=8192 INHERIT=yes "$PWD/run/run.yaml"
  run evo-run command run RUN=runs/again SEED=6
  [[ $output == "make -f scripts/ga.mk RUN=runs/again TASK=Carrier-v0 POP=3 EVALS=7 "*" SEED=6 "*" -j8" ]]
  [[ $output != *ALGO=* ]]  # what lineage.yaml says
  begin_by_make "$(evo-run command run "RUN=$PWD/again")" "$PWD/again/run.yaml"
  cmp run/run.yaml again/run.yaml
  fails_with 2 "'SEED' is not VARIABLE=VALUE" -- evo-run command run SEED
  fails_with 2 "'=2' is not" -- evo-run command run =2
  fails_with 66 "no such run folder" -- evo-run command nowhere
}
