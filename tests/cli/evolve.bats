# evo-evolve: a run as a folder with a Makefile, as a user has it: planned, run, killed and
# given again, refused. Small populations and short trainings; the chain is whole.
load helpers

# Judged by one episode from the start itself, as evo-eval does.
quick="--train evaluation_episodes=1 --train evaluation_jitter=0 --train final_episodes=0"
settings=(--task Walker-v0 --pop 4 --evals 9 --steps 2048 --seed 1 --train-options "$quick" --video gif
  --video-options "--size 160x90 --speed 10")

# METHOD FOLDER [OPTION]...; a method may have a word of its own, as "recipe FILE" has.
evolve() { evo-evolve $1 --run "$2" "${settings[@]}" "${@:3}"; }

# Everything of a run that must not depend on how it came about.
essence() {
  (cd "$1" && cat run.yaml Makefile gen-*/population.jsonl gen-*/scores.jsonl history.jsonl best.json &&
    sha256sum policies/*.policy.h5)
}

# A fitness that costs nothing: by the body alone.
stand_in() {
  cat > score <<'END'
#!/bin/bash
exec jq -c '.fitness = ((.id[0:6] | explode | map(. * 7 % 101) | add) / 10)'
END
  chmod +x score
  settings=(--pop 4 --evals 14 --seed 1 --evaluate "$PWD/score")
}

# Kills the run with all its children at random moments, then lets it end.
kill_and_repeat() {
  local method=$1 folder=$2 kills=$3 i pid
  for ((i = 0; i < kills; i++)); do
    setsid evo-evolve $method --run "$folder" "${settings[@]}" -j2 > /dev/null 2>&1 3>&- &
    pid=$!
    random_pause
    kill -KILL -- "-$pid" 2> /dev/null || true
    wait "$pid" 2> /dev/null || true
  done
  evolve "$method" "$folder" -q -j2
}

@test "ga: ends at exactly --evals robots, with everything a run ends with" {
  evolve ga run -j2 2> said
  [ "$(wc -l < run/history.jsonl)" -eq 9 ]
  [ "$(jq -r .id run/history.jsonl | sort -u | wc -l)" -eq 9 ]
  for file in best.json best.policy.h5 best.gif report.html; do [ -s "run/$file" ]; done
  [ "$(jq -s 'map(.fitness) | max' run/history.jsonl)" = "$(jq .fitness run/best.json)" ]
  evo-eval run/best.json | jq -e ".fitness == $(jq .fitness run/best.json)"
  evo-eval --policy run/best.policy.h5 run/best.json | jq -e ".fitness == $(jq .fitness run/best.json)"
  # Survivors keep their fitness and were not trained again.
  [ "$(ls run/policies/*.policy.h5 | wc -l)" -eq 9 ]
  [ "$(cat run/journal/*.jsonl | wc -l)" -eq 9 ]
  [ -z "$(find run -name '*.running')" ]
  evo-inspect run | tee shown | grep -q '9 of 9 trained, 0 left'
  [ -s "$(sed -n 's/^policy  *//p' shown)" ]
  evo-inspect --slots run | awk 'NR > 1 && $4 != "done"' | cmp - /dev/null
  # A line per generation, and at the end the last state again.
  [ "$(grep -c '^gen-.* robots  best' said)" -ge 3 ]
  evo-inspect --watch run | grep -q '^gen-003 .* 9/9 robots  best'
  # The Makefile is what runs: by itself it finds everything done, and makes again what is removed.
  make -s -n -C run --no-print-directory | diff - <(echo 'evo-evolve -q --run . --plan')
  cp run/report.html run/best.rollout.h5 .
  rm run/best.* run/report.html run/history.jsonl
  make -s -C run
  cmp run/report.html report.html
  cmp run/best.rollout.h5 best.rollout.h5
}

@test "the same bytes by any -j, folder and make, killed or not, every method" {
  local method kills=4
  [ -z "${EVO_SLOW:-}" ] || kills=20
  settings+=(--evals 7)
  for method in ga neat bo map random race; do
    local more=()
    [ $method != race ] || more=(--rungs 2 --inherit yes)
    settings+=("${more[@]}")
    evolve $method "$method calm's" -q -j2
    evolve $method $method-plain --plan
    make -s -C $method-plain best.json LAUNCH='nice -n 5'
    mv "$method calm's" moved
    make -s -C moved
    diff <(essence moved) <(essence $method-plain)
    evo-eval moved/best.json | jq -e ".fitness == $(jq .fitness moved/best.json)"
    kill_and_repeat $method $method-stormy $kills
    diff <(essence moved) <(essence $method-stormy)
    settings=("${settings[@]:0:${#settings[@]}-${#more[@]}}")
    rm -r moved
  done
}

@test "a window: the same bytes by any -j, robots from the scores that their numbers know" {
  stand_in
  local method
  for method in ga bo map; do
    evolve $method $method-one -q -j4 --window 3
    evolve $method $method-two -q -j1 --window 3
    diff $method-one/history.jsonl $method-two/history.jsonl
    [ "$(wc -l < $method-one/history.jsonl)" -eq 14 ]
    [ "$(jq -r .id $method-one/history.jsonl | sort -u | wc -l)" -eq 14 ]
  done
  # The best of robots 0 to k-4 are the parents of robot k.
  jq -r .id ga-one/history.jsonl > ids
  local robot
  for robot in 6 9 13; do
    head -n $((robot - 3)) ga-one/history.jsonl | evo-select --keep 4 | jq -r .id > best
    grep -qxF "$(sed -n $((robot + 1))p ga-one/history.jsonl | jq -r '.parents[0]')" best
  done
  evolve ga chunks -q -j4 --window 4 --chunk 2
  [ "$(wc -l < chunks/history.jsonl)" -eq 14 ]
  fails_with 2 "unknown option --window" -- evo-evolve neat --run no --window 3
  fails_with 2 "--chunk 5 is larger than --window 3" -- evo-evolve ga --run no --window 3 --chunk 5
}

@test "neat: a generation may have more robots than slots; every robot is trained" {
  stand_in
  evolve neat run -q -j2 --pop 7 --evals 35
  for generation in run/gen-*; do
    [ "$(wc -l < "$generation/scores.jsonl")" -eq "$(wc -l < "$generation/population.jsonl")" ]
  done
  [ "$(jq -r .id run/history.jsonl | sort -u | wc -l)" -eq "$(wc -l < run/history.jsonl)" ]
  jq -e '.genome.kind == "cppn"' run/best.json
  evo-inspect run > /dev/null
}

@test "10 000 robots are planned, and make knows what is left of them" {
  stand_in
  local method
  for method in ga bo map; do
    local window=()
    [ $method = bo ] || window=(--window 25)
    evo-evolve $method --run $method --pop 25 --evals 10000 --evaluate ./score --plan -q "${window[@]}"
    make -n -C $method > plan
    [ "$(grep -c 'evo-score .*--pick' plan)" -ge 10000 ]
  done
}

@test "own fitness: what comes back is checked, what dies is tried, then failed with the reason" {
  local own='x=$(cat); case $x in'
  stand_in
  cat > picky <<'END'
#!/bin/bash
robot=$(cat)
id=$(jq -r .id <<< "$robot")
echo "$id" >> asked
case $id in [0-7]*) kill -SEGV $$;; esac
jq -c '.fitness = 1.5' <<< "$robot"
END
  chmod +x picky
  evo-evolve ga --run run --pop 8 --evals 8 --seed 1 --evaluate ./picky -q -j2
  jq -es 'length == 8 and all(if .id[0:1] | test("[0-7]") then .fitness == null and (.failure.why | test("status 139, 3 times")) else .fitness == 1.5 end)' run/history.jsonl
  [ "$(sort asked | uniq -c | awk '$1 == 3' | wc -l)" -eq "$(jq -s 'map(select(.fitness == null)) | length' run/history.jsonl)" ]
  evo-inspect --slots run | grep -q 'failed.*status 139'
  evo-sample -n 2 --seed 1 > two
  fails_with 65 "it gave another one" -- evo-score --by "tail -n1 $PWD/two" --pick 0 two
  fails_with 65 "with its fitness" -- evo-score --by 'jq -c ".fitness = 1 | .body[0] = \"HHHHH\""' two
  fails_with 65 "has no fitness" -- evo-score --by cat two
  fails_with 65 "to write the robot with its fitness" -- evo-score --by 'cat; echo nonsense' two
  fails_with 65 "not 2" -- evo-score --by "cat $PWD/two" two
  fails_with 65 "ended with status 65" -- evo-score --by 'exit 65' two
  for number in NaN 1e999 '"x"'; do
    fails_with 65 "with its fitness" -- evo-score --by "sed 's/}\$/,\"fitness\":$number}/'" two
  done
  evo-score --by 'jq -c ".fitness = null"' two | jq -es 'all(.fitness == null and .failure.why == "its program gave no fitness")'
  # A survivor keeps its fitness.
  evo-score --by 'jq -c ".fitness = 1"' two | evo-score --by false | jq -es 'all(.fitness == 1)'
}

