# Values of options.
load helpers

@test "an empty value, as of an unset variable, is refused" {
  echo '{"body":["HV"],"fitness":1}' > r.json
  fails_with 2 "--keep" "empty" -- evo-select --keep '' r.json
  fails_with 2 "--keep" "empty" -- evo-select --keep= r.json
  fails_with 2 "--count" "empty" -- evo-sample -n ''
  fails_with 2 "--seed" "empty" -- evo-sample --seed ''
  fails_with 2 "--max-steps" "empty" -- evo-eval --task Walker-v0 --actions random --max-steps '' r.json
  fails_with 2 "--output" "empty" -- evo-sample -o ''
  fails_with 2 "--avoid" "empty" -- evo-sample --avoid ''
}

@test "whole numbers: exact, with k and M and as 5e5" {
  evo-sample -n 2 --seed 18446744073709551615 | tail -1 | grep -q '"seed":18446744073709551615,'
  fails_with 2 "--seed: '18446744073709551616' is not a whole number from 0 to 18446744073709551615" -- evo-sample --seed 18446744073709551616
  fails_with 2 "--seed" "'-1'" -- evo-sample --seed -1
  fails_with 2 "--seed" "'1.5'" -- evo-sample --seed 1.5
  evo-sample -n 1 --seed 2k | cmp - <(evo-sample -n 1 --seed 2000)
  evo-sample -n 1 --seed 1M | cmp - <(evo-sample -n 1 --seed 1e6)
  printf 'H\n' > h
  tiny_profile > tiny.yaml
  sed -i 's/rollout: 2/rollout: 500/' tiny.yaml
  evo-train h --task Walker-v0 --train tiny.yaml --steps 1k --out-dir k | jq -e '.steps == 1000'
  evo-train h --task Walker-v0 --train tiny.yaml --steps 1e3 --out-dir k | jq -e '.steps == 1000'
}

@test "a number's bounds are told where they are what is wrong" {
  fails_with 2 "--count: 'five' is not a whole number" -- evo-sample --count five
  run evo-sample --count five
  [[ $output != *2147483648* && $output != *"from"* ]]
  fails_with 2 "--steps: 'five' is not a whole number of at least 1" -- evo-train --task Walker-v0 --steps five /dev/null
  fails_with 2 "--count: '3000000000' is not a whole number up to 2147483647" -- evo-sample --count 3000000000
}

@test "what other programs call a setting is understood well enough to name it" {
  printf 'HV\n' > r.txt
  local train=(evo-train r.txt --task Walker-v0 --steps 2048)
  fails_with 2 "unknown training setting 'gama' (did you mean 'gamma'?)" -- "${train[@]}" --train gama=1
  fails_with 2 "a number from 0 to 1 is expected for 'gamma', found '1.5'" -- "${train[@]}" --train gamma=1.5
  fails_with 2 "found 'PPO' (did you mean 'ppo'?)" -- "${train[@]}" --train algorithm=PPO
  fails_with 65 "no robot has a fitness yet" "evo-eval" -- evo-select r.txt
}

@test "on a terminal, a tool that waits for robots says so" {
  command -v script > /dev/null || skip "script is not installed"
  printf '\4' | script -qec "evo-mutate -n 0" /dev/null > said
  grep -q "reading robots from the terminal; Ctrl-D" said
  run -2 script -qec "evo-inspect" /dev/null < /dev/null
  [[ $output == *"name a file or a run folder"* ]]
}

@test "numbers: finite, and nothing else behind them" {
  printf 'H\n' > h
  for value in nan inf 1e999 1,5 0x10 1.0.0 '1 '; do
    fails_with 2 "--rate" -- evo-mutate -n 1 --rate "$value" h
  done
  fails_with 2 "--seconds" -- evo-bench --seconds 1e308
  fails_with 2 "--seconds" -- evo-bench --seconds -1
  fails_with 2 "--size: '64x64x5'" "WIDTHxHEIGHT" -- evo-render --size 64x64x5 h -o x.png
  fails_with 2 "--size" -- evo-render --size 64x h -o x.png
  evo-eval h --task Walker-v0 --actions random --max-steps 2 --rollout r.h5 > /dev/null
  fails_with 2 "--episode: '1.5'" -- evo-render r.h5 --episode 1.5 -o x.gif
  fails_with 2 "--envs" "'0'" "1 to 4096" -- evo-bench --envs 1,0
  # A constant is named in full.
  fails_with 2 "'soft.edge'" "'x'" -- evo-eval --task Walker-v0 --actions random --physics soft.edge=x h
}

