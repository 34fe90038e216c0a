# Trainings {task, body, method, seed, steps, best, last, jittered, seconds} as a
# table: mean and standard deviation over seeds.
def mean: add / length;
def deviation: if length < 2 then 0 else mean as $m | (map(. - $m | . * .) | add) / (length - 1) | sqrt end;
def round_to($digits): . * pow(10; $digits) | round / pow(10; $digits);

["task", "body", "method", "steps", "seeds", "best", "best_sd", "last", "last_sd", "jittered", "jittered_sd", "cpu_seconds"],
(group_by([.task, .body, .method])[]
  | [.[0].task, .[0].body, .[0].method, .[0].steps, length]
    + ([map(.best), map(.last), map(.jittered)] | map((mean, deviation) | round_to(3)))
    + [map(.seconds) | mean | round_to(1)])
| @tsv
