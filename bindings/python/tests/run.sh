#!/bin/bash
# Tests of the Python package: run.sh client|gymnasium|stable-baselines3 BUILD_FOLDER
# All but the client need packages that Debian does not have: they are installed
# from PyPI into a virtual environment in the build folder. Where that cannot be
# done, a message says so and the exit status is 77 (skipped).
set -euo pipefail
kind=$1 build=$2
source=$(cd "$(dirname "$0")/.." && pwd)
export EVO_BIN="$build/bin"

run() { "$@" -m unittest discover -s "$source/tests" -p "$pattern"; }

if [ "$kind" = client ]; then
  cd "$source"
  export PYTHONPATH="$source" PYTHONDONTWRITEBYTECODE=1
  for pattern in test_simulator.py test_worlds.py test_evogym.py test_files.py test_own.py; do run /usr/bin/python3; done
  exit
fi

skip() { echo "skipped: $1"; exit 77; }
venv="$build/python-$kind"
packages=(gymnasium)
[ "$kind" = gymnasium ] || packages+=(stable-baselines3 'pyarrow<20') # the last for Debian's numpy
if [ ! -e "$venv/complete" ]; then
  rm -rf "$venv"
  /usr/bin/python3 -m venv --system-site-packages "$venv" 2> /dev/null || skip "python3-venv is not installed"
  "$venv/bin/pip" install -q --disable-pip-version-check "${packages[@]}" ||
    skip "${packages[*]} cannot be installed from PyPI"
  touch "$venv/complete"
fi
# As a user installs it; from a copy, since pip builds where the source is.
copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT
cp -r "$source" "$copy/python"
"$venv/bin/pip" install -q --disable-pip-version-check --force-reinstall --no-deps "$copy/python" ||
  skip "setuptools cannot be had from PyPI"
cd "$copy"
patterns=("test_${kind//-/_}.py")
[ "$kind" = gymnasium ] || patterns+=(test_datasets.py)
for pattern in "${patterns[@]}"; do run "$venv/bin/python"; done
[ "$kind" = gymnasium ] || exit 0

# The gallery.
mkdir run
"$EVO_BIN/evo-sample" -n 3 --seed 1 | "$EVO_BIN/evo-eval" --task Walker-v0 --actions sine:0.5,20,0.7 > run/history.jsonl
for script in "$source"/../../examples/python/*.py; do
  case $script in
    *own_reward.py) arguments=(4096) ;;
    *one_controller.py) arguments=(2) ;;
    *reading_a_run.py) arguments=(run) ;;
    *) arguments=() ;;
  esac
  "$venv/bin/python" "$script" "${arguments[@]}" > said || { echo "$script failed" >&2; exit 1; }
  [ -s said ] || { echo "$script says nothing" >&2; exit 1; }
done
