#!/bin/bash
# Tests of the Python package: run.sh client|gymnasium|examples|stable-baselines3 BUILD_FOLDER
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
case $kind in
  stable-baselines3) packages+=(stable-baselines3) ;;
  examples) packages+=(pandas tqdm 'h5py>=3.11') ;; # the last for PyPI's numpy
esac
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
case $kind in
  gymnasium) pattern=test_gymnasium.py ;;
  examples) pattern=test_files.py ;;
  stable-baselines3) pattern=test_stable_baselines3.py ;;
esac
for package in jax tensorboard cma deap nevergrad optuna pettingzoo ribs; do
  [ "$kind" = examples ] || break
  "$venv/bin/python" -c "import $package" 2> said || "$venv/bin/pip" install -q --disable-pip-version-check $package ||
    echo "$package cannot be installed from PyPI"
done
run "$venv/bin/python"
[ "$kind" = examples ] || exit 0

# The gallery.
"$EVO_BIN/evo-evolve" ga --run run --pop 3 --evals 6 --evaluate "jq -c '.fitness = (.body | length)'" -q
for script in "$source"/../../examples/python/*.py; do
  case $script in
    *own_reward.py) arguments=(4096) ;;
    *one_controller.py) arguments=(2) ;;
    *reading_a_run.py) arguments=(run) ;;
    *) arguments=() ;;
  esac
  package=$(sed -n 's/.*with_\(.*\)\.py$/\1/p' <<< "$script")
  [ "$package" != pyribs ] || package=ribs
  python=("$venv/bin/python")
  # Debian's PyTorch goes with Debian's numpy.
  [ "$package" != torch ] || python=(env "PYTHONPATH=$source" PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3)
  "${python[@]}" -c "import ${package:-numpy}" 2> said || { echo "skipped: $script"; continue; }
  "${python[@]}" "$script" "${arguments[@]}" > said || { echo "$script failed" >&2; exit 1; }
  [ -s said ] || { echo "$script says nothing" >&2; exit 1; }
done
