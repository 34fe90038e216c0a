# Three evolutions of walkers on a fixed gait, side by side in a minute or two:
#   make -f examples/experiments.mk -j8
# plain: as far as possible. economical: each actuator costs 0.1. symmetric: the
# same, with children that are the same on both sides.
EXAMPLES := $(dir $(lastword $(MAKEFILE_LIST)))
RUNS ?= runs/examples
POP ?= 12
EVALS ?= 60
SEED ?= 1
GA = +evo-evolve ga -q --run $(RUNS)/$@ --pop $(POP) --evals $(EVALS) --seed $(SEED)

.PHONY: all plain economical symmetric
all: plain economical symmetric
	@for run in $^; do \
	  jq -r --arg run $$run '"\($$run): \(.fitness), \(.actuators) actuators", (.body | join("\n"))' \
	    $(RUNS)/$$run/best.json; done

plain:
	$(GA) --evaluate '$(EXAMPLES)economical 0'
economical:
	$(GA) --evaluate '$(EXAMPLES)economical 0.1'
symmetric:
	$(GA) --evaluate '$(EXAMPLES)economical 0.1' --mutate '$(EXAMPLES)symmetric'
