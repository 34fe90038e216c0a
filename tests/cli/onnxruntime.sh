#!/bin/bash
# onnxruntime.sh FOLDER: prints a Python that has onnxruntime, which Debian has not:
# one of a virtual environment in the folder, filled from PyPI. Fails where that
# cannot be done.
set -euo pipefail
venv=${1:?folder}/python-onnxruntime
if [ ! -e "$venv/complete" ]; then
  rm -rf "$venv"
  /usr/bin/python3 -m venv --system-site-packages "$venv" > /dev/null 2>&1
  "$venv/bin/pip" install -q --disable-pip-version-check onnxruntime > /dev/null 2>&1
  touch "$venv/complete"
fi
echo "$venv/bin/python"
