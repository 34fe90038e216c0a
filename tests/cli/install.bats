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

@test "tasks, profiles and pipelines are found where the prefix was moved to" {
  installed 'evo-data' | grep -qx "$PREFIX/share/evo"
  installed 'evo-data scripts/ga.mk tasks/physics/fast.yaml' > paths
  printf '%s\n' "$PREFIX/share/evo/scripts/ga.mk" "$PREFIX/share/evo/tasks/physics/fast.yaml" | diff - paths
  diff <(installed 'evo-inspect tasks') <(evo-inspect tasks)
  installed 'evo-sample -n 3 --seed 1' | diff - <(evo-sample -n 3 --seed 1)
}

@test "every tool and every file the pipelines read is installed" {
  diff <(cd "$EVO_BIN" && ls evo-*) <(cd "$PREFIX/bin" && ls evo-*)
  for file in "$EVO_SOURCE"/scripts/*.{mk,jq,gnuplot}; do [ -e "$PREFIX/share/evo/scripts/$(basename "$file")" ]; done
  diff <(cd "$EVO_SOURCE/tasks" && find . -type f | sort) <(cd "$PREFIX/share/evo/tasks" && find . -type f | sort)
}

@test "a pipeline runs from the installed place to the same result" {
  settings="POP=3 EVALS=4 STEPS=2048 SEED=1 VIDEO=gif VIDEO_OPTIONS='--size 160x90 --every 50'"
  installed "make -s -f \"\$(evo-data scripts/ga.mk)\" RUN=run $settings"
  eval make -s -f "$EVO_SOURCE/scripts/ga.mk" RUN=here "$settings"
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
  evo-data --names physics | grep -qx fast
  EVO_DATA=none fails_with 66 "EVO_DATA" "none" -- evo-inspect tasks
  fails_with 66 "scripts/gaa.mk" "scripts/ga.mk" -- evo-data scripts/gaa.mk
  fails_with 66 "../LICENSE" -- evo-data ../LICENSE
  fails_with 2 "physics" -- evo-data --names phsics
}

@test "a tool without its data says where it looked" {
  mkdir alone
  cp "$EVO_BIN/evo-inspect" alone
  fails_with 66 "$PWD/share/evo" "EVO_DATA" -- alone/evo-inspect tasks
}

@test "Debian packages: names, dependencies, contents" {
  command -v dpkg-shlibdeps > /dev/null || skip "dpkg-dev is not installed"
  (cd "$BATS_TEST_TMPDIR" && cpack --config "$EVO_BIN/../CPackConfig.cmake" -G DEB -B "$PWD/packages" > log) || { cat log; false; }
  deb=$(ls packages/evo_*.deb)
  dpkg-deb -f "$deb" Depends > depends
  for package in libc6 libhdf5-103-1 libosmesa6 make jq; do grep -qE "(^|, )$package(:|,| |$)" depends; done
  dpkg-deb -f "$deb" Recommends | grep -q ffmpeg
  dpkg-deb -x "$deb" root
  cmp root/usr/share/evo/scripts/evolve.mk "$EVO_SOURCE/scripts/evolve.mk"
  # Nothing in it tells where it was built.
  run ! grep -rqF "$EVO_SOURCE" root
  root/usr/bin/evo-inspect tasks | diff - <(evo-inspect tasks)
}
