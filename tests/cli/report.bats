# evo-report: one page about a run, whatever state it is in, or about several.
load helpers

make_run() { "$EVO_SOURCE/tests/report/make-run.sh" "$@"; }
count() { grep -o -- "$1" "$2" | wc -l; }

data_of() { sed -n 's|.*id="data">\(.*\)</script>|\1|p' "$1"; }
# Those with a card and a row in the table.
robots_of() { data_of "$1" | jq -r '.runs["run-1"].robots | keys[]'; }
# The chart of that name, as report.js has it.
chart_of() { data_of "$1" | jq -c --arg key "$(grep -o 'data-chart="[^"]*" data-run="[^"]*" data-name="'"$2"'"' "$1" | cut -d'"' -f2)" '.charts[$key]'; }

@test "a run: every robot in the table, every generation on the sheet, the champion's line" {
  make_run run ga 1 4 8 trained
  evo-report run -o page.html
  robots=$(wc -l < run/history.jsonl)
  [ "$(robots_of page.html | wc -l)" -eq "$robots" ]
  [ "$(count '<li class="generation">' page.html)" -eq 4 ]
  # The lineage, followed here by hand.
  line=0
  id=$(jq -r .id run/best.json)
  while [ -n "$id" ]; do
    line=$((line + 1))
    id=$(jq -r --arg id "$id" 'select(.id == $id) | .parents[0] // empty' run/history.jsonl)
  done
  [ "$(count '<div class="step">' page.html)" -eq "$line" ]
  grep -q "<dd>$(printf %.2f "$(jq .fitness run/best.json)")</dd>" page.html
  for part in 'data:image/svg' 'training steps' 'share of soft voxels' 'data-cast='; do
    grep -q "$part" page.html
  done
}

@test "the same run gives the same bytes, wherever its folder is" {
  make_run here/run ga 1 3 6
  mkdir elsewhere
  cp -r here elsewhere/here
  evo-report here/run -o one.html
  (cd elsewhere && evo-report ./here/run/) > two.html
  cmp one.html two.html
  (cd here/run && evo-report .) > three.html
  evo-report "$PWD/elsewhere/here/run" -o four.html
  cmp three.html four.html
}

@test "the page needs no network and names no folder of this machine" {
  make_run run ga 1 2 6 trained
  evo-report run -o page.html
  lacks '(src|href)="([^#d]|d[^a])' page.html
  lacks '<link|@import|url\([^#]|sourceMappingURL' page.html
  lacks "$PWD" page.html
  grep -q '<td class="wrap">fast.yaml</td>' page.html
}

@test "what comes from files stays text" {
  make_run '<i>run' ga 1 2 6
  evo-report '<i>run' -o page.html
  grep -q '<p class="lead">&lt;i&gt;run: soft robots by ga' page.html
  grep -q 'numbers left the finite ones at \\u003cb>step' page.html
  lacks '<img src=x|<i>run|at <b>step' page.html
}

@test "an unfinished run: settings alone, half a generation, no champion's files" {
  make_run run ga 1 2 6
  mkdir bare half
  cp run/run.yaml bare
  evo-report bare > page.html
  grep -q '<h1>Nothing has been trained yet on Walker-v0</h1>' page.html
  cp -r run/run.yaml run/gen-000 half
  mkdir half/gen-001
  cp run/gen-001/population.jsonl half/gen-001
  for slot in 0 3 4; do
    sed -n "$((slot + 1))p" run/gen-001/scores.jsonl > "half/gen-001/0$slot.json"
  done
  evo-report half > page.html
  grep -q '<li class="generation"><b>1 (3/6)</b>' page.html
  grep -q '>unfinished<' page.html
}

@test "a run in which every training failed" {
  make_run run bo 1 1 4
  jq -c '.fitness = null' run/gen-000/scores.jsonl > failed && mv failed run/gen-000/scores.jsonl
  evo-report run > page.html
  grep -q '<h1>Every training failed on Walker-v0</h1>' page.html
  [ "$(robots_of page.html | wc -l)" -eq 4 ]
}

@test "a replay is the episode, to a hundredth of a voxel, in a few kilobytes" {
  make_run run ga 1 2 6 trained
  evo-report run -o page.html
  id=$(jq -r .id run/best.json)
  data_of page.html | jq -c --arg id "$id" '.runs["run-1"].robots[$id]' > robot.json
  # As its card says.
  eval "$(jq -r '.commands[1]' robot.json | sed 's/runs.run/run/g')" > /dev/null
  /usr/bin/python3 - <<'PY'
import base64, glob, json, zlib
import h5py, numpy as np
replay = json.load(open('robot.json'))['replay']
assert len(replay['packed']) < 60000, len(replay['packed'])
data = zlib.decompress(base64.b64decode(replay['packed']), -15)
numbers, value, shift = [], 0, 0
for byte in data:
    value |= (byte & 127) << shift
    shift += 7
    if byte < 128:
        numbers.append(-(value + 1) // 2 if value & 1 else value // 2)
        value = shift = 0
series = np.array(numbers).reshape(1 + 2 * replay['points'], replay['frames'])
first, slope = series[:, :1], np.cumsum(series[:, 1:], axis=1)
series = np.concatenate([first, first + np.cumsum(slope, axis=1)], axis=1)
episode = h5py.File(glob.glob('*.h5')[0])['episode_0']
steps = episode['rewards'].shape[0]
assert replay['steps'] == steps
at = [min(f * replay['stride'], steps) for f in range(replay['frames'])]
positions = episode['infos']['positions'][()][at] / 0.1
robot = replay['robot']
for axis in (0, 1):
    packed = series[1 + axis:1 + 2 * robot:2].T / replay['scale']
    assert np.abs(packed - positions[:, :robot, axis]).max() < 0.0051
returns = np.concatenate([[0], np.cumsum(episode['rewards'][()])])[at]
assert np.abs(series[0] / 1000 - returns).max() < 0.00051
PY
}

@test "the verdict: what came out, and commands for what is next" {
  make_run run ga 1 4 8
  evo-report run > page.html
  grep -q 'class="card verdict doubt"' page.html  # not over: 1000 robots were asked for
  grep -q '<h1>[0-9.]* on Walker-v0, from [0-9.]*' page.html
  grep -q 'Better, and it is not over' page.html
  grep -q 'evo evolve ga --run run --task Walker-v0 --pop 8 --evals 1000' page.html
  # Nothing is said of a run before its first population is done.
  cp -r run begun && rm -r begun/gen-00[1-9]
  split -l 1 -d --additional-suffix .json <(head -n 2 begun/gen-000/scores.jsonl) begun/gen-000/
  rm begun/gen-000/scores.jsonl
  evo-report begun > page.html
  grep -q 'Just begun' page.html
  grep -q '2 of the first 8 robots are trained' page.html
  # A run in which all robots are alike bad has learnt nothing.
  for scores in run/gen-*/scores.jsonl; do
    jq -c 'if .fitness then .fitness = 0.08 else . end' "$scores" > new && mv new "$scores"
  done
  evo-report run > page.html
  grep -q 'class="card verdict bad"' page.html
  grep -q 'Nothing was learnt' page.html
}

@test "commands name the run's folder and files, wherever they are" {
  make_run "some runs/walker" ga 1 3 6 trained
  evo-report "some runs/walker" -o page.html
  id=$(jq -r .id "some runs/walker/best.json")
  data_of page.html | jq -r --arg id "$id" '.runs["run-1"].robots[$id].commands[]' > commands
  [ "$(head -1 commands)" = "evo-inspect 'some runs/walker/policies/$id.policy.h5'" ]
  bash -c "$(head -1 commands)" | grep -q "$id"
  grep -q "evo-render &#39;some runs/walker/best.rollout.h5&#39; --strip 6" page.html ||
    grep -q "evo-render 'some runs/walker/best.rollout.h5' --strip 6" page.html
}

@test "every fitness of a run has the decimals of the best" {
  make_run run ga 1 1 4
  for scores in run/gen-*/scores.jsonl; do
    jq -c 'if .fitness then .fitness = 6.82649 else . end' "$scores" > new && mv new "$scores"
  done
  evo-report run -o page.html
  grep -q '<h1>6.83 on Walker-v0' page.html
  grep -q '<dd>6.83</dd>' page.html
  # Six digits for the page's scripts to round.
  data_of page.html | jq -e '.runs["run-1"] | .decimals == 2 and ([.robots[].fitness | select(. != null)] | all(. == 6.82649) and length > 0)'
  sed -i 's/6.82649/-0.0682649/' run/gen-*/scores.jsonl
  evo-report run -o page.html
  grep -q '<h1>\xe2\x88\x920.0683 on Walker-v0' page.html || grep -q '<h1>−0.0683 on Walker-v0' page.html
}

@test "the first screen says what this is, in words for anyone" {
  make_run run ga 1 3 6 trained
  evo-report run -o page.html
  grep -q 'This robot was evolved to walk to the right over flat ground: the best of [0-9]* that were tried' page.html
  line() { grep -n "$1" page.html | head -1 | cut -d: -f1; }
  [ "$(line 'This robot was evolved')" -lt "$(line 'class="card verdict')" ]
  [ "$(line 'class="card verdict')" -lt "$(line 'data-name="fitness-by-robots"')" ]
  [ "$(line 'What to do next</h2>')" -gt "$(line 'id="run-1-robots"')" ]
  lacks '<h4' page.html  # from h1 over h2 to h3
}

@test "several runs: methods side by side, repetitions as their median" {
  for seed in 1 2; do make_run "ga-$seed" ga "$seed" 3 6; done
  make_run neat neat 1 3 6
  make_run bo bo 1 2 6
  evo-report ga-1 ga-2 neat bo -o page.html
  chart_of page.html best-so-far-Walker-v0 > chart.json
  jq -e '[.series[].name] == ["ga, median of 2", "ga-1", "ga-2", "neat", "bo"]' chart.json
  # The median of two after the third robot is their mean, the band their range.
  mean=$(for seed in 1 2; do head -3 "ga-$seed/history.jsonl" | jq -s 'map(.fitness // empty) | max'; done | jq -s 'add / 2')
  jq -e --argjson mean "$mean" '.series | map(.y[.x | index(3)]) as $at
    | ($at[0] - $mean | fabs < 1e-3) and .[0].low[.[0].x | index(3)] == ([$at[1], $at[2]] | min)
    and .[0].high[.[0].x | index(3)] == ([$at[1], $at[2]] | max)' chart.json
  [ "$(count '<details id=' page.html)" -eq 4 ]
  data_of page.html | jq -e '[.runs["run-3"].robots[].genes[0]] | all(. > 1)'
}

@test "the answer: medians, effect size, rank test, robots for the same fitness" {
  # Twelve robots each; one run after the other begins a little higher; bo is far ahead.
  for method in ga bo; do
    for seed in 1 2 3 4; do
      make_run "$method-$seed" $method $seed 2 6
      head=$([ $method = bo ] && echo 5 || echo 0)
      for scores in "$method-$seed"/gen-*/scores.jsonl; do
        jq -c --argjson base "$head" --argjson seed "$seed" 'if .fitness then .fitness = $base + $seed / 10 else . end' "$scores" > new && mv new "$scores"
      done
    done
  done
  evo-report ga-? bo-? -o page.html
  grep -q '<h2>Walker-v0: bo finds fitter robots than ga</h2>' page.html
  # Medians of 0.1 to 0.4 and 5.1 to 5.4; all 16 pairs; 2 of 70 orders are as extreme.
  grep -q 'a fitness of 5.25 with bo and 0.25 with ga\.' page.html
  grep -q 'A run of bo beats one of ga in 100 % of all pairs; by chance alone a difference as large comes up with p = 0.029 (rank test)\.' page.html
  grep -q 'To reach a fitness of 0.25, half of the runs of each took: bo 1 robot and ga 1 robot\.' page.html
  grep -q '<b>5.25</b> <small>(5.10 to 5.40)</small>' page.html
  # Three seeds cannot show a difference, however large it is.
  evo-report ga-[123] bo-[123] -o page.html
  grep -q 'Too few runs to tell bo and ga apart' page.html
  grep -q 'compare 4 seeds or more of each' page.html
  # Names of settings are text.
  for seed in 1 2 3 4; do sed 's/^train_options:.*/train_options: "--note <b>x"/' bo-$seed/run.yaml > new && mv new bo-$seed/run.yaml; sed 's/^method: bo/method: ga/' bo-$seed/run.yaml > new && mv new bo-$seed/run.yaml; done
  evo-report ga-? bo-? -o page.html
  lacks '<b>x' page.html
}

@test "every robot of a run can be played" {
  make_run run ga 1 3 6 all
  evo-report run -o page.html
  data_of page.html | jq -e '.runs["run-1"].robots | [.[] | select(.fitness != null)] | length > 8 and all(.replay != null)'
  [ "$(stat -c %s page.html)" -lt 2000000 ]
}

@test "curves: best so far and the quartiles of a generation" {
  make_run run ga 1 3 9
  evo-report run > page.html
  chart_of page.html fitness-by-robots | jq -e --argjson best "$(jq .fitness run/best.json)" '.series[1].y[-1] - $best | fabs < 1e-3'
  # The robots that are new in the generation, here five.
  wanted=$(jq -sc --slurpfile before run/gen-001/scores.jsonl '
    ($before | map(.id)) as $old | map(select(.id | IN($old[]) | not) | .fitness) | sort
    | [.[1], .[2], .[3]]' run/gen-002/scores.jsonl)
  chart_of page.html fitness-by-generation | jq -e --argjson wanted "$wanted" '.series[2]
    | [.low[2], .y[2], .high[2]] | [., $wanted] | transpose | all(.[0] - .[1] | fabs < 1e-3)'
}

@test "the figures: every chart as PDF and CSV, with its caption" {
  make_run run ga 1 3 9
  evo-report run --figures figures
  for name in fitness-by-robots fitness-by-generation family-tree coverage voxels-soft; do
    head -c 4 figures/$name.pdf | grep -qx '%PDF'
    grep -aq /FontFile figures/$name.pdf  # letters, not outlines
    grep -q "^$name.pdf" figures/captions.txt
  done
  grep -aq '/MediaBox \[ 0 0 240.75 ' figures/family-tree.pdf  # points, 85 mm
  [ "$(grep -c '^points,each robot,' figures/fitness-by-robots.csv)" -eq "$(jq -s 'map(select(.fitness)) | length' run/history.jsonl)" ]
  grep -q '^Fitness by generation. Best over all robots' figures/captions.txt
  make_run bo bo 1 2 6
  evo-report run bo --figures both
  [ -s both/best-so-far-Walker-v0.pdf ] && [ -s both/bo-coverage.pdf ]
}

@test "a chart from a table, on axes of powers, as wide as asked for" {
  printf 'look,series,"side, voxels",speed,low,high\nline,"a, b",5,100,90,110\nline,"a, b",20,10,9,12\nstep,c,5,1000\nstep,c,20,10\n' > t.csv
  evo-report --chart t.csv --log xy --width 6in -o chart.svg
  grep -q 'width="576"' chart.svg
  grep -q '>side, voxels</text>' chart.svg && grep -q '>a, b (range)</text>' chart.svg && grep -q '>1000</text>' chart.svg
  grep -q 'prefers-color-scheme: dark' chart.svg
  printf 'look,series,x,y\nline,a,0.00004,0.4\nline,a,0.0003,3\n' > small.csv
  evo-report --chart small.csv --log xy --width 6in -o small.svg
  for tick in 0.5 1 2 '5·10⁻⁵' '10⁻⁴'; do grep -q ">$tick</text>" small.svg; done
  fails_with 2 "parrot" -- evo-report --chart t.csv --width parrot -o chart.svg
  fails_with 2 ".svg or .pdf" -- evo-report --chart t.csv -o chart.png
  fails_with 2 "--log" -- evo-report run --log x
  printf 'look,series,x,y\nline,a,1,2\nline,a,3,0\n' > zero.csv
  evo-report --chart zero.csv --log x -o chart.svg
  fails_with 65 "zero.csv:3: an axis of powers needs values above 0" -- evo-report --chart zero.csv --log y -o chart.svg
  printf 'look,series,x,y\nline,a,1,inf\n' > endless.csv
  fails_with 65 "endless.csv:2: expected numbers" -- evo-report --chart endless.csv -o chart.svg
  echo 'step,c,many,10' >> t.csv
  fails_with 65 "t.csv:6: expected numbers" -- evo-report --chart t.csv -o chart.svg
}

@test "an archive: its elites with their bodies, coverage and QD score" {
  make_run run ga 1 3 9
  sed -i 's/^method: ga/method: map/' run/run.yaml
  echo 'features: actuated:4,rigid:3' >> run/run.yaml
  evo-report run -o page.html
  cells=$(evo-archive --features actuated:4,rigid:3 run/history.jsonl | wc -l)
  score=$(evo-archive --features actuated:4,rigid:3 run/history.jsonl | jq -s 'map(.fitness) | add')
  grep -q "$cells of 12 cells have a robot" page.html
  grep -q "The QD score, the sum of their fitness, is $(printf %.2f "$score")" page.html
  chart_of page.html archive | jq -e --argjson cells "$cells" '.series[0].robots | length == $cells'
}

@test "two thousand robots: a page that loads" {
  make_run run bo 1 1 2000
  evo-report run --robots 2000 -o page.html
  [ "$(stat -c %s page.html)" -lt 1500000 ]
}

@test "of many robots a choice: figures of all, cards of what the page points to" {
  make_run run ga 1 12 12
  robots=$(wc -l < run/history.jsonl)
  evo-report run -o all.html
  evo-report run --robots 10 -o page.html
  shown=$(robots_of page.html | wc -l)
  [ "$shown" -gt 10 ]
  [ "$shown" -lt "$robots" ]
  grep -q "$shown of $robots robots: the fittest" page.html
  # Every link to a robot has its card, and a picture.
  robots_of page.html | sort > cards
  grep -o 'href="#run-1-[0-9a-f]\{12\}"' page.html | sed 's/.*run-1-\(.*\)"/\1/' | sort -u > links
  [ -z "$(comm -23 links cards)" ]
  data_of page.html | jq -e --argjson shown "$shown" '[.charts[].series[].robots // [] | .[] | select(. != null)] | max == $shown - 1'
  grep -q "$(jq -r .id run/best.json)" cards
  # The curve of the best so far steps where it did, generations and tiles are of all.
  for page in all page; do
    chart_of $page.html fitness-by-robots | jq -c '.series[1] | [.x, .y] | transpose as $rows | [$rows[0]] + [range(1; $rows | length)
      | select($rows[.][1] != $rows[. - 1][1]) | $rows[.]]' > $page.steps
    for name in fitness-by-generation coverage; do chart_of $page.html $name | jq -c '[.series[] | .x, .y]'; done > $page.figures
    grep -o '<dl class="tiles">.*' $page.html > $page.tiles
  done
  cmp all.steps page.steps
  cmp all.figures page.figures
  cmp all.tiles page.tiles
  fails_with 2 "--robots" -- evo-report run --robots 0
}

@test "a folder that is not a run is refused" {
  fails_with 66 "missing" -- evo-report missing
  mkdir folder && touch file
  fails_with 65 "folder" "run.yaml" -- evo-report folder
  fails_with 65 "file" -- evo-report file
  echo 'format: evo/neat' > folder/run.yaml
  fails_with 65 "folder/run.yaml:1" "evo/run" -- evo-report folder
  printf 'format: evo/run\nversion: 9\n' > folder/run.yaml
  fails_with 65 "folder/run.yaml:2" "newer" -- evo-report folder
  make_run run ga 1 1 4
  echo '{"body":["HX"]}' >> run/gen-000/scores.jsonl
  fails_with 65 "run/gen-000/scores.jsonl" "X" -- evo-report run
  fails_with 2 "run folder" -- evo-report
}

@test "a run with one controller for all: how it learnt, and every robot moves with it" {
  evo-evolve modular -q --run run --task Walker-v0 --pop 4 --children 1 --evals 5 --steps 1024 --champions 1 \
    --train-options '--train environments=2' --no-video
  evo-report run -o page.html
  grep -q 'id="run-1-controller">The controller of all robots' page.html
  data_of page.html > data.json
  # Two generations, each from an evaluation; the best robot where each ends.
  chart_of page.html controller | jq -e '.series | .[1].x == [1024, 2048] and (.[0].x | length >= 3)'
  # All robots have an episode; those without a training of their own no curve.
  jq -e '.runs["run-1"].robots | (length == 5) and all(.[]; .replay != null)' data.json
  champion=$(jq -r .id run/gen-002/scores.jsonl)
  jq -e --arg champion "$champion" '.runs["run-1"].robots | to_entries
    | all(.[]; (.value.charts.return == null) == (.key != $champion))' data.json
  # A card's commands play the robot it is of.
  other=$(jq -r --arg champion "$champion" 'select(.id != $champion) | .id' run/history.jsonl | tail -n 1)
  jq -e --arg id "$other" '.runs["run-1"].robots[$id].sharing == 1' data.json
  eval "$(jq -r --arg id "$other" '.runs["run-1"].robots[$id].commands[1]' data.json)" |
    jq -e --argjson known "$(jq -c "select(.id == \"$other\")" run/history.jsonl)" '.fitness == $known.fitness'
  [ -s "$other.h5" ]
}
