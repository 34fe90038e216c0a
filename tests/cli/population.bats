# evo-sample, evo-mutate, evo-select: populations through pipes.
load helpers

@test "sampling: the same seed gives the same bytes, a longer list begins like a shorter one" {
  for encoding in voxel cppn; do
    evo-sample -n 30 --encoding $encoding --seed 5 > a
    evo-sample -n 30 --encoding $encoding --seed 5 -o b
    cmp a b
    for count in 0 1 10; do
      evo-sample -n $count --encoding $encoding --seed 5 | cmp - <(head -n $count a)
    done
    evo-sample -n 30 --encoding $encoding --seed 6 > c
    run ! cmp -s a c
    [ "$(jq -r .id a | sort -u | wc -l)" -eq 30 ]
  done
}

@test "sampling: shape, weights, avoidance" {
  evo-sample -n 5 --shape 3x7 --weights 0,0,1,1,1 > a
  [ "$(jq -r '.body | length' a | sort -u)" = 3 ]
  [ "$(jq -r '.body[] | length' a | sort -u)" = 7 ]
  run ! grep -q '[.R]' <(jq -r '.body[]' a)
  evo-sample -n 5 --seed 3 > a
  evo-sample -n 5 --seed 3 --avoid a > b
  [ "$(cat a b | jq -r .id | sort -u | wc -l)" -eq 10 ]
}

@test "sampling: what cannot be is refused" {
  fails_with 2 "--shape: '5y5'" "ROWSxCOLS" -- evo-sample --shape 5y5
  fails_with 2 "actuator" -- evo-sample --weights 1,1,1,0,0
  fails_with 2 "expected 5 numbers" -- evo-sample --weights 1,1
  fails_with 1 "no new 1x1 body" -- evo-sample --shape 1x1 -n 3 -o few
  fails_with 73 "missing-folder" -- evo-sample -o missing-folder/x.jsonl
  [ ! -e missing-folder ]
}

@test "mutation: children are valid, new, and know their parents" {
  evo-sample -n 10 --seed 3 > parents
  evo-mutate -n 50 --seed 4 parents > children
  evo-sample -n 10 --seed 3 | evo-mutate -n 50 --seed 4 | cmp - children
  [ "$(cat parents children | jq -r .id | sort -u | wc -l)" -eq 60 ]
  jq -r '.parents[]' children | sort -u > used
  [ -z "$(comm -23 used <(jq -r .id parents | sort))" ]
  evo-mutate -n 5 --crossover 1 --seed 1 parents | jq -e '.parents | length == 2'
}

@test "mutation: nothing left to find ends in status 1" {
  echo H | evo-mutate -n 1 > child
  printf 'H\n' > h; printf 'V\n' > v
  fails_with 1 "no new body for child 0" -- evo-mutate -n 1 --avoid v h
}

@test "selection: best first, failures last, ties in input order" {
  cat > scored <<'J'
{"body":["H"],"fitness":1.5}
{"body":["V"],"fitness":null,"failure":{"why":"diverged"}}
{"body":["HH"],"fitness":3}
{"body":["HV"],"fitness":1.5,"note":"kept"}
J
  evo-select scored | jq -r '.body[0]' | tr '\n' ' ' | grep -qx 'HH H HV V '
  evo-select --keep 1 < scored | jq -e '.fitness == 3'
  evo-select --keep 3 scored | tail -1 | jq -e '.note == "kept"'
  evo-select --unscored scored | jq -es 'length == 3 and all(has("fitness") | not)'
  printf '%s\n' '{"body":["H"],"final":{"mean":1}}' '{"body":["V"],"final":{"mean":2}}' | evo-select --by final.mean --keep 1 | jq -e '.final.mean == 2'
  evo-select --by=-actuators scored | tail -n 1 | jq -r '.body[0]' | grep -x 'H[HV]'
}