@test "a list for a training setting is read as it is written in files" {
  printf 'H\n' > h
  tiny_profile > tiny.yaml
  for hidden in '[8, 8]' '8,8' '[8,8]'; do
    evo-train h --task Walker-v0 --train tiny.yaml --steps 2 --out-dir p --train "hidden=$hidden" > /dev/null
  done
}

@test "what would be ignored is refused, or told" {
  printf 'HV\nS.\n' > r.txt
  fails_with 2 "x.foo" ".foo" "--to" -- evo-convert r.txt -o x.foo
  [ ! -e x.foo ]
  fails_with 2 "--max-steps 1000" "500 steps" -- evo-eval --task Walker-v0 --actions random --max-steps 1000 r.txt
  run -0 --separate-stderr evo-train r.txt --task Walker-v0 --steps 2e3 -j1
  [[ $stderr == *"1024 of 2000 steps are trained"* ]]
}

@test "a planner plans freely, or holds to what a policy does" {
  echo HV > r.txt
  tiny_profile > tiny.yaml
  evo-train r.txt --task Walker-v0 --train tiny.yaml --steps 1k --out-dir k > trained.json
  evo-eval trained.json --planner hold:4,2,2,2 --max-steps 20 | jq -e '.lengths == [20]'
  evo-eval r.txt --task Walker-v0 --planner free:20,10,3,2 --max-steps 20 --seed 1 --rollout r.h5 > planned.json
  evo-eval r.txt --task Walker-v0 --actions r.h5 | jq -e --slurpfile planned planned.json '.fitness == $planned[0].fitness'
  fails_with 2 "--planner: 'fly' is neither free nor hold" -- evo-eval r.txt --task Walker-v0 --planner fly
  fails_with 2 "'free:1,2' is not free:WINDOW,COMMITTED,ROUNDS,LANES" -- evo-eval r.txt --task Walker-v0 --planner free:1,2
  fails_with 2 "--planner" "'0'" -- evo-eval r.txt --task Walker-v0 --planner free:0,2,2,2
  fails_with 2 "it has no policy" -- evo-eval r.txt --task Walker-v0 --planner hold
}

@test "robots in the field's own notation, told by their bytes, in every tool" {
  printf '3 3 3\n4 0 4\n' > r.txt
  printf '[[3,3,3],[4,0,4]]' > r.json
  evo-convert r.txt -o r.npz
  cp r.npz without-ending
  evo-convert r.txt --to evogym -o world.json
  for file in r.txt r.json r.npz without-ending world.json; do
    [ "$(evo-convert "$file" | jq -c '[.id, .body]')" = '["9bdfd2342d8b",["HHH","V.V"]]' ]
    [ "$(evo-eval --task Walker-v0 --actions random --max-steps 3 "$file" | jq -r .id)" = 9bdfd2342d8b ]
    [ "$(evo-mutate -n 1 "$file" | jq -r '.parents[0]')" = 9bdfd2342d8b ]
  done
  [ "$(evo-convert < r.npz | jq -r .id)" = 9bdfd2342d8b ]
}

