# evo-train and evo-eval as processes: reproducible, resumable, careful.
load helpers

robots() { evo-sample -n 3 --seed 2; }
train() { evo-train --task Walker-v0 --steps 8192 --train final_episodes=2 --out-dir "$1" "${@:2}"; }
# The training in the background has begun: its log is there, or says this.
begun() { until ls $1 > /dev/null 2>&1; do kill -0 "$training" || return; sleep 0.05; done; }
evaluated() { until grep -qs global_step $1; do kill -0 "$training" || return; sleep 0.05; done; }
@test "training: the same bytes for any -j and grouping, other ones for another seed" {
  robots | train a -j1 > a.jsonl
  robots | train b -j3 | sed 's|"b/|"a/|' | cmp - a.jsonl
  robots | tail -1 | train c > /dev/null
  for policy in a/*.policy.h5; do cmp "$policy" "b/$(basename "$policy")"; done
  cmp c/*.policy.h5 "a/$(basename c/*.policy.h5)"
  robots | head -1 | train d --seed 7 > /dev/null
  run ! cmp -s d/*.policy.h5 "a/$(basename d/*.policy.h5)"
}

@test "training: SIGTERM in the middle of an update, from several sides, saves the state after it, and ends the same" {
  robots | head -1 > robot
  local options=(--task Walker-v0 --steps 65536 --train environments=4 --train rollout=4096
    --train evaluation_interval=1 --train evaluation_episodes=1 --train final_episodes=0 -j1)
  evo-train "${options[@]}" --out-dir calm robot > calm.json
  evo-train "${options[@]}" --out-dir stormy robot 2> said >/dev/null 3>&- &
  local training=$! status=0
  evaluated 'stormy/*.log'
  # Saving takes longer than the signals do, which are one.
  for _ in 1 2 3 4; do kill -TERM $training; sleep 0.05; done
  wait $training || status=$?
  [ "$status" -eq 143 ]
  grep -q -- --resume said
  [ -s stormy/*.checkpoint.h5 ]
  [ "$(grep -c global_step stormy/*.log)" -lt 4 ]
  evo-train "${options[@]}" --out-dir stormy --resume robot 2> said > stormy.json
  grep -q "continues from" said
  cmp calm/*.policy.h5 stormy/*.policy.h5
  cmp <(jq 'del(.policy)' calm.json) <(jq 'del(.policy)' stormy.json)
}

@test "training: done is done, and other settings are refused" {
  robots | train p > first
  robots | train p | cmp - first
  fails_with 73 "other settings" "--force" -- bash -c 'evo-sample -n 3 --seed 2 | evo-train --task Walker-v0 --steps 4096 --out-dir p -j1'
  robots | evo-train --task Walker-v0 --steps 4096 --out-dir p --force | jq -e '.steps <= 4096' > /dev/null
}

@test "training: open-loop algorithms" {
  robots | head -1 > robot
  for algo in gait sequence; do
    evo-train --task Walker-v0 --train $algo --steps 16000 --out-dir $algo robot > $algo.json
    evo-eval $algo.json | jq -e ".fitness == $(jq .fitness $algo.json)"
    evo-inspect $algo/*.policy.h5 > said
    grep -q "^control .*open loop" said
    run ! grep "^observes" said
    grep -q "best evaluation $(jq -r '.fitness * 100 | floor / 100' $algo.json)" said
  done
}

@test "training: children continue from their parent's sequence" {
  robots | head -1 > robot
  options="--task Walker-v0 --train sequence"
  evo-train $options --steps 9000 --out-dir calm robot > calm.json
  evo-eval calm.json | jq -e ".fitness == $(jq .fitness calm.json)"
  evo-mutate -n 1 --seed 1 calm.json > child
  evo-train $options --steps 9000 --out-dir heir --init calm child > heir.json
  evo-convert heir/*.policy.h5 --to json | jq -e '.kind == "sequence" and (.actions | length) == 500'
  fails_with 2 "give at least 5000" -- evo-train $options --steps 4999 --out-dir few robot
}

@test "training: children start from their parents' policies, the rest from scratch" {
  robots > parents
  evo-train --task Walker-v0 --steps 4096 --out-dir old parents > trained
  evo-mutate -n 2 --seed 1 trained > children
  evo-train --task Walker-v0 --steps 4096 --out-dir new --init old children parents > mixed
  evo-train --task Walker-v0 --steps 4096 --out-dir plain children > /dev/null
  id=$(head -1 children | jq -r .id)
  run ! cmp -s new/$id.policy.h5 plain/$id.policy.h5
  parent=$(head -1 children | jq -r '.parents[0]')
  hash=$(h5dump -a settings_hash old/$parent.policy.h5 | grep -o '[0-9a-f]\{64\}')
  [[ $(h5dump -a identity new/$id.policy.h5) == *"inherited=$hash"* ]]
  id=$(head -1 parents | jq -r .id)
  cmp old/$id.policy.h5 new/$id.policy.h5
  # One policy for every robot; done is done; another start is another training.
  head -1 children | evo-train --task Walker-v0 --steps 4096 --out-dir one --init old/$id.policy.h5 > one.json
  head -1 children | evo-train --task Walker-v0 --steps 4096 --out-dir one --init old/$id.policy.h5 | cmp - one.json
  fails_with 73 "other settings" -- evo-train --task Walker-v0 --steps 4096 --out-dir one children
}

@test "training: robots without parents may be given more steps" {
  evo-sample -n 1 --seed 3 > founder
  evo-mutate founder -n 1 --seed 4 > child
  evo-train --task Walker-v0 --steps 4096 --founder-steps 8192 --out-dir p founder child > both
  [ "$(jq -c .steps both | paste -sd ' ')" = "8192 4096" ]
  fails_with 2 "--founder-steps" -- evo-train --task Walker-v0 --founder-steps none founder
}

@test "training: what has ended continues with more steps, and says so" {
  robots | head -1 > robot
  go() { evo-train --task Walker-v0 --out-dir "$1" --keep-checkpoint --resume --steps "$2" robot; }
  go parts 8192 > first
  [ -s parts/*.checkpoint.h5 ]
  go parts 8192 | cmp - first
  go parts 16384 > second
  jq -e ".steps == 16384 and .fitness >= $(jq .fitness first)" second
  go parts 16384 | cmp - second
  [[ $(h5dump -a identity parts/*.policy.h5) == *part.0=8192* ]]
  go whole 16384 > /dev/null
  run ! cmp -s parts/*.policy.h5 whole/*.policy.h5
  fails_with 73 "other settings" -- evo-train --task Walker-v0 --out-dir parts --resume --steps 32768 --seed 5 robot
}

@test "training: a diverging robot ends alone" {
  robots > three
  fails_with 1 "seed" -- evo-train --task Walker-v0 --steps 4096 --train learning_rate=1e30 --out-dir x three
  evo-train --task Walker-v0 --steps 4096 --train learning_rate=1e30 --failures skip --out-dir x three > failed
  [ "$(wc -l < failed)" -eq 3 ]
  jq -e '.fitness == null and (.failure.why | length > 0)' failed > /dev/null
}

@test "the policy gives its recorded fitness again, to the last digit" {
  robots | train p > trained
  earned() { evo-eval --episodes 8 --jitter 1e-3 "$@"; } # as the profile evaluates
  earned trained | jq -c '[.id, .fitness]' | cmp - <(jq -c '[.id, .fitness]' trained)
  head -1 trained > one
  earned --rollout r.h5 one > /dev/null
  earned --policy p/"$(jq -r .id one)".policy.h5 r.h5 | jq -e ".fitness == $(jq .fitness one)"
}

@test "one pipe from sampling to the five best" {
  evo-sample -n 20 --seed 3 | evo-mutate -n 10 --seed 4 |
    evo-eval --task Walker-v0 --actions sine:0.5,20,0.7 -j2 | evo-select --keep 5 | jq -r .fitness > five
  [ "$(wc -l < five)" -eq 5 ]
  sort -gr five | cmp - five
}

@test "evaluation: physics can be changed, and a typo names the nearest key" {
  fails_with 1 "became unstable in step 1" -- bash -c 'evo-sample -n 1 | evo-eval --task Walker-v0 --actions random --physics gravity=1e12'
  robots | head -1 > robot
  evo-eval --task Walker-v0 --actions sine:0.5,20,0.7 robot > normal
  evo-eval --task Walker-v0 --actions sine:0.5,20,0.7 --physics gravity=110 robot | cmp - normal
  evo-eval --task Walker-v0 --actions sine:0.5,20,0.7 --physics gravity=50 robot > light
  run ! cmp -s normal light
  evo-eval --task Walker-v0 --actions sine:0.5,20,0.7 --physics paper robot > paper
  run ! cmp -s normal paper
  fails_with 2 "gravty" "gravity" -- evo-eval --task Walker-v0 --actions random --physics gravty=50 robot
  evo-eval --task Walker-v0 --actions random --physics min_target=1.7 --physics max_target=1.8 robot > strong
  fails_with 2 "min_target" -- evo-eval --task Walker-v0 --actions random --physics min_target=1.7 robot
}

@test "evaluation: the random tasks draw by seed, and take draws" {
  robots | head -1 > robot
  evo-eval --task Catcher-v0 --actions random --seed 1 --rollout a.h5 robot > one
  evo-eval --task Catcher-v0 --actions random --seed 1 --draws a.h5 robot | cmp - one
  evo-eval --task Catcher-v0 --actions random --seed 1 --draws '{"ox":0,"oy":3}' robot > /dev/null
  fails_with 2 "ox" -- evo-eval --task Catcher-v0 --actions random --draws '{"oz":0}' robot
}

@test "evaluation: -j and the company of other robots change nothing" {
  robots | evo-eval --task Thrower-v0 --actions random --episodes 3 -j1 > a
  robots | evo-eval --task Thrower-v0 --actions random --episodes 3 -j3 | cmp - a
  robots | tail -1 | evo-eval --task Thrower-v0 --actions random --episodes 3 | cmp - <(tail -1 a)
}

@test "a truncated or foreign HDF5 file: status 65 and one line" {
  robots | head -1 > robot
  evo-eval --task Walker-v0 --actions random --max-steps 5 --rollout r.h5 robot > /dev/null
  head -c 3000 r.h5 > cut.h5
  /usr/bin/python3 -c "import h5py; h5py.File('foreign.h5','w')['x'] = [1.0, 2.0]"
  for file in cut.h5 foreign.h5; do
    fails_with 65 "$file" -- evo-eval --task Walker-v0 --actions "$file" robot
    fails_with 65 "$file" -- evo-render "$file" -o x.png
    fails_with 65 "$file" -- evo-inspect "$file"
    [ ! -e x.png ]
  done
}

@test "file systems without locks: the same bytes as on others" {
  cc -D_GNU_SOURCE -shared -fPIC -o nolock.so "$EVO_SOURCE/tests/cli/nolock.c"
  robots | head -1 > robot
  tiny_profile > tiny.yaml
  work() {
    mkdir "$1"
    (
      cd "$1"
      for steps in 2 4; do
        evo-train ../robot --task Walker-v0 --train ../tiny.yaml --steps $steps --out-dir . --keep-checkpoint --resume \
          > trained
      done
      evo-eval trained --max-steps 20 --rollout walk.h5 > scored
      evo-inspect ./*.policy.h5 walk.h5 ./*.checkpoint.h5 > said
      evo-render walk.h5 --at 9 -o step.png
    )
  }
  work with
  LD_PRELOAD=$PWD/nolock.so work without
  diff -r -x '*.log' with without  # those hold durations
}

@test "training: by a sequence, one network of two, the same bytes killed or not" {
  robots | head -2 > two
  # No function: what is killed is to be the training itself.
  local learn=(evo-train --by-sequence --task Jumper-v0 --steps 40000 --seed 3 --resume -q --out-dir)
  "${learn[@]}" n two > whole
  "${learn[@]}" n two | cmp - whole
  "${learn[@]}" k two > killed 2>&1 3>&- &
  local training=$!
  begun 'k/moments/*.log'
  kill -TERM $training
  wait $training || true
  [ ! -s killed ] || lacks '"fitness"' killed
  "${learn[@]}" k two | sed 's|"k/|"n/|' | cmp - whole
  local file
  while read -r robot; do
    id=$(jq -r .id <<< "$robot")
    [ "$(jq -r .policy <<< "$robot")" = "n/$id.policy.h5" ] && cmp "n/$id.policy.h5" "k/$id.policy.h5"
    # It is one of the two, with what it earns from other starts; the stages had seeds of their own.
    for file in "n/$id" n/sequence/$id n/feedback/$id n/moments/$id; do
      evo-convert "$file.policy.h5" --to json | jq -c '[.seed, .actor]' > "$(basename "$(dirname "$file")").$id"
    done
    [ "$(cat sequence.$id feedback.$id moments.$id | jq -c .[0] | sort -u | wc -l)" -eq 3 ]
    cmp -s "n.$id" "feedback.$id" || cmp "n.$id" "moments.$id"
    jq -e '.final.episodes == 64' <<< "$robot" > same
    for file in n/feedback/$id n/moments/$id; do evo-convert "$file.policy.h5" --to json; done | jq -s 'map(.fitness)' > own
    jq -e --slurpfile own own '.fitness as $fitness | $own[0] | all(. != $fitness)' <<< "$robot" > other
  done < whole
  fails_with 2 "--init excludes --by-sequence" -- evo-train --by-sequence --init n --task Jumper-v0 two
  fails_with 2 "512 steps are less than one rollout" -- evo-train --by-sequence --task Jumper-v0 --steps 4096 --out-dir f two
}
