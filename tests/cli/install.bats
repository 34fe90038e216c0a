# The suite as it is after `cmake --install` and in its Debian packages: moved
# to another folder, run from yet another, by somebody without privileges.
load helpers

setup_file() {
  export PREFIX="$BATS_FILE_TMPDIR/moved"
  cmake --install "$EVO_BIN/.." --prefix "$BATS_FILE_TMPDIR/first" > /dev/null
  mv "$BATS_FILE_TMPDIR/first" "$PREFIX"
}

# A shell that sees only the installed tools, as nobody where we are root.
installed() {
  local as=()
  if [ "$(id -u)" -eq 0 ]; then
    as=(setpriv --reuid=65534 --regid=65534 --clear-groups)
    chmod o+x "$BATS_RUN_TMPDIR" "$BATS_RUN_TMPDIR"/*/ "$BATS_FILE_TMPDIR"
    chown 65534 "$BATS_TEST_TMPDIR"
  fi
  "${as[@]}" env -i HOME="$BATS_TEST_TMPDIR" PATH="$PREFIX/bin:/usr/bin:/bin" LC_ALL=C.UTF-8 \
    bash -euo pipefail -c "$1"
}

@test "tasks, profiles and recipes are found where the prefix was moved to" {
  installed 'evo-data' | grep -qx "$PREFIX/share/evo"
  installed 'evo-data tasks/recipes/moments.yaml tasks/Walker-v0.yaml' > paths
  printf '%s\n' "$PREFIX/share/evo/tasks/recipes/moments.yaml" "$PREFIX/share/evo/tasks/Walker-v0.yaml" | diff - paths
  diff <(installed 'evo-inspect tasks') <(evo-inspect tasks)
  installed 'evo-sample -n 3 --seed 1' | diff - <(evo-sample -n 3 --seed 1)
}

@test "every tool and every file that runs read is installed" {
  diff <(cd "$EVO_BIN" && ls evo-*) <(cd "$PREFIX/bin" && ls evo-*)
  diff <(cd "$EVO_SOURCE/tasks" && find . -type f | sort) <(cd "$PREFIX/share/evo/tasks" && find . -type f | sort)
}

@test "links between the installed documents lead somewhere" {
  [ -s "$PREFIX/share/doc/evo/README.md" ]
  "$EVO_SOURCE/tests/citations.py" "$PREFIX/share/doc/evo"
}

@test "man finds the pages" {
  command -v man > /dev/null || skip "man is not installed"
  [ -e "$EVO_BIN/../docs/man/evo.1" ] || skip "built without help2man"
  for page in $(cd "$EVO_BIN" && ls evo-*) evo; do
    MANPATH="$PREFIX/share/man" man -w "$page" | grep -q "^$PREFIX/share/man/man1/$page\.1$"
  done
}

@test "a run from the installed place ends to the same result" {
  settings="--pop 3 --evals 4 --steps 2048 --seed 1 --video gif --video-options '--size 160x90 --speed 25' -q"
  installed "evo evolve ga --run run $settings"
  eval evo-evolve ga --run here "$settings"
  cmp run/history.jsonl here/history.jsonl
  for file in best.policy.h5 best.gif report.html; do [ -s "run/$file" ]; done
}

@test "evo-data: EVO_DATA and EVO_TASKS come first; what is missing is said with its nearest name" {
  mkdir -p mine/tasks/physics more
  cp "$EVO_SOURCE/tasks/Walker-v0.yaml" mine/tasks/Mine.yaml
  cp "$EVO_SOURCE/tasks/Walker-v0.yaml" more/More.yaml
  [ "$(EVO_DATA=mine evo-data)" = "$PWD/mine" ]
  EVO_DATA=mine EVO_TASKS=more evo-data --names tasks > names
  printf '%s\n' Mine More | diff - names
  evo-data --names physics | grep -qx paper
  EVO_DATA=none fails_with 66 "EVO_DATA" "none" -- evo-inspect tasks
  fails_with 66 "tasks/recipe" "tasks/recipes" -- evo-data tasks/recipe
  fails_with 66 "../LICENSE" -- evo-data ../LICENSE
  fails_with 2 "physics" -- evo-data --names phsics
}

@test "a tool without its data says where it looked" {
  mkdir alone
  cp "$EVO_BIN/evo-inspect" alone
  fails_with 66 "$PWD/share/evo" "EVO_DATA" -- alone/evo-inspect tasks
}

# The example as programs are built that have nothing of ours but these files:
# with what pkg-config says of the package below this prefix.
build_example() {
  local flags
  flags=$(PKG_CONFIG_LIBDIR="$1/lib/pkgconfig:$1/lib/$(gcc -print-multiarch)/pkgconfig" pkg-config --cflags --libs evo)
  # shellcheck disable=SC2086
  g++ -std=c++20 -O1 "$EVO_SOURCE/examples/library/walk.cpp" $flags -o "$2"
}

@test "library: the example is built with CMake and with pkg-config, and does what the tools do" {
  cmake -S "$EVO_SOURCE/examples/library" -B with-cmake -D CMAKE_PREFIX_PATH="$PREFIX" > log
  cmake --build with-cmake >> log
  installed "$PWD/with-cmake/walk Walker-v0 2048" > said
  build_example "$PREFIX" with-pkg-config
  installed "LD_LIBRARY_PATH=$PREFIX/lib $PWD/with-pkg-config Walker-v0 2048" | diff said -
  printf 'RHHHR\nVSSSV\nVHRHV\nV...V\nV...V\n' > walker.txt
  evo-train walker.txt --task Walker-v0 --steps 2048 --seed 1 -o trained.json
  fitness=$(jq '.fitness' trained.json)
  official=$(evo-eval trained.json | jq '.fitness')
  printf 'trained: fitness %.4f, from the official start %.4f\n' "$fitness" "$official" | diff - <(tail -n 1 said)
  content() { evo-convert "$1" --to json | jq -S 'del(.created_by)'; }
  diff <(content walk.policy.h5) <(content "$(jq -r .policy trained.json)")
  fails_with 2 "Walkr-v0" "Walker-v0" -- env LD_LIBRARY_PATH="$PREFIX/lib" ./with-pkg-config Walkr-v0
}

@test "library: the example in C is built without warnings and runs" {
  export PKG_CONFIG_PATH="$PREFIX/lib/pkgconfig"
  gcc -std=c11 -O1 -Wall -Wextra -Werror "$EVO_SOURCE/examples/library/worlds.c" $(pkg-config --cflags --libs evo) -lm -o worlds
  LD_LIBRARY_PATH="$PREFIX/lib" ./worlds > said
  [ "$(wc -l < said)" -eq 9 ]
  # The same wave in every world, shifted: most end elsewhere.
  [ "$(tail -n +2 said | awk '{ print $2 }' | sort -u | wc -l)" -ge 6 ]
}

@test "library: it shows the functions of its header and nothing else" {
  nm -D --defined-only "$PREFIX/lib/libevo.so" | awk '$2 == "T" { sub(/@.*/, "", $3); print $3 }' | sort > symbols
  nm -D --defined-only "$PREFIX/lib/libevo.so" | awk '$2 != "A" && $2 != "T"' > others
  [ ! -s others ]
  grep -E '^EVO_API' "$PREFIX/include/evo/evo.h" | grep -oE 'evo_[a-z_]+\(' | tr -d '(' | sort -u | diff - symbols
  objdump -p "$PREFIX/lib/libevo.so" | grep -qE 'SONAME +libevo\.so\.[0-9]+\.[0-9]+$'
  grep -h '^#include' "$PREFIX/include/evo/evo.h" > includes
  run ! grep -vE '<[a-z]+(\.h)?>$|"evo/evo\.h"' includes
  echo '#include <evo/evo.h>' > alone.cpp
  g++ -std=c++20 -Wall -Wextra -Wconversion -Wpedantic -Werror -fsyntax-only -I"$PREFIX/include" alone.cpp
}

