# The genetic algorithm of the benchmark, as a pipeline of small tools:
#
#   make -f scripts/ga.mk RUN=runs/walker TASK=Walker-v0 POP=25 EVALS=250 STEPS=512000 SEED=1 -j8
#
# POP robots are sampled and trained; the best of them (a share that shrinks as
# evaluations are used up) survive with their fitness and have mutated children;
# no body is trained twice; the run ends at exactly EVALS trained robots.

METHOD := ga
TRIAL = $(try_founders); \
  $(if $(filter evo-mutate,$(MUTATE)),evo-mutate -n 0 $(MUTATE_OPTIONS);)
first_population = mkdir -p '$(@D)' && $(first_robots)

# A row per generation: generation, robots, created, survivors, children.
plan = $(shell PATH='$(PATH)' evo-select --schedule paper --pop $(POP) --evals $(EVALS) --plan | $(1))
GENERATIONS = $(or $(filter-out 0,$(call plan,sed 1d | wc -l)),$(error no plan for POP=$(POP) EVALS=$(EVALS)))
slots = $(call counting,$(call plan,awk '$$1 == "$(GEN)" { print $$2 }'))

all:

include $(dir $(lastword $(MAKEFILE_LIST)))evolve.mk

$(if $(WINDOW),$(if $(filter evo-mutate,$(MUTATE)),,$(error MUTATE makes the children of generations; WINDOW does without)))

ifdef GEN
ifeq ($(GEN),0)
$(POPULATION):
	@$(first_population)
else
before := $(call plan,awk '$$1 == $(GEN) - 1')
# Survivors keep their fitness and policy; their children are new to the run.
$(POPULATION):
	@mkdir -p '$(@D)'
	@evo-select --schedule paper --pop $(POP) --evals $(EVALS) --evaluated $(word 3,$(before)) \
	  '$(PREVIOUS)/scores.jsonl' -o '$@.survivors.tmp'
	@$(list_seen)
	@$(MUTATE) -n $(word 5,$(before)) --seed $(call stage_seed,$(GEN)) $(MUTATE_OPTIONS) \
	  --avoid '$@.seen.tmp' '$@.survivors.tmp' -o '$@.children.tmp'
	@cat '$@.survivors.tmp' '$@.children.tmp' > '$@.tmp'
	@mv '$@.tmp' '$@' && rm '$@'.*.tmp
endif
endif
