#!/bin/bash
# The rooms of the house and whom each may include (docs/house.md). Fails with
# every include that goes the wrong way, and with anything in libevo that
# touches files, terminals, the environment or the clock.
set -euo pipefail
cd "${1:?source folder}"

declare -A may=(
  [libevo/base]="libevo/base"
  [libevo/body]="libevo/base libevo/body"
  [libevo/sim]="libevo/base libevo/body libevo/sim"
  [libevo/task]="libevo/base libevo/body libevo/sim libevo/task"
  [libevo/control]="libevo/base libevo/body libevo/sim libevo/task libevo/control"
  [libevo/evolve]="libevo/base libevo/body libevo/evolve"
  [formats/io]="libevo formats/io"
  [formats/robot]="libevo formats/io formats/robot"
  [formats/task]="libevo formats/io formats/robot formats/task"
  [formats/training]="libevo formats/io formats/robot formats/task formats/training"
  [formats/rollout]="libevo formats/io formats/robot formats/task formats/training formats/rollout"
  [formats/foreign]="libevo formats/io formats/robot formats/task formats/training formats/rollout
                     formats/foreign"
  [formats/run]="libevo formats"
  [render]="libevo formats render"
  [render/painters]="libevo formats render/painters"
  [render/scene]="libevo formats render/painters render/scene"
  [render/figures]="libevo formats render/painters render/scene render/figures"
  [render/film]="libevo formats render/painters render/scene render/figures render/film"
  [bindings/c]="libevo formats render bindings/c"
  [bindings/web]="libevo formats bindings/web"
  [cli]="libevo formats bindings/c render cli"
)

bad=0
for room in "${!may[@]}"; do
  while IFS=: read -r file line include; do
    target=${include#*\"} target=${target%%\"*}
    case $target in libevo/*|formats/*|render/*|bindings/*|cli/*) ;; *) continue ;; esac
    allowed=no
    for prefix in ${may[$room]}; do [[ $target == "$prefix"/* ]] && allowed=yes; done
    if [ $allowed = no ]; then echo "$file:$line: $room must not include $target"; bad=1; fi
  done < <(grep -nE '^#include "' -r "$room" --include='*.h' --include='*.cpp' || true)
done

outside='#include <(fstream|filesystem|chrono|iostream|cstdio|ctime|unistd\.h|fcntl\.h)>|\bgetenv\(|std::(cout|cerr|chrono)'
if grep -nE "$outside" -r libevo --include='*.h' --include='*.cpp'; then
  echo "libevo touches no file, terminal, environment variable or clock"; bad=1
fi
exit $bad