@test "a robot that cannot be is refused with the cell" {
  printf 'HV.\n...\n..S\n' > apart
  printf 'SS\nRS\n' > idle
  printf 'HV\nHVS\n' > ragged
  printf 'HV\nHX\n' > letter
  fails_with 65 apart "row 3, column 3" -- evo-mutate apart
  fails_with 65 idle "actuator" -- evo-mutate idle
  fails_with 65 ragged "row 2" -- evo-mutate ragged
  fails_with 65 letter "'X'" "row 2, column 2" -- evo-mutate letter
  fails_with 65 "row 2, column 2" -- evo-select <(echo '{"body":["HV","HX"]}')
  fails_with 66 "no-such-file" -- evo-select no-such-file
}

@test "archive: the fittest of every kind, as robots and as a table" {
  printf '%s\n' '{"body":["HHH"],"fitness":1}' '{"body":["HHH","..R"],"fitness":3,"final":{"mean":9}}' \
    '{"body":["HRR"],"fitness":2}' '{"body":["SSV"],"fitness":4,"final":{"mean":1}}' '{"body":["VVV"],"fitness":null}' > scored
  evo-archive -q --features actuated:3,height:2 scored > elites
  jq -c '[.cell, .fitness]' elites | diff - <(printf '[[1,1],4]\n[[2,1],3]\n')
  evo-archive -q --features actuated:3,height:2 --table < scored | cut -f 1-3 |
    diff - <(printf 'actuated\theight\tfitness\n0.3333333333333333\t0.5\t4\n0.6666666666666666\t0.5\t3\n')
  evo-archive -q --features final.mean:2:0:10 scored | jq -c .cell | diff - <(printf '[0]\n[1]\n')
  [ "$(evo-archive -q < /dev/null)" = "" ]
  evo-archive scored 2>&1 > /dev/null | grep -q '3 of 25 cells'
  printf '%s\n' '{"body":["H"],"fitness":1,"behaviour":{"distance":-3,"aloft":0.9}}' \
    '{"body":["V"],"fitness":2,"behaviour":{"distance":7,"aloft":0.1}}' '{"body":["HV"],"fitness":null}' > behaved
  evo-archive -q --features behaviour.distance:5:0:10,behaviour.aloft:2:0:1 behaved | jq -c .cell | diff - <(printf '[0,1]\n[3,0]\n')
  fails_with 65 "has no 'behaviour.aloft'" -- evo-archive --features behaviour.aloft:2:0:1 behaved scored
  fails_with 2 "a behaviour needs its range" -- evo-archive --features behaviour.aloft:2 behaved
  fails_with 2 "'behaviour.hight' is no behaviour" "behaviour.rise" -- evo-archive --features behaviour.hight:2:0:1 behaved
  fails_with 2 "'hight' is no feature of bodies" "height" -- evo-archive --features hight:5 scored
  fails_with 2 "NAME:BINS" -- evo-archive --features height scored
  fails_with 2 "nothing lies between" -- evo-archive --features x:5:1:1 scored
  fails_with 65 "no robot has a number 'final.median'" -- evo-archive --features final.median:2:0:1 scored
}

@test "neat: neat-python's own configuration file, and its population size" {
  printf '[NEAT]\npop_size = 4\nno_fitness_termination = True\n[DefaultGenome]\nweight_init_stdev = 2.0\n' > neat.cfg
  printf 'format: evo/neat\nversion: 1\npop_size: 4\nweight_init_stdev: 2\n' > neat.yaml
  evo-neat --neat neat.cfg --seed 3 --state-out a.json > a.jsonl
  evo-neat --neat neat.yaml --seed 3 --state-out b.json | cmp - a.jsonl
  cmp a.json b.json
  [ "$(wc -l < a.jsonl)" -eq 4 ]
  [ "$(evo-neat --neat neat.cfg -n 6 --state-out c.json | wc -l)" -eq 6 ]
  [ "$(evo-neat --state-out d.json | wc -l)" -eq 25 ]
  evo-inspect neat.cfg | grep -q "settings of NEAT, 4 genomes"
  sed -i 's/True/False/' neat.cfg
  fails_with 65 "neat.cfg" "no_fitness_termination" -- evo-neat --neat neat.cfg --state-out e.json
  sed -i 's/False/Maybe/' neat.cfg
  fails_with 65 "neat.cfg:3:" "'Maybe'" -- evo-neat --neat neat.cfg --state-out e.json
}
