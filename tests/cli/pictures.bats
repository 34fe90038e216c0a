# evo-render and evo-inspect as processes.
load helpers

episode() { evo-sample -n 1 --seed 4 | evo-eval --task Walker-v0 --actions sine:0.5,20,0.7 --max-steps 40 --rollout "$1" > /dev/null; }

@test "video, animation, frames, sheet" {
  unset DISPLAY
  episode r.h5
  evo-render r.h5 -o r.mp4 --size 320x180
  ffprobe -v error -show_entries stream=width,height,nb_frames -of csv=p=0 r.mp4 | grep -qx 320,180,41
  evo-render r.h5 -o r.gif --size 160x90
  evo-render r.h5 -o 'frames/%05d.png' --size 160x90 --speed 10
  [ "$(ls frames | wc -l)" -eq 5 ]
  evo-render r.h5 --panels 6 -o sheet.png
  evo-sample -n 7 | evo-render --grid -o grid.png
  for file in r.gif sheet.png grid.png; do [ "$(stat -c %s $file)" -gt 1000 ]; done
}

@test "a film of a picture, and a picture of a film, are refused with how to make one" {
  printf 'HV\nVH\n' > robot.txt
  episode r.h5
  for ending in mp4 webm gif; do
    fails_with 2 "x.$ending" "no motion" "evo-eval --rollout" -- evo-render robot.txt -o x.$ending
  done
  fails_with 2 "x.png" "--at" "--strip" "--panels" ".gif" -- evo-render r.h5 -o x.png
  fails_with 2 "x.png" "--at" -- evo-render r.h5 --steps 3-3 -o x.png
  [ -z "$(ls x.* 2> /dev/null)" ]
}

@test "several robots at one moment, side by side" {
  evo-sample -n 7 --seed 1 > robots
  evo-eval --task Walker-v0 --actions sine:0.4,20,0.7 --max-steps 60 --rollout each/ robots > /dev/null
  mapfile -t each < <(jq -r '"each/\(.id).h5"' robots)
  evo-render "${each[@]}" --at 50 --show trail --size 800x600 -o seven.svg
  for id in $(jq -r .id robots); do grep -q "$id" seven.svg; done
  grep -q "step 50" seven.svg
  [ "$(grep -o '>return [^<]*[0-9]' seven.svg | wc -l)" -eq 7 ]
  evo-render "${each[@]}" --at 50 --size 800x600 -o seven.png
  # One that is over stands at its end.
  head -1 robots | evo-eval --task Walker-v0 --actions sine:0.4,20,0.7 --max-steps 40 --rollout short.h5 > /dev/null
  evo-render short.h5 "${each[1]}" --at 50 -o two.svg
  # With several tasks no one's name stands above all.
  evo-sample -n 1 --seed 2 | evo-eval -q --task Jumper-v0 --actions random --max-steps 50 --rollout j.h5 > /dev/null
  evo-render j.h5 "${each[1]}" --at 50 -o tasks.svg
  grep -q '>2 tasks<' tasks.svg && grep -q '>Jumper-v0<' tasks.svg
  grep -q "return +[0-9.]* at step 40<" two.svg
  fails_with 2 "there is no step 70: the longest episode has steps 0 to 60" -- evo-render short.h5 "${each[1]}" --at 70 -o x.png
  fails_with 2 "--at STEP shows several" -- evo-render short.h5 "${each[1]}" --strip 3 -o x.png
}

@test "a race: several robots in one world, one frame per step of the longest" {
  for seed in 4 5; do
    evo-sample -n 1 --seed $seed |
      evo-eval --task Walker-v0 --actions sine:0.5,20,0.7 --max-steps $((seed * 10)) --rollout $seed.h5 > /dev/null
  done
  evo-render --race 4.h5 5.h5 -o race.mp4 --size 320x180
  ffprobe -v error -show_entries stream=nb_frames -of csv=p=0 race.mp4 | grep -qx 51
  evo-render --race 4.h5 5.h5 -o 'race/%d.png' --size 320x180 --speed 25
  evo-render 5.h5 -o 'one/%d.png' --size 320x180 --speed 25
  [ "$(ls race | wc -l)" -eq "$(ls one | wc -l)" ]
  fails_with 2 "2 to 26" -- evo-render --race 4.h5 -o race.mp4
  evo-sample -n 1 --seed 4 | evo-eval --task Climber-v0 --actions random --max-steps 5 --rollout c.h5 > /dev/null
  fails_with 2 "Climber-v0" "Walker-v0" -- evo-render --race 4.h5 c.h5 -o race.mp4
  fails_with 2 "--race" -- evo-render --race -o race.png < /dev/null
}

