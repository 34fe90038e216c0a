#!/bin/bash
# threads.sh BIN: tools with several threads at their work: results in order, progress,
# the watch over interrupts, files. For tools built with the thread sanitizer (preset
# tsan), which ends one with status 66 where two threads meet unguarded.
set -euo pipefail
bin=$(realpath "${1:?folder of the tools}")
export PATH=$bin:$PATH
cd "$(mktemp -d)"
trap 'rm -rf "$PWD"' EXIT
small=(--task Walker-v0 -j4 --progress always --train environments=2 --train rollout=16
  --train hidden=4 --train final_episodes=1 --train evaluation_interval=1)

# Says something only if it fails.
quietly() { "$@" 2> said > /dev/null || { cat said; exit 1; }; }

evo-sample -n 8 --shape 3x3 -o robots.jsonl
quietly evo-eval -j4 --progress always --task Walker-v0 --actions random --max-steps 5 --rollout rollouts/ robots.jsonl -o scored.jsonl
quietly evo-suggest -j4 -n 4 scored.jsonl
quietly evo-train "${small[@]}" --steps 64 --out-dir policies robots.jsonl
evo-train "${small[@]}" --steps 5120000 --out-dir stopped robots.jsonl 2> said > /dev/null &
until [ "$(cat stopped/*.log 2> /dev/null | grep -c global_step)" -ge 4 ]; do kill -0 $! && sleep 0.1; done
kill -TERM $!
status=0
wait $! || status=$?
[ "$status" -eq 143 ] || { cat said; echo "status $status"; exit 1; }
! grep -q ThreadSanitizer said || { cat said; exit 1; }
echo "tools: no thread met another unguarded"
