# The pipelines of scripts/*.mk as a user runs them: planned, run, killed and
# given again, refused. Small populations and short trainings; the chain is whole.
load helpers

settings=(TASK=Walker-v0 POP=4 EVALS=9 STEPS=4096 SEED=1 VIDEO=gif VIDEO_OPTIONS="--size 160x90 --every 10")

run_make() {
  local method=$1 folder=$2
  shift 2
  pipeline_words "$method" "${settings[@]}" "$@"
  make "${pipeline[@]}" RUN="$folder" "${settings[@]}" "$@"
}

# Everything of a run that must not depend on how it came about.
essence() {
  (cd "$1" && cat run.yaml gen-*/population.jsonl gen-*/scores.jsonl gen-*/ranking.tsv \
    history.jsonl best.json && sha256sum best.policy.h5 policies/*.policy.h5)
}

# Kills the pipeline with all its children at a random moment, until it has run
# through; at most $3 times.
kill_and_repeat() {
  local method=$1 folder=$2 kills=$3 i pid
  for ((i = 0; i < kills; i++)); do
    setsid make -f "$EVO_SOURCE/scripts/$method.mk" RUN="$folder" "${settings[@]}" -j2 >/dev/null 2>&1 3>&- &
    pid=$!
    random_pause
    kill -KILL -- "-$pid" 2>/dev/null || true
    wait "$pid" 2>/dev/null || true
  done
  run_make "$method" "$folder" -j2
}

@test "ga: ends at exactly EVALS robots, with everything a run ends with" {
  run_make ga run -j2
  [ "$(wc -l < run/history.jsonl)" -eq 9 ]
  [ "$(jq -r .id run/history.jsonl | sort -u | wc -l)" -eq 9 ]
  for file in best.json best.policy.h5 best.gif report.html; do [ -s "run/$file" ]; done
  for generation in run/gen-*; do
    [ "$(wc -l < "$generation/ranking.tsv")" -eq "$(wc -l < "$generation/population.jsonl")" ]
    sort -t $'\t' -k2,2gr -s "$generation/ranking.tsv" | cmp - "$generation/ranking.tsv"
  done
  [ "$(jq -s 'map(.fitness) | max' run/history.jsonl)" = "$(jq .fitness run/best.json)" ]
  # The best policy earns its recorded fitness again, to the last digit.
  evo-eval run/best.json | jq -e ".fitness == $(jq .fitness run/best.json)"
  evo-eval --policy run/best.policy.h5 run/best.json | jq -e ".fitness == $(jq .fitness run/best.json)"
  # Survivors keep their fitness and were not trained again.
  [ "$(ls run/policies/*.policy.h5 | wc -l)" -eq 9 ]
  evo-inspect run | grep -q '9 of 9 trained, 0 left'
}

@test "ga: an absolute folder and one that is moved work like any other" {
  run_make ga "$PWD/here" -j2
  mv here there
  evo-eval there/best.json | jq -e ".fitness == $(jq .fitness there/best.json)"
  run_make ga near -j2
  diff <(essence there) <(essence near)
}

@test "ga: twice the same bytes, whatever -j" {
  run_make ga one -j2
  run_make ga two
  diff <(essence one) <(essence two)
}

@test "ga: killed again and again, it ends with the same result" {
  run_make ga calm -j2
  kill_and_repeat ga stormy 10
  diff <(essence calm) <(essence stormy)
}

@test "inherit: children go on from their parents' gaits, by generations and without" {
  local inherit=(INHERIT=yes TRAIN=gait STEPS=8000 -s)
  run_make ga calm "${inherit[@]}" -j2 calm/history.jsonl
  run_make ga other "${inherit[@]}" other/history.jsonl
  diff calm/history.jsonl other/history.jsonl
  run_make ga-window steady "${inherit[@]}" -j2 steady/history.jsonl
  # A child's policy names its parent's, the first robots' name none.
  for folder in calm steady; do
    child=$(tail -n 1 $folder/history.jsonl)
    parent=$(find $folder/policies -name "$(jq -r '.parents[0]' <<< "$child").policy.h5")
    hash=$(h5dump -a settings_hash "$parent" | grep -o '[0-9a-f]\{64\}')
    [[ $(h5dump -a identity "$(find $folder/policies -name "$(jq -r .id <<< "$child").policy.h5")") == *"inherited=$hash"* ]]
  done
  [[ $(h5dump -a identity "calm/policies/$(head -n 1 calm/history.jsonl | jq -r .id).policy.h5") != *inherited=* ]]
  run -2 run_make ga third INHERIT=maybe
  [[ $output == *"yes, no or all, not 'maybe'"* ]]
}

@test "ga: a population without room for children is refused, once and before any training" {
  run -2 --separate-stderr run_make ga run POP=2 EVALS=42
  [ "$(grep -c 'no room for children' <<< "$stderr")" -eq 1 ]
  [[ $stderr == *"no plan for POP=2 EVALS=42"* ]]
  [ ! -e run/gen-000 ]
}

@test "founders have their own steps and sampling, and survive with what they had" {
  local options=(FOUNDER_STEPS=8192 SAMPLE_OPTIONS="--encoding cppn" MUTATE_OPTIONS="--attempts 1" INHERIT=yes -s)
  run_make ga calm "${options[@]}" -j2
  run_make ga other "${options[@]}" other/history.jsonl
  diff calm/history.jsonl other/history.jsonl
  jq -e -s 'length == 9 and all(.[]; .steps == if .parents | length > 0 then 4096 else 8192 end)' \
    calm/history.jsonl
  jq -e '.genome.kind == "cppn"' calm/gen-000/00.json
  grep -q "FOUNDER_STEPS=8192" calm/report.html
  run_make ga-window steady FOUNDER_STEPS=8192 -s -j2 steady/history.jsonl
  [ "$(jq -s 'map(.steps) | unique | length' steady/history.jsonl)" -eq 2 ]
}

@test "founders are the best robots of another run, trained anew" {
  run_make ga scout TRAIN=sequence STEPS=9000 INHERIT=yes -s -j2 scout/history.jsonl
  run_make ga next FOUNDERS=scout FOUNDER_STEPS=8192 INHERIT=yes -s -j2 next/history.jsonl
  ids() { jq -r .id "$@" | sort; }
  diff <(evo-select --keep 4 scout/history.jsonl | ids) <(ids next/gen-000/population.jsonl)
  jq -e -s 'all(.[]; .steps == if .parents | length > 0 then 4096 else 8192 end)' next/history.jsonl
  [[ $(evo-run command next) == *" FOUNDERS=scout "* ]]
  cp scout/history.jsonl robots.jsonl
  run_make ga from-file FOUNDERS=robots.jsonl FOUNDER_STEPS=8192 INHERIT=yes -s from-file/history.jsonl
  diff next/history.jsonl from-file/history.jsonl
  # Bodies of anywhere, as many as are wanted, need no fitness.
  evo-sample -n 4 --seed 7 > drawn.jsonl
  run_make ga drawn FOUNDERS=drawn.jsonl EVALS=4 -s drawn/history.jsonl
  diff <(ids drawn.jsonl) <(ids drawn/gen-000/population.jsonl)
  evo-sample -n 5 --seed 7 > five.jsonl
  run -2 --separate-stderr run_make ga five FOUNDERS=five.jsonl -s
  [[ $stderr == *"five.jsonl: has 5 robots and none has a fitness to choose POP=4 by; "*"POP=5 takes all"* ]]
  # One that could not be scored takes no place, and leaves none empty.
  jq -c 'if .id == $first then del(.fitness) else . end' --arg first "$(head -1 robots.jsonl | jq -r .id)" robots.jsonl > fallen.jsonl
  fails_with 65 "fallen.jsonl: has 8 different robots with a fitness, not POP=9" -- \
    bash -c '"$EVO_SOURCE/scripts/founders" 9 fallen.jsonl < fallen.jsonl'
  "$EVO_SOURCE/scripts/founders" 8 fallen.jsonl < fallen.jsonl | ids | cmp - <(tail -n +2 fallen.jsonl | ids)
  # From their controllers: a search for sequences begins with what they earn already.
  run_make ga further FOUNDERS=scout FOUNDER_STEPS=8192 TRAIN=sequence INHERIT=all -s -j2 further/history.jsonl
  fitness() { jq -r '[.id, .fitness] | @tsv' "$@" | sort; }
  join <(fitness scout/history.jsonl) <(fitness further/gen-000/scores.jsonl) |
    awk '$3 < $2 { worse = 1 } END { exit worse || NR != 4 }'
  id=$(jq -r .id further/gen-000/00.json)
  hash=$(h5dump -a settings_hash scout/policies/$id.policy.h5 | grep -o '[0-9a-f]\{64\}')
  [[ $(h5dump -a identity further/policies/$id.policy.h5) == *"inherited=$hash"* ]]
  [[ $(evo-run command further) == *" INHERIT=all "* ]]
  run ! run_make ga file FOUNDERS=robots.jsonl TRAIN=sequence INHERIT=all -s file/history.jsonl
  [[ $output == *"robots.jsonl: has no policies to go on from; INHERIT=yes trains founders anew"* ]]
  cp -r scout damaged
  rm damaged/policies/$id.policy.h5
  run ! run_make ga lacking FOUNDERS=damaged TRAIN=sequence INHERIT=all -s lacking/history.jsonl
  [[ $output == *"damaged/policies: has no policy of robot $id to go on from"* ]]
  run ! run_make ga alone INHERIT=all -s
  [[ $output == *"INHERIT=all is for FOUNDERS that have controllers"* ]]
  head -n 3 robots.jsonl > few.jsonl
  run -2 --separate-stderr run_make ga too-few FOUNDERS=few.jsonl -s
  [[ $stderr == *"few.jsonl: has 3 different robots, not POP=4"* ]]
  [ ! -e too-few/gen-000/population.jsonl ]
  run -2 --separate-stderr run_make ga nothing FOUNDERS=none -s
  [[ $stderr == *"none"* && $stderr != *"different robots"* ]]
  for pipeline in map neat; do
    run -2 --separate-stderr run_make $pipeline $pipeline FOUNDERS=scout
    [[ $stderr == *"no setting FOUNDERS (a setting of ga.mk modular.mk)"* ]]
  done
}

@test "rounds: each begins with the best of the one before, killed or not" {
  rounds() {
    make -f "$EVO_SOURCE/scripts/rounds.mk" RUN="$1" TASK=Walker-v0 SEED=1 VIDEO=gif VIDEO_OPTIONS="--size 160x90 --every 10" \
      ALGO=gait TRAIN_OPTIONS="--train-set population=4" STEPS=4000 ROUND_1='POP=4 EVALS=7' ROUND_2='POP=3 EVALS=5' \
      ROUND_3='POP=2 EVALS=2 FOUNDER_STEPS=8000' "${@:2}"
  }
  rounds calm -s -j2
  ids() { jq -r .id "$@" | sort; }
  diff <(evo-select --keep 3 calm/1/history.jsonl | ids) <(ids calm/2/gen-000/population.jsonl)
  diff <(evo-select --keep 2 calm/2/history.jsonl | ids) <(ids calm/3/history.jsonl)
  [ "$(jq -s 'map(.steps) | unique | length' calm/3/history.jsonl)" -eq 1 ]
  [ "$(cat calm/*/run.yaml | grep -c '^seed: [123]$')" -eq 3 ]
  [ -s calm/3/report.html ]
  [ ! -e calm/1/report.html ]
  # Rounds may be added to what has ended.
  rounds parts -s -j2 ROUND_3=
  [ ! -e parts/3 ]
  rounds parts -s -j2
  diff calm/3/best.json parts/3/best.json

  for _ in 1 2 3 4; do
    setsid bash -c "$(declare -f rounds); rounds stormy -j2" > /dev/null 2>&1 3>&- &
    random_pause
    kill -KILL -- "-$!" 2> /dev/null || true
    wait "$!" 2> /dev/null || true
  done
  rounds stormy -s -j2
  for round in 1 2 3; do diff <(sort calm/$round/history.jsonl) <(sort stormy/$round/history.jsonl); done
  diff calm/3/best.json stormy/3/best.json

  run -2 --separate-stderr rounds calm SEED=2
  [[ $stderr == *"calm/1 belongs to a run with other settings (seed: 1 there, seed: 2 asked for)"* ]]
}

