# Bayesian optimisation as a pipeline: a Gaussian process over voxels proposes
# each batch from all robots scored so far; invalid bodies are never proposed.
#
#   make -f scripts/bo.mk RUN=runs/walker-bo TASK=Walker-v0 POP=25 EVALS=250 STEPS=512000 SEED=1 -j8

METHOD := bo
GENERATIONS = $(call batches,$(EVALS),$(POP))
slots = $(call counting,$(call batch_size,$(GEN)))

all:

include $(dir $(lastword $(MAKEFILE_LIST)))evolve.mk

ifdef GEN
ifeq ($(GEN),0)
# The first design is uniform over the kinds, unlike the other methods' samples.
$(POPULATION):
	@mkdir -p '$(@D)'
	@evo-sample -n $(POP) --shape $(SHAPE) --weights 1,1,1,1,1 --seed $(call stage_seed,$(GEN)) -o '$@'
else
$(POPULATION):
	@mkdir -p '$(@D)'
	@cd '$(PREVIOUS)' && $(all_scores) | evo-suggest -n $(call batch_size,$(GEN)) --seed $(call stage_seed,$(GEN)) \
	  --history - -o '../$(notdir $(GENERATION))/population.jsonl'
endif
endif