@test "own fitness: what is known is said, and no task, steps or training" {
  stand_in
  evolve ga run -q -j2
  lacks '^(task|steps|train|inherit|video|physics):' run/run.yaml
  evo-inspect run > said
  grep -qF "run: ga scored by $PWD/score, seed 1" said
  grep -qF "program      $PWD/score ($(sha256sum score | cut -c1-12))" said
  lacks 'Walker|train' said
  grep -qF 'by a fitness of its own' run/report.html
  grep -q 'is what a program gave it: score' run/report.html
  sed 's/<script.*//; /<style/,/<\/style/d' run/report.html > page
  lacks 'Walker-v0|task|trained|training' <(grep -o '<[hpdt][^>]*>[^<]*' page)
  evo-report --table - run | grep -qF "own fitness: score$(printf '\t')ga"
  fails_with 2 "--steps is of robots that are trained" -- evolve ga no --steps 100
  evo-evolve compare --run all --methods "ga map" --seeds "1 2" --pop 4 --evals 6 --evaluate ./score -q > table
  [ "$(ls -d all/evaluate/* | wc -l)" -eq 4 ]
  fails_with 2 "--tasks goes with robots that are trained" -- evo-evolve compare --run no --tasks Walker-v0 --evaluate ./score
  # Another program, a pipe, with nothing to name.
  evo-evolve ga --run pipe --pop 3 --evals 3 --evaluate 'jq -c ".fitness = 1"' --plan -q
  lacks 'source' pipe/run.yaml
}

