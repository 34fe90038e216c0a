# All reference trajectories through the command line.
load helpers

compare() { /usr/bin/python3 "$EVO_SOURCE/tests/cli/compare_rollout.py" "$@"; }

replay() {  # TASK CASE.h5: the case's actions and draws, recorded into ours.h5
  local draws=()
  case $1 in Catcher-v0|BidirectionalWalker-v0) draws=(--draws "$2") ;; esac
  evo-eval --task "$1" --actions "$2" "${draws[@]}" --rollout ours.h5 "$2" > /dev/null
}

@test "two bodies on each of the 32 tasks" {
  local cases=("$data"/reference/*_[AB].h5) case task
  [ ${#cases[@]} -eq 64 ]
  for case in "${cases[@]}"; do
    task=$(basename "$case"); task=${task%_?.h5}
    replay "$task" "$case"
    # 27 loose blocks in exact contact: the order of contact sums decides after step 8
    if [ "$task" = Traverser-v0 ]; then compare "$case" ours.h5 8; else compare "$case" ours.h5; fi
  done
}

@test "double points, partial links, empty borders, a large body, self-folding" {
  local case
  for case in "$data"/reference/extra/Walker-v0_*.h5; do
    replay Walker-v0 "$case"
    compare "$case" ours.h5
  done
}

@test "a body falling onto the world floor" {
  cat > empty.yaml <<'Y'
format: evo/task
version: 1
name: empty
description: Nothing but a robot above the world floor.
steps: 500
robot: {at: [2, 3]}
world: {objects: {}}
observation: [velocity: robot]
reward: [displacement: {of: robot, axis: x}]
Y
  replay ./empty.yaml "$data/reference/extra/floor.h5"
  compare "$data/reference/extra/floor.h5" ours.h5
}
