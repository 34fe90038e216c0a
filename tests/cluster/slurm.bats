# Runs under Slurm: a private one, two virtual nodes of two cores each.
load helpers

# Why there is no Slurm; skipping in setup_file itself counts as a failure (bats 1.8).
setup_file() {
  export no_slurm=
  if ! command -v sbatch > /dev/null || ! PATH=$PATH:/usr/sbin command -v slurmctld munged > /dev/null; then
    no_slurm="Slurm is not here (apt-get install slurm-wlm munge)"
  elif ! mountpoint -q /sys/fs/cgroup; then
    no_slurm="slurmd needs /sys/fs/cgroup, which a bare chroot has not"
  fi
  [ -z "$no_slurm" ] || return 0
  CPUS=2 MEMORY=4000 "$EVO_SOURCE/scripts/slurm/one-node" "$BATS_FILE_TMPDIR/slurm" 2 > "$BATS_FILE_TMPDIR/conf"
  SLURM_CONF=$BATS_FILE_TMPDIR/slurm/slurm.conf
  export SLURM_CONF
}

setup() {
  [ -z "$no_slurm" ] || skip "$no_slurm"
  cd "$BATS_TEST_TMPDIR" || return
}

teardown_file() {
  if [ -e "$BATS_FILE_TMPDIR/slurm" ]; then "$EVO_SOURCE/scripts/slurm/one-node" --stop "$BATS_FILE_TMPDIR/slurm"; fi
}

# What a test leaves behind when it fails does not fail the next one.
teardown() {
  [ -z "${BATS_TEST_COMPLETED:-}" ] && [ -z "$no_slurm" ] || return 0
  squeue --noheader --format=%i | xargs -r scancel
  if [ -e "$BATS_FILE_TMPDIR/slurm/n2.pid" ] && ! within 20 both_idle; then
    kill -KILL "$(daemon_of_n2)" 2> /dev/null || true
    n2_returns || true
  fi
}

small=(POP=6 EVALS=18 SHAPE=4x4)

# submit RUN [sbatch options] -- [make arguments]; the job's number is in $job.
submit() {
  local answer
  answer=$("$EVO_SOURCE/scripts/slurm/submit" "$@")
  job=$(grep -o '^job [0-9]*' <<< "$answer" | cut -d' ' -f 2)
}
# The arguments of make for an evolution trained by the stand-in, and nothing else.
evolution=("${settings[@]}" -s "TRAINER=$stand_in")

