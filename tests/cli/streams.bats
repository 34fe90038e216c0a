# Streams, threads and memory: what a tool writes where, and what it does when
# the system has no more to give.
load helpers

# A scored robot, a population, a rollout and a policy, made once.
setup_file() {
  cd "$BATS_FILE_TMPDIR" || return
  export made="$BATS_FILE_TMPDIR"
  evo-sample -n 6 --seed 1 > six.jsonl
  printf 'HV\nHV\n' > small.txt
  tiny_profile > tiny.yaml
  evo-eval small.txt --task Walker-v0 --actions random --max-steps 3 --rollout walk.h5 > scored.jsonl
  evo-train small.txt --task Walker-v0 --train gait --steps 8000 --out-dir . -o trained.json
}

@test "a result that cannot be written: status 74, whatever the number of robots and threads" {
  for j in 1 4; do
    fails_with 74 "standard output" -- bash -c "evo-eval -j$j --task Walker-v0 --actions random --max-steps 2 '$made/six.jsonl' > /dev/full"
    fails_with 74 "standard output" -- bash -c "evo-train -j$j --task Walker-v0 --train '$made/tiny.yaml' --steps 2 --out-dir p '$made/six.jsonl' > /dev/full"
    fails_with 74 "standard output" -- bash -c "evo-eval -j$j --task Walker-v0 --actions random --max-steps 2 '$made/six.jsonl' >&-"
  done
}

@test "every tool says 74 on a full disk behind standard output" {
  cd "$made"
  local commands=(
    "evo-sample -n 2" "evo-mutate six.jsonl" "evo-archive -q scored.jsonl" "evo-select scored.jsonl" "evo-suggest -q -n 2"
    "evo-neat -n 4 --state-out $BATS_TEST_TMPDIR/s.json" "evo-convert six.jsonl" "evo-inspect tasks"
    "evo-inspect six.jsonl" "evo-render small.txt -o -" "evo-render walk.h5 --at 1 -o -"
    "evo-convert small.txt --to npz"
    "evo-bench --sizes 3 --seconds 0.01" "evo-inspect task Walker-v0" "evo-sample --help")
  local command
  for command in "${commands[@]}"; do
    echo "$command"
    fails_with 74 -- bash -c "$command > /dev/full"
  done
}

@test "a warning is told from a note, filtered, and written to a file" {
  cd "$made"
  evo-archive scored.jsonl 2> "$BATS_TEST_TMPDIR/note" > /dev/null
  evo-suggest -n 1 2> "$BATS_TEST_TMPDIR/warning" > /dev/null
  cd "$BATS_TEST_TMPDIR"
  grep -qx 'evo-archive: info: [0-9]* of [0-9]* cells have an elite' note
  grep -qx 'evo-suggest: warning: no scored robot to learn from; these bodies are random' warning
  local level
  for level in debug info warning error off; do
    evo-archive --log-level $level "$made/scored.jsonl" 2>> at-$level > /dev/null
    evo-suggest --log-level $level -n 1 2>> at-$level > /dev/null
  done
  cat note warning | cmp - at-info
  cmp warning at-warning
  [ ! -s at-error ] && [ ! -s at-off ]
  [ "$(grep -c ': debug: ' at-debug)" -ge 2 ]
  evo-suggest -q -n 1 2> quiet > /dev/null; [ ! -s quiet ]
  evo-suggest -v -n 1 2> more > /dev/null; grep -q '^evo-suggest: debug: took' more
  fails_with 2 "--quiet" "--log-level" -- evo-suggest -q --log-level info

  evo-suggest --log-file messages --log-level warning -n 1 2> /dev/null > /dev/null
  evo-archive --log-file messages "$made/scored.jsonl" 2> /dev/null > /dev/null
  [ "$(wc -l < messages)" -eq 2 ]
  grep -Eq '^20[0-9]{2}-[0-9]{2}-[0-9]{2}T[0-9:.]+[+-][0-9:]+ evo-suggest\[[0-9]+\] warning: no scored robot' messages
  grep -Eq ' evo-archive\[[0-9]+\] info: [0-9]+ of' messages
  fails_with 73 "--log-file" -- evo-suggest --log-file / -n 1
  # What a training says of itself, in time.
  evo-train -v --log-file training "$made/small.txt" --task Walker-v0 --train "$made/tiny.yaml" --steps 8 --out-dir . \
    > /dev/null 2> /dev/null
  grep -Eq 'debug: robot [0-9a-f]{12}: step [0-9]+ of 8, return' training
}

@test "levels have colours on a terminal, but where NO_COLOR is set" {
  needs_terminal
  TERM=xterm-256color script -qec "evo-suggest -n 1 -o /dev/null" /dev/null | grep -q $'evo-suggest: \e\[.*warning'
  NO_COLOR=1 TERM=xterm-256color script -qec "evo-suggest -n 1 -o /dev/null" /dev/null > said
  grep -q 'evo-suggest: warning: ' said
  run ! grep -q $'\e' said
}

@test "every message goes through the log" {
  cd "$EVO_SOURCE"
  local by_itself='(print|fputs|fwrite|fprintf|fputc)\([^;]*stderr|std::(cerr|clog)'
  # But the line of progress, which is drawn again and again.
  run ! grep -rnE --include='*.cpp' --include='*.h' --exclude=progress.cpp "$by_itself" cli libevo formats render bindings/c
}

