# A table of best-so-far against evaluations from all robots of all runs, in the
# order they were evaluated: {task, method, seed, fitness}. Runs of one method
# count as far as the shortest of them goes (NEAT may train a few robots more).

def best_so_far: [foreach .[] as $f (null; if $f != null and (. == null or $f > .) then $f else . end)];
def mean: add / length;
def median: sort | (.[length / 2 | floor] + .[(length - 1) / 2 | floor]) / 2;
def deviation: if length < 2 then 0 else mean as $m | (map(. - $m | . * .) | add) / (length - 1) | sqrt end;

["task", "method", "evaluations", "runs", "mean", "sd", "min", "max", "median"],
(group_by([.task, .method])[]
  | .[0] as {$task, $method}
  | (group_by(.seed) | map(map(.fitness) | best_so_far)) as $runs
  | range($runs | map(length) | min) as $i
  | ($runs | map(.[$i])) as $best
  | select(all($best[]; . != null))
  | [$task, $method, $i + 1, ($runs | length), ($best | mean), ($best | deviation), ($best | min), ($best | max), ($best | median)])
| @tsv
