# Races between trainings, as a pipeline: steps go where they pay.
#
#   make -f scripts/race.mk RUN=runs/race TASK=UpStepper-v0 POP=32 RUNGS=3 EVALS=96 STEPS=262144 INHERIT=yes SEED=1 -j8
#
# POP robots start. The better half of them goes on to twice the steps, the better half of
# those again, until RUNGS rungs are done and the last few have had STEPS; successive
# halving (Jamieson and Talwalkar 2016). Then POP children of the PARENTS best robots that any
# race took to the end start the next race, until EVALS robots have. So only robots of
# equal maturity are compared, and a child has a race of its own before it meets its elders.
#
# A rung is a generation of the run. A training that goes on is one training: what an
# interruption and --resume do, with the policy of the shorter one beside it meanwhile.

METHOD := race
PARENTS ?= $(shell echo $$(( ($(POP) + 7) / 8 )))
TRIAL = evo-sample -n 0 $(SAMPLE_OPTIONS); evo-mutate -n 0 $(MUTATE_OPTIONS);
GENERATIONS = $(shell echo $$(( $(call batches,$(EVALS),$(POP)) * $(RUNGS) )))
# As many as the population has: of trainings that failed none goes on.
slots = $(call counting,$(call lines_or,$(POPULATION),0))

all:

include $(dir $(lastword $(MAKEFILE_LIST)))evolve.mk

$(if $(FOUNDER_STEPS),$(error FOUNDER_STEPS is no setting of race.mk: every race has the same rungs))
$(if $(EVALUATE),$(error EVALUATE is no setting of race.mk: what is not trained cannot go on))
$(if $(python_task),$(error TASK=$(TASK): trainings in Python cannot go on, which races need))

ifdef GEN
race := $(shell echo $$(( $(GEN) / $(RUNGS) )))
rung := $(shell echo $$(( $(GEN) % $(RUNGS) )))
entrants = $(call batch_size,$(race))
scored = jq -c 'select(.fitness != null)'
best_of = $(1) | $(scored) | evo-select --keep $(PARENTS) -o '../$(notdir $(GENERATION))/$(2)'
# The last rung of every race before, or of the one before with the best of the others.
parents_before := $(notdir $(if $(filter-out 0,$(race)),$(call folder_of,$(GEN) - $(RUNGS))))/parents.jsonl
ended = $(if $(wildcard $(RUN)/$(parents_before)),cat '../$(parents_before)' scores.jsonl,\
  $(call scores_of,$$(( $(RUNGS) - 1 )) $(RUNGS) $$(( $(GEN) - 1 ))))

$(POPULATION):
	@mkdir -p '$(@D)'
ifneq ($(rung),0)
	@half=$$(( ($$(wc -l < '$(PREVIOUS)/population.jsonl') + 1) / 2 )); \
	  $(scored) '$(PREVIOUS)/scores.jsonl' | evo-select --keep $$half | \
	  jq -c 'del(.fitness, .task, .steps, .policy, .final, .behaviour)' > '$@.tmp'
	@for id in $$(jq -r .id '$(PREVIOUS)/population.jsonl'); do \
	  grep -q "\"id\":\"$$id\"" '$@.tmp' || rm -f "$(RUN)/policies/$$id.checkpoint.h5"; done
	@mv '$@.tmp' '$@'
else ifeq ($(race),0)
	@evo-sample -n $(entrants) --shape $(SHAPE) $(SAMPLE_OPTIONS) --seed $(call stage_seed,$(GEN)) -o '$@'
else
	@cd '$(PREVIOUS)' && $(call best_of,$(ended),parents.jsonl)
	@cd '$(PREVIOUS)' && if [ -s '../$(notdir $(GENERATION))/parents.jsonl' ]; then \
	  cp '../$(notdir $(GENERATION))/parents.jsonl' '../$(notdir $(GENERATION))/parents.tmp'; else \
	  $(call best_of,$(all_scores),parents.tmp); fi
	@$(list_seen)
	@evo-mutate -n $(entrants) --seed $(call stage_seed,$(GEN)) $(MUTATE_OPTIONS) \
	  --avoid '$@.seen.tmp' '$(@D)/parents.tmp' -o '$@'
	@rm '$@.seen.tmp' '$(@D)/parents.tmp'
endif
endif
