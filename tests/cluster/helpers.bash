# Shared by the tests of many processes and machines.
load ../cli/helpers
stand_in="$EVO_SOURCE/tests/cluster/stand-in"

settings=(TASK=Walker-v0 STEPS=4096 SEED=1)

# A pipeline of scripts/ in a session of its own, so that it can be killed.
run_make() {
  local name=$1 folder=$2
  shift 2
  local pipeline
  pipeline_words "$name" "${settings[@]}" "$@"
  make "${pipeline[@]}" RUN="$folder" "${settings[@]}" "$@"
}

# Only the evolution, trained by the stand-in: no video, no report.
evolve() {
  local pipeline=$1 folder=$2
  shift 2
  run_make "$pipeline" "$folder" -s TRAINER="$stand_in" "$@" "$folder/history.jsonl"
}

# The same in the background, and the end of make alone.
evolve_behind() {
  local name=$1 folder=$2 pipeline
  shift 2
  pipeline_words "$name" "${settings[@]}" "$@"
  (exec make "${pipeline[@]}" RUN="$folder" "${settings[@]}" -s TRAINER="$stand_in" "$@" \
    "$folder/history.jsonl" > /dev/null 2>&1 3>&-) &
  make=$!
}
kill_make() {
  kill -KILL "$make" 2> /dev/null || true
  wait "$make" 2> /dev/null || true
  within 10 nobody_works
}
# None of our processes is in the test's folder any more.
nobody_works() {
  local process
  for process in $(pgrep -f "scripts/|evo-|stand-in"); do
    if [ "$(readlink "/proc/$process/cwd")" = "$PWD" ]; then return 1; fi
  done
}

# Everything of a run that must not depend on how it came about.
essence() {
  (cd "$1" && cat run.yaml gen-*/population.jsonl gen-*/scores.jsonl gen-*/ranking.tsv history.jsonl
    if ls policies/* > /dev/null 2>&1; then find policies -name '*.h5' | sort | xargs sha256sum; fi)
}

# Waits until a condition holds, for so many seconds.
within() {
  local seconds=$1 i
  shift
  for ((i = 0; i < seconds * 10; i++)); do
    if "$@"; then return 0; fi
    sleep 0.1
  done
  echo "not within $seconds s: $*" >&2
  return 1
}

# ssh is a script that starts a shell on this machine, and has never heard of some
# others. With FAR, shells begin there; with CUT, the first connection of all breaks.
fake_ssh() {
  mkdir bin
  cat > bin/ssh << 'END'
#!/bin/bash
# ssh [-o option].. [-l user] MACHINE COMMAND
while :; do case $1 in -l | -o | -p | -S) shift 2 ;; -* | --) shift ;; *) break ;; esac; done
case $1 in nowhere*) echo "ssh: Could not resolve hostname $1" >&2; exit 255 ;; esac
export SLURMD_NODENAME=$1
shift
if [ "$1" = -- ]; then shift; fi
if [ -n "${FAR:-}" ]; then cd "$FAR" || exit; fi
case $* in *"head -c"*) ;; *) exec < /dev/null ;; esac  # but for scripts/carry
if [ -n "${CUT:-}" ] && mkdir "$CUT" 2> /dev/null; then bash -c "$*" | head -c 3000; exit 255; fi
exec bash -c "$*"
END
  chmod +x bin/ssh
  export PARALLEL_SSH=$PWD/bin/ssh PARALLEL_HOME=$PWD CARRY_SSH=$PWD/bin/ssh
}
