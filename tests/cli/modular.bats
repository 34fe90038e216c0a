# One controller for several robots, as processes: reproducible, resumable, of use to other bodies.
load helpers

robots() { evo-sample -n 4 --seed 2; }
shared() { evo-train --task Walker-v0 --train modular --train environments=2 --steps "$1" --shared "$2" "${@:3}"; }

@test "modular: one controller for all, which any body can wear" {
  robots | shared 4096 one.policy.h5 > scored
  [ "$(ls one*)" = "$(printf 'one.log\none.policy.h5')" ]
  [ "$(jq -r .policy scored | sort -u)" = one.policy.h5 ]
  # A robot's fitness is what it earns with it; the policy's is the mean, its robot the best.
  evo-eval --policy one.policy.h5 scored 2> /dev/null | jq .fitness | cmp - <(jq .fitness scored)
  evo-convert one.policy.h5 --to json > policy.json
  jq -e '.kind == "modular" and (.robots | length) == 4' policy.json
  jq -e --slurpfile all scored '(.fitness - ([$all[].fitness] | add / length) | fabs) < 1e-12' policy.json
  jq -e '.robot.fitness == ([.robots[].fitness] | max)' policy.json
  /usr/bin/python3 "$EVO_SOURCE/tests/cli/check_schema.py" policy < policy.json
  evo-inspect one.policy.h5 | grep "of every voxel, for any body"
  # Another body, without training and with a little.
  evo-sample -n 1 --seed 9 --shape 4x6 > other
  evo-eval --policy one.policy.h5 other 2> warnings | jq -e '.fitness | type == "number"'
  [ ! -s warnings ]
  evo-train --task Walker-v0 --train modular --steps 512 --train environments=2 --init one.policy.h5 --out-dir own other |
    jq -e '.steps == 512'
  evo-train --task Walker-v0 --train adapt --steps 2048 --init one.policy.h5 --out-dir adapted other > adapted.json
  jq -e --slurpfile before <(evo-eval --policy one.policy.h5 other 2> /dev/null) '.fitness >= $before[0].fitness' adapted.json
}

@test "modular: the same bytes again, for any -j, and interrupted" {
  robots > robots
  shared 16384 calm.policy.h5 -j1 robots > calm
  shared 16384 again.policy.h5 -j3 robots | sed 's/again/calm/' | cmp - calm
  cmp calm.policy.h5 again.policy.h5
  # It is known, and is not trained again.
  shared 16384 calm.policy.h5 robots | cmp - calm
  for _ in 1 2 3; do
    (exec evo-train --task Walker-v0 --train modular --train environments=2 --steps 16384 --shared stormy.policy.h5 \
      --resume robots > /dev/null 2>&1 3>&-) & training=$!
    until [ -e stormy.log ]; do kill -0 $training || return; sleep 0.05; done
    random_pause
    kill -TERM $training 2> /dev/null || break
    wait $training && break
  done
  shared 16384 stormy.policy.h5 --resume robots | sed 's/stormy/calm/' | cmp - calm
  cmp calm.policy.h5 stormy.policy.h5
  [ ! -e stormy.checkpoint.h5 ]
}

@test "modular: what does not fit is refused in a line" {
  robots > robots
  shared 512 one.policy.h5 robots > scored
  fails_with 2 "ppo makes a controller for each robot; modular makes one for all" -- \
    evo-train --task Walker-v0 --steps 16384 --shared two.policy.h5 robots
  fails_with 2 "starts from one policy, not from those of a folder" -- shared 512 two.policy.h5 --init . robots
  fails_with 73 "one.policy.h5: trained with other settings" -- shared 1024 one.policy.h5 robots
  head -2 robots > fewer
  fails_with 73 "robots: 4 " -- shared 512 one.policy.h5 fewer
  fails_with 65 "trained on another task" -- evo-eval -q --policy one.policy.h5 --task Carrier-v0 fewer
  fails_with 2 "ppo cannot start from a modular policy" -- \
    evo-train --task Walker-v0 --steps 16384 --init one.policy.h5 --out-dir own fewer
  echo '{"body":["RR","SS"]}' > still
  fails_with 65 "no actuator" -- shared 512 two.policy.h5 robots still
  [ ! -e two.policy.h5 ]
}

@test "modular: as an ONNX graph for one body, which acts as the controller does" {
  robots > robots
  evo-sample -n 1 --seed 9 --shape 4x6 > other
  local python
  python=$("$EVO_SOURCE/tests/cli/onnxruntime.sh" "$EVO_BUILD") || python=/usr/bin/python3
  shared 512 two.policy.h5 --train clock=10,20 robots > scored
  evo-convert two.policy.h5 --robot other -o two.onnx
  "$python" "$EVO_SOURCE/tests/cli/policy_onnx.py" two.onnx two.policy.h5 other
  # Without --robot it is for the policy's own, the best; without a clock no step is asked for.
  shared 512 one.policy.h5 --train action_map=squash robots > scored
  evo-convert one.policy.h5 -o own.onnx
  evo-convert one.policy.h5 --to jsonl -o best
  /usr/bin/python3 "$EVO_SOURCE/tests/cli/policy_onnx.py" own.onnx one.policy.h5 best
  /usr/bin/python3 -c 'import onnx; print([i.name for i in onnx.load("own.onnx").graph.input])' | grep -x "\['task', 'local'\]"
  fails_with 2 "--to onnx writes one robot, but 4 were read" -- evo-convert one.policy.h5 --robot robots -o no.onnx
  fails_with 2 "--robot is for --to onnx" -- evo-convert robots --robot other -o no.jsonl
  evo-train other --task Walker-v0 --train algorithm=ppo --steps 64 --train environments=2 --train rollout=32 --out-dir net > net.json
  fails_with 2 "--robot is for modular policies" -- evo-convert net/*.policy.h5 --robot other -o no.onnx
  [ ! -e no.onnx ]
}

@test "modular: the benchmark measures bodies that a controller met, and others" {
  measure=("$EVO_SOURCE/benchmarks/modular/measure" Walker-v0 one two --seen 4 --unseen 4 --sample 4
    --shared 4096 --own 1024 --tuned 1024 --shape 3x3)
  "${measure[@]}" > first 2> /dev/null
  # Means over bodies and seeds, zero-shot in the fourth column.
  mean=$(cat one/bodies.tsv two/bodies.tsv | awk '$2 == "unseen" { sum += $3; n++ } END { printf "%.2f", sum / n }')
  [ "$(awk '$4 == "unseen" { print $8 }' first)" = "$mean" ]
  # What is there is not made again.
  rm one/*.jsonl
  "${measure[@]}" | cmp - first
}