gone() { [ -z "$(squeue --noheader --job "$job" 2> /dev/null)" ]; }
running() { [ "$(squeue --noheader --job "$job" --format=%T)" = RUNNING ]; }
waiting() { [ "$(squeue --noheader --job "$job" --format=%T)" = PENDING ]; }
trained() { [ -e run/stand-in.log ] && [ "$(grep -c ^end run/stand-in.log)" -ge "$1" ]; }
ended() {
  within 400 gone || { squeue; cat run/slurm/*.log; return 1; }
  [ -e run/history.jsonl ] || { cat run/slurm/*.log; return 1; }
}

@test "a genetic algorithm over two nodes ends with the bytes of make -j2" {
  real=(POP=4 EVALS=9 SHAPE=4x4 VIDEO=gif VIDEO_OPTIONS="--size 160x90 --every 10")
  run_make ga calm "${real[@]}" -j2 -s
  submit run --ntasks=4 --mem-per-cpu=300 -- -f "$EVO_SOURCE/scripts/ga.mk" "${settings[@]}" "${real[@]}"
  ended
  diff <(essence calm) <(essence run)
  cmp calm/best.json run/best.json
  # Both nodes have trained.
  [ "$(cd run/timings && echo *)" = "n1.jsonl n2.jsonl" ]
}

# Everything of node n2 by process number: its daemon, its steps and what they run.
daemon_of_n2() { cat "$BATS_FILE_TMPDIR/slurm/n2.pid"; }
all_of_n2() {
  local step process
  daemon_of_n2
  for step in $(squeue --noheader --steps --format="%i %N" | awk '$2 == "n2" { print $1 }'); do
    for process in $(pgrep -f "slurmstepd: \[$step\]"); do echo "$process"; pgrep -P "$process" || true; done
  done
}
both_idle() { [ "$(sinfo --noheader --Node --partition=main --states=idle --format=%N | wc -l)" -eq 2 ]; }
# The daemon of n2 begins anew, whatever became of the one before.
n2_returns() {
  PATH=$PATH:/usr/sbin slurmd -c -N n2
  within 60 both_idle
}

@test "a node's daemon is killed in the middle: its trainings are done elsewhere" {
  export SECONDS_EACH=0.4
  SECONDS_EACH=0 evolve ga-window calm "${small[@]}" -j7
  submit run --ntasks=4 -- "${evolution[@]}" "${small[@]}" "$PWD/run/history.jsonl"
  within 60 trained 3
  kill -KILL "$(daemon_of_n2)"
  ended
  diff <(essence calm) <(essence run)
  n2_returns
}

@test "a node stops dead with its trainings: they are done elsewhere" {
  export SECONDS_EACH=2 PATIENCE=2  # long enough for a slow machine to find what to stop
  SECONDS_EACH=0 evolve ga-window calm "${small[@]}" -j7
  submit run --ntasks=4 -- "${evolution[@]}" "${small[@]}" "$PWD/run/history.jsonl"
  within 60 trained 3
  mapfile -t frozen < <(all_of_n2)
  kill -STOP "${frozen[@]}" || true  # some may have ended
  ended
  kill -KILL "${frozen[@]}" 2> /dev/null || true
  diff <(essence calm) <(essence run)
  # How soon Slurm takes the node from the job decides what is said of it.
  grep -Eq "places: n2 is lost|on n2 before anything had begun|on n2, [12] of 3 times" run/slurm/*.log
  n2_returns
}

@test "a training that is cancelled is done again" {
  export SECONDS_EACH=2
  few=("${small[@]/EVALS=18/EVALS=9}")
  SECONDS_EACH=0 evolve ga-window calm "${few[@]}" -j7
  submit run --ntasks=3 -- "${evolution[@]}" "${few[@]}" "$PWD/run/history.jsonl"
  begun() { [ -e run/stand-in.log ]; }
  within 60 begun
  # The newest step; it may end before it can be cancelled.
  cancelled() {
    local step
    step=$(squeue --noheader --steps --format=%i | grep "^$job\.[0-9]" | sort -V | tail -1)
    [ -n "$step" ] && scancel "$step" 2> /dev/null
  }
  within 20 cancelled
  ended
  diff <(essence calm) <(essence run)
  # Killed in its training, or before it had begun.
  grep -Eq "ended with status 1[34][0-9] on n[12], 1 of 3 times|before anything had begun" run/slurm/*.log ||
    { cat run/slurm/*.log; return 1; }
}

@test "preempted, it goes back into the queue and then on" {
  export SECONDS_EACH=0.4
  SECONDS_EACH=0 evolve ga-window calm "${small[@]}" -j7
  submit run --ntasks=4 -- "${evolution[@]}" "${small[@]}" "$PWD/run/history.jsonl"
  within 60 trained 3
  sbatch --parsable --partition=urgent --ntasks=4 --nodes=2 --output=/dev/null --wrap "sleep 3" > urgent
  within 60 waiting
  scontrol update JobId="$job" StartTime=now  # else two minutes later
  ended
  diff <(essence calm) <(essence run)
  # What was done before was not done again.
  [ -z "$(grep ^end run/stand-in.log | cut -d' ' -f 2 | sort | uniq -d)" ]
}

@test "preempted, trainings save checkpoints and go on from them" {
  long=(POP=2 EVALS=2 SHAPE=4x4 STEPS=100000 TRAIN_OPTIONS="--final-episodes 0")
  run_make ga-window calm "${settings[@]}" "${long[@]}" -s -j2 calm/history.jsonl
  submit run --ntasks=2 -- "${settings[@]}" "${long[@]}" -s "$PWD/run/history.jsonl"
  learning() { [ "$(cat run/logs/*/*.log 2> /dev/null | grep -c '^charts')" -ge 2 ]; }
  within 60 learning
  sbatch --parsable --partition=urgent --ntasks=4 --nodes=2 --output=/dev/null --wrap "sleep 1" > urgent
  within 60 waiting
  [ "$(find run/policies -name '*.checkpoint.h5' | wc -l)" -ge 1 ]
  scontrol update JobId="$job" StartTime=now
  ended
  diff <(essence calm) <(essence run)
  grep -q 'resumed' run/logs/*/*.log
}

@test "an array has a job for every run of a comparison" {
  submit --array run --cpus-per-task=1 -- "${settings[@]:1}" "${small[@]}" TASKS=Walker-v0 METHODS="ga bo-window" SEEDS="1 2" \
    "TRAINER=$stand_in" VIDEO=gif VIDEO_OPTIONS="--size 160x90 --every 10"
  [ "$(wc -l < run/slurm/runs)" -eq 4 ]
  grep -q '^#SBATCH --array=1-4' run/slurm/job.sh
  squeue --noheader --format=%F | sort -u | xargs -r scancel
}

@test "settings that are wrong, or of another run, are refused before anything is queued" {
  # Nothing is trained here, whatever the targets are.
  "$EVO_SOURCE/scripts/slurm/submit" waits --hold -- "${evolution[@]}" "${small[@]}" "$PWD/waits/history.jsonl" > said
  [ -e waits/run.yaml ]
  [ -z "$(find waits -name "gen-*" -o -name stand-in.log)" ]
  held=$(grep -o '^job [0-9]*' said | cut -d' ' -f 2)
  scancel "$held"
  run -2 "$EVO_SOURCE/scripts/slurm/submit" run -- "${settings[@]}" METHOD=nix
  [[ $output == *"ga.mk has no setting METHOD; it has "* ]]
  evo-run init run method=ga task=Walker-v0 pop=1 evals=2 steps=1 seed=1
  run -2 "$EVO_SOURCE/scripts/slurm/submit" run -- "${settings[@]}"
  [[ $output == *"steps: 1 there, steps: 4096 asked for"* ]]
  # (%F: elements of an array get numbers of their own, %A, when they begin.)
  [ "$(squeue --noheader --states=all --format=%F | sort -n | tail -n 1)" -eq "$held" ]
}

@test "without sbatch it says what to do, and the script is there" {
  mkdir bin
  for program in bash dirname realpath basename mkdir mv cat nproc wc make sed cut; do ln -s "$(command -v $program)" bin/; done
  PATH=$PWD/bin run -69 "$EVO_SOURCE/scripts/slurm/submit" run --ntasks=8 -- EVALS=100 STEPS=65536
  [[ $output == *"sbatch is not here"* && $output == *"one-node"* ]]
  grep -q '^#SBATCH --ntasks=8' run/slurm/job.sh
  bash -n run/slurm/job.sh
}
