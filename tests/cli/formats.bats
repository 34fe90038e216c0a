# Formats: what the tools write fits the schemas, and other programs can use it.
load helpers

setup_file() {
  cd "$BATS_FILE_TMPDIR" || return
  export made="$BATS_FILE_TMPDIR"
  printf 'HVH\nHVH\n' > small.txt
  local small=(--train 'hidden=[8]' --train environments=2 --train rollout=32)
  evo-train small.txt --task Walker-v0 --steps 640 --out-dir net "${small[@]}" -o net.json
  evo-train small.txt --task Walker-v0 --steps 640 --out-dir squash "${small[@]}" --train action_map=squash -o squash.json
  evo-train small.txt --task Walker-v0 --steps 64 --out-dir timed "${small[@]}" --train 'clock=[20]'
  evo-train small.txt --task Walker-v0 --steps 8000 --train gait --out-dir sine -o sine.json
  evo-train small.txt --task Walker-v0 --steps 16000 --train algorithm=sequence --out-dir sequence -o sequence.json
}
schema() { /usr/bin/python3 "$EVO_SOURCE/tests/cli/check_schema.py" "$1"; }

@test "everything the tools write fits its schema" {
  cd "$made"
  evo-sample -n 20 --shape 3x4 | tee sampled | schema robot
  evo-mutate -n 20 --crossover 0.5 sampled | schema robot
  evo-suggest -q -n 2 | schema robot
  evo-neat -n 6 --state-out species.json | jq -c '.fitness = 1' | tee genomes | schema robot
  schema neat-state < species.json
  evo-neat -n 6 --state-in species.json --state-out next.json genomes | schema robot
  schema neat-state < next.json
  evo-eval --task Walker-v0 --actions random --max-steps 3 sampled | tee scored | schema robot
  evo-select --keep 3 scored | schema robot
  schema robot < net.json
  schema robot < sine.json
  evo-train small.txt --task Walker-v0 --steps 64 --out-dir bad --failures skip --train learning_rate=1e300 --train environments=2 --train rollout=8 | schema robot
  evo-convert sampled --to yaml | schema robot
  evo-convert small.txt --to json | schema robot
  evo-convert small.txt --to evogym | schema design-tool
  evo-convert --task Carrier-v0 --to evogym | schema design-tool
  local policy
  for policy in {net,squash,timed,sine,sequence}/*.policy.h5; do
    evo-convert "$policy" --to json | tee policy.json | schema policy
    jq -r .task_yaml policy.json | schema task
    jq -r .physics_yaml policy.json | schema physics
    jq -r .training_yaml policy.json | schema training
  done
  evo-convert --task Carrier-v1 --to evogym -o world.json
  evo-convert world.json --to task | schema task
}

@test "runs fit their schemas" {
  local method
  for method in ga neat bo map race modular; do
    evo-evolve $method -q --plan --run $method --pop 40 --evals 90 --shape 4x4 --train-options "--train 'hidden=8,8'"
    schema run < $method/run.yaml
  done
  evo-evolve ga -q --plan --run own --evaluate "echo '# it\"s: [odd]' \$x" --window 3
  schema run < own/run.yaml
  [ "$(evo-inspect own/run.yaml | sed -n 's/^evaluate  *//p')" = "echo '# it\"s: [odd]' \$x" ]
}

@test "the data that the tools come with fits the schemas" {
  local file
  for file in "$EVO_SOURCE"/tasks/*-v?.yaml "$EVO_SOURCE"/tasks/examples/*.yaml "$EVO_SOURCE"/tasks/easier/*.yaml; do
    schema task < "$file"
  done
  for file in "$EVO_SOURCE"/tasks/physics/*.yaml; do schema physics < "$file"; done
  for file in "$EVO_SOURCE"/tasks/training/*.yaml; do schema training < "$file"; done
  schema neat < "$EVO_SOURCE/tasks/neat.yaml"
}

@test "a schema takes and refuses what the tools do" {
  evo-sample -n 1 > robot
  printf '%s\n' 'name: Step' 'base: Walker-v0' 'world: {objects: {step: {at: [9, 0], rows: ["##", "##"]}}}' > step.yaml
  evo-inspect task ./step.yaml > shown
  schema task < step.yaml
  printf '%s\n' 'name: Aimless' 'base: Walker-v0' 'goals: {start: 1, between: [2, 3], distance: 4}' > aimless.yaml
  fails_with 65 "radius" -- evo-inspect task ./aimless.yaml
  run -1 schema task < aimless.yaml
  run -1 schema robot < <(jq -c '.body[0] = "XYZ"' robot)
  run -1 schema robot < <(jq -c 'del(.id)' robot)
  run -1 schema task < <(sed 's/^steps:/stesp:/' "$EVO_SOURCE/tasks/Walker-v0.yaml")
}

@test "a policy as JSON acts as the tools do, in a few lines of Python; so does its ONNX graph" {
  local kind python
  python=$("$EVO_SOURCE/tests/cli/onnxruntime.sh" "$EVO_BUILD") || python=/usr/bin/python3
  for kind in net squash; do
    evo-eval "$made/$kind.json" --rollout $kind.h5 > /dev/null
    evo-convert "$made/$kind"/*.policy.h5 -o $kind.json
    /usr/bin/python3 "$EVO_SOURCE/tests/cli/policy_json.py" $kind.json $kind.h5
    evo-convert "$made/$kind"/*.policy.h5 -o $kind.onnx
    "$python" "$EVO_SOURCE/tests/cli/policy_onnx.py" $kind.onnx $kind.h5
  done
  fails_with 65 "open loop" -- evo-convert "$made"/sine/*.policy.h5 --to onnx -o x.onnx
  fails_with 65 "depends on the time" -- evo-convert "$made"/timed/*.policy.h5 --to onnx -o x.onnx
  [ ! -e x.onnx ]
}

@test "a world of the design tool becomes a task that runs" {
  evo-convert --task Carrier-v1 --to evogym -o steps.json
  evo-convert steps.json --to task -o steps.yaml
  evo-inspect task steps.yaml | grep -q steps
  evo-eval --task steps.yaml --actions random --max-steps 3 "$made/small.txt" | jq -e '.lengths == [3]'
  evo-convert "$made/small.txt" --to evogym -o 'my robot.json'
  evo-convert 'my robot.json' --to task -o alone.yaml
  evo-eval --task alone.yaml --actions random --max-steps 3 "$made/small.txt" | jq -e '.task == "my-robot"'
}
