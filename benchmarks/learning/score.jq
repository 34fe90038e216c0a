# Trainings {task, body, method, seed, steps, best, jittered, seconds} as rows with
# their scores; $references is references.tsv. A training that failed counts as random.
def mean: add / length;
def deviation: if length < 2 then 0 else mean as $m | (map(. - $m | . * .) | add) / (length - 1) | sqrt end;
def round_to($digits): . * pow(10; $digits) | round / pow(10; $digits);

($references | split("\n")[1:] | map(select(. != "") | split("\t")
  | {key: (.[0] + "/" + .[1]), value: {random: .[2] | tonumber, paper: .[3] | tonumber}}) | from_entries) as $of
| ["task", "body", "method", "steps", "seeds", "best", "best_sd", "jittered", "jittered_sd", "cpu_seconds", "score", "jittered_score"],
(group_by([.task, .body, .method])[]
  | $of[.[0].task + "/" + .[0].body] as $ref
  | def score: [(. - $ref.random) / ($ref.paper - $ref.random), 1.2] | min;
    map(.best = (.best // $ref.random) | .jittered = (.jittered // $ref.random))
  | [.[0].task, .[0].body, .[0].method, .[0].steps, length]
    + ([map(.best), map(.jittered)] | map((mean, deviation) | round_to(3)))
    + [map(.seconds) | mean | round_to(1)]
    + [(map(.best | score), map(.jittered | score)) | mean | round_to(3)])
| @tsv