@test "what decides fitness is the same from a run's first command to its last" {
  changed() { fails_with 73 "is another one than when the run began" -- "$@"; }
  cp "$EVO_SOURCE/tasks/Walker-v0.yaml" mine.yaml
  evo-evolve ga --run yaml --task mine.yaml --pop 3 --evals 3 --plan -q
  sed -i 's/^name: .*/&\n# a comment, and the same world/' mine.yaml
  sed -i 's/^steps: .*/steps: 99/' mine.yaml
  changed evo-evolve --run yaml --plan
  changed evo-evolve ga --run yaml --task mine.yaml --plan
  run -2 make -s -C yaml
  [[ $output == *"is another one than when the run began"* ]]
  run -65 evo-inspect --check --replay yaml
  [[ $output == *"mine.yaml is another one"* ]]
  stand_in
  evolve ga program --plan -q
  echo '# more' >> score
  changed evo-evolve --run program --plan
  own_task
  mkdir parts
  : > parts/__init__.py
  echo 'scale = 1' > parts/more.py
  printf 'from parts import more\nimport os, helper as h\n' | cat - hop.py > new && mv new hop.py
  : > helper.py
  evolve ga python --plan -q
  evo-evolve --run python --plan -q
  local file
  for file in hop.py helper.py parts/more.py; do
    cp $file kept
    echo '# changed' >> $file
    changed evo-evolve --run python --plan
    mv kept $file
    evo-evolve --run python --plan -q
  done
}

@test "own mutation: as many new bodies as it was asked for" {
  stand_in
  printf '#!/bin/bash\nexec evo-mutate "$@" -n 1\n' > lazy && chmod +x lazy
  run ! evolve ga run -q -j2 --mutate "$PWD/lazy"
  [[ $output == *"gen-001/children.jsonl: 1 new bodies, not 2"* ]]
  [ ! -e run/gen-001/population.jsonl ]
}

@test "whatever lies in a run folder: nothing hangs, and what is damaged is named" {
  stand_in
  evolve ga run -q -j2
  look() { timeout 20 evo-inspect run && timeout 20 evo-inspect --slots run && timeout 60 evo-report -q run -o page.html; }
  echo '{"host":5}' > run/journal/0123456789ab.running
  echo '{"robot":"x","seconds":null,"started":"now"}' > run/journal/there.jsonl
  mkfifo run/journal/{more.jsonl,ba9876543210.running} run/gen-000/99.json
  look > said
  grep -q '14 of 14 scored' said
  rm run/gen-001/scores.jsonl && mkfifo run/gen-001/scores.jsonl
  look > said
  mkfifo fifo
  fails_with 66 "fifo is no file" -- timeout 20 evo-evolve ga --run no --founders fifo
  local text
  for text in Null $'\xff\xfe' 'method: [' 'format: evo/run'; do
    echo "$text" > run/run.yaml
    fails_with 65 "run/run.yaml" -- evo-inspect run
  done
}

@test "a run in which every first training fails ends with the reason; mended, it continues" {
  stand_in
  printf '#!/bin/bash\n[ -e mended ] || exit 9\nexec jq -c ".fitness = 1"\n' > weak && chmod +x weak
  run ! evo-evolve ga --run run --pop 50 --evals 60 --evaluate ./weak -q -j2
  [[ $output == *"none of 50 robots has a fitness (50 x its program ended with status 9, 3 times)"* ]]
  : > mended
  rm -r run/gen-000
  evo-evolve --run run -q -j2
  [ "$(wc -l < run/history.jsonl)" -eq 60 ]
}

@test "several makes on one run give what one gives" {
  local method make
  stand_in
  for method in ga neat bo "map --window 8"; do
    read -ra words <<< "$method"
    evolve "${words[0]}" one "${words[@]:1}" -q -j2
    evolve "${words[0]}" many "${words[@]:1}" --plan
    makes=()
    for make in 1 2 3; do
      make -s -C many -j2 > /dev/null 2>&1 3>&- &
      makes+=($!)
    done
    for make in "${makes[@]}"; do wait "$make"; done
    diff one/history.jsonl many/history.jsonl
    rm -r one many
  done
}

@test "a training that is killed is begun again, and counts as failed in the end" {
  # evo-train that dies for one robot.
  mkdir bin
  victim=$(evo-sample -n 4 --seed 1000000 | sed -n 2p | jq -r .id)
  cat > bin/fatal <<END
#!/bin/bash
"\$@" & child=\$!
case "\$*" in *--give-up*) ;; *"--pick 01 "*gen-000*)
  until [ -e journal/$victim.running ] || ! kill -0 \$child 2> /dev/null; do sleep 0.01; done
  kill -KILL \$child 2> /dev/null;; esac