@test "Debian packages: names, dependencies, contents" {
  command -v dpkg-shlibdeps > /dev/null || skip "dpkg-dev is not installed"
  (cd "$BATS_TEST_TMPDIR" && cpack --config "$EVO_BIN/../CPackConfig.cmake" -G DEB -B "$PWD/packages" > log) || { cat log; false; }
  for deb in packages/*.deb; do dpkg-deb -x "$deb" root; done
  depends() { dpkg-deb -f packages/"$1"_*.deb Depends; }
  for package in libc6 libhdf5-103-1 libosmesa6 make; do
    depends evo | grep -qE "(^|, )$package(:|,| |$)"
  done
  dpkg-deb -f packages/evo_*.deb Recommends | grep -q ffmpeg
  library=$(cd packages && ls | sed -n 's/_.*//; /^libevo[0-9]/p')
  depends "$library" | grep -q 'evo (= '
  depends libevo-dev | grep -q "^$library (= "
  depends python3-evo-robots | grep -q python3-numpy
  depends python3-evo-robots | grep -q "$library (= "
  dpkg-deb -f packages/python3-evo-robots_*_all.deb Architecture | grep -qx all
  # Each file is in one of them.
  for deb in packages/*.deb; do dpkg-deb -c "$deb" | awk '$1 !~ /^d/ { print $6 }'; done | sort | uniq -d > twice
  [ ! -s twice ]
  cmp root/usr/share/evo/tasks/recipes/moments.yaml "$EVO_SOURCE/tasks/recipes/moments.yaml"
  # Nothing in them tells where they were built.
  run ! grep -rqF "$EVO_SOURCE" root
  root/usr/bin/evo-inspect tasks | diff - <(evo-inspect tasks)
  build_example root/usr walk
  LD_LIBRARY_PATH=root/usr/lib ./walk Walker-v0 2048 > said
  PATH="$PWD/root/usr/bin:/usr/bin:/bin" PYTHONPATH=root/usr/lib/python3/dist-packages EVO_BIN='' /usr/bin/python3 -c '
import evo_robots
with evo_robots.Simulator("Walker-v0", [[3, 4], [4, 3]]) as simulator:
    print(simulator.reset().observations.shape)
world = evo_robots.World()
world.add("robot", [[3, 4], [4, 3]], 0, 0)
print(evo_robots.Simulations(world).positions.shape)'
}
