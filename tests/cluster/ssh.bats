# Runs on machines that ssh reaches.
load helpers

setup() {
  cd "$BATS_TEST_TMPDIR" || return
  command -v parallel > /dev/null || skip "GNU parallel is not here"
  fake_ssh
}

small=(POP=6 EVALS=12 SHAPE=4x4)

over_ssh() {
  local logins=$1 folder=$2
  shift 2
  "$EVO_SOURCE/scripts/ssh-run" "$logins" "$folder" -- "${settings[@]}" "${small[@]}" -s "$@" "$folder/history.jsonl"
}

@test "two machines end with the bytes of make here; one that is not there is gone round" {
  run_make ga-window calm "${small[@]}" -s -j2 calm/history.jsonl
  SHELL=/usr/sbin/nologin over_ssh 2/one,1/nowhere,1/two run 2> messages
  diff <(essence calm) <(essence run)
  [ "$(cd run/timings && echo *)" = "one.jsonl two.jsonl" ]
  grep -q "Could not resolve hostname nowhere" messages
}

@test "killed, it leaves nothing running anywhere" {
  (unset SHELL; exec "$EVO_SOURCE/scripts/ssh-run" 2/one,1/two run -- TASK=Walker-v0 STEPS=100000000 "${small[@]}" -s > /dev/null 2>&1 3>&-) &
  main=$!
  training() { [ "$(ls run/gen-000/*.running 2> /dev/null | wc -l)" -eq 3 ]; }
  within 60 training
  sleep 1
  kill -TERM "$(pgrep -P $main -x make)"
  within 30 nobody_works
  [ "$(find run/policies -name '*.checkpoint.h5' | wc -l)" -eq 3 ]
}

# ---- files carried -------------------------------------------------------------------

# Machines that see nothing of this folder: what runs there begins in another one.
carried() {
  local logins=$1 folder=$2
  shift 2
  mkdir -p far
  FAR=$PWD/far TMPDIR=$PWD/far "$EVO_SOURCE/scripts/ssh-run" --carry "$logins" "$folder" -- \
    "${settings[@]}" "${small[@]}" -s "$@" "$folder/history.jsonl"
}
# The oldest process of ours with such a command line.
ours() {
  local process
  for process in $(pgrep -f "$1"); do
    if [ "$(readlink "/proc/$process/cwd")" = "$PWD" ]; then echo "$process"; return; fi
  done
}
nothing_left() {
  [ -z "$(ls -A far)" ]
  [ -z "$(find run -name '.carried*' -o -name '*.running' -o -name '*.checkpoint.h5')" ]
}

@test "carried: two machines end with the bytes of make here, inherited policies and chunks as well" {
  mkdir own
  cp "$EVO_SOURCE/tasks/Walker-v0.yaml" own/task.yaml
  run_make ga scout "${small[@]}" -s -j2 scout/history.jsonl
  for pipeline in "ga-window CHUNK=2" "ga INHERIT=yes TASK=own/task.yaml" "ga INHERIT=all FOUNDERS=scout"; do
    read -ra words <<< "$pipeline"
    run_make "${words[0]}" calm "${small[@]}" -s -j2 "${words[@]:1}" calm/history.jsonl
    pipeline_words "${words[0]}" "${small[@]}"
    carried 2/one,1/nowhere,1/two run "${pipeline[@]}" "${words[@]:1}" 2> messages
    diff <(essence calm) <(essence run)
    [ "$(cd run/timings && echo *)" = "one.jsonl two.jsonl" ]
    [ "$(cat run/timings/*.jsonl | wc -l)" -eq 12 ]
    grep -q "Could not resolve hostname nowhere" messages
    nothing_left
    rm -r calm run
  done
}

@test "carried: one controller for all robots goes there and comes back" {
  modular=(EVALS=8 CHILDREN=2 STEPS=3072 CHAMPIONS=2 OWN_STEPS=2048 TRAIN_OPTIONS="--train-set environments=2 --checkpoint-every 1")
  run_make modular calm "${small[@]}" -s "${modular[@]}" calm/history.jsonl
  CARRY_EVERY=1 carried 1/one,1/two run -f "$EVO_SOURCE/scripts/modular.mk" "${modular[@]}" 2> messages
  diff <(essence calm) <(essence run)
  nothing_left
}

@test "carried: a connection that breaks costs a training, and leaves no part of one" {
  run_make ga-window calm "${small[@]}" -s -j2 calm/history.jsonl
  CUT=$PWD/cut carried 1/one,1/two run 2> messages
  diff <(essence calm) <(essence run)
  nothing_left
  # So does one that has begun, and whose process here is killed.
  rm -r run
  (carried 1/one,1/two run "STEPS=400000" TRAIN_OPTIONS="--final-episodes 0" 2> messages) 3>&- &
  main=$!
  begun() { [ -n "$(ls run/gen-000/*.running 2> /dev/null)" ]; }
  within 60 begun
  kill -KILL "$(ours "scripts/carry (one|two) ")"
  again() { grep -q "1 of 3 times" messages; }
  within 60 again
  kill -TERM "$(ours "^make .*RUN=run .*-j 2")"
  wait $main || true
  within 30 nobody_works
  [ -n "$(find run -name '.carried*')" ]
  carried 1/one,1/two run "STEPS=400000" TRAIN_OPTIONS="--final-episodes 0" -n 2> messages || true
  [ -z "$(find run -name '.carried*')" ]
}

@test "carried: stopped, checkpoints come back, and it goes on from them" {
  long=(STEPS=150000 POP=2 EVALS=3 TRAIN_OPTIONS="--final-episodes 0 --checkpoint-every 8000")
  run_make ga-window calm "${small[@]}" "${long[@]}" -s -j2 calm/history.jsonl
  (CARRY_EVERY=1 carried 1/one,1/two run "${long[@]}" 2> messages) 3>&- &
  main=$!
  begun() { [ -n "$(ls run/gen-000/*.running 2> /dev/null)" ]; }
  within 60 begun
  sleep 1
  kill -TERM "$(ours "^make .*RUN=run .*-j 2")"
  wait $main || true
  within 30 nobody_works
  [ "$(find run/policies -name '*.checkpoint.h5' | wc -l)" -ge 1 ]
  [ -z "$(ls -A far)" ]
  carried 1/one,1/two run "${long[@]}" 2> messages
  diff <(essence calm) <(essence run)
  nothing_left
}

@test "carried: another version of the tools is not used; a program that scores is carried, too" {
  mkdir other
  printf '#!/bin/sh\necho evo-run 0.0.1 "(old)"\n' > other/evo-run
  chmod +x other/evo-run
  sed -i '2i case " $* " in *" two "*) export PATH=$OTHER:$PATH ;; esac' bin/ssh
  OTHER=$PWD/other carried 1/one,1/two run 2> messages
  [ "$(cd run/timings && echo *)" = one.jsonl ]
  grep -q "two has 'evo-run 0.0.1 (old)', here is 'evo-run" messages
  rm -r run
  evaluate='jq -c ". + {fitness: (.body | join(\"\") | length)}"'
  carried 1/one run EVALUATE="$evaluate"
  [ "$(jq -s 'map(select(.fitness == 16)) | length' run/history.jsonl)" -eq 12 ]
  nothing_left
}

@test "what is no list of machines is refused" {
  run -2 "$EVO_SOURCE/scripts/ssh-run" 0/one run --
  [[ $output == *"0/one"* ]]
  run -2 "$EVO_SOURCE/scripts/ssh-run" one run EVALS=3
}