wait \$child
END
  chmod +x bin/fatal
  evolve ga run -q -j2 --evals 5 --tries 2 --steps 40000 --launch "$PWD/bin/fatal"
  jq -es --arg victim "$victim" '.[] | select(.id == $victim) | .fitness == null and (.failure.why | test("^its training was killed on "))' run/history.jsonl
  [ "$(wc -l < run/history.jsonl)" -eq 5 ]
  [ -z "$(find run -name '*.running')" ]
}

@test "two makes on one run train nothing twice" {
  evolve ga run --plan -q
  make -s -j2 -C run best.json &
  make -s -j2 -C run best.json
  wait
  [ "$(jq -r .robot run/journal/*.jsonl | sort | uniq -d | wc -l)" -eq 0 ]
}

@test "inherit: children continue from their parents' gaits" {
  evolve ga run -q -j2 --inherit yes --train gait --steps 8000
  child=$(tail -n 1 run/history.jsonl)
  parent=$(jq -r '.parents[0]' <<< "$child")
  hash=$(h5dump -a settings_hash "run/policies/$parent.policy.h5" | grep -o '[0-9a-f]\{64\}')
  [[ $(h5dump -a identity "run/policies/$(jq -r .id <<< "$child").policy.h5") == *"inherited=$hash"* ]]
  fails_with 2 "--video excludes --no-video" -- evo-evolve ga --run no --video gif --no-video
  fails_with 2 "--video: none not in {mp4,webm,gif}" -- evo-evolve ga --run no --video none
  evo-evolve ga --run quiet --no-video --plan -q
  grep -q '^video: none$' quiet/run.yaml
  evo-inspect quiet | grep -q -- ' --no-video'
  fails_with 2 "--inherit: maybe not in {no,yes,all}" -- evo-evolve ga --run no --inherit maybe
  fails_with 2 "--inherit all is for --founders" -- evo-evolve ga --run no --inherit all
}

@test "founders are the best robots of another run, trained anew or continuing" {
  evolve ga scout -q -j2 --train sequence --steps 9000 --inherit yes
  evolve ga next -q -j2 --founders scout --founder-steps 4096 --inherit yes
  ids() { jq -r .id "$@" | sort; }
  diff <(evo-select --keep 4 scout/history.jsonl | ids) <(ids next/gen-000/population.jsonl)
  jq -es 'all(.[]; .steps == if .parents | length > 0 then 2048 else 4096 end)' next/history.jsonl
  evo-inspect next | grep -q -- "--founders $PWD/scout"
  evo-sample -n 4 --seed 7 > drawn.jsonl
  evolve ga drawn -q --founders drawn.jsonl --evals 4
  diff <(ids drawn.jsonl) <(ids drawn/gen-000/population.jsonl)
  evo-sample -n 5 --seed 7 > five.jsonl
  fails_with 65 "five.jsonl: has 5 robots and none has a fitness to choose --pop 4 by" -- evolve ga five --founders five.jsonl
  head -n 3 scout/history.jsonl > few.jsonl
  fails_with 65 "few.jsonl: has 3 robots, not --pop 4" -- evolve ga few --founders few.jsonl
  fails_with 66 "lost: cannot be opened" -- evolve ga lost --founders lost
  evolve ga further -q -j2 --founders scout --founder-steps 8192 --steps 4096 --train sequence --inherit all
  id=$(jq -r .id further/gen-000/00.json)
  hash=$(h5dump -a settings_hash scout/policies/$id.policy.h5 | grep -o '[0-9a-f]\{64\}')
  [[ $(h5dump -a identity further/policies/$id.policy.h5) == *"inherited=$hash"* ]]
  fails_with 2 "--inherit yes trains founders anew" -- evolve ga file --founders few.jsonl --pop 3 --inherit all
}

@test "map: an archive of kinds, of behaviours too" {
  evolve map run -q -j2 --features behaviour.distance:4:-2:2,filled:3
  jq -se 'length == 9 and all(.behaviour | keys == ["aloft", "distance", "rise", "width"])' run/history.jsonl
  head -n 1 run/archive.tsv | grep -q "^behaviour.distance$(printf '\t')filled"
  [ "$(jq -s 'map(.fitness) | max' run/archive.jsonl)" = "$(jq .fitness run/best.json)" ]
}

