# What the documentation shows, run.
load helpers

@test "every command in README and docs runs, and prints what the text says" {
  for file in README.md docs/recipes.md docs/benchmark.md docs/evo-env.md docs/own-fitness.md \
      docs/run-folder.md docs/make-a-task.md docs/pictures.md docs/modular.md; do
    python3 "$EVO_SOURCE/tests/cli/run_blocks.py" "$EVO_SOURCE/$file"
  done
}

@test "every command in docs/cluster.md runs, with stand-ins for the cluster" {
  mkdir stand-ins
  # Runs what it wraps, as often as the array says; srun's options go, as --sshlogin's machines do.
  cat > stand-ins/sbatch <<'END'
#!/bin/bash
array=1-1
for word; do [[ $word != --array=* ]] || array=${word#--array=}; done
for ((SLURM_ARRAY_TASK_ID = ${array%-*}; SLURM_ARRAY_TASK_ID <= ${array#*-}; SLURM_ARRAY_TASK_ID++)); do
  export SLURM_ARRAY_TASK_ID
  bash -euo pipefail -c "${!#}"
done
END
  printf '#!/bin/bash\nwhile [[ $1 == -* ]]; do shift; done\nexec "$@"\n' > stand-ins/srun
  printf '#!/bin/bash\nexec /usr/bin/parallel --sshlogin 2/: "${@:3}"\n' > stand-ins/parallel
  chmod +x stand-ins/*
  command -v parallel > /dev/null || skip "no GNU parallel (apt install parallel)"
  EVO_BIN="$PWD/stand-ins:$EVO_BIN" python3 "$EVO_SOURCE/tests/cli/run_blocks.py" "$EVO_SOURCE/docs/cluster.md"
}

@test "the tour of README prints what it says, to the last digit" {
  [ -n "${EVO_SLOW:-}" ] || skip "with EVO_SLOW: it trains for half a minute"
  python3 "$EVO_SOURCE/tests/cli/run_blocks.py" --in-full "$EVO_SOURCE/README.md"
}

@test "what a text says wrongly is found, up to a command that was made smaller" {
  blocks() { cat > text.md; run python3 "$EVO_SOURCE/tests/cli/run_blocks.py" text.md; echo "$output"; }
  text='    $ echo here
    HERE

    $ echo --steps 512000
    more

    $ echo there
    THERE
'
  blocks <<< "${text/ HERE/ here}"
  [ "$status" -eq 0 ]
  [[ $output == *"3 commands, 1 outputs compared"* ]]
  blocks <<< "$text"
  [ "$status" -eq 1 ]
  [[ $output == *"printed"*"here"*"but the text says"*"HERE"* ]]
}
