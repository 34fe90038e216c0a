# Runs on machines that ssh reaches. Here ssh is a script that starts a shell on this
# machine, and has never heard of some others.
load helpers

setup() {
  cd "$BATS_TEST_TMPDIR" || return
  command -v parallel > /dev/null || skip "GNU parallel is not here"
  mkdir bin
  cat > bin/ssh << 'END'
#!/bin/bash
# ssh [-o option].. [-l user] MACHINE COMMAND
while :; do case $1 in -l | -o | -p | -S) shift 2 ;; -* | --) shift ;; *) break ;; esac; done
case $1 in nowhere*) echo "ssh: Could not resolve hostname $1" >&2; exit 255 ;; esac
export SLURMD_NODENAME=$1
shift
if [ "$1" = -- ]; then shift; fi
exec bash -c "$*" < /dev/null
END
  chmod +x bin/ssh
  export PARALLEL_SSH=$PWD/bin/ssh PARALLEL_HOME=$PWD
}

small=(POP=6 EVALS=12 SHAPE=4x4)

over_ssh() {
  local logins=$1 folder=$2
  shift 2
  "$EVO_SOURCE/scripts/ssh-run" "$logins" "$folder" -- "${settings[@]}" "${small[@]}" -s "$@" "$folder/history.jsonl"
}

@test "two machines end with the bytes of make here; one that is not there is gone round" {
  run_make steady calm "${small[@]}" -s -j2 calm/history.jsonl
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

@test "what is no list of machines is refused" {
  run -2 "$EVO_SOURCE/scripts/ssh-run" 0/one run --
  [[ $output == *"0/one"* ]]
  run -2 "$EVO_SOURCE/scripts/ssh-run" one run EVALS=3
}
