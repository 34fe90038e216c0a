# Trainings {task, body, method, seed, steps, seconds, curve: [{step, best}]} as a
# table: what `paper` earns, its best evaluation in the mean over seeds, and when the
# same mean of `default` gets there; "-" where it does not.
def mean: add / length;
def round_to($digits): . * pow(10; $digits) | round / pow(10; $digits);
def of($method): map(select(.method == $method));

["task", "body", "paper_best", "paper_cpu_seconds", "default_steps", "default_cpu_seconds"],
(group_by([.task, .body])[]
  | (of("paper") | map(.curve[-1].best) | mean) as $goal
  | (of("default") | map(.curve) | transpose
     | map({step: .[0].step, best: (map(.best) | mean)} | select(.best >= $goal)) | first) as $there
  | [.[0].task, .[0].body, ($goal | round_to(3)), (of("paper") | map(.seconds) | mean | round_to(1))]
    + if $there == null then ["-", "-"]
      else [$there.step, (of("default") | map(.seconds * $there.step / .steps) | mean | round_to(1))] end)
| @tsv
