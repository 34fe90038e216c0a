# CPPN-NEAT as a pipeline: networks that paint bodies are evolved with
# speciation; every robot trained is new to the run.
#
#   make -f scripts/neat.mk RUN=runs/walker-neat TASK=Walker-v0 POP=25 EVALS=250 STEPS=512000 SEED=1 -j8

METHOD := neat
own_settings = $(if $(filter-out default,$(NEAT)),--neat '$(NEAT)')
TRIAL = evo-neat -n $(POP) $(own_settings) --state-out /dev/null;
GENERATIONS = $(call batches,$(EVALS),$(POP))
# Whole populations: EVALS is rounded up to a multiple of POP, as in the benchmark.
# Reproduction may yield a few robots more, all of which are kept.
slots = $(call counting,$(call lines_or,$(POPULATION),$(POP)))

all:

include $(dir $(lastword $(MAKEFILE_LIST)))evolve.mk

ifdef GEN
NEAT_OPTIONS := -n $(POP) --seed $(call stage_seed,$(GEN)) $(own_settings)

# The population's file comes last, so that where it is, the species are too.
ifeq ($(GEN),0)
$(POPULATION):
	@mkdir -p '$(@D)'
	@evo-neat $(NEAT_OPTIONS) --shape $(SHAPE) --state-out '$(@D)/species.json' -o '$@' < /dev/null
else
$(POPULATION):
	@mkdir -p '$(@D)'
	@$(list_seen)
	@evo-neat $(NEAT_OPTIONS) --avoid '$@.seen.tmp' \
	  --state-in '$(PREVIOUS)/species.json' --state-out '$(@D)/species.json' \
	  '$(PREVIOUS)/scores.jsonl' -o '$@'
	@rm '$@.seen.tmp'
endif
endif