@test "a film of an evolution: the champions of its generations, each once" {
  "$EVO_SOURCE/tests/report/make-run.sh" run ga 1 3 4
  fails_with 66 "policies/" "generation 0" -- evo-render --evolution run -o film.mp4
  evo-train -q --task Walker-v0 --steps 1024 --out-dir run/policies run/gen-*/scores.jsonl > /dev/null
  evo-render --evolution run -o film.mp4 --size 320x180 --speed 10 --fps 50
  champions=$(for scores in run/gen-*/scores.jsonl; do evo-select --keep 1 "$scores" | jq -r .id; done | uniq | wc -l)
  # Each is shown 0.7 s at rest, 2 s of its episode, and 0.4 s at its end, ten times as fast.
  frames=$(ffprobe -v error -show_entries stream=nb_frames -of csv=p=0 film.mp4)
  [ "$frames" -eq $((champions * (4 + 10 + 2))) ]
  fails_with 2 "--evolution" -- evo-render --evolution run run/best.json -o film.mp4
  fails_with 66 "missing" -- evo-render --evolution missing -o film.mp4
  [ ! -e missing ]
}

@test "still pictures: a moment, a strip, robots; as pixels and as shapes" {
  episode r.h5
  evo-render r.h5 --at 12.5 -o moment.png --size 320x180
  evo-render r.h5 --strip 4 -o strip.svg
  evo-render r.h5 --strip 4 --moments time --theme paper -o strip.pdf
  evo-sample -n 3 | evo-render --grid -o grid.svg
  head -c 4 strip.svg | grep -qx '<svg'
  head -c 4 strip.pdf | grep -qx '%PDF'
  evo-render r.h5 --strip 4 --width 85mm -o column.svg
  grep -q '<svg[^>]* width="321"' column.svg && grep -q '<text' column.svg
  fails_with 2 "parrot" -- evo-render r.h5 --at 5 --width parrot -o x.png
  fails_with 2 "--size" -- evo-render r.h5 --at 5 --width 85mm --size 320x180 -o x.png
  fails_with 2 "--width" -- evo-render r.h5 --width 85mm -o x.mp4
  [ "$(grep -c '>step ' strip.svg)" -eq 4 ]
  evo-render r.h5 --strip 4 -o again.svg
  cmp strip.svg again.svg
  fails_with 2 "99" "0 to 40" -- evo-render r.h5 --at 99 -o x.png
  fails_with 2 "x.mp4" ".svg" -- evo-render r.h5 --strip 4 -o x.mp4
  fails_with 2 "gait" -- evo-render r.h5 --strip 4 --moments walk -o x.svg
}

@test "a gait plays for ever in an SVG" {
  evo-sample -n 1 --seed 4 | evo-eval --task Walker-v0 --actions sine:0.5,20,0.7 --max-steps 160 --rollout w.h5 > /dev/null
  evo-render w.h5 --loop --steps 60- --size 240x240 -o gait.svg
  grep -q 'dur="0.40s" repeatCount="indefinite"' gait.svg
  [ "$(wc -c < gait.svg)" -lt 150000 ]
  evo-render w.h5 --loop --steps 60- --size 240x240 -o again.svg
  cmp gait.svg again.svg
  fails_with 2 "gait.png" ".svg" -- evo-render w.h5 --loop -o gait.png
  fails_with 2 "--loop" "--strip" -- evo-render w.h5 --loop --strip 4 -o x.svg
}

@test "a run on one page" {
  evo-evolve ga -q --run run --task Walker-v0 --pop 3 --evals 6 --steps 1024 --seed 1 > /dev/null 2>&1
  evo-render --poster run -o poster.svg
  for words in "What it does" "What it is" "The best so far" "Where it comes from" "The best of 6 robots"; do
    grep -q ">$words" poster.svg
  done
  evo-render --poster run -o poster.pdf
  head -c 4 poster.pdf | grep -qx '%PDF'
  fails_with 2 "--poster" -- evo-render --poster run run/best.json -o x.pdf
  fails_with 66 "missing" -- evo-render --poster missing -o x.pdf
}

@test "robots are called by their names" {
  evo-sample -n 2 --seed 1 | jq -c '.name = "neat-\(.origin.index)"' > NEAT.jsonl
  evo-render --grid NEAT.jsonl -o named.svg
  grep -q '>neat-0<' named.svg && grep -q '>neat-1<' named.svg
}

