# The graph of scripts/steady.mk: rules with @@ after each (make's $(shell)
# turns newlines into blanks).
#
#   awk -v run=RUN -v population=25 -v window=25 -v evaluations=250 -v chunk=1 -v finished="0 1" -f steady.awk
#
# A chunk c of a generation has two targets: its robots proposed, P(c), and trained,
# T(c). P(c) follows P(c-1) and those T with scores that its last robot knows; T(c)
# follows P(c); a generation's ranking.tsv follows its T. What is finished has no
# rules any more, and nothing waits for it.

function slots(first, last) {
  if (first == last) return sprintf("%02d", first % population)
  return sprintf("%02d-%02d", first % population, last % population)
}

function folder(generation) { return sprintf("%s/gen-%03d", run, generation) }

function proposed(first, last) { return folder(generation_of(first)) "/" slots(first, last) ".proposed" }

function trained(first, last) {
  return folder(generation_of(first)) "/" slots(first, last) (first == last ? ".json" : ".trained")
}

function rule(target, needs, recipe) { printf "%s:| %s;@$(call %s)@@", target, needs, recipe }

function generation_of(robot) { return int(robot / population) }

function at_most(a, b) { return a < b ? a : b }

# The last robot of the chunk that begins with this one: no chunk crosses a generation.
function chunk_end(first) {
  return at_most(at_most(first + chunk, (generation_of(first) + 1) * population), evaluations) - 1
}

# As known_scores() of libevo/evolve/select.h.
function known(robot) { return robot < population ? 0 : robot < window ? 0 : robot - window }

BEGIN {
  count = split(finished, words)
  for (i = 1; i <= count; i++) done[words[i] + 0] = 1

  previous = ""
  told = 0  # scores of robots before this one are waited for by an earlier P
  for (first = 0; first < evaluations; first = last + 1) {
    last = chunk_end(first)
    generation = generation_of(first)
    needs = previous
    for (; told < known(last); told = chunk_end(told) + 1)
      if (!done[generation_of(told)]) needs = needs " " trained(told, chunk_end(told))
    if (done[generation]) continue
    previous = proposed(first, last)
    rule(previous, needs, "propose," (last + 1))
    rule(trained(first, last), previous, "train," generation "," slots(first, last))
    ready[generation] = ready[generation] " " trained(first, last)
    robots[generation] += last - first + 1
  }
  for (generation = 0; generation * population < evaluations; generation++)
    if (!done[generation])
      rule(folder(generation) "/ranking.tsv", ready[generation], "rank," generation "," robots[generation])
}