@test "actions as NumPy writes them; what learners leave behind is told apart" {
  /usr/bin/python3 - <<'END'
import pickle, zipfile
import numpy as np
actions = np.random.default_rng(0).uniform(0.6, 1.6, (20, 5))
np.save("a.npy", actions)
np.save("fortran.npy", np.asfortranarray(actions))
np.savez("a.npz", actions)
np.savez("named.npz", other=np.zeros(3), actions=actions)
np.savetxt("a.txt", actions)
np.savetxt("a.csv", actions, delimiter=",")
np.save("turned.npy", actions.T)
np.save("flat.npy", actions.ravel())
np.save("row.npy", np.array([3, 4, 3]))
np.savez("two.npz", left=actions, right=actions)
actions[3, 2] = np.nan
np.save("nan.npy", actions)
def archive(name, *members):
    with zipfile.ZipFile(name, "w") as file:
        for member in members:
            file.writestr(member, b"x" * 100)
archive("model.zip", "data", "pytorch_variables.pth", "policy.pth", "_stable_baselines3_version")
archive("net.pt", "archive/data.pkl", "archive/version")
pickle.dump({"weights": [1.0]}, open("genome.pkl", "wb"))
END
  printf '3 3 3\n4 0 4\n' > r.txt
  local eval=(evo-eval --task Walker-v0)
  "${eval[@]}" --actions a.csv r.txt > expected
  for file in a.npy fortran.npy a.npz named.npz a.txt; do "${eval[@]}" --actions $file r.txt | cmp - expected; done
  "${eval[@]}" --actions - r.txt < a.npy | cmp - expected
  fails_with 65 "turned.npy: 20 actions per step" "5 actuators" -- "${eval[@]}" --actions turned.npy r.txt
  fails_with 65 "flat.npy: 100 numbers in a row, expected a matrix" -- "${eval[@]}" --actions flat.npy r.txt
  fails_with 65 "row.npy: 3 numbers in a row, expected a matrix" -- evo-convert row.npy
  fails_with 65 "two.npz: 2 arrays, none of which is called actions" -- "${eval[@]}" --actions two.npz r.txt
  fails_with 65 "nan.npy: step 3 holds nan" -- "${eval[@]}" --actions nan.npy r.txt
  local command
  for command in "evo-convert FILE" "evo-inspect FILE" "evo-eval --task Walker-v0 --actions random FILE" \
      "evo-eval --policy FILE r.txt" "evo-eval --task Walker-v0 --actions FILE r.txt" \
      "evo-train --task Walker-v0 --steps 2048 --init FILE r.txt" "evo-mutate -n 1 FILE"; do
    fails_with 65 "model.zip: a model of Stable-Baselines3" write_sb3_policy -- ${command/FILE/model.zip}
    fails_with 65 "net.pt: a file of PyTorch" write_policy -- ${command/FILE/net.pt}
    fails_with 65 "genome.pkl: a Python pickle" write_policy -- ${command/FILE/genome.pkl}
  done
}

@test "an option where it means nothing is refused" {
  printf 'HV\nVH\n' > r.txt
  evo-eval --task Walker-v0 --actions random --max-steps 3 r.txt --rollout r.h5 > s.json
  fails_with 2 "--weights goes with --encoding voxel" -- evo-sample --encoding cppn --weights 0,0,0,1,1
  fails_with 2 "s.json: a scored population goes with --state-in" -- evo-neat --state-out x.json s.json
  evo-neat -n 2 --state-out x.json > g.jsonl
  fails_with 2 "--shape excludes --state-in" -- evo-neat --shape 3x3 --state-in x.json --state-out y.json g.jsonl
  fails_with 2 "--episode goes with rollouts" -- evo-render r.txt --episode 1 -o a.png
  fails_with 2 "--plot goes with rollouts" -- evo-render r.txt --plot return -o a.png
  fails_with 2 "--fps goes with films" -- evo-render r.h5 --at 2 --fps 5 -o a.png
  fails_with 2 "--moments goes with" -- evo-render r.h5 --at 2 --moments time -o a.png
  fails_with 2 "--steps goes with films" -- evo-render r.h5 --at 2 --steps 1-2 -o a.png
  fails_with 2 "--at excludes --strip" -- evo-render r.h5 --at 2 --strip 2 -o a.png
  fails_with 2 "excludes" -- evo-render r.h5 --panels 2 --strip 2 -o a.png
  fails_with 2 "--show: 'trial' is unknown; allowed: trail, velocities, contacts" -- evo-render r.h5 --show trial -o a.gif
  fails_with 2 "--steps: '5' is not" -- evo-render r.h5 --steps 5 -o a.gif
  fails_with 2 "the last step shown, 1, comes before the first, 2" -- evo-render r.h5 --steps 2-1 -o a.gif
  fails_with 2 "--camera: '1,2' is not X,Y,WIDTH,HEIGHT" -- evo-render r.h5 --camera 1,2 -o a.gif
  fails_with 2 "cannot follow 'packge'" -- evo-render r.h5 --camera packge -o a.gif
  [ -z "$(ls a.* y.json 2> /dev/null)" ]
}