@test "rounds: what cannot be meant is refused before anything is made" {
  refused() {
    run -2 --separate-stderr make -f "$EVO_SOURCE/scripts/rounds.mk" RUN=run "${@:2}"
    [[ $stderr == *"$1"* ]]
    [ ! -e run ]
  }
  refused "there is no RECIPE 'nets'; choose network, moments, long, easier, sequence or shape" RECIPE=nets
  refused "there is no easier world for Walker-v0 in tasks/easier; give EASIER" TASK=Walker-v0 RECIPE=easier
  refused "RECIPE=easier is for bodies that are there: give FOUNDERS" TASK=PlatformJumper-v0 RECIPE=easier
  refused "EASIER is at most eight tasks" RECIPE=easier EASIER="1 2 3 4 5 6 7 8 9" FOUNDERS=bodies
  refused "ROUND_1 is missing" ROUND_2=POP=3
  refused "EVALS is decided round by round" EVALS=7
  refused "STEPS is decided round by round" STEPS=7 ROUND_1=STEPS=4000
  planned() {
    make -s -f "$EVO_SOURCE/scripts/rounds.mk" RUN=run TASK=PlatformJumper-v0 RECIPE="$1" FOUNDERS=bodies "${@:2}"
  }
  for recipe in network:2 moments:2 long:3 easier:4 sequence:2 shape:2; do
    planned ${recipe%:*} -n > plan
    for ((round = 1; round <= ${recipe#*:}; round++)); do grep -q "evo-run init 'run/$round' method=ga" plan; done
    [ "$(grep -c "evo-run init" plan)" -eq ${recipe#*:} ]
    [ "$(planned ${recipe%:*} rounds)" = "$(seq -s ' ' ${recipe#*:})" ]
  done
}

@test "rounds: each may have a task of its own, and goes on with the controllers of the one before" {
  make -f "$EVO_SOURCE/scripts/rounds.mk" RUN=run TASK=PlatformJumper-v0 SEED=1 VIDEO=gif VIDEO_OPTIONS="--size 160x90 --every 50" \
    ROUND_1='TASK=PlatformJumper-v0-1 POP=2 EVALS=2 STEPS=2048' ROUND_2='POP=1 EVALS=1 STEPS=2048 INHERIT=all' -s -j2
  jq -es 'all(.task == "PlatformJumper-v0-1")' run/1/history.jsonl
  jq -e '.task == "PlatformJumper-v0"' run/2/best.json
  [ "$(jq -r .id run/2/best.json)" = "$(evo-select --keep 1 run/1/history.jsonl | jq -r .id)" ]
  make -s -n -f "$EVO_SOURCE/scripts/rounds.mk" RUN=plan TASK=Walker-v0 RECIPE=easier EASIER="ramp.yaml BridgeWalker-v0" \
    FOUNDERS=run/1/best.json | sed -n "s/.*evo-run init 'plan.*task='\([^']*\)'.*/\1/p" > tasks
  diff tasks - <<< "$(printf '%s\n' ramp.yaml BridgeWalker-v0 Walker-v0)"
}

@test "neat and bo: exactly as asked, no body twice, twice the same bytes" {
  for method in neat bo; do
    run_make $method $method-one -j2
    [ "$(wc -l < $method-one/history.jsonl)" -ge 9 ]
    [ "$(jq -r .id $method-one/history.jsonl | sort -u | wc -l)" -eq "$(wc -l < $method-one/history.jsonl)" ]
    run_make $method $method-two -j1
    diff <(essence $method-one) <(essence $method-two)
    # Every robot of a population was trained, however many there are.
    for generation in $method-one/gen-*; do
      [ "$(wc -l < "$generation/scores.jsonl")" -eq "$(wc -l < "$generation/population.jsonl")" ]
    done
  done
  jq -e '.genome.kind == "cppn"' neat-one/best.json
}

@test "map: an archive of kinds, twice the same bytes, killed or not" {
  run_make map calm -j2
  kill_and_repeat map stormy 3
  diff <(essence calm) <(essence stormy)
  [ "$(wc -l < calm/history.jsonl)" -eq 9 ]
  [ "$(jq -r .id calm/history.jsonl | sort -u | wc -l)" -eq 9 ]
  [ "$(wc -l < calm/archive.tsv)" -eq $(($(wc -l < calm/archive.jsonl) + 1)) ]
  [ "$(jq -s 'map(.fitness) | max' calm/archive.jsonl)" = "$(jq .fitness calm/best.json)" ]
}

@test "map without generations: an archive of kinds, from founders as sampled, any -j" {
  local features=(FEATURES=filled:3,behaviour.distance:4:-2:2 SAMPLE_OPTIONS="--encoding cppn")
  run_make map-window one "${features[@]}" -s -j2
  run_make map-window two "${features[@]}" CHUNK=2 -s two/history.jsonl
  diff one/history.jsonl two/history.jsonl
  jq -es '.[0].genome.kind == "cppn"' one/gen-000/scores.jsonl
  [ "$(jq -r .id one/history.jsonl | sort -u | wc -l)" -eq 9 ]
  [ "$(wc -l < one/archive.tsv)" -eq $(($(wc -l < one/archive.jsonl) + 1)) ]
  # Children descend from the elites among the scores that their numbers know.
  jq -r .id one/history.jsonl > ids
  robot=8
  head -n $((robot - 4)) one/history.jsonl | evo-archive -q --features filled:3,behaviour.distance:4:-2:2 | jq -r .id > elites
  grep -qxF "$(sed -n $((robot + 1))p one/history.jsonl | jq -r '.parents[0]')" elites
}

@test "map: behaviours as axes are measured, kept and drawn" {
  run_make map run -j2 FEATURES=behaviour.distance:4:-2:2,behaviour.aloft:2:0:1
  grep -q "^train_options: '--behaviour'" run/run.yaml
  jq -se 'length == 9 and all(.behaviour | keys == ["aloft", "distance", "rise", "width"])' run/history.jsonl
  head -n 1 run/archive.tsv | grep -q "^behaviour.distance$(printf '\t')behaviour.aloft"
  grep -q 'behaviour.distance, voxels' run/report.html
  # It is that of the episode that the fitness is from, for the best in Walker: 0.1 a voxel.
  jq -e '(.behaviour.distance * 0.1 - .fitness | fabs) < 1e-9' run/best.json
  evo-eval --behaviour run/best.json | jq -c .behaviour | diff - <(jq -c .behaviour run/best.json)
  # A fitness of another evaluation takes it away, and children have none.
  evo-eval run/best.json | jq -e 'has("behaviour") | not'
  evo-mutate run/best.json | jq -e 'has("behaviour") | not'
  # The same command again, and the one that the run says, find everything done.
  run_make map run -s FEATURES=behaviour.distance:4:-2:2,behaviour.aloft:2:0:1
  (cd "$EVO_SOURCE" && eval "$(evo-run command "$BATS_TEST_TMPDIR/run") -s")
}

# Of the robot of a line of JSON: how long it was trained, and what it earned.
steps_and_fitness() { jq -c 'select(.id == "'"$2"'") | [.steps, .fitness]' "$1"; }

@test "race: half of the robots go on to twice the steps, in one training each" {
  run_make race run POP=5 EVALS=8 RUNGS=3 STEPS=8192 INHERIT=yes -j2
  [ "$(wc -l run/gen-*/population.jsonl | awk '{ printf "%s ", $1 }')" = "5 3 2 3 2 1 16 " ]
  [ "$(jq -r .steps run/gen-*/scores.jsonl | paste -s -d ' ')" = \
    "2048 2048 2048 2048 2048 4096 4096 4096 8192 8192 2048 2048 2048 4096 4096 8192" ]
  # Those that go on are the best, and nothing is left of the others' trainings.
  for rung in 1 2 4 5; do
    before=run/gen-00$((rung - 1))
    diff <(jq -r .id "run/gen-00$rung/population.jsonl") \
      <(head -n "$(wc -l < "run/gen-00$rung/population.jsonl")" "$before/ranking.tsv" | cut -f1)
  done
  [ -z "$(find run/policies -name '*.checkpoint.h5')" ]
  # Every robot once, as it was in the end.
  [ "$(wc -l < run/history.jsonl)" -eq 8 ]
  champion=$(jq -r .id run/best.json)
  [ "$(jq .steps run/best.json)" -eq 8192 ]
  [ "$(steps_and_fitness run/history.jsonl "$champion")" = "[8192,$(jq .fitness run/best.json)]" ]
  evo-eval --policy run/best.policy.h5 run/best.json | jq -e ".fitness == $(jq .fitness run/best.json)"
  evo-inspect run | grep -q '8 of 8 trained, 0 left'
  # Parents have run to the end.
  for parent in $(jq -r '.parents[]' run/gen-003/population.jsonl); do
    grep -q "^$parent" run/gen-002/ranking.tsv
  done
  # The same as by hand.
  robot=$(head -n1 run/gen-002/ranking.tsv | cut -f1)
  jq -c "select(.id == \"$robot\")" run/gen-000/population.jsonl > robot.json
  for steps in 2048 4096 8192; do
    evo-train -q robot.json --task Walker-v0 --algo ppo --steps $steps --seed 1 --resume --keep-checkpoint --out-dir byhand -o byhand.json
  done
  [ "$(steps_and_fitness byhand.json "$robot")" = "$(steps_and_fitness run/gen-002/scores.jsonl "$robot")" ]
}

@test "race: one that fails as a whole ends nothing, and the next has its parents from before" {
  settings+=(EVALS=12 RUNGS=2 INHERIT=yes)
  run_make race run EVALS=4 -j2 # a race alone, to have its first generations
  mkdir again && cp -r run/gen-000 run/gen-001 run/policies run/logs run/timings again
  sed 's/^evals: .*/evals: 12/' run/run.yaml > again/run.yaml
  run_make race again GEN=2 again/gen-002/population.jsonl
  evo-run fail again --generation 2 --slot 0-3 --why "its machine was taken away"
  run_make race again -j2
  [ ! -s again/gen-003/population.jsonl ]
  [ "$(wc -l < again/gen-004/population.jsonl)" -eq 4 ]
  [ "$(wc -l < again/history.jsonl)" -eq 12 ]
  for parent in $(jq -r '.parents[]' again/gen-004/population.jsonl); do
    grep -q "^$parent" again/gen-001/ranking.tsv
  done
}

# A task in Python; Debian's has numpy.
own_task() {
  export EVO_PYTHON=/usr/bin/python3
  "$EVO_PYTHON" -c 'import numpy' 2> /dev/null || skip "$EVO_PYTHON has no numpy"
  settings=(TASK=hop.py:Hop POP=3 EVALS=6 STEPS=512 SHAPE=3x3 SEED=1 VIDEO=apng
    TRAIN_OPTIONS='--train-set environments=4 --train-set rollout=32 --train-set minibatches=4')
  cat > hop.py <<'END'
import numpy as np
import evo_robots

class Hop(evo_robots.Task):
    steps = 60

    def observe(self, now):
        return np.concatenate([now.mean_velocity("robot"), now.shape("robot")], axis=1)

    def reward(self, before, now):
        return now.mean_velocity("robot")[:, 1]
END
}

@test "a task in Python: the same bytes by any -j, killed or not, by generations and without" {
  own_task
  run_make ga calm -j2
  [ "$(jq -s 'map(.fitness) | unique | length' calm/history.jsonl)" -gt 3 ]
  for file in best.json best.policy.h5 best.apng; do [ -s "calm/$file" ]; done
  [ ! -e calm/best.rollout.h5 ]
  [ "$(jq -r .policy calm/best.json)" = "policies/$(jq -r .id calm/best.json).policy.h5" ]
  [ -z "$(find calm -name '*.running' -o -name '*.tmp')" ]
  kill_and_repeat ga stormy 4
  diff <(essence calm) <(essence stormy)
  run_make ga-window window -s
  [ "$(wc -l < window/history.jsonl)" -eq 6 ]
}

@test "a task in Python: what it cannot do is refused in a line, before anything is made" {
  own_task
  local word said
  while IFS='|' read -r word said; do
    run --separate-stderr run_make ga run "$word"
    [ "$status" -eq 2 ]
    [[ "$stderr" == *"$said"* ]]
    [ ! -e run ]
  done <<'END'
INHERIT=yes|inherit=yes is for tasks of the suite: hop.py:Hop is a class in Python
PHYSICS=paper|physics=paper is for tasks of the suite
TRAIN=sequence|algorithm sequence needs a task of the suite
STEPS=100|100 steps are less than one rollout
TASK=hop.py:Run|hop.py: 'Run' is no evo_robots.Task; there are: Hop
TASK=none.py:Hop|none.py: there is no such file
VIDEO_OPTIONS=--grid|VIDEO_OPTIONS are of evo-render
END
  printf 'raise ImportError("No module named numpy")\n' > numpy.py
  PYTHONPATH=. run --separate-stderr run_make ga run
  [[ "$stderr" == *"TASK=hop.py:Hop needs the package evo_robots, which /usr/bin/python3 cannot load (No module named numpy)"* ]]
  EVO_PYTHON=no-python run --separate-stderr run_make ga run
  [[ "$stderr" == *"there is no no-python; install it, or name it in EVO_PYTHON"* ]]
  [ ! -e run ]
  # A mistake in the task shows where it is, and ends the run, which goes on when it is mended.
  rm numpy.py
  sed -i 's/return now.mean_velocity/return now.speed/' hop.py
  run --separate-stderr run_make ga run
  [ "$status" -eq 2 ]
  [[ "$stderr" == *'hop.py", line '*"no attribute 'speed'"* ]]
  [ -z "$(find run -name '*.running')" ]
  sed -i 's/return now.speed/return now.mean_velocity/' hop.py
  run_make ga run -s run/best.json
  run -2 evo-run train run --slot 0
  [[ $output == *"run: its task is a class in Python"* ]]
  evo-sample -n 1 > robot.json
  fails_with 2 "hop.py:Hop is a task in Python" -- evo-train robot.json --task hop.py:Hop
}

# Small, and long enough that a controller changes.
modular=(POP=6 CHILDREN=2 EVALS=9 STEPS=3072 CHAMPIONS=2 OWN_STEPS=2048
  TRAIN_OPTIONS='--train-set environments=2 --train-set evaluation_interval=4')

@test "modular: one controller learns on all robots of a generation, and the best go on alone" {
  settings+=("${modular[@]}")
  run_make modular run -j2
  [ "$(wc -l run/gen-*/population.jsonl | awk '{ printf "%s ", $1 }')" = "6 6 6 2 20 " ]
  [ "$(wc -l < run/history.jsonl)" -eq 9 ]
  # A share each of the steps of one training.
  [ "$(jq -r .steps run/gen-000/scores.jsonl | sort -u)" = \
    "$(evo-convert run/policies/gen-000.policy.h5 --to json | jq '.steps / 6')" ]
  for generation in 1 2; do
    now=run/gen-00$generation before=run/gen-00$((generation - 1))
    # The young stay, of the others the best; children are new, and of robots that stay.
    children=$((3 - generation))
    jq -r .id $now/population.jsonl | head -n -$children | sort > stay
    jq -r .id $now/population.jsonl | tail -n $children > children
    jq -r .id $before/population.jsonl | tail -n $(((generation - 1) * 2)) | sort > young
    [ -z "$(comm -23 young stay)" ]
    grep -v -F -f <(cat young; echo none) $before/ranking.tsv | head -n $((6 - children - $(wc -l < young))) |
      cut -f1 | cat - young | sort | cmp - stay
    run ! grep -q -F -f children $before/population.jsonl
    [ -z "$(tail -n $children $now/population.jsonl | jq -r '.parents[]' | sort -u | comm -23 - stay)" ]
    # The controller goes on from that of the generation before.
    [ "$(evo-convert run/policies/gen-00$generation.policy.h5 --to json | jq '.robots | length')" -eq 6 ]
    h5dump -a identity run/policies/gen-00$generation.policy.h5 | grep -q inherited=
  done
  # What a robot earns is with the controller that its document names.
  evo-eval -q run/gen-001/scores.jsonl | jq .fitness | cmp - <(jq .fitness run/gen-001/scores.jsonl)
  evo-eval -q run/history.jsonl | jq .fitness | cmp - <(jq .fitness run/history.jsonl)
  diff <(jq -r .id run/gen-003/population.jsonl) <(head -n 2 run/gen-002/ranking.tsv | cut -f1)
  for id in $(jq -r .id run/gen-003/population.jsonl); do
    [ "$(steps_and_fitness run/gen-003/scores.jsonl "$id" | jq '.[0]')" -eq \
      $(($(steps_and_fitness run/gen-002/scores.jsonl "$id" | jq '.[0]') + 2048)) ]
    [ -s "run/policies/$id.policy.h5" ]
  done
  for file in best.json best.policy.h5 best.gif report.html; do [ -s "run/$file" ]; done
  evo-inspect run | grep -q '9 of 9 trained, 0 left'
  # Without champions the best robot's controller is that of all.
  sed 's/^champions: .*/champions: 0/' -i run/run.yaml
  rm -r run/gen-003 run/policies/[!g]* run/best.* run/history.jsonl
  run_make modular run CHAMPIONS=0
  evo-eval --policy run/best.policy.h5 run/best.json | jq -e ".fitness == $(jq .fitness run/best.json)"
  evo-render --poster run -o poster.svg
  evo-render --evolution run --size 160x90 --every 50 -o film.gif
  evo-run slots run | awk 'NR > 1 && $4 != "done"' | cmp - /dev/null
}

@test "modular: the same bytes, killed or not" {
  settings+=("${modular[@]}" LAYERS=2)
  kill_and_repeat modular killed 12
  run_make modular whole
  diff <(essence killed) <(essence whole)
}

@test "modular: from the controller of another run, and bodies that it chose" {
  # Settings of the training hold to the end, of the champions' as well.
  settings+=("${modular[@]}" "TRAIN_OPTIONS=${modular[6]#TRAIN_OPTIONS=} --train-set gating=none")
  run_make modular first EVALS=7 CHAMPIONS=0 first/history.jsonl
  run_make modular next FOUNDERS=first INHERIT=all SCREEN=12 SHAPE=4x4 SEED=9 EVALS=8 -j2 next/history.jsonl
  controller=first/policies/gen-001.policy.h5
  evo-sample -n 12 --shape 4x4 --seed 9000000 | evo-eval -q --policy $controller --seed 9 --failures skip | evo-select --keep 6 |
    jq -r .id | cmp - <(jq -r .id next/gen-000/population.jsonl)
  # The first generation goes on from it, the next with what the one before has learnt.
  inherited() { h5dump -a identity $1 | grep -o 'inherited=[0-9a-f]*'; }
  hash_of() { h5dump -a settings_hash "$1" | grep -o '[0-9a-f]\{64\}'; }
  [ "$(inherited next/policies/gen-000.policy.h5)" = "inherited=$(hash_of $controller)" ]
  [ "$(inherited next/policies/gen-001.policy.h5)" = "inherited=$(hash_of next/policies/gen-000.policy.h5)" ]
  best=$(jq -r .id next/gen-002/scores.jsonl | head -n 1)
  [ "$(inherited "next/policies/$best.policy.h5")" = "inherited=$(hash_of next/policies/gen-001.policy.h5)" ]
  [[ $(evo-run command next) == *" INHERIT=all FOUNDERS=first SCREEN=12 "* ]]
  # Or its best robots, with a controller of their own.
  run_make modular anew FOUNDERS=first EVALS=6 CHAMPIONS=0 anew/history.jsonl
  evo-select --keep 6 first/history.jsonl | jq -r .id | sort | cmp - <(jq -r .id anew/gen-000/population.jsonl | sort)
  run ! inherited anew/policies/gen-000.policy.h5
  # What it ends with can be a record.
  RECORDS=records "$EVO_SOURCE/scripts/add-record" next
  record=records/Walker-v0/record.json
  [ "$(jq -r .controller $record)" = modular ] && cmp records/Walker-v0/policy.h5 "next/policies/$(jq -r .robot $record).policy.h5"
  [[ $(jq -r .command $record) == *"modular.mk RUN=runs/scout "*" && "*"modular.mk RUN=runs/record "*"FOUNDERS=runs/scout"* ]]
  # Others go on from a record.
  run_make modular further FOUNDERS=records/Walker-v0 INHERIT=all SCREEN=12 SHAPE=4x4 SEED=9 EVALS=6 CHAMPIONS=0 further/history.jsonl
  [ "$(inherited further/policies/gen-000.policy.h5)" = "inherited=$(hash_of records/Walker-v0/policy.h5)" ]
  head -3 first/history.jsonl > few
  refused_at_once modular FOUNDERS=few "few: has 3 different robots, not POP=6"
  refused_at_once modular SCREEN=12 "SCREEN=12 needs FOUNDERS, a run of modular.mk"
  run ! run_make modular run FOUNDERS=first SCREEN=5
  [[ $output == *"SCREEN=5 is less than POP=6"* ]]
  cp -r anew other && rm other/policies/gen-*
  run ! run_make modular run FOUNDERS=other INHERIT=all
  [[ $output == *"other: has no controller of all robots to go on from; INHERIT=no begins with a new one"* ]]
  [ ! -e run/run.yaml ]
}

@test "modular: who stays, by grace and layers of age" {
  mkdir run
  evo-sample -n 12 --seed 3 > twelve
  for generation in 0 1 2 3; do
    mkdir run/gen-00$generation
    head -n $((6 + 2 * generation)) twelve > run/gen-00$generation/population.jsonl
  done
  # The older the fitter, but for the last, which has failed.
  jq -c '.fitness = (if input_line_number == 12 then null else 20 - input_line_number end) | .steps = 7' \
    twelve > run/gen-003/scores.jsonl
  stay() { "$EVO_SOURCE/scripts/stay" run 4 "$@" | jq -r .id | grep -n -F -f - <(jq -r .id twelve) | cut -d: -f1 | paste -sd ' '; }
  [ "$(stay 6 0 1)" = "1 2 3 4 5 6" ]
  [ "$(stay 6 1 1)" = "1 2 3 4 5 11" ]
  [ "$(stay 6 2 1)" = "1 2 3 9 10 11" ]
  [ "$(stay 6 0 2)" = "1 2 3 4 5 11" ]  # of age 0, and from 1 on; what one leaves the others take
  [ "$(stay 6 0 3)" = "1 2 3 7 8 11" ]  # of age 0, 1 and 2, and from 3 on
  [ "$(stay 7 1 3)" = "1 2 7 8 9 10 11" ]
  "$EVO_SOURCE/scripts/stay" run 4 6 1 1 | jq -e '.steps == 7 and (has("fitness") or has("policy") | not)'
}

@test "modular: what cannot be meant is refused before anything is made" {
  refused_at_once ga GRACE=2 "ga.mk has no setting GRACE (a setting of modular.mk)"
  settings+=("${modular[@]}")
  refused_at_once modular POP=4 "POP=4 leaves no place for robots out of GRACE; more than CHILDREN x (GRACE + 1) are needed, 4"
  refused_at_once modular INHERIT=yes "INHERIT is no or all in modular.mk, not 'yes'"
  refused_at_once modular FOUNDER_STEPS=9 "FOUNDER_STEPS is no setting of modular.mk"
  refused_at_once modular EVALUATE=true "EVALUATE is no setting of modular.mk"
  refused_at_once modular TRAIN=default "train=default: ppo makes a controller for each robot"
  refused_at_once modular OWN_OPTIONS='--algo ppo' "ppo makes a controller for each robot"
  refused_at_once modular STEPS=100 "100 steps are less than one rollout of 12 x 16"
  refused_at_once modular OWN_STEPS=100 "100 steps are less than one rollout"
  refused_at_once modular LAYERS=0 "LAYERS is a number from 1, not '0'"
  refused_at_once modular CHAMPIONS=x "CHAMPIONS is a number from 0, not 'x'"
  refused_at_once modular WINDOW=5 "modular.mk has no setting WINDOW"
  refused_at_once modular SHAPE=5 "--shape: '5'"
  refused_at_once modular SAMPLE_OPTIONS='--weights 1' "evo-sample: --weights: expected 5"
  refused_at_once modular MUTATE_OPTIONS='--rate 5' "evo-mutate: --rate must be"
  # A generation that has one controller has no slots of its own.
  run_make modular run -s run/run.yaml
  run_make modular run -s GEN=0 run/gen-000/population.jsonl
  fails_with 2 "generation 0 has one controller for its 6 robots" -- evo-run train run --generation 0 --slot 1
}

@test "race: the same bytes, killed or not" {
  settings+=(RUNGS=2 INHERIT=yes)
  kill_and_repeat race killed 12
  run_make race whole
  diff <(essence killed) <(essence whole)
}

@test "race: what cannot be meant is refused before anything is made" {
  run --separate-stderr run_make race run RUNGS=0
  [ "$status" -eq 2 ]
  [[ "$stderr" == *"RUNGS is a number from 1, not '0'"* ]]
  run --separate-stderr run_make race run PARENTS=none
  [[ "$stderr" == *"PARENTS is a number from 1, not 'none'"* ]]
  for method in race map neat ga; do
    run --separate-stderr run_make $method run POP=0
    [ "$status" -eq 2 ]
    [[ "$stderr" == *"POP is a number from 1, not '0'"* ]]
  done
  run --separate-stderr run_make race run FOUNDER_STEPS=8192
  [[ "$stderr" == *"FOUNDER_STEPS is no setting of race.mk"* ]]
  run --separate-stderr run_make race run EVALUATE=true
  [[ "$stderr" == *"EVALUATE is no setting of race.mk"* ]]
  [ ! -e run ]
}

@test "neat and bo: killed, they end with the same result" {
  for method in neat bo; do
    run_make $method $method-calm -j2
    kill_and_repeat $method $method-stormy 3
    diff <(essence $method-calm) <(essence $method-stormy)
  done
}

@test "compare: methods and seeds side by side end as a table, a plot and a report" {
  compare() {
    make -f "$EVO_SOURCE/scripts/compare.mk" RUN=all "${settings[@]:1}" EVALS=6 -j2 METHODS="ga bo" SEEDS="1 2" "$@"
  }
  compare TASKS="Walker-v0 Jumper-v0"
  [ "$(cut -f 1,2,4 all/compare.tsv | sort -u | wc -l)" -eq 5 ]
  [ "$(wc -l < all/compare.tsv)" -eq $((1 + 2 * 2 * 6)) ]
  # What the table says of one method after its last robot, from the runs themselves.
  local mean
  mean=$(cat all/Jumper-v0/bo-{1,2}/best.json | jq -s 'map(.fitness) | add / length')
  awk -F'\t' -v mean="$mean" '$1 == "Jumper-v0" && $2 == "bo" && $3 == 6 {
    found = ($5 - mean) ^ 2 < 1e-18 && $7 <= $5 && $5 <= $8 } END { exit !found }' all/compare.tsv
  # Best so far never falls.
  awk -F'\t' 'NR > 1 { if (last[$1 $2] != "" && $5 < last[$1 $2]) exit 1; last[$1 $2] = $5 }' all/compare.tsv
  awk -F'\t' 'NR > 1 && ($9 < $7 || $9 > $8) { exit 1 }' all/compare.tsv
  grep -q '</svg>' all/compare.svg
  grep -q "prefers-color-scheme: dark" all/compare.svg
  # A method has one colour, in the picture as on the page; and no legend lies on a curve.
  for color in '217, *115, *13' '47, *134, *201'; do grep -qiE "rgb\\( *$color\\)" all/compare.svg; done
  sed -n 's|.*id="data">\(.*\)</script>|\1|p' all/compare.html |
    jq -e '.charts["chart-1"] as $c | [$c.labels[1:], $c.series] | transpose | all(if .[0] | test("(^|/)ga") then .[1].color == 0 else .[1].color == 1 end)'
  grep -q "palette = \['#d9730d', '#2f86c9'" "$EVO_SOURCE/render/report/charts.js"
  [ -s all/compare.html ]
  # A further seed adds to what is there.
  touch all/mark
  compare TASKS=Walker-v0 SEEDS="1 2 3"
  [ "$(tail -n 1 all/compare.tsv | cut -f 4)" -eq 3 ]
  [ -z "$(find all/Walker-v0/ga-1/policies -newer all/mark)" ]
  run compare TASKS=Walker-v0 METHODS=gaa
  [ "$status" -ne 0 ]
  [[ $output == *"there is no 'gaa'"* ]]
}

@test "a changed setting in an existing run is refused, not mixed in" {
  make -f "$EVO_SOURCE/scripts/ga.mk" RUN=run "${settings[@]}" run/run.yaml
  run make -f "$EVO_SOURCE/scripts/ga.mk" RUN=run "${settings[@]}" STEPS=8192 run/run.yaml
  [ "$status" -ne 0 ]
  [[ $output == *"other settings"* && $output == *"steps: 8192"* ]]
  [[ $output == *"nothing has been trained in it yet: removing it loses nothing"* ]]
  make -f "$EVO_SOURCE/scripts/ga.mk" RUN=run "${settings[@]}" run/run.yaml
  touch run/policies/0123456789ab.checkpoint.h5
  run make -f "$EVO_SOURCE/scripts/ga.mk" RUN=run "${settings[@]}" STEPS=8192 run/run.yaml
  [[ $output == *"other settings"* && $output != *"removing it"* ]]
}

# Refused with these words before anything is made: pipeline, what is wrong with it, words.
refused_at_once() {
  run --separate-stderr run_make "$1" run "$2"
  [ "$status" -eq 2 ]
  [[ "${stderr_lines[0]}" == *"$3"* ]]
  [ ! -e run/run.yaml ]
}

@test "a name that a pipeline does not have is refused, with those that it has" {
  refused_at_once ga EVAL=8 "ga.mk has no setting EVAL; it has EVALS EVALUATE"
  refused_at_once ga POPULATION=8 "ga.mk has no setting POPULATION; it has POP"
  refused_at_once ga evals=8 "ga.mk has no setting evals; it has ALGO CHUNK"
  refused_at_once race WINDOW=5 "race.mk has no setting WINDOW (a setting of ga.mk neat.mk bo.mk map.mk)"
  refused_at_once neat FOUNDERS=lost "neat.mk has no setting FOUNDERS (a setting of ga.mk modular.mk); it has ALGO"
  refused_at_once neat SEEDS=1 "neat.mk has no setting SEEDS; it has SEED."
  for pipeline in compare rounds records; do
    run -2 make -f "$EVO_SOURCE/scripts/$pipeline.mk" RUN=run STEP=8
    [[ $output == *"$pipeline.mk has no setting STEP; it has FOUNDER_STEPS STEPS."* ]]
    [ ! -e run ]
  done
  # A makefile of one's own may have settings of its own.
  printf 'all:\n\t+@$(MAKE) -s -n -f "$(EVO_SOURCE)/scripts/ga.mk" RUN=run\n' > Makefile
  make EVAL=8 > plan
  grep -q "evals='250'" plan
}

@test "a new setting is a line of the table" {
  cp -r "$EVO_SOURCE/scripts" .
  printf 'mood\tga map\tcalm|wild\tcalm\tchanged\tof its own\n' >> scripts/settings.tsv
  printf 'vigour\tall\tcount\t7\tyes\tof its own\n' >> scripts/settings.tsv
  make -n -f scripts/ga.mk RUN=run "MOOD=wild" run/run.yaml | grep "evo-run init .* mood='wild' vigour='7'"
  make -n -f scripts/map.mk RUN=run VIGOUR=8 run/run.yaml | grep "evo-run init .* vigour='8'" | grep -v mood=
  run -2 make -f scripts/bo.mk RUN=run MOOD=calm
  [[ $output == *"bo.mk has no setting MOOD (a setting of ga.mk map.mk)"* ]]
  run -2 make -f scripts/ga.mk RUN=run MOOD=sad
  [[ $output == *"MOOD is calm or wild, not 'sad'"* ]]
  run -2 make -f scripts/ga.mk RUN=run VIGOUR=none
  [[ $output == *"VIGOUR is a number from 1, not 'none'"* ]]
  awk -f "$EVO_SOURCE/docs/man/settings.awk" scripts/settings.tsv "$EVO_SOURCE/docs/man/evo-pipelines.7.scd" | grep -A1 -F '*MOOD*=_calm|wild_'
  [ ! -e run ]
}

@test "what a tool is asked for only later is refused at the beginning" {
  for method in ga map neat bo race ga-window neat-window; do refused_at_once $method SHAPE=5 "--shape: '5'"; done
  for method in ga map race; do
    refused_at_once $method SAMPLE_OPTIONS='--weights 1' "evo-sample: --weights: expected 5"
  done
  for method in ga map race ga-window; do
    refused_at_once $method MUTATE_OPTIONS='--rate 5' "evo-mutate: --rate must be"
  done
  refused_at_once map FEATURES=height "evo-archive: --features: 'height'"
  refused_at_once neat NEAT=lost.yaml "evo-neat: lost.yaml: cannot be opened"
  refused_at_once ga FOUNDERS=lost "lost: cannot be opened"
}

@test "numbers that are none, quotes and line breaks are refused at once" {
  local name value method
  for method in ga neat bo map race modular map-window; do
    for name in CHUNK POP EVALS CORES TRIES; do
      for value in -1 0 x '' "3'"; do
        pipeline_words $method "${settings[@]}"
        run --separate-stderr timeout 10 make "${pipeline[@]}" RUN=run "${settings[@]}" "$name=$value"
        [ "$status" -eq 2 ]
        [[ $stderr == *"$name is a number from 1"* || $stderr == *"$name=3' has a quote in it"* ]]
      done
    done
    for name in TASK SHAPE TRAIN PHYSICS FOUNDER_STEPS; do
      refused_at_once $method "$name=a'b" "$name=a'b has a quote in it"
      refused_at_once $method "$name=a"$'\n'"touch broken" "$name has a line break in it"
    done
    refused_at_once $method VIDEO=mpeg "VIDEO is mp4, webm, gif or apng, not 'mpeg'"
  done
  refused_at_once ga MUTATE_OPTIONS=$'--rate\ntouch broken' "MUTATE_OPTIONS has a line break in it"
  refused_at_once bo WINDOW=x "WINDOW is a number from 1, not 'x'"
  run -2 --separate-stderr run_make ga run WINDOW=2 CHUNK=3
  [[ $stderr == *"CHUNK is a number from 1 to WINDOW, which is 2, not '3'"* ]]
  run -2 --separate-stderr run_make ga run WINDOW=2 MUTATE=mine
  [[ $stderr == *"MUTATE makes the children of generations"* ]]
  # GNU screen sets a variable of this name.
  WINDOW=0 run_make ga run -n run/run.yaml > plan
  run ! grep window= plan
  rm plan
  for value in "a'b" 'a"b' 'a b' $'a\nb' 'a&b' 'a`b' 'a<b' 'a>b' 'a!b' 'a;b' 'a|b'; do
    run --separate-stderr timeout 10 make -f "$EVO_SOURCE/scripts/ga.mk" "${settings[@]}" "RUN=$value"
    [ "$status" -eq 2 ]
    [[ $stderr == *"RUN"* ]]
  done
  rm -f separate-stderr-*
  [ -z "$(ls)" ]
}

@test "steps that a training cannot do with are refused before the run keeps them" {
  local least="training: 4096 steps are too few for a sequence here; give at least 5000"
  settings+=(TRAIN=sequence)
  refused_at_once ga STEPS=4096 "$least"
  refused_at_once ga-window STEPS=4096 "$least"
  refused_at_once ga FOUNDER_STEPS=8192 "$least"
  refused_at_once ga TRAIN=moments "moments need a controller to start from"
  # A child that begins with its parent's controller needs fewer.
  run_make ga run FOUNDER_STEPS=8192 INHERIT=yes run/run.yaml
}

@test "one make at a time works on a run; one that was killed lets go" {
  local long=("${settings[@]/STEPS=4096/STEPS=51200000}") pid
  setsid make -s -f "$EVO_SOURCE/scripts/ga.mk" RUN=run "${long[@]}" > /dev/null 2>&1 3>&- &
  pid=$!
  until [ -e run/gen-000/00.running ]; do kill -0 $pid && sleep 0.1; done
  run make -s -f "$EVO_SOURCE/scripts/ga.mk" RUN=run "${long[@]}"
  [ "$status" -eq 2 ]
  [[ $output == *"run: another make is at work on this run"* ]]
  kill -KILL -- -$pid
  wait $pid || true
  flock -w 5 run/run.yaml true
}

@test "folders that make cannot work in are refused with the reason" {
  local name
  for name in "my runs/x" "a:b" "a'b" "50%"; do
    run run_make ga "$name"
    [ "$status" -eq 2 ]
    [[ $output == *"RUN='$name': make cannot work in a folder whose name has "* ]]
    run make -f "$EVO_SOURCE/scripts/compare.mk" RUN="$name"
    [ "$status" -eq 2 ]
    [[ $output == *"make cannot work in a folder"* ]]
  done
  [ -z "$(ls)" ]
}

@test "make -n shows the plan by slots" {
  run_make ga run -n > plan
  [ "$(grep -c 'train-slots' plan)" -ge 9 ]
  run_make bo run WINDOW=3 -n > plan
  [ "$(grep -c 'train-slots' plan)" -eq 9 ]
  [ "$(grep -c 'evo-run propose' plan)" -eq 9 ]
  [ ! -e run ] || [ ! -e run/gen-000 ]
}

@test "live: a line per generation in a file, one redrawn line on a terminal, no two at once" {
  needs_terminal
  run_make ga run -j2 > log 2>&1
  [ "$(grep -c 'robots  best' log)" -eq "$(ls -d run/gen-* | wc -l)" ]
  grep '^gen-' log | tail -1 | grep -q '^gen-003 .* 9/9 robots  best .*[█▁]  .* core hours, .* idle$'
  # What takes long at the end is named, and all that was made.
  grep -q '^rendering run/best\.' log
  [ "$(tail -1 log)" = 'made: run/report.html' ]
  if grep -q $'[\r\x1b]' log; then return 1; fi
  # On a terminal of 60 columns nothing is wider, and what was live is wiped.
  command="make -f $EVO_SOURCE/scripts/ga.mk RUN=seen ${settings[*]:0:6} VIDEO_OPTIONS='--size 160x90' -j2"
  script -qec "stty cols 60; $command" /dev/null > raw
  [ "$(tr '\r' '\n' < raw | grep -c ' 9/9 robots')" -ge 1 ]
  tr '\r' '\n' < raw | sed 's/\x1b\[K//g' | grep '^[ 0-9]*/9 robots' > live
  [ "$(LC_ALL=C.UTF-8 wc -L < live)" -le 59 ]
  diff <(essence run) <(essence seen)
  # Silent when make is.
  run_make bo quiet -j2 -s > log 2>&1
  [ ! -s log ]
}

@test "watching a run ends with it" {
  run_make ga run -j2
  evo-inspect --watch run > lines
  [ ! -s lines ]
  fails_with 65 "run.yaml" -- evo-inspect --watch "$BATS_TEST_TMPDIR"
}

# Until a command succeeds; a minute at most.
wait_until() { local k; for ((k = 0; k < 600; k++)); do ! "$@" || return 0; sleep 0.1; done; return 1; }

@test "watching waits for a run to begin; a terminal of 80 columns shows the champion" {
  needs_terminal
  "$EVO_SOURCE/tests/report/make-run.sh" run ga 1 2 4
  mkdir held
  mv run/gen-001/scores.jsonl run/best.json held/
  : > run/gen-000/ranking.tsv
  timeout 100 evo-inspect --watch seen --progress lines > lines 2> said &
  timeout 100 script -qec "stty cols 80; evo-inspect --watch seen" /dev/null > raw &
  wait_until grep -q 'waiting for seen to begin' said
  wait_until grep -q 'waiting for seen to begin' raw
  cp -r run seen
  wait_until grep -q 'robots' raw
  cp held/scores.jsonl seen/gen-001/scores.jsonl
  : > seen/gen-001/ranking.tsv
  wait_until grep -q gen-001 raw
  cp held/best.json seen/best.json
  wait
  # A line in a pipe; and the body of the best on a terminal.
  [ "$(wc -l < lines)" -eq 1 ]
  grep -q '^gen-001 .* robots  best ' lines
  local plain
  plain=$(tr '\r' '\n' < raw | sed 's/\x1b\[[0-9;]*[mKJA]//g')
  jq -r '.id' held/best.json > id
  grep -q "^$(cat id)  [0-9.]*$" <<< "$plain"
  grep -q '^[RSHV ][RSHV ]*$' <<< "$plain"
  [ "$(LC_ALL=C.UTF-8 wc -L <<< "$plain")" -le 80 ]
}

@test "watching uses the terminal it has: its height, its characters, and none of what it lacks" {
  needs_terminal
  "$EVO_SOURCE/tests/report/make-run.sh" run ga 1 3 8
  mkdir held
  mv run/gen-002/scores.jsonl run/best.json held/
  look() {  # FILE and the surroundings: what a terminal of 100 x 50 is sent until the run is over
    local file=$1
    shift
    rm -f run/best.json
    timeout 60 env "$@" script -qec "stty rows 50 cols 100; evo-inspect --watch run" /dev/null > "$file" &
    wait_until grep -qs "$(cat awaited)" "$file"
    cp held/best.json run/best.json
    wait
  }
  echo robots > awaited
  look blocks LC_ALL=C.UTF-8 TERM=xterm
  # A picture is what stands between two of its beginnings: how it stands, and a curve of 16 lines.
  sed 's/\r\x1b\[J/\n@\n/g; s/\r//g' blocks | awk '/^@/ { if (n > most) most = n; n = 0; next } { ++n } END { print most }' > lines
  [ "$(cat lines)" -ge 17 ]
  grep -q '█' blocks
  sed 's/\x1b\[[0-9;]*[mKJA]//g; s/\r//g' blocks > plain
  [ "$(LC_ALL=C.UTF-8 wc -L < plain)" -le 99 ]
  # Where the locale has no blocks there are none, and no word is cut.
  look ascii LC_ALL=C TERM=xterm
  [ -z "$(LC_ALL=C tr -d '\000-\177' < ascii)" ]
  grep -q '#' ascii
  sed 's/\x1b\[[0-9;]*[mKJA]//g; s/\r/\n/g' ascii | grep -o '0 launches[a-z, 0-9]*' | sort -u > words
  grep -qx '0 launches.*' words
  lacks 'launche?$|waitin?$' words
  # A terminal that cannot go back gets lines, without colours.
  echo gen-002 > awaited
  { sleep 2; cp held/scores.jsonl run/gen-002/scores.jsonl; : > run/gen-002/ranking.tsv; } &
  look dumb LC_ALL=C TERM=dumb
  lacks $'\x1b' dumb
}

@test "an installation has every file that the pipelines name" {
  cmake --install "$EVO_BUILD" --prefix "$PWD/there" > /dev/null
  cd there/share/evo/scripts
  local name
  for name in $(grep -ho '$(SCRIPTS)[a-z]*\.[a-z]*' ./*.mk | sed 's/^$(SCRIPTS)//') evolve.mk; do
    [ -e "$name" ] || { echo "$name is not installed" >&2; return 1; }
  done
  [ -e compare.gnuplot ]
}

@test "what scripts/quickstart builds first is enough for its run" {
  mkdir -p tree/build/release/bin
  cp -r "$EVO_SOURCE"/{scripts,tasks} tree
  eval "tools=($(sed -n 's/^cmake --build .* --target //p' "$EVO_SOURCE/scripts/quickstart"))"
  for tool in "${tools[@]}"; do cp "$EVO_BIN/$tool" tree/build/release/bin; done
  # None of the others is to be found.
  env -u EVO_BIN PATH=/usr/bin:/bin make -s -f tree/scripts/ga.mk RUN=run TASK=Walker-v0 POP=3 EVALS=4 STEPS=2048 SEED=1 \
    VIDEO=gif VIDEO_OPTIONS="--size 160x90 --every 50"
  [ -s run/report.html ]
  [ -s run/best.gif ]
  PATH=/usr/bin:/bin tree/build/release/bin/evo-inspect run/best.json > /dev/null
}