@test "race: half of the robots continue to twice the steps, in one training each" {
  evolve race run -q -j2 --pop 5 --evals 8 --rungs 3 --steps 8192 --inherit yes
  [ "$(wc -l run/gen-*/population.jsonl | awk '{ printf "%s ", $1 }')" = "5 3 2 3 2 1 16 " ]
  [ "$(jq -r .steps run/gen-*/scores.jsonl | paste -s -d ' ')" = \
    "2048 2048 2048 2048 2048 4096 4096 4096 8192 8192 2048 2048 2048 4096 4096 8192" ]
  for rung in 1 2 4 5; do
    diff <(jq -r .id "run/gen-00$rung/population.jsonl") \
      <(evo-select --keep "$(wc -l < "run/gen-00$rung/population.jsonl")" "run/gen-00$((rung - 1))/scores.jsonl" | jq -r .id)
  done
  [ "$(wc -l < run/history.jsonl)" -eq 8 ]
  [ "$(jq .steps run/best.json)" -eq 8192 ]
  for parent in $(jq -r '.parents[]' run/gen-003/population.jsonl); do grep -q "\"$parent\"" run/gen-002/scores.jsonl; done
  evo-inspect run | grep -q '8 of 8 trained, 0 left'
}

# Small, and long enough that a controller changes.
modular=(--pop 6 --children 2 --evals 9 --steps 3072 --champions 2
  --train-options "$quick --train environments=2 --train evaluation_interval=4")

@test "modular: one controller learns on all robots of a generation, and the best continue alone" {
  settings+=("${modular[@]}")
  evolve modular run -q -j2
  [ "$(wc -l run/gen-*/population.jsonl | awk '{ printf "%s ", $1 }')" = "6 6 6 2 20 " ]
  [ "$(wc -l < run/history.jsonl)" -eq 9 ]
  # A share each of the steps of one training.
  [ "$(jq -r .steps run/gen-000/scores.jsonl | sort -u)" = \
    "$(evo-convert run/policies/gen-000.policy.h5 --to json | jq '.steps / 6')" ]
  evo-eval -q run/gen-001/scores.jsonl | jq .fitness | cmp - <(jq .fitness run/gen-001/scores.jsonl)
  evo-eval -q run/history.jsonl | jq .fitness | cmp - <(jq .fitness run/history.jsonl)
  diff <(jq -r .id run/gen-003/population.jsonl) <(evo-select --keep 2 run/gen-002/scores.jsonl | jq -r .id)
  for id in $(jq -r .id run/gen-003/population.jsonl); do
    steps() { jq "select(.id == \"$id\") | .steps" "$1"; }
    [ "$(steps run/gen-003/scores.jsonl)" -eq $(($(steps run/gen-002/scores.jsonl) + 1536)) ]
  done
  evo-inspect run | grep -q '9 of 9 trained, 0 left'
  kill_and_repeat modular stormy 4
  diff <(essence run) <(essence stormy)
  # From the controller of another run, for its best robots or for others.
  evolve modular next -q -j2 --founders run --inherit all --seed 9 --evals 6 --champions 0
  evo-sample -n 6 --seed 9 -o others.jsonl
  evolve modular others -q -j2 --founders others.jsonl --evals 6 --champions 0 \
    --train-options "${modular[-1]} --init $PWD/run/policies/gen-002.policy.h5"
  hash=$(h5dump -a settings_hash run/policies/gen-002.policy.h5 | grep -o '[0-9a-f]\{64\}')
  for run in next others; do [[ $(h5dump -a identity $run/policies/gen-000.policy.h5) == *"inherited=$hash"* ]]; done
}

@test "modular: who stays, by grace" {
  evo-sample -n 12 --seed 3 > twelve
  for generation in 0 1 2; do head -n $((6 + 2 * generation)) twelve > $generation; done
  # The older the fitter, but for the last, which has failed.
  jq -c '.fitness = (if input_line_number == 12 then null else 20 - input_line_number end) | .steps = 7' twelve > 3
  stay() { evo-select --keep "$1" --grace "$2" --unscored 0 1 2 3; }
  numbers() { stay "$@" | jq -r .id | grep -n -F -f - <(jq -r .id twelve) | cut -d: -f1 | paste -sd ' '; }
  [ "$(numbers 6 0)" = "1 2 3 4 5 6" ]
  [ "$(numbers 6 1)" = "1 2 3 4 5 11" ]
  [ "$(numbers 6 2)" = "1 2 3 9 10 11" ]
  stay 6 1 | jq -e '.steps == 7 and (has("fitness") or has("policy") | not)'
}

# Refused in one line before anything is made, with a status and words.
refused() {
  run "-$1" --separate-stderr evo-evolve "${@:3}"
  [[ $stderr == *"$2"* ]] || { echo "no '$2' in: $stderr" >&2; return 1; }
  [ -z "$(ls -A | grep -v '^separate-stderr')" ]
}

