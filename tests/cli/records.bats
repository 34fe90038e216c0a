# The records of the tasks: added by a command that checks, replayed to the last bit.
load helpers

setup() {
  cd "$BATS_TEST_TMPDIR" || return
  mkdir records
  cp "$EVO_SOURCE/records/published.tsv" records
  export RECORDS=$PWD/records
}
evolve() {
  evo-evolve ga -q --run "$1" --task Walker-v0 --pop 4 --evals 8 --train gait --steps 4000 --seed "$2" \
    --train-options "--train population=4" --no-video "${@:3}"
}

@test "a run's best robot becomes the record, is replayed, and is beaten only by a better one" {
  evolve one 1
  evolve two 2
  best() { jq -s 'map(.fitness) | max' "$1/history.jsonl"; }
  # From perturbed starts, as records are ranked.
  worth() {
    evo-select --keep 1 "$1/history.jsonl" > best
    evo-eval --policy "$1/policies/$(jq -r .id best).policy.h5" --episodes 256 --jitter 1e-4 --seed 1 best | jq '.returns | add'
  }
  if jq -en "$(worth one) > $(worth two)"; then better=one worse=two; else better=two worse=one; fi
  "$EVO_SOURCE/scripts/add-record" $worse
  jq -e ".fitness == $(best $worse) and .robots == 8 and .shifted.episodes == 256" records/Walker-v0/record.json
  [ "$(jq .steps records/Walker-v0/record.json)" -eq "$(jq -s 'map(.steps) | add' $worse/history.jsonl)" ]
  # What trained it, from its policy: tool, version and commit, without the processor.
  [ "$(jq -r .tools records/Walker-v0/record.json)" = "$(evo-train --version | sed 's/ [^ ]*$//')" ]
  "$EVO_SOURCE/scripts/verify-records"
  fails_with 73 "the record is" -- "$EVO_SOURCE/scripts/add-record" $worse
  "$EVO_SOURCE/scripts/add-record" $better
  jq -e ".fitness == $(best $better)" records/Walker-v0/record.json
  fails_with 73 "nothing was changed" -- "$EVO_SOURCE/scripts/add-record" $worse
  grep -q '^| \[Walker-v0\](Walker-v0) | gait | ' records/README.md
  [[ $(head -c 4 records/Walker-v0/picture.png | tr -d '\211') == PNG ]]
  # The command makes the same run again.
  command=$(jq -r .command records/Walker-v0/record.json)
  (cd "$EVO_SOURCE" && eval "${command/runs\/record/$BATS_TEST_TMPDIR/again} -q")
  diff $better/history.jsonl again/history.jsonl
}

@test "a robot of tools whose commit is in no history becomes no record" {
  evolve run 1
  mkdir elsewhere
  cp -r "$EVO_SOURCE/scripts" elsewhere
  git -C elsewhere init -q
  git -C elsewhere -c user.name=a -c user.email=b commit -q --allow-empty -m another
  fails_with 2 "which is not in the history" -- elsewhere/scripts/add-record run
  [ ! -e records/Walker-v0 ]
}

@test "what a record does not earn, or another body, or an old page is found out" {
  evolve run 1
  "$EVO_SOURCE/scripts/add-record" run
  record=records/Walker-v0/record.json
  cp $record whole
  jq '.fitness += 1e-15' whole > $record
  run -1 "$EVO_SOURCE/scripts/verify-records" Walker-v0
  [[ $output == *"Walker-v0: claims"* ]]
  jq '.body[0] = "HHHHH"' whole > $record
  run -1 "$EVO_SOURCE/scripts/verify-records" Walker-v0
  [[ $output == *"another body"* ]]
  jq '.shifted.mean += 1e-9' whole > $record
  "$EVO_SOURCE/scripts/verify-records" Walker-v0
  run -1 "$EVO_SOURCE/scripts/verify-records" --perturbed Walker-v0
  [[ $output == *" from perturbed starts, earns "* ]]
  cp whole $record
  "$EVO_SOURCE/scripts/verify-records" --perturbed Walker-v0
  fails_with 2 "usage: verify-records" -- "$EVO_SOURCE/scripts/verify-records" --pertubed Walker-v0
  echo >> records/README.md
  run -1 "$EVO_SOURCE/scripts/verify-records"
  [[ $output == *"not up to date"* ]]
  head -c 1000 records/Walker-v0/policy.h5 > cut && mv cut records/Walker-v0/policy.h5
  run -1 "$EVO_SOURCE/scripts/verify-records" Walker-v0
  fails_with 66 "no run folder" -- "$EVO_SOURCE/scripts/add-record" nothing
}

