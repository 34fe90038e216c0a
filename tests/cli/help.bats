# Help, version and wrong usage, for every tool.
load helpers

tools() { (cd "$EVO_BIN" && printf '%s\n' evo-*); }

statuses() { sed -n '/^Exit status:/,$p'; }

# The help without what tools share, whose words are in evo-train's: of common options the names
# alone, and no statuses.
own() {
  awk '/^Exit status:/ { exit }
    /^Common options:/ { names = $0 } names == "" { print }
    names && match($0, /^  (-[a-z], |    )--[a-z-]+/) { names = names " " substr($0, 7, RLENGTH - 6) }
    names && /^$/ { print names "\n"; names = "" }'
}

@test "every tool's help is as agreed, fits a terminal and shows two examples" {
  evo-train --help | golden help/evo-train.txt
  for tool in $(tools); do
    "$tool" --help > help
    run ! grep -E '^.{81}' help
    [ "$(sed -n '/^Examples:/,$p' help | grep -c '^  # ')" -ge 2 ]
    sed -n '/^Common options:/,/^$/p' help > shared
    run ! grep -vxFf <(evo-train --help) shared
    statuses < help | diff - <(evo-train --help | statuses)
    [ "$tool" = evo-train ] || golden "help/$tool.txt" <<< "$(own < help)"
  done
}

# All words are in those of compare and ga; of the others how many lines there are, the names of
# options, and what they say otherwise; of ga what compare does not say.
@test "every method's help is as agreed" {
  evo-evolve compare --help > known
  statuses < known | diff - <(evo-train --help | statuses)
  golden help/evo-evolve-compare.txt <<< "$(own < known)"
  run ! grep -E '^.{81}' known
  for method in ga neat bo map random program race modular recipe; do
    evo-evolve $method --help > help
    run ! grep -E '^.{81}' help
    echo "$method, $(wc -l < help) lines:" $(grep -oE '^      --[a-z-]+' <(own < help))
    grep -vxFf known help
    [ $method != ga ] || cat help >> known
  done > methods
  golden help/evo-evolve-methods.txt < methods
}

@test "help names the training profiles that there are" {
  named() { evo-train --help | tr -d '\n' | grep -o '(adapt[^)]*)' | tr -d '() ' | tr , '\n'; }
  (cd "$EVO_SOURCE/tasks/training" && ls *.yaml) | sed 's/\.yaml//' | cmp - <(named)
}

@test "evo: one name for the tools, and for one's own in PATH" {
  evo --help | golden help/evo.txt
  evo help | cmp - <(evo --help)
  evo | cmp - <(evo --help)
  run ! grep -E '^.{81}' <(evo help)
  for tool in $(tools); do
    evo help | grep -q "^  ${tool#evo-} "
    evo help "${tool#evo-}" | cmp - <("$tool" --help)
  done
  evo sample -n 2 --seed 3 | cmp - <(evo-sample -n 2 --seed 3)
  evo --version | grep -Eqx "evo [0-9.]+ \(.+\) [a-z0-9-]+"
  fails_with 2 "'trian'" "did you mean 'train'" "evo help" -- evo trian robot
  fails_with 2 "'../evo-train'" -- evo ../evo-train
  fails_with 2 "''" -- evo ""
  fails_with 66 "missing.json" -- evo eval --task Walker-v0 --actions random missing.json
  mkdir own; printf '#!/bin/sh\necho own "$@"\nexit 7\n' > own/evo-mine; chmod +x own/evo-mine
  PATH=$PWD/own:$PATH run -7 evo mine a 'b c'
  [ "$output" = "own a b c" ]
}

@test "version: tool, version, commit, instruction set in one line" {
  for tool in $(tools); do "$tool" --version | grep -Eqx "$tool [0-9.]+ \(.+\) [a-z0-9-]+"; done
}

# What a build is made from, as cmake --build looks it up.
commit_of() {
  cmake -D SOURCE="$1" -D VERSION=1.2.3 -D TO="$PWD/version.h" -P "$EVO_SOURCE/cli/version.cmake" >&2
  sed -n 's/^#define EVO_COMMIT "\(.*\)"$/\1/p' version.h
}

@test "version: the commit a build is from, marked where its files were changed since" {
  mkdir checkout
  [ "$(commit_of checkout)" = "no commit" ]
  git init -q checkout
  echo 1 > checkout/source
  git -C checkout add source
  git -C checkout -c user.name=n -c user.email=e commit -qm one
  commit=$(git -C checkout rev-parse --short HEAD)
  [ "$(commit_of checkout)" = "$commit" ]
  touch checkout/left-behind
  [ "$(commit_of checkout)" = "$commit" ]
  echo 2 > checkout/source
  [ "$(commit_of checkout)" = "$commit+" ]
}

@test "scripts tell their usage and do nothing else" {
  local script
  for script in quickstart install-packages test; do
    "$EVO_SOURCE/scripts/$script" --help | grep -q "^usage: scripts/$script"
    fails_with 2 "usage: scripts/$script" -- "$EVO_SOURCE/scripts/$script" --hlep
  done
  fails_with 2 "tset: no kind of packages" -- "$EVO_SOURCE/scripts/install-packages" tset
}

@test "wrong usage: status 2 and one line that names the nearest option" {
  for tool in $(tools); do fails_with 2 "$tool" "--verbsoe" "--verbose" -- "$tool" --verbsoe; done
  fails_with 2 "--seed" -- evo-sample --seed seven
  fails_with 2 "--jobs" -- evo-eval -j 0 --task Walker-v0 --actions random
}

@test "names misspelt or cut short, tasks and files mixed up: what was meant is named" {
  fails_with 2 "did you mean '--keep'" -- evo-select --kepp 3
  evo-sample -n 1 > robot
  local word
  for word in walker Walker WALKER-V0 wlaker-v0; do
    fails_with 2 "'$word'" "did you mean 'Walker-v0'" -- evo-eval --task $word --actions random robot
  done
  cp "$EVO_SOURCE/tasks/Walker-v0.yaml" mine
  fails_with 2 "'./mine'" -- evo-eval --task mine --actions random robot
  evo-eval --task ./mine --actions random --max-steps 1 robot > /dev/null
  fails_with 66 "given as 'Walker-v0'" -- evo-eval --task Walker-v0.yaml --actions random robot
  fails_with 66 "a task and no file" "--task Walker-v0" -- evo-eval Walker-v0
  fails_with 66 "a task and no file" "evo-inspect task Walker-v0" -- evo-inspect Walker-v0
}