@test "what cannot be meant is refused before anything is made" {
  refused 2 "'gaa' is not one of ga, neat" gaa --run run
  refused 2 "did you mean" ga --run run --eval 8
  refused 2 "unknown option --grace; see evo-evolve --help" ga --run run --grace 2
  refused 2 "--shape" ga --run run --shape 5
  refused 2 "no room for children" ga --run run --pop 2 --evals 42
  refused 2 "evo-sample: error: --weights: expected 5" ga --run run --sample-options '--weights 1'
  refused 2 "evo-mutate: error: --rate" ga --run run --mutate-options '--rate 5'
  refused 2 "evo-archive: error: --features: 'height'" map --run run --features height
  refused 66 "evo-neat: error: lost.yaml: cannot be opened" neat --run run --neat lost.yaml
  refused 2 "unknown training profile 'nope'" ga --run run --train nope
  refused 2 "unknown task" ga --run run --task Walker-v9
  refused 2 "nothing" ga --run run --train-options '--train nothing=1'
  refused 2 "the quote ' is not closed" ga --run run --train-options "--train 'hidden=8"
  refused 2 "4096 steps are too few for a sequence here; give at least 5000" ga --run run --train sequence --steps 4096
  refused 2 "moments need a controller to start from" ga --run run --train moments
  refused 2 "leaves no place for robots out of --grace" modular --run run --pop 4 --children 2
  refused 2 "ppo makes a controller for each robot" modular --run run --train default
  refused 2 "--run: its value is empty" ga --run ''
  refused 73 "neither a run nor an empty folder" ga --run /
  refused 66 "there is no such run" --run run
}

@test "every setting with hostile values: refused or taken literally, no file outside the run" {
  mkdir outside && cd outside
  local option value
  for method in ga neat bo map race modular; do evo-evolve $method --help; done |
    grep -o -- '^ *--[a-z-]* [A-Z|a-z]' | grep -o -- '--[a-z-]*' | sort -u |
    grep -vE -- '--(run|launch|progress|tasks|methods|seeds|log-file)$' > ../options
  [ "$(wc -l < ../options)" -ge 25 ]
  # Every seventh pair; with EVO_SLOW all.
  local number=0
  for option in $(cat ../options) ; do
    for value in -1 0 1e9 "'" '"' '$(touch x)' '`touch x`' ';touch x' '#' $'a\ntouch x' '../..' '$(shell touch x)' 'a\'; do
      [ -n "${EVO_SLOW:-}" ] || [ $((number++ % 7)) -eq 0 ] || continue
      rm -rf run
      for method in ga neat map race modular; do
        evo-evolve $method --run run --plan -q "$option=$value" > ../said 2>&1 && break || status=$?
        [ $status -lt 128 ]
      done
      if [ -e run/Makefile ]; then make -n -C run > ../plan 2>&1; fi
      rm -rf run
      [ -z "$(ls -A)" ] || { echo "$option=$value left $(ls -A)" >&2; return 1; }
    done
  done
  # Taken literally to the end.
  for value in "'" '"' '$(touch x)' '`touch x`' ';touch x' '#' '$(shell touch x)' '$$' '\' '%' '*'; do
    evo-evolve ga --run run --pop 3 --evals 3 --evaluate "jq -c --arg x $(printf %q "$value") '.fitness = (\$x | length) | .said = \$x'" -q
    [ "$(jq -r .said run/best.json)" = "$value" ]
    rm -r run
    [ -z "$(ls -A)" ]
  done
  run -2 evo-evolve ga --run run --evaluate $'a\nb'
  # Folders of any name.
  for value in "my run" "a:b" "a'b" '50%' '$(touch x)' '#' '--x'; do
    evo-evolve ga --run "./$value" --pop 3 --evals 3 --evaluate 'jq -c ".fitness = 1"' -q
    [ -s "./$value/best.json" ]
    rm -r "./$value"
    [ -z "$(ls -A)" ]
  done
}

@test "another value for a setting is refused; an edited Makefile continues and says so" {
  stand_in
  evolve ga run -q --plan
  fails_with 73 "run belongs to a run with other settings (pop: 4 there, 5 asked for)" "removing it loses nothing" -- evo-evolve ga --run run --pop 5
  fails_with 73 "method: ga there, bo asked for" -- evo-evolve bo --run run
  evo-evolve ga --run run --pop 4 -q
  fails_with 73 "seed: 1 there, 2 asked for" -- evo-evolve ga --run run --seed 2
  lacks "edited" <(evo-inspect run)
  sed -i 's/^MUTATE = evo-mutate/& --rate 0.3/' run/Makefile
  evo-inspect run | grep -q 'Makefile .*edited by hand'
  evo-report run | grep -q 'edited by hand'
  rm run/best.json
  evo-evolve --run run -q
  [ -s run/best.json ]
  # What a killed plan left half written is in nobody's way.
  mkdir half && : > half/.Makefile.tmp
  evo-evolve ga --run half --plan -q
  [ -s half/Makefile ]
  mkdir full && : > full/file
  fails_with 73 "neither a run nor an empty folder (file is in it)" -- evo-evolve ga --run full
  [ "$(ls full)" = file ]
}