@test "colours, contacts and curves over a picture, each with what it measures" {
  episode r.h5
  evo-render r.h5 --at 30 --tint strain --show velocities -o strain.svg
  grep -q '>strain (area)<' strain.svg
  grep -q 'voxels/s<' strain.svg
  evo-render r.h5 --at 30 --tint stress --plot actuation -o stress.svg
  grep -q '>stress (weights per voxel)<' stress.svg
  grep -q '>commanded length<' stress.svg
  evo-render r.h5 --at 30 --show contacts --plot return -o contacts.svg
  grep -q 'robot weights\?<' contacts.svg
  grep -q '>return<' contacts.svg
  fails_with 2 "--tint: strian not in" "strain" -- evo-render r.h5 --at 1 --tint strian -o x.png
  fails_with 2 "--plot" "return" -- evo-render r.h5 --at 1 --plot speed -o x.png
  evo-render --race r.h5 r.h5 --show contacts --tint stress --steps 30-30 -o 'race/%d.png'
  [ "$(ls race | wc -l)" -eq 1 ]
  fails_with 2 "--race" "--plot" -- evo-render --race r.h5 r.h5 --plot return -o x.mp4
}

# Mean difference of two pictures of one size, of 255.
difference() {
  for file in "$1" "$2"; do ffmpeg -v error -i "$file" -f rawvideo -pix_fmt rgb24 "$file.rgb"; done
  /usr/bin/python3 -c "
import sys, numpy as np
a, b = (np.fromfile(f + '.rgb', np.uint8).astype(float) for f in sys.argv[1:])
assert a.size == b.size, (a.size, b.size)
print(np.abs(a - b).mean())" "$1" "$2"
}

@test "shapes as another program paints them are our pixels" {
  episode r.h5
  for theme in light paper; do
    evo-render r.h5 --strip 3 --theme $theme --size 800x450 -o ours.png
    evo-render r.h5 --strip 3 --theme $theme --size 800x450 -o shapes.svg
    rsvg-convert shapes.svg -o theirs.png
    difference ours.png theirs.png | awk '{ exit !($1 < 2.5) }'
    rm ./*.rgb
  done
  # And a browser, where there is one; its window is as high as the picture.
  command -v chromium > /dev/null || skip "the browser's part: no chromium (scripts/install-packages full)"
  read -r width height < <(sed -n '1s/.* width="\([0-9]*\)" height="\([0-9]*\)".*/\1 \2/p' shapes.svg)
  printf '<body style="margin:0"><img src="shapes.svg" style="display:block">' > page.html
  HOME=$PWD timeout 100 chromium --headless=new --no-sandbox --disable-gpu --hide-scrollbars --user-data-dir="$PWD/profile" \
    --window-size="$width,$((height + 200))" --screenshot="$PWD/window.png" "file://$PWD/page.html" 2> /dev/null
  ffmpeg -v error -i window.png -vf "crop=$width:$height:0:0" browser.png
  difference ours.png browser.png | awk '{ exit !($1 < 2.5) }'
}

@test "what cannot be drawn is refused in one line, and leaves no file" {
  episode r.h5
  fails_with 2 "0x9" "1280x720" -- evo-render r.h5 -o x.png --size 0x9
  fails_with 2 "-o" -- evo-render r.h5
  fails_with 2 "walk.xyz" -- evo-render r.h5 -o walk.xyz
  fails_with 66 "none.h5" -- evo-render none.h5 -o x.mp4
  fails_with 66 "none.h5: cannot be opened" -- evo-render none.h5 --strip 6 -o x.png
  [ -z "$(ls x.* 2>/dev/null)" ]
}

@test "inspect: tasks, one task, robots, files" {
  evo-inspect tasks | golden tasks.txt
  [ "$(evo-inspect tasks | tail -n +2 | wc -l)" -eq 32 ]
  evo-inspect task Carrier-v1 | golden task-Carrier-v1.txt
  evo-inspect task Catcher-v0 | grep -q 'package at 21 + ox, 41 + oy'
  evo-inspect task WingspanMaximizer-v0 | head -1 | grep -q WingspanMazimizer-v0
  evo-sample -n 1 --seed 1 | evo-inspect robot | golden robot.txt
  echo '{"body": ["H."], "stiffness": [[3, 1]]}' | evo-inspect | grep -qx 'stiffness 3 to 3'
  TERM=xterm-256color script -qec "evo-sample -n 1 --seed 1 | evo-inspect robot" /dev/null | grep -q $'\x1b\[48;5;'
  episode r.h5
  evo-inspect r.h5 | grep -q 'rollout of Walker-v0'
  evo-inspect r.h5 | tail -1 | grep -q '  end of the recording$'
  evo-inspect task UpStepper-v0 | grep -q '^  #####################\.'
  evo-inspect task Climber-v0 | grep -q '66 more lines above'
  fails_with 2 "Walkr" "Walker-v0" -- evo-inspect task Walkr-v0
}

