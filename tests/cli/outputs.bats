# Outputs: none destroys another, none is lost, each comes back as it was written.
load helpers

setup_file() {
  cd "$BATS_FILE_TMPDIR" || return
  export made="$BATS_FILE_TMPDIR"
  printf 'HV\nHV\n' > small.txt
  evo-eval small.txt --task Walker-v0 --actions random --max-steps 3 --rollout walk.h5 > scored.jsonl
}

@test "one name for two outputs is refused" {
  cp "$made"/* .
  fails_with 2 "--output and --state-out" "'x'" -- evo-neat -n 4 -o x --state-out x
  fails_with 2 "--output and --state-out" -- evo-neat -n 4 -o x --state-out ./x
  [ ! -e x ]
  fails_with 2 "--output and --rollout" -- evo-eval small.txt --task Walker-v0 --actions random -o x --rollout x
  local id; id=$(evo-convert small.txt | jq -r .id)
  mkdir p
  fails_with 2 "--output" "policy of robot $id" -- evo-train small.txt --task Walker-v0 --steps 2 --train algorithm=gait --out-dir p -o "p/$id.policy.h5"
  evo-neat -n 4 -o /dev/null --state-out /dev/null
}

@test "a rollout does not replace what it is made from" {
  cp "$made"/* .
  cp walk.h5 before.h5
  fails_with 2 "--rollout would replace the robots, 'walk.h5'" -- evo-eval walk.h5 --task Walker-v0 --actions random --rollout walk.h5
  fails_with 2 "the actions, './walk.h5'" -- evo-eval small.txt --task Walker-v0 --actions ./walk.h5 --rollout walk.h5
  fails_with 2 "the draws" -- evo-eval small.txt --task Walker-v0 --actions random --draws walk.h5 -o walk.h5
  mkdir dir
  cp walk.h5 "dir/$(evo-convert small.txt | jq -r .id).h5"
  fails_with 2 "--rollout" "the robots" -- evo-eval dir/*.h5 --task Walker-v0 --actions random --rollout dir/
  cmp walk.h5 before.h5
  # Robots may go where they came from.
  evo-eval scored.jsonl --task Walker-v0 --actions random --max-steps 1 -o scored.jsonl
  jq -e '.lengths == [1]' scored.jsonl
}

@test "-o of an input destroys nothing; a pipe whose reader has gone ends quietly" {
  evo-sample -n 3 --seed 1 | jq -c '.fitness = 1' > robots.jsonl
  cp robots.jsonl before
  ln -s robots.jsonl link
  local command
  for command in "evo-select --keep 1" "evo-mutate -n 1" evo-archive "evo-suggest -n 1" "evo-convert --unique" evo-render; do
    fails_with 2 "--output would replace an input, 'robots.jsonl'" -- $command robots.jsonl -o ./link
  done
  cmp robots.jsonl before
  evo-convert --to ids robots.jsonl > ids
  evo-convert --to ids ids robots.jsonl -o ids
  [ "$(wc -l < ids)" -eq 3 ]
  # Whatever the caller ignores.
  trap '' PIPE
  for command in "evo-sample -n 100000" "evo-inspect tasks" "evo-convert --to text robots.jsonl"; do
    run bash -c "$command 2> said | true; sleep 0.1; echo \${PIPESTATUS[0]}; cat said"
    [[ $output == 141 || $output == 0 ]]
  done
  run bash -c 'evo-sample -n 100000 2>&1 > >(head -n 1 > /dev/null); echo $?'
  [ "$output" = 141 ]
}

@test "inputs that would not be read are refused" {
  cp "$made"/* .
  fails_with 2 "small.txt" -- evo-convert small.txt --task Walker-v0
  fails_with 2 "one robot" "2 were read" -- evo-convert small.txt walk.h5 --to npz -o x.npz
}

@test "two trainings with different settings in one folder: the second is refused, at the end as well" {
  cp "$made/small.txt" .
  evo-train small.txt --task Walker-v0 --train gait --steps 60000 --seed 1 --out-dir p -o one.json &
  local first=$!
  run --separate-stderr evo-train small.txt --task Walker-v0 --train gait --steps 60000 --seed 2 --out-dir p -o two.json
  local second=$status
  local status=0
  wait $first || status=$?
  echo "$status $second $stderr"
  [ $(( status + second )) -eq 73 ]
  if [ "$status" -eq 0 ]; then seed=1 kept=one.json; else seed=2 kept=two.json; fi
  evo-train small.txt --task Walker-v0 --train gait --steps 60000 --seed $seed --out-dir p | jq .fitness | cmp - <(jq .fitness $kept)
}

@test "folders that cannot be made, disks that are full: 73 and 74" {
  cp "$made"/small.txt .
  echo x > file
  fails_with 73 "file/sub" -- evo-eval small.txt --task Walker-v0 --actions random --rollout file/sub/
  fails_with 73 "file/sub" -- evo-train small.txt --task Walker-v0 --out-dir file/sub
  fails_with 74 "too large" -- bash -c 'ulimit -f 1; evo-eval small.txt --task Walker-v0 --actions random --max-steps 200 --rollout big.h5'
  fails_with 74 "too large" -- bash -c "ulimit -f 1; evo-render $made/walk.h5 -o walk.mp4"
  [ ! -e big.h5 ]
  [ ! -e walk.mp4 ]
  [ -z "$(find . -name '.*.tmp')" ]
}

@test "HDF5: links and values in other files are not followed" {
  cp "$made/walk.h5" .
  /usr/bin/python3 - <<'P'
import h5py
with h5py.File("walk.h5", "r+") as f:
    rewards = f["episode_0/rewards"][()]
    with h5py.File("other.h5", "w") as g:
        g["rewards"] = rewards
        g["robot"] = f.attrs["robot"]
    del f["episode_0/rewards"]
    f["episode_0/rewards"] = h5py.ExternalLink("other.h5", "/rewards")
P
  fails_with 65 "rewards" -- evo-inspect walk.h5
  cp "$made/walk.h5" raw.h5
  /usr/bin/python3 - <<'P'
import h5py
with h5py.File("raw.h5", "r+") as f:
    del f["episode_0/rewards"]
    f["episode_0"].create_dataset("rewards", (3,), "f8", external=[("secret", 0, h5py.h5f.UNLIMITED)])
P
  head -c 100 /dev/zero > secret
  fails_with 65 "rewards" "another file" -- evo-inspect raw.h5
}