@test "a record's folder is named by its task, and by no path" {
  evo-evolve ga -q --plan --run run --task Walker-v0 --pop 2 --evals 2 --steps 1024 --seed 1
  sed -i 's|^task: .*|task: ../../x|' run/run.yaml
  RECORDS=$PWD/records fails_with 2 "cannot be the name of a record" -- "$EVO_SOURCE/scripts/add-record" run
}

@test "a sequence of actions is no record, but what a body can do beside one" {
  evolve waves 1
  evo-evolve ga -q --run actions --task Walker-v0 --pop 4 --evals 8 --train sequence --steps 9000 --seed 1 \
    --inherit yes --no-video
  fails_with 66 "add a controller first" -- "$EVO_SOURCE/scripts/add-record" actions
  "$EVO_SOURCE/scripts/add-record" waves
  record=records/Walker-v0/record.json
  jq -e '.controller == "sine" and .task == "Walker-v0" and .sequence == null' $record
  jq '.fitness = -100' $record > weak && mv weak $record
  "$EVO_SOURCE/scripts/add-record" actions
  best=$(jq -s 'map(.fitness) | max' actions/history.jsonl)
  jq -e --argjson best "$best" '.fitness == -100 and .sequence.fitness == $best and .sequence.robots == 8 and
    (.sequence.command | test("--train sequence"))' $record
  grep -q '^| \[Walker-v0\](Walker-v0) | gait | ' records/README.md
  fails_with 73 "nothing was changed" -- "$EVO_SOURCE/scripts/add-record" actions
  # A better controller leaves it there.
  jq '.shifted.mean = -100' $record > worse && mv worse $record
  "$EVO_SOURCE/scripts/add-record" waves
  jq -e --argjson best "$best" '.fitness > -100 and .sequence.fitness == $best' $record
  cp $record kept
  jq '.shifted.mean = -100 | .sequence.fitness = -100' kept > $record # or is more than it
  "$EVO_SOURCE/scripts/add-record" waves
  jq -e '.sequence == null' $record
  mv kept $record
  "$EVO_SOURCE/scripts/records-page" > records/README.md
  "$EVO_SOURCE/scripts/verify-records"
  mv records/Walker-v0 records/Carrier-v0
  run -1 "$EVO_SOURCE/scripts/verify-records" Carrier-v0
  [[ $output == *"is of Walker-v0"* ]]
}

@test "a record that was judged from perturbed starts is what it earns from the start itself" {
  evo-evolve ga -q --run calm --task Walker-v0 --pop 4 --evals 4 --steps 2048 --seed 1 \
    --train-options '--train evaluation_jitter=1e-2 --train evaluation_episodes=4' --no-video
  evo-inspect --check --replay calm
  "$EVO_SOURCE/scripts/add-record" calm
  best=$(evo-select --keep 1 calm/history.jsonl | jq .fitness)
  jq -e --argjson best "$best" '.fitness != $best' records/Walker-v0/record.json
  "$EVO_SOURCE/scripts/verify-records"
}

@test "a record whose founders came from another run says so, and counts what that took" {
  evolve scout 1
  evolve next 2 --evals 6 --founders scout
  "$EVO_SOURCE/scripts/add-record" next
  record=records/Walker-v0/record.json
  [[ $(jq -r .command $record) == "evo evolve ga --run runs/scout "*" && evo evolve ga --run runs/record "*" --founders runs/scout "* ]]
  [ "$(jq .robots $record)" -eq $((8 + 6)) ]
  [ "$(jq -r .tools $record)" = "$(evo-train --version | sed 's/ [^ ]*$//')" ]  # one build made both
  [ "$(jq .steps $record)" -eq "$(cat scout/history.jsonl next/history.jsonl | jq -s 'map(.steps) | add')" ]
  # As far back as it goes.
  evolve last 3 --evals 5 --founders next
  rm -r records/Walker-v0
  "$EVO_SOURCE/scripts/add-record" last
  [ "$(jq -r .command $record | grep -oE -- '--(run|founders) [^ ]*' | xargs)" = \
    "--run runs/scout-2 --run runs/scout --founders runs/scout-2 --run runs/record --founders runs/scout" ]
  [ "$(jq .robots $record)" -eq $((8 + 6 + 5)) ]
  mv scout elsewhere
  fails_with 2 "no one command" -- "$EVO_SOURCE/scripts/add-record" last
}

