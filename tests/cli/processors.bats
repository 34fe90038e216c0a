# One rollout, byte for byte, whatever the processor says it has and however
# many of it there are. (tests/unit/task/pinned_test.cpp forces instruction sets.)
load helpers

rollout() {  # NAME [OPTION]...: random episodes of a world with much contact
  local name=$1; shift
  evo-eval --task Climber-v1 --actions random --seed 7 --episodes 5 --max-steps 40 \
    "$@" --rollout "$name.h5" "$data/reference/Climber-v1_A.h5" > "$name.jsonl"
}

same() { cmp native.h5 "$1.h5" && cmp native.jsonl "$1.jsonl"; }

@test "the C library's choice of instructions does not show" {
  rollout native
  # What older and newer releases of the library call the same features.
  GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2_Usable,-AVX2,-FMA_Usable,-FMA rollout masked
  same masked
}

@test "the number of threads does not show" {
  local jobs
  rollout native -j 1
  for jobs in 2 3; do rollout "jobs$jobs" -j "$jobs"; same "jobs$jobs"; done
}

@test "evo-bench measures every instruction set, width and body" {
  local isas
  evo-bench --sizes 5,6 --envs 1,4 --isa all --seconds 0.01 --json > bench.jsonl
  isas=$(jq -r .isa bench.jsonl | sort -u | wc -l)
  [ "$isas" -ge 1 ]
  [ "$(jq -c '[.isa, .shape, .seed, .width]' bench.jsonl | sort -u | wc -l)" -eq $((4 * isas)) ]
  jq -es 'all(.steps_per_second_min > 0 and .steps_per_second >= .steps_per_second_min and
    .steps_per_second_max >= .steps_per_second and .voxels > 0)' bench.jsonl
  evo-bench --task all --envs 1 --seconds 0.001 > table
  [ "$(tail -n +2 table | wc -l)" -eq 32 ]
  run ! grep '.\{81\}' table
  fails_with 2 z80 -- evo-bench --isa z80
}
