# evo-env: what a client sees, and that no client can hurt it.
load helpers

setup() {
  cd "$BATS_TEST_TMPDIR" || return
  printf 'RHHHR\nVSSSV\nVHRHV\nV...V\nV...V\n' > walker.txt
  printf 'HV\nVH\n' > small.txt
}

env_of() { timeout 60 evo-env -j 1 "$@"; }

@test "says what it is, resets, steps, and ends with its input" {
  printf '%s\n' '{"reset":{"seed":1}}' "{\"step\":[$(seq -s, 13 | sed 's/[0-9]*/1.1/g; s/^/[/; s/$/]/')]}" > script
  env_of --task Walker-v0 walker.txt < script > answers
  [ "$(wc -l < answers)" -eq 3 ]
  sed -n 1p answers | jq -e '.format == "evo/env" and .version == 1 and .task == "Walker-v0" and
    .action_low == 0.6 and .action_high == 1.6 and .robots[0].action_length == 13'
  sed -n 2p answers | jq -e '.environments == [0] and .rewards == [0] and .status == ["ok"] and
    (.observations[0] | length) == 66'
  sed -n 3p answers | jq -e '.steps == [1] and .rewards[0] != 0 and (.terminated[0] | not)'
}

@test "an episode is evo-eval's, jitter, draws and all" {
  for task in Walker-v0 Catcher-v0 BidirectionalWalker-v0; do
    for jitter in 0 0.001; do
      { echo "{\"reset\":{\"seed\":7,\"episode\":2,\"jitter\":$jitter}}"
        yes "{\"step\":[[$(printf '1.4,0.7,%.0s' {1..6})1.4]]}" | head -n 40; } |
        env_of --task $task walker.txt | jq -s '[.[2:][].rewards[0]] | add' > steps
      yes "$(printf '1.4,0.7,%.0s' {1..6})1.4" | head -n 40 > actions.csv
      evo-eval --task $task --actions actions.csv --episodes 3 --seed 7 --jitter $jitter walker.txt |
        jq '.returns[2]' > eval
      cmp steps eval
    done
  done
}

@test "several robots and environments, some of them at a time, as each alone" {
  row13="[$(printf '1.3,%.0s' {1..12})1.3]"
  row4='[1.3,0.8,1.3,0.8]'
  printf '%s\n' '{"reset":{"seed":3}}' "{\"step\":[$row13,$row13,$row4,$row4]}" \
    "{\"environments\":[2,1],\"step\":[$row4,$row13]}" > script
  env_of --task Catcher-v0 --envs 2 walker.txt small.txt < script | tail -n 1 > both
  jq -e '.environments == [2,1] and .steps == [2,2] and (.observations[0] | length) < (.observations[1] | length)' both
  printf '%s\n' '{"reset":{"seed":3}}' "{\"step\":[$row4]}" "{\"step\":[$row4]}" |
    env_of --task Catcher-v0 small.txt | tail -n 1 | jq -c '.observations[0]' > alone
  jq -c '.observations[0]' both | cmp - alone
  printf '%s\n' '{"reset":{"seed":3,"episode":1}}' "{\"step\":[$row13]}" "{\"step\":[$row13]}" |
    env_of --task Catcher-v0 walker.txt | tail -n 1 | jq -c '.observations[0]' > alone
  jq -c '.observations[1]' both | cmp - alone
}