@test "standard streams that are closed: no file takes their place" {
  cp "$made/small.txt" .
  fails_with 74 "standard output" -- bash -c 'evo-train small.txt --task Walker-v0 --train gait --steps 8000 --out-dir out >&-'
  cmp out/*.policy.h5 "$made"/*.policy.h5
  run -0 bash -c 'evo-train small.txt --task Walker-v0 --train gait --steps 8000 --out-dir quiet -o x.json 2>&-'
  cmp quiet/*.policy.h5 "$made"/*.policy.h5
  fails_with 74 "standard input" -- bash -c 'evo-select <&-'
}

@test "nothing but results on standard output, warnings and -v or not" {
  cd "$made"
  local commands=(
    "evo-suggest -n 2" "evo-suggest -n 2 six.jsonl" "evo-suggest -n 2 scored.jsonl"
    "evo-sample -n 2" "evo-mutate six.jsonl" "evo-select scored.jsonl" "evo-convert six.jsonl"
    "evo-neat -n 4 --state-out $BATS_TEST_TMPDIR/s.json"
    "evo-eval --task Walker-v0 --actions random --max-steps 2 six.jsonl"
    "evo-eval --progress always --task Walker-v0 --actions random --max-steps 2 six.jsonl"
    "evo-train --progress always --task Walker-v0 --train tiny.yaml --steps 2 --out-dir $BATS_TEST_TMPDIR/p six.jsonl")
  local command
  for command in "${commands[@]}"; do
    $command -v > "$BATS_TEST_TMPDIR/loud" 2> "$BATS_TEST_TMPDIR/words"
    $command -q > "$BATS_TEST_TMPDIR/quiet" 2> "$BATS_TEST_TMPDIR/silence"
    cmp "$BATS_TEST_TMPDIR/loud" "$BATS_TEST_TMPDIR/quiet"
    jq -e '.format == "evo/robot"' "$BATS_TEST_TMPDIR/loud" > /dev/null
    [ ! -s "$BATS_TEST_TMPDIR/silence" ] || { echo "$command -q said: $(cat "$BATS_TEST_TMPDIR/silence")"; return 1; }
  done
  evo-suggest -n 1 2>&1 >/dev/null | grep -q "no scored robot"
}

@test "threads that cannot be started: fewer share the work, with a word" {
  cp "$made/six.jsonl" .
  evo-sample -n 64 > many.jsonl
  run --separate-stderr timeout 60 bash -c "ulimit -v 300000; evo-eval -j64 --task Walker-v0 --actions random --max-steps 2 many.jsonl"
  if [ "$status" -eq 0 ]; then
    [[ $stderr == *"threads could be started"* ]]
    [ "${#lines[@]}" -eq 64 ]
  else
    echo "$status: $stderr"
    [ "$status" -eq 1 ]
    [[ $stderr == *"memory"* ]]
  fi
  fails_with 2 "--jobs: must be from 1 to 1024" -- evo-eval -j100000 --task Walker-v0 --actions random six.jsonl
}

@test "memory that ends anywhere in a training: status 1, one line, and no half file" {
  evo-sample -n 3 --shape 3x3 > robots.jsonl
  tiny_profile > tiny.yaml
  limited() { (ulimit -v "$1"; shift; exec timeout 20 "$@"); }
  # From what the program itself takes, in steps of half a megabyte.
  local least=10000 kilobytes
  until limited $least evo-train --version > /dev/null 2>&1; do least=$((least + 500)); [ $least -lt 500000 ]; done
  for ((kilobytes = least; kilobytes < least + 16000; kilobytes += 500)); do
    run --separate-stderr limited $kilobytes evo-train -j1 --task Walker-v0 --train tiny.yaml --steps 2 --out-dir out robots.jsonl
    if [ "$status" -eq 0 ]; then
      [ "${#lines[@]}" -eq 3 ]
      rm -r out
    else
      [ "$status" -eq 1 ] || { echo "$kilobytes kB: $status, $stderr"; return 1; }
      [[ $stderr == *"memory"* ]]
    fi
    [ -z "$(find out -name '*.tmp*' -o -name '.*' -type f 2> /dev/null)" ]
  done
}

@test "control characters and bytes that are no text do not reach the terminal" {
  printf '{"body":["HV"],"task":"\\u001b[31mred\\u0007","policy":"a\\nb"}\n' > red.json
  run evo-inspect red.json
  [[ $output != *$'\e'* ]]
  [[ $output == *'\x1b[31mred\x07'* ]]
  [[ $output == *'a\x0ab'* ]]
  sed 's/^name: .*/name: "a\\e[31mb"/; s/^description: .*/description: "c\\x07d"/' "$EVO_SOURCE/tasks/Walker-v0.yaml" > red.yaml
  for subject in "task ./red.yaml" red.yaml; do
    evo-inspect $subject > said
    run ! grep -P '[\x00-\x08\x0b-\x1f\x7f]' said
    grep -qF 'a\x1b[31mb' said
  done
  printf 'H\x1b[2JV\n' > letters.txt
  for words in "evo-select letters.txt" $'evo-select \e[31mfile' $'evo-train --task \e[2J' $'evo-sample --\e[2J' \
    $'evo-sample --shape \xff' $'evo-eval --task W\x9b --actions random red.json'; do
    IFS=' ' read -ra command <<<"$words"
    run --separate-stderr "${command[@]}"
    [ "$status" -ne 0 ]
    ! LC_ALL=C grep -qP '[\x00-\x09\x0b-\x1f\x7f-\xff]' <<<"$stderr" || { echo "$stderr" | od -c | head; return 1; }
  done
}