@test "recipes: rounds as data, each begins with the best of the one before, killed or not" {
  cat > rounds.yaml <<'END'
rounds:
  - {pop: 4, evals: 7, steps: 4000}
  - {pop: 3, evals: 5, steps: 4000}
  - {pop: 2, evals: 2, steps: 4000, founder_steps: 8000, inherit: all}
END
  settings=(--task Walker-v0 --seed 1 --video gif --video-options "--size 160x90 --speed 5" --train gait
    --train-options "--train population=4")
  local rounds="recipe rounds.yaml"
  evolve "$rounds" calm -q -j2
  ids() { jq -r .id "$@" | sort; }
  diff <(evo-select --keep 3 calm/1/history.jsonl | ids) <(ids calm/2/gen-000/population.jsonl)
  diff <(evo-select --keep 2 calm/2/history.jsonl | ids) <(ids calm/3/history.jsonl)
  [ "$(cat calm/*/run.yaml | grep -c '^seed: [123]$')" -eq 3 ]
  [ -s calm/3/report.html ] && [ ! -e calm/1/report.html ]
  kill_and_repeat "$rounds" stormy 4
  for round in 1 2 3; do diff calm/$round/history.jsonl stormy/$round/history.jsonl; done
  fails_with 73 "calm/1 belongs to a run with other settings (seed: 1 there, 2 asked for)" -- evolve "$rounds" calm --seed 2
  fails_with 2 "--pop is decided round by round" -- evo-evolve recipe rounds.yaml --run no --pop 3
  fails_with 2 "unknown recipe 'nets'" -- evo-evolve recipe nets --run no
  fails_with 2 "there is no easier world for Walker-v0" -- evo-evolve recipe easier --run no
  for recipe in $(ls "$EVO_SOURCE/tasks/recipes" | sed 's/.yaml//'); do
    local more=()
    [ $recipe != easier ] || more=(--task PlatformJumper-v0 --founders calm/1)
    evo-evolve recipe $recipe --run plan-$recipe --plan -q "${more[@]}"
  done
  [ "$(ls -d plan-easier/? | wc -l)" -eq 4 ]
  evo-evolve recipe --run default --plan -q
}

@test "compare: methods and seeds side by side end as a table and a page" {
  compare() { evo-evolve compare --run all --methods "ga bo" --pop 4 --evals 6 --steps 2048 --train-options "$quick" -q -j2 "$@"; }
  compare --tasks "Walker-v0,Jumper-v0" --seeds "1 2" > table 2> said
  [ "$(wc -l < table)" -eq 5 ]
  grep -q 'all/compare.html' said
  # Nobody asked for videos.
  [ "$(grep -l '^video: none$' all/*/*/run.yaml | wc -l)" -eq 8 ]
  [ -z "$(find all -name 'best.mp4')" ]
  [ -s all/compare.html ]
  local mean
  mean=$(cat all/Jumper-v0/bo-{1,2}/best.json | jq -s 'map(.fitness) | add / length')
  awk -F'\t' -v mean="$mean" '$1 == "Jumper-v0" && $2 == "bo" && $3 == 2 && $4 == 6 { found = ($5 - mean) ^ 2 < 1e-8 } END { exit !found }' table
  # The best method first, and a further seed adds to what is there.
  awk -F'\t' 'NR > 1 && $1 == task && $5 > last { exit 1 } { task = $1; last = $5 }' table
  touch mark
  compare --tasks Walker-v0 --seeds "1 2 3" > table
  [ "$(tail -n 1 table | cut -f 3)" -eq 3 ]
  [ -z "$(find all/Walker-v0/ga-1/policies -newer mark)" ]
  evo-report --table t.csv all/*/*
  diff <(cut -f 1-10 table | tr '\t' ',') <(grep -v Jumper t.csv)
  evo-report --table t.tex all/*/*
  grep -qE 'ga & 3 & [$]-?[0-9]+[.][0-9]{3}[$] ' t.tex
  fails_with 2 ".tsv, .csv or .tex" -- evo-report --table t.xls all/Walker-v0/ga-1
  fails_with 2 "unknown method 'gaa'" -- compare --methods gaa
  fails_with 2 "--tasks: two of them have the same name" -- compare --tasks "Walker-v0 ./elsewhere/Walker-v0.yaml"
  fails_with 2 "unknown option --seed (did you mean '--seeds'?)" -- compare --seed 3
}

@test "compare: random robots and programs of one's own are methods, too" {
  stand_in
  cat > mine <<'END'
#!/bin/bash
# The best again with a change, or at random: -n N --seed S --shape RxC.
if evo-select --keep 1 --unscored - > best.$$ 2> /dev/null && [ -s best.$$ ]; then
  evo-mutate "${@:1:4}" best.$$
else
  evo-sample "$@"
fi
rm best.$$
END
  chmod +x mine
  evo-evolve compare --run all --methods "random mine=./mine" --seeds 1 "${settings[@]:0:4}" --evaluate "$PWD/score" -q -j2 > table
  [ "$(cut -f 2 table | sort | paste -sd ' ')" = "method mine random" ]
  grep -q "^name: mine" all/evaluate/mine-1/run.yaml
  grep -q 'mine' all/compare.html
  echo "# changed" >> mine
  fails_with 73 "is another one than when the run began, or a file" -- evo-evolve --run all/evaluate/mine-1 --plan
  # Nothing that a random run draws depends on a score.
  evo-evolve random --run other "${settings[@]:0:4}" --seed 1 --evaluate 'jq -c ".fitness = 1"' -q
  diff <(jq .id all/evaluate/random-1/history.jsonl) <(jq .id other/history.jsonl)
  [ "$(jq .id other/history.jsonl | sort -u | wc -l)" -eq 14 ]
  fails_with 2 "--propose names the program" -- evo-evolve program --run no
  fails_with 2 "NAME=PROGRAM" -- evo-evolve compare --run no --methods "ga =x"
  fails_with 66 "--propose ./gone: there is no such program" -- evo-evolve compare --run no --methods "mine=./gone" --evaluate "$PWD/score"
  fails_with 66 "--mutate ./gone: there is no such program" -- evo-evolve ga --run no --mutate ./gone
  # Fewer than asked for end the run.
  run -2 evo-evolve program --run few --propose "bash -c 'evo-sample -n 1'" --pop 3 --evals 3 --evaluate "$PWD/score" -q
  [[ $output == *"different robots, not 3"* ]]
}

