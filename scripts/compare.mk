# Methods against each other: every method on every task with every seed, each a
# run of its own, then a table and a plot of best-so-far against evaluations.
#
#   make -f scripts/compare.mk RUN=runs/compare TASKS="Walker-v0 Carrier-v0" METHODS="ga neat bo" SEEDS="1 2 3" \
#     POP=25 EVALS=250 STEPS=65536 -j8
#
# Compared are robots: those of a race have fewer steps each, but for its last rungs.
# Runs are $(RUN)/task/method-seed; other settings (TRAIN, PHYSICS, ..) go to all
# of them. After an interruption the same command continues; more SEEDS or METHODS later add to
# what is there. Ends with compare.tsv, compare.svg and compare.html in $(RUN).

SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.SUFFIXES:
MAKEFLAGS += --no-builtin-rules --no-print-directory

SCRIPTS := $(dir $(lastword $(MAKEFILE_LIST)))
include $(SCRIPTS)tools.mk

include $(SCRIPTS)command-line.mk
TASKS ?= Walker-v0

# A method with -window is without generations.
known := ga neat bo map race ga-window neat-window bo-window map-window
unknown := $(filter-out $(known),$(METHODS))
$(if $(unknown),$(error METHODS may be ga, neat, bo, map and race, and ga-window, neat-window, bo-window and map-window, without generations; there is no '$(unknown)'))
# The pipeline of a method.
window := $(or $(WINDOW),$(POP),$(initial_POP))
pipeline_of = '$(SCRIPTS)$(patsubst %-window,%,$(1)).mk' WINDOW=$(if $(filter %-window,$(1)),$(window))

RUNS := $(foreach task,$(TASKS),$(foreach method,$(METHODS),$(foreach seed,$(SEEDS),$(RUN)/$(task)/$(method)-$(seed))))

.PHONY: all list $(RUNS)
all:

# The runs, one a line, each a target of its own: for a scheduler's array.
list:
	@printf '%s\n' $(RUNS)

all: $(RUN)/compare.$(PLOT) $(RUN)/compare.html

# $(1) folder, $(2) task, $(3) method, $(4) seed. Runs go side by side, so none
# of them draws live curves; evo-inspect shows how far one is.
define run
$(1):
	+@$$(MAKE) -s -f $$(call pipeline_of,$(3)) RUN='$(1)' TASK='$(2)' SEED='$(4)'
	@jq -r '"$(2)  $(3)-$(4)  best \(.fitness)"' '$(1)/best.json'
endef
$(foreach task,$(TASKS),$(foreach method,$(METHODS),$(foreach seed,$(SEEDS),\
  $(eval $(call run,$(RUN)/$(task)/$(method)-$(seed),$(task),$(method),$(seed))))))

# task, method, evaluations, runs, mean, sd, min, max, median
$(RUN)/compare.tsv: $(RUNS)
	@for run in $(RUNS); do \
	  name=$${run##*/}; task=$${run%/*}; \
	  jq -c --arg task "$${task##*/}" --arg method "$${name%-*}" --arg seed "$${name##*-}" \
	    '{task: $$task, method: $$method, seed: $$seed, fitness}' "$$run/history.jsonl"; \
	done | jq -rs -f '$(SCRIPTS)compare.jq' > '$@.tmp' && mv '$@.tmp' '$@'

$(RUN)/compare.$(PLOT): $(RUN)/compare.tsv
	@command -v gnuplot > /dev/null || \
	  { echo "compare.$(PLOT) is drawn by gnuplot, which is not here; the table is $<. To install it: apt install gnuplot-nox" >&2; exit 69; }
	@gnuplot -e "table='$<'; picture='$@.tmp'; format='$(PLOT)'" '$(SCRIPTS)compare.gnuplot'
	@[ '$(PLOT)' != svg ] || '$(SCRIPTS)dark-aware' '$@.tmp'
	@mv '$@.tmp' '$@'

$(RUN)/compare.html: $(RUNS)
	@evo-report $(RUNS) -o '$@'
