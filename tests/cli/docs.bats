# What the documentation shows, run.
load helpers

@test "every command in README and docs runs, and prints what the text says" {
  for file in README.md docs/recipes.md docs/benchmark.md docs/evo-env.md docs/own-fitness.md \
      docs/run-folder.md docs/make-a-task.md docs/pictures.md; do
    python3 "$EVO_SOURCE/tests/cli/run_blocks.py" "$EVO_SOURCE/$file"
  done
}

@test "the examples run" {
  cp -r "$EVO_SOURCE/examples" .
  make -s -f examples/experiments.mk POP=4 EVALS=9 -j2 > said
  [ "$(grep -c 'actuators' said)" -eq 3 ]
  # Both sides of the symmetric ones are the same.
  jq -e 'select(.parents) | all(.body[]; . == (explode | reverse | implode))' \
    runs/examples/symmetric/history.jsonl > same
  ! grep -v true same
}
