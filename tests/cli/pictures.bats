# evo-render and evo-inspect as processes.
load helpers

episode() { evo-sample -n 1 --seed 4 | evo-eval --task Walker-v0 --sine 0.5,20,0.7 --max-steps 40 --rollout "$1" > /dev/null; }

@test "video, animation, frames, sheet, raw stream" {
  unset DISPLAY
  episode r.h5
  evo-render r.h5 -o r.mp4 --size 320x180
  ffprobe -v error -show_entries stream=width,height,nb_frames -of csv=p=0 r.mp4 | grep -qx 320,180,41
  evo-render r.h5 -o r.gif --size 160x90
  evo-render r.h5 -o r.png --size 160x90
  evo-render r.h5 -o 'frames/%05d.png' --size 160x90 --every 10
  [ "$(ls frames | wc -l)" -eq 5 ]
  evo-render r.h5 --sheet 6 -o sheet.png
  evo-render r.h5 -o - --size 160x90 | head -c 9 | grep -qx YUV4MPEG2
  evo-sample -n 7 | evo-render --grid -o grid.png
  for file in r.gif r.png sheet.png grid.png; do [ "$(stat -c %s $file)" -gt 1000 ]; done
}

@test "the same rollout is the same picture, whatever -j" {
  episode r.h5
  evo-render r.h5 -o a.png --size 160x90 -j1
  evo-render r.h5 -o b.png --size 160x90 -j3
  cmp a.png b.png
}

@test "what cannot be drawn is refused in one line, and leaves no file" {
  episode r.h5
  fails_with 2 "0x9" "8192" -- evo-render r.h5 -o x.png --size 0x9
  fails_with 2 "-o" -- evo-render r.h5
  fails_with 2 "walk.xyz" -- evo-render r.h5 -o walk.xyz
  fails_with 66 "none.h5" -- evo-render none.h5 -o x.mp4
  [ -z "$(ls x.* 2>/dev/null)" ]
}

@test "inspect: tasks, one task, robots, files" {
  evo-inspect tasks | golden tasks.txt
  [ "$(evo-inspect tasks | tail -n +2 | wc -l)" -eq 32 ]
  evo-inspect task Carrier-v1 | golden task-Carrier-v1.txt
  evo-inspect task WingspanMaximizer-v0 | head -1 | grep -q WingspanMazimizer-v0
  evo-sample -n 1 --seed 1 | evo-inspect robot | golden robot.txt
  evo-sample -n 1 --seed 1 | evo-inspect robot --color always | grep -q $'\x1b\[48;5;'
  episode r.h5
  evo-inspect r.h5 | grep -q 'rollout of Walker-v0'
  fails_with 2 "Walkr" "Walker-v0" -- evo-inspect task Walkr-v0
}

@test "convert: round trips through every form" {
  evo-sample -n 1 --seed 1 > r.jsonl
  for form in json yaml txt npz; do
    evo-convert r.jsonl -o r.$form
    evo-convert r.$form | jq -r .id | cmp - <(jq -r .id r.jsonl)
  done
  evo-convert --to evogym r.jsonl | evo-convert | jq -r .id > id
  evo-convert --task Carrier-v0 -o world.json
  jq -e '.objects | keys == ["ground","package"]' world.json
  /usr/bin/python3 -c "
import numpy as np
a = np.load('r.npz'); assert a['arr_0'].shape == (5, 5) and a['arr_1'].shape[0] == 2"
  fails_with 2 "jsn" "json" -- evo-convert r.jsonl --to jsn
}
