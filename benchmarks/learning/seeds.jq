# Rows of seeds.tsv as a row per task: means over seeds with half of their 95 % interval, how
# many seeds have the paper's end, $references, or more from perturbed starts.
def mean: add / length;
def deviation: mean as $m | (map(. - $m | . * .) | add) / (length - 1) | sqrt;
# Student's t for 2 to 10 values; beyond, that of ten, which is wide enough.
def half_interval: if length < 2 then null else
  deviation / (length | sqrt) * ([12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262][[length, 10] | min - 2]) end;
def digits: if . == null then "" else . * 1000 | round / 1000 end;

($references | split("\n")[1:] | map(select(. != "") | split("\t") | {key: .[0], value: .[3] | tonumber}) | from_entries) as $paper
| ["task", "seeds", "official", "official_half_interval", "perturbed", "perturbed_half_interval", "best_perturbed", "reached", "paper", "million_steps", "core_minutes"],
([inputs | split("\t") | select(.[0] != "task") | {task: .[0], official: .[3] | tonumber, perturbed: .[4] | tonumber, steps: .[5] | tonumber, seconds: .[6] | tonumber}]
  | group_by(.task)[]
  | .[0].task as $task
  | [$task, length]
    + ([map(.official), map(.perturbed)] | map((mean, half_interval) | digits))
    + [(map(.perturbed) | max | digits), (map(select(.perturbed >= $paper[$task])) | length), $paper[$task],
       (map(.steps) | mean / 1e5 | round / 10), (map(.seconds) | mean / 6 | round / 10)])
| @tsv