@test "a request that cannot be fulfilled is answered and changes nothing" {
  row4='[1.3,0.8,1.3,0.8]'
  cat > bad <<END
junk
{
[]
{}
{"reset":{},"step":[]}
{"reset":{"sed":1}}
{"reset":{"seed":-1}}
{"reset":{"seed":1.5}}
{"reset":{"seed":99999999999999999999999}}
{"reset":{"jitter":0.7}}
{"reset":{"jitter":-1}}
{"reset":{"jitter":"much"}}
{"reset":{"environments":[]}}
{"reset":{"environments":[2]}}
{"reset":{"environments":[-1]}}
{"reset":{"environments":[0,0]}}
{"reset":{"environments":0}}
{"reset":{"episode":-3}}
{"reset":{"draws":{}}}
{"reset":{"draws":{"ox":0}}}
{"reset":{"draws":{"ox":0,"oy":1000000000}}}
{"reset":{"draws":{"ox":-2147483649,"oy":0}}}
{"reset":{"draws":{"ox":0,"oy":4294967296}}}
{"reset":{"draws":{"ox":0,"oy":0.5}}}
{"reset":{"draws":{"ox":0,"oy":0,"oz":0}}}
{"reset":7}
{"reset":{"seed":1,"seed":2}}
{"step":[]}
{"step":[$row4]}
{"step":[$row4,$row4,$row4]}
{"step":[[1],[1]]}
{"step":[$row4,[1,1,1,null]]}
{"step":[$row4,[1,1,1,NaN]]}
{"step":[$row4,[1,1,1,1e999]]}
{"step":[$row4,"1111"]}
{"step":$row4}
{"step":{}}
{"step":[$row4,$row4],"environments":[0]}
{"step":[$row4],"environments":["0"]}
{"picture":{}}
{"reset":{},"picture":{}}
{"positions":{"environments":[5]}}
{"task":{"name":1}}
{"save":{"environments":[7]}}
{"save":[]}
{"restore":{}}
{"restore":{"environments":[0],"states":[]}}
{"restore":{"environments":[0],"states":[1]}}
{"restore":{"environments":[0],"states":["%"]}}
{"restore":{"environments":[0],"states":["AAAA"]}}
$(head -c 300 /dev/zero | tr '\0' '[')
$(printf '\xff\xfe\x01x')
END
  { echo '{"reset":{"seed":3}}'; cat bad; echo "{\"step\":[$row4,$row4]}"; } |
    env_of --task Catcher-v0 --envs 2 small.txt > answers
  [ "$(grep -ac '^{"error":"request' answers)" -eq "$(wc -l < bad)" ]
  printf '%s\n' '{"reset":{"seed":3}}' "{\"step\":[$row4,$row4]}" |
    env_of --task Catcher-v0 --envs 2 small.txt | tail -n 1 | cmp - <(tail -n 1 answers)
  # Before its first reset nothing moves.
  echo "{\"step\":[$row4]}" | env_of --task Walker-v0 small.txt | tail -n 1 | jq -r .error > why
  grep -q "reset" why
}

@test "a last line without an end, one with a zero byte, one that never ends" {
  printf '{"reset":{}}' | env_of --task Walker-v0 small.txt | tail -n 1 | jq -e '.status == ["ok"]'
  printf '{"reset":{}}\0\n{"reset":{}}\n' | env_of --task Walker-v0 small.txt > answers
  sed -n 2p answers | jq -r .error | grep -q 'request 1'
  sed -n 3p answers | jq -e '.status == ["ok"]'
  head -c 70000000 /dev/zero | tr '\0' 'x' > endless
  run -65 --separate-stderr env_of --task Walker-v0 small.txt < endless
  [[ $stderr == *"longer than"* ]]
}

@test "a client that goes away ends the session quietly" {
  yes '{"reset":{}}' | { env_of --task Walker-v0 small.txt 2> said || echo $? > status; } | head -n 3 > /dev/null
  [ "$(cat status)" -eq 141 ]
  [ ! -s said ]
  env_of --task Walker-v0 small.txt < /dev/null > hello
  [ "$(wc -l < hello)" -eq 1 ]
}

@test "a state is saved and restored, as text" {
  local row='[1.5,0.7,1.2,1.6]'
  printf '%s\n' '{"reset":{"seed":3}}' "{\"step\":[$row]}" '{"save":{}}' "{\"step\":[$row]}" |
    env_of --task Catcher-v0 small.txt > first
  printf '%s\n' "$(sed -n 4p first | jq -c '{restore: .}')" "{\"step\":[$row]}" |
    env_of --task Catcher-v0 small.txt > second
  cmp <(sed -n 3p first) <(sed -n 2p second)
  cmp <(sed -n 5p first) <(sed -n 3p second)
}

@test "wrong usage" {
  fails_with 2 "standard input carries the requests" -- evo-env --task Walker-v0
  fails_with 2 "standard input carries the requests" -- evo-env --task Walker-v0 -
  fails_with 2 "0 environments" -- evo-env --task Walker-v0 --envs 0 small.txt
  fails_with 2 "environments" -- evo-env --task Walker-v0 --envs 70000 small.txt
  fails_with 66 "none.txt" -- evo-env --task Walker-v0 none.txt
}