@test "a record keeps the bodies of a file that its run began with, and its command finds them" {
  evo-sample -n 2 --seed 5 > bodies.jsonl
  evolve drawn 1 --pop 2 --evals 2 --founders bodies.jsonl
  "$EVO_SOURCE/scripts/add-record" drawn
  diff <(jq -c .body bodies.jsonl) <(jq -c .body records/Walker-v0/founders.jsonl)
  command=$(jq -r .command records/Walker-v0/record.json)
  [[ $command == *" --founders records/Walker-v0/founders.jsonl "* ]]
  rm bodies.jsonl
  eval "${command/runs\/record/again} -q --no-video"
  diff drawn/history.jsonl again/history.jsonl
  # Founders that nobody drew leave no such file.
  evolve other 2
  jq '.shifted.mean = -100' records/Walker-v0/record.json > worse && mv worse records/Walker-v0/record.json
  "$EVO_SOURCE/scripts/add-record" other
  [ ! -e records/Walker-v0/founders.jsonl ]
}

@test "a run continues from a record, and what that took counts" {
  evolve waves 1
  "$EVO_SOURCE/scripts/add-record" waves
  record=records/Walker-v0/record.json
  first=$(jq -r .command $record) tools=$(jq -r .tools $record)
  further() {
    evo-evolve ga -q --run "$1" --task Walker-v0 --pop 1 --evals 1 --train moments --steps 16384 --seed 1 --inherit all \
      --founders "$2" --train-options "--train evaluation_interval=2 --train final_episodes=0" "${@:3}" --no-video
  }
  cp -r records/Walker-v0 first  # what takes its place below is another one
  further network first
  jq '.shifted.mean = -100' $record > worse && mv worse $record
  "$EVO_SOURCE/scripts/add-record" network
  [[ $(jq -r .command $record) == "${first/record/scout} && evo evolve ga --run runs/record "*" --founders runs/scout "* ]]
  [ "$(jq .robots $record)" -eq 9 ]
  [ "$(jq .steps $record)" -eq "$(cat waves/history.jsonl network/history.jsonl | jq -s 'map(.steps) | add')" ]
  [ "$(jq -r .tools $record)" = "$tools" ]
  # Those commands, one after the other, make the same controller.
  further again waves
  cmp network/policies/*.policy.h5 again/policies/*.policy.h5
  # From a run that continued from it, the commands are numbered anew.
  further longer network
  jq '.shifted.mean = -100' $record > worse && mv worse $record
  "$EVO_SOURCE/scripts/add-record" longer
  [ "$(jq -r .command $record | grep -oE -- '--(run|founders) [^ ]*' | xargs)" = \
    "--run runs/scout-2 --run runs/scout --founders runs/scout-2 --run runs/record --founders runs/scout" ]
  [ "$(jq .robots $record)" -eq 10 ]
  # The page says how it was found, and makes bold what reaches the paper.
  "$EVO_SOURCE/scripts/records-page" | grep -E '^\| \[Walker-v0\]\(Walker-v0\) \| network along a gait \| [^|]* \| -?[0-9.]+ \| '
  jq '.fitness = 20' $record > better && mv better $record
  "$EVO_SOURCE/scripts/records-page" | grep -F '[Walker-v0](Walker-v0) | network along a gait | ' | grep -F '| **20** |'
  # What a record was replaced by is nothing that a run began with.
  cp records/Walker-v0/* first
  jq '.shifted.mean = -100' $record > worse && mv worse $record
  fails_with 2 "network began with another record than $PWD/first is now" -- "$EVO_SOURCE/scripts/add-record" network
  run further two records/Walker-v0 --pop 2 --evals 2
  [ "$status" -ne 0 ]
  [[ $output == *"records/Walker-v0: has 1 robots, not --pop 2"* ]]
}

@test "a record of a task with draws is replayed with those that it was trained on" {
  evolve run 5 --task Catcher-v0 --evals 4
  "$EVO_SOURCE/scripts/add-record" run
  jq -e '.seed == 5' records/Catcher-v0/record.json
  "$EVO_SOURCE/scripts/verify-records"
  # So is the champion of a run.
  jq -en "$(evo-inspect run/best.rollout.h5 | tail -n 1 | awk '{ print $3 }') == $(jq .fitness run/best.json)"
}
