# Shared by the command-line tests. CMake sets EVO_BIN (the tools), EVO_BUILD and
# EVO_SOURCE (the checkout) and runs each file in a folder of its own.
bats_require_minimum_version 1.5.0
export PATH="$EVO_BIN:$PATH"
unset MAKELEVEL MAKEFLAGS EVO_DATA EVO_TASKS
data="$EVO_SOURCE/tests/data"

setup() { cd "$BATS_TEST_TMPDIR" || return; }

# A random part of a second, before something is killed. Where a test fails its seed is
# among what it printed; EVO_TEST_SEED=SEED repeats the pauses.
EVO_TEST_SEED=${EVO_TEST_SEED:-$((RANDOM * 32768 + RANDOM))}
RANDOM=$EVO_TEST_SEED
random_pause() {
  local pause=0.$((RANDOM % 9 + 1))
  echo "EVO_TEST_SEED=$EVO_TEST_SEED: a pause of $pause s"
  sleep "$pause"
}

# The command ends with this status, says nothing on standard output, and says
# exactly one line on standard error, which contains every text given.
fails_with() {
  local status_wanted=$1; shift
  local texts=()
  while [ "$1" != -- ]; do texts+=("$1"); shift; done
  shift
  run --separate-stderr "$@"
  if [ "$status" -ne "$status_wanted" ]; then
    echo "status $status, not $status_wanted; $stderr" >&2; return 1
  fi
  [ -z "$output" ] || { echo "standard output: $output" >&2; return 1; }
  [ "$(wc -l <<<"$stderr")" -eq 1 ] || { echo "not one line: $stderr" >&2; return 1; }
  local text
  for text in "${texts[@]}"; do
    [[ $stderr == *"$text"* ]] || { echo "no '$text' in: $stderr" >&2; return 1; }
  done
}

# No line of the file is of the pattern.
lacks() { if grep -E -- "$1" "$2"; then echo "unwanted: $1" >&2; return 1; fi; }

# For tests that look at what a terminal gets.
needs_terminal() {
  script -qec true /dev/null > /dev/null 2>&1 || skip "no pseudo-terminals here (is /dev/pts mounted?)"
}

# Standard input equals the golden file (UPDATE_GOLDEN=1 writes it anew).
golden() {
  local file="$EVO_SOURCE/tests/cli/golden/$1"
  if [ -n "${UPDATE_GOLDEN:-}" ]; then mkdir -p "$(dirname "$file")"; cat > "$file"; else diff -u "$file" -; fi
}

# Trainings of a moment: --train tiny.yaml --steps 2.
tiny_profile() {
  printf 'base: paper\nenvironments: 1\nrollout: 2\nminibatches: 1\nhidden: [4]\nfinal_episodes: 0\n'
}
