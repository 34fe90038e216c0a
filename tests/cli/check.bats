# evo-inspect --check, and what evo-inspect knows.
load helpers

setup_file() {
  cd "$BATS_FILE_TMPDIR" || return
  export made="$BATS_FILE_TMPDIR"
  printf 'HV\nHV\n' > small.txt
  evo-train small.txt --task Walker-v0 --steps 640 --out-dir . -o trained.json \
    --train 'hidden=[8]' --train environments=2 --train rollout=32
  evo-eval trained.json --max-steps 5 --rollout walk.h5 > /dev/null
}

@test "whole files are ok, and earn their fitness again" {
  cp "$made"/* .
  evo-inspect --check trained.json ./*.policy.h5 walk.h5 small.txt "$EVO_SOURCE/tasks/Walker-v0.yaml" > said
  [ "$(grep -c ': ok' said)" -eq 5 ]
  evo-inspect --check --replay trained.json
  evo-inspect --check . | grep -q 'trained.json: ok'
  fails_with 2 "--check" -- evo-inspect --replay trained.json
}

@test "a policy or a rollout stands for its robot, by name and on standard input" {
  cp "$made"/* .
  local policy; policy=$(ls ./*.policy.h5)
  for file in "$policy" walk.h5; do
    evo-convert "$file" | jq -r .id | cmp - <(jq -r .id trained.json)
    evo-convert < "$file" | jq -r .id | cmp - <(jq -r .id trained.json)
    evo-mutate -n 1 < "$file" | cmp - <(evo-mutate -n 1 small.txt)
  done
  # A policy named is its robot's policy; these are the episodes that its training judged it by.
  local episodes=(--episodes 8 --jitter 1e-3)
  evo-eval "$policy" "${episodes[@]}" | jq .fitness | cmp - <(jq .fitness trained.json)
  mkdir elsewhere
  evo-convert "$policy" -o elsewhere/robot.json --to jsonl
  [ "$(jq -r .policy elsewhere/robot.json)" = "../$(basename "$policy")" ]
  evo-eval elsewhere/robot.json "${episodes[@]}" | jq .fitness | cmp - <(jq .fitness trained.json)
  fails_with 2 "it has no policy" -- evo-eval small.txt
}

@test "what was changed is found: a value in a policy, a fitness, another's policy" {
  cp "$made"/* .
  jq -c '.fitness += 1' trained.json > inflated.json
  run -65 --separate-stderr evo-inspect --check inflated.json
  [[ $output == *"fitness"* ]]
  [[ $stderr == *"1 of 1"* ]]
  jq -c '.body = ["HH"] | del(.id)' trained.json > other.json
  run -65 evo-inspect --check other.json
  [[ $output == *"is the policy of robot"* ]]
  local policy; policy=$(ls ./*.policy.h5)
  cp "$policy" whole
  printf '\377' | dd of="$policy" bs=1 seek=3000 conv=notrunc status=none
  fails_with 65 "checksum" -- evo-eval trained.json
  run -65 evo-inspect --check "$policy"
  [[ $output == *"checksum"* ]]
  # Nothing to compare with, but the fitness.
  mv whole "$policy"
  /usr/bin/python3 -c "
import h5py, sys
with h5py.File(sys.argv[1], 'r+') as f: f['actor/layer_0/bias'][0] += 0.5" "$policy"
  evo-inspect --check "$policy"
  run -65 evo-inspect --check --replay "$policy"
  [[ $output == *"not its fitness"* ]]
}

@test "a changed checkpoint is refused; --force replaces a damaged policy" {
  cp "$made"/* .
  local policy; policy=$(basename ./*.policy.h5)
  head -c 2000 "$policy" > half; mv half "$policy"
  fails_with 65 "$policy" -- evo-train small.txt --task Walker-v0 --steps 640 --out-dir . --train 'hidden=[8]' --train environments=2 --train rollout=32
  evo-train small.txt --task Walker-v0 --steps 640 --out-dir . --force --train 'hidden=[8]' --train environments=2 --train rollout=32 | jq -e '.fitness'
  cmp "$policy" "$made/$policy"
}

@test "a checkpoint that an older version left is refused by name, with what to do" {
  printf 'HV\nHV\n' > small.txt
  local train=(evo-train small.txt --task Walker-v0 --train sequence --out-dir . --keep-checkpoint -o trained.json)
  "${train[@]}" --steps 8000
  local checkpoint; checkpoint=$(ls ./*.checkpoint.h5)
  /usr/bin/python3 -c "
import h5py, sys
with h5py.File(sys.argv[1], 'r+') as f:
    index = f['index']
    others = [name for name in index if b'soonest' not in name]
    assert len(others) == len(index) - 1
    kind = index.dtype
    del f['index']
    f.create_dataset('index', data=others, dtype=kind)" "$checkpoint"
  fails_with 65 "remove it to start afresh" -- "${train[@]}" --steps 16000 --resume
}

@test "evo-inspect knows every format, and says what is not a robot" {
  cp "$made"/* .
  evo-convert small.txt -o s.npz
  evo-inspect s.npz | grep -q 2x2
  evo-convert small.txt --to evogym -o w.json
  evo-inspect w.json | grep -q 'design tool, 1 objects'
  evo-neat -n 4 --state-out species.json -o /dev/null
  evo-inspect species.json | grep -q 'state of NEAT'
  evo-inspect "$EVO_SOURCE/tasks/neat.yaml" "$EVO_SOURCE/tasks/Walker-v0.yaml" "$EVO_SOURCE/tasks/physics/paper.yaml" "$EVO_SOURCE/tasks/training/default.yaml"
  evo-inspect - < "$(ls ./*.policy.h5)" | grep -q 2x2
  evo-inspect - < walk.h5 | grep -q 2x2
  mkdir elsewhere
  (cd elsewhere && evo-inspect ../trained.json | grep -q '^policy  *\.\./.*policy.h5')
  evo-evolve ga -q --plan --run run --pop 3 --evals 4 --shape 3x3 --seed 1
  evo-inspect run/run.yaml | grep -qx 'task  *Walker-v0'
  evo-inspect --check run/run.yaml
  evo-mutate -n 1 < walk.h5 | jq -e '.parents | length == 1'
  printf 'RS\n' > idle.txt
  fails_with 65 "actuator" -- evo-convert idle.txt
  fails_with 65 "actuator" -- evo-render idle.txt -o x.png
  fails_with 65 "actuator" -- evo-suggest idle.txt
  fails_with 65 "actuator" -- evo-sample -n 1 --avoid idle.txt
  run -65 --separate-stderr evo-inspect idle.txt
  [[ $stderr == *"actuator"* ]]
  [[ $output == *"R S"* ]]
}