@test "inspect: many robots as a histogram of their fitness, and why an episode ended" {
  for fitness in 1 1.5 2 2 2 2.5 5; do evo-sample -n 1 --seed "${fitness/./}" | jq -c ".fitness = $fitness"; done > many.jsonl
  evo-inspect many.jsonl > seen
  # As many as a line has room for, the best first; the others are counted.
  [ "$(sed -n 6p seen | wc -w)" -eq 5 ]
  [[ $(sed -n 6p seen) == $(jq -r 'select(.fitness == 5) | .id' many.jsonl)" "* ]]
  # Three parts of the range, six in the lowest, none between, the best on top.
  diff <(sed -n '9,11s/ *#* *\([0-9]*\)$/ \1/p' seen | sed 's/^ *//; s/  */ /g') - << 'END'
3.667 .. 5 1
2.333 .. 3.667 1
1 .. 2.333 5
END
  evo-sample -n 1 --seed 4 | evo-eval --task Lifter-v0 --actions sine:0.5,20,0.7 --rollout l.h5 > /dev/null
  evo-inspect l.h5 | tail -1 | grep -q '  time is up$'
}

@test "inspect: no line is wider than the terminal" {
  needs_terminal
  local of
  for of in tasks 'task Carrier-v0' 'task BidirectionalWalker-v0' training physics; do
    script -qec "stty cols 80; evo-inspect $of" /dev/null > raw
    [ "$(tr -d '\r' < raw | LC_ALL=C.UTF-8 wc -L)" -le 80 ]
    # The same words as in a pipe.
    diff <(tr -s ' \r\n' '\n' < raw) <(evo-inspect $of | tr -s ' \n' '\n')
  done
}

@test "convert: round trips through every form" {
  evo-sample -n 1 --seed 1 > r.jsonl
  for form in json yaml txt npz; do
    evo-convert r.jsonl -o r.$form
    evo-convert r.$form | jq -r .id | cmp - <(jq -r .id r.jsonl)
  done
  evo-convert --to evogym r.jsonl | evo-convert | jq -r .id | cmp - <(jq -r .id r.jsonl)
  evo-sample -n 7 --shape 4x6 > seven.jsonl
  evo-convert seven.jsonl --to yaml | evo-convert | cmp - seven.jsonl
  evo-convert --task Carrier-v0 -o world.json
  jq -e '.objects | keys == ["ground","package"]' world.json
  /usr/bin/python3 -c "
import numpy as np
a = np.load('r.npz'); assert a['arr_0'].shape == (5, 5) and a['arr_1'].shape[0] == 2"
  fails_with 2 "jsn" "json" -- evo-convert r.jsonl --to jsn
}

# As another user where we are root, as ourselves elsewhere.
as_user() {
  if [ "$(id -u)" -eq 0 ]; then setpriv --reuid=65534 --regid=65534 --clear-groups "$@"; else "$@"; fi
}

@test "an unprivileged user without display in a read-only folder" {
  mkdir -p locked out
  episode locked/r.h5
  "$EVO_SOURCE/tests/report/make-run.sh" locked/run ga 1 2 4 trained
  chmod a+rx . locked && chmod a+rwx out && chmod -R a+rX,a-w locked
  cd locked
  unset DISPLAY WAYLAND_DISPLAY XDG_RUNTIME_DIR
  export HOME=/nonexistent
  if as_user touch here 2>/dev/null; then skip "nothing is read-only for this user"; fi
  for output in walk.mp4 walk.gif; do as_user evo-render r.h5 --size 160x90 -o "../out/$output"; done
  as_user evo-render r.h5 --strip 3 -o ../out/sheet.png
  as_user evo-render --grid run/gen-001/scores.jsonl -o ../out/grid.png
  as_user evo-report run -o ../out/report.html
  [ "$(find ../out -size +1k | wc -l)" -ge 5 ]
  fails_with 73 "here.png" -- as_user evo-render r.h5 --strip 3 -o here.png
  chmod -R u+w .
}

@test "progress on a terminal is wiped, and there is none in a file" {
  needs_terminal
  episode r.h5
  evo-render r.h5 --size 160x90 -o x.gif 2> log
  [ ! -s log ]
  script -qec "evo-render r.h5 --size 320x180 -o x.mp4" /dev/null > raw
  [ -s raw ]
  [ "$(tail -c 4 raw)" = $'\r\x1b[K' ]
}

@test "a terminal that knows no colours gets none" {
  needs_terminal
  evo-sample -n 1 --seed 1 > robot.jsonl
  TERM=xterm-256color script -qec "evo-inspect robot.jsonl" /dev/null > coloured
  TERM=dumb script -qec "evo-inspect robot.jsonl" /dev/null > plain
  grep -q $'\e\[' coloured
  if grep -q $'\e\[' plain; then false; fi
}

@test "the figures of README and the documents are what is drawn today" {
  "$EVO_SOURCE/scripts/figures" drawn
  for figure in $(cd drawn && find . -name '*.svg'); do cmp "drawn/$figure" "$EVO_SOURCE/$figure"; done
  [ "$(find drawn -name '*.svg' | wc -l)" -gt 15 ]
}
