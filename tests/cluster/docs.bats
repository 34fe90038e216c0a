# docs/cluster.md from the top: its commands, smaller, in a private Slurm and over an ssh
# that is a script.
load helpers

teardown() {
  if [ -e "$BATS_TEST_TMPDIR/slurm" ]; then "$EVO_SOURCE/scripts/slurm/one-node" --stop "$BATS_TEST_TMPDIR/slurm"; fi
}

@test "every command of docs/cluster.md runs" {
  if ! command -v sbatch > /dev/null || ! PATH=$PATH:/usr/sbin command -v slurmctld munged > /dev/null; then
    skip "Slurm is not here (apt-get install slurm-wlm munge)"
  fi
  command -v parallel > /dev/null || skip "GNU parallel is not here"
  cd "$BATS_TEST_TMPDIR"
  fake_ssh
  eval "$(CPUS=2 MEMORY=4000 "$EVO_SOURCE/scripts/slurm/one-node" slurm 2)"
  python3 "$EVO_SOURCE/tests/cli/run_blocks.py" "$EVO_SOURCE/docs/cluster.md" > said
  grep -q "cluster.md: 5 commands" said
}
