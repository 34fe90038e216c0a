#!/bin/bash
# The wheel, as a user has it: wheel.sh BUILD_FOLDER makes it and installs it in an empty virtual
# environment of every Python from 3.9 on that is found here, without the project in reach. Where
# PyPI is not reached, a message says so and the exit status is 77 (skipped).
set -euo pipefail
build=$1
source=$(cd "$(dirname "$0")/../../.." && pwd)
skip() { echo "skipped: $1"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
BUILD=$build "$source/scripts/wheel" "$work/wheel" || skip "auditwheel cannot be had from PyPI"
cp "$source/bindings/python/tests/wheel.py" "$work"
cd "$work"
unset EVO_BIN EVO_LIBRARY PYTHONPATH
export PATH=/usr/bin:/bin
for python in /usr/bin/python3 "${PYENV_ROOT:-$HOME/.pyenv}"/versions/3.{9,10,11,12,13,14}.*/bin/python; do
  [ -x "$python" ] || continue
  "$python" -m venv venv
  begin=$(date +%s%N)
  venv/bin/pip install -q --disable-pip-version-check --only-binary :all: "$(echo wheel/*.whl)[gymnasium]" ||
    skip "numpy and Gymnasium cannot be installed from PyPI"
  echo "$("$python" -V): installed in $((($(date +%s%N) - begin) / 1000000)) ms"
  PATH="$work/venv/bin:$PATH" venv/bin/python wheel.py
  rm -rf venv
done