# A task in Python; Debian's has numpy.
own_task() {
  export EVO_PYTHON=/usr/bin/python3
  "$EVO_PYTHON" -c 'import numpy' 2> /dev/null || skip "$EVO_PYTHON has no numpy"
  settings=(--task hop.py:Hop --pop 3 --evals 6 --steps 512 --shape 3x3 --seed 1 --video gif
    --train-options '--train environments=4 --train rollout=32 --train minibatches=4')
  cat > hop.py <<'END'
import numpy as np
import evo_robots

class Hop(evo_robots.Task):
    steps = 60

    def observe(self, now):
        return np.concatenate([now.mean_velocity("robot"), now.shape("robot")], axis=1)

    def reward(self, before, now, actions):
        return now.mean_velocity("robot")[:, 1]
END
}

@test "a task in Python: the same bytes by any -j, killed or not" {
  own_task
  evolve ga calm -q -j2
  [ "$(jq -s 'map(.fitness) | unique | length' calm/history.jsonl)" -gt 3 ]
  for file in best.json best.policy.h5 best.gif report.html; do [ -s "calm/$file" ]; done
  [ "$(jq -r .policy calm/best.json)" = "policies/$(jq -r .id calm/best.json).policy.h5" ]
  kill_and_repeat ga stormy 3
  diff <(essence calm) <(essence stormy)
  fails_with 2 "--inherit is for tasks of the suite" -- evolve ga no --inherit yes
  fails_with 2 "--physics is for tasks of the suite" -- evolve ga no --physics evogym
  fails_with 2 "--tint" -- evolve ga no --video-options "--tint nothing"
  # All that is done with runs of tasks in YAML.
  evo-inspect --check --replay calm
  grep -q '"replay":{"points":' calm/report.html
  evo-render --poster calm --size 400x300 -o poster.svg
  evo-render --evolution calm --size 160x90 -o film.gif
  evo-render calm/best.rollout.h5 --strip 3 -o strip.svg
  evo-evolve compare --run both --tasks "$PWD/hop.py:Hop Walker-v0" --methods ga --seeds 1 --pop 2 --evals 2 \
    --steps 512 --shape 3x3 -q -j2 "${settings[@]:14}" > table
  cut -f1 table | grep -qx Hop
  [ -s both/Hop/ga-1/best.json ]
  # Without its episodes a run has a report, too; what needs them says which.
  rm calm/policies/*.rollout.h5
  evo-report -q calm -o less.html
  fails_with 66 ".rollout.h5" -- evo-render --evolution calm --size 160x90 -o film.gif
  # The class is another one now, though its file is not.
  sed -i 's/mean_velocity("robot")\[:, 1\]/mean_velocity("robot")[:, 0]/' hop.py
  run -65 --separate-stderr evo-inspect --check --replay calm
  [[ ${output} == *"another one than when the run began"* ]]
  run -2 --separate-stderr evolve ga no --task none.py:Hop
  [ ! -e no ]
}

@test "what scripts/quickstart builds first is enough for its run" {
  mkdir -p tree/build/release/bin
  cp -r "$EVO_SOURCE"/{scripts,tasks} tree
  eval "tools=($(sed -n 's/^cmake --build .* --target //p' "$EVO_SOURCE/scripts/quickstart"))"
  for tool in "${tools[@]}"; do cp "$EVO_BIN/$tool" tree/build/release/bin; done
  # None of the others is to be found.
  PATH=/usr/bin:/bin EVO_DATA=tree tree/build/release/bin/evo-evolve ga --run run --task Walker-v0 --pop 3 --evals 4 --steps 2048 --seed 1 \
    --video gif --video-options "--size 160x90 --speed 25" -q
  [ -s run/report.html ]
  [ -s run/best.gif ]
}

@test "the small pipelines: a shell script and a Makefile over the tools" {
  for example in ga.sh ga.mk; do [ "$(wc -l < "$EVO_SOURCE/examples/pipelines/$example")" -le 25 ]; done
  "$EVO_SOURCE/examples/pipelines/ga.sh" sh Walker-v0 6 3 2> /dev/null
  make -s -f "$EVO_SOURCE/examples/pipelines/ga.mk" RUN=mk -j2
  jq -es 'length == 6 and all(.fitness)' sh/scores-2.jsonl
  diff sh/scores-2.jsonl mk/scores-2.jsonl
}
