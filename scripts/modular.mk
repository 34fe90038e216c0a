# Bodies evolve while one controller learns on all of them (docs/modular.md), as a pipeline:
#
#   make -f scripts/modular.mk RUN=runs/walker TASK=Walker-v0 POP=64 EVALS=256 STEPS=262144 SEED=1 -j4
#
# Every generation the controller trains STEPS steps on the present robots, beginning with what
# it learnt on those before, and what a robot earns with it is its fitness. Then CHILDREN of all
# that stay take the places of the worst. A new robot is safe for GRACE selections, since the
# controller does not know it yet, and LAYERS keep the old from taking all places (scripts/stay).
# A child starts with its parent's controller as it is, which is that of all. The first
# generation's is a new one or, with INHERIT=all, goes on from that of FOUNDERS, another run or a
# record, which also says which of SCREEN sampled bodies are worth learning on.
#
# The generation after the last has the CHAMPIONS best, each with a training of its own, of
# OWN_STEPS steps, from the controller of all; a launch each, as -j has it. The others have one
# launch, on one core. A robot's steps are those of its own environments.

METHOD := modular
TRIAL = $(if $(screens),evo-sample -n 0 $(SAMPLE_OPTIONS),$(try_founders)); evo-mutate -n 0 $(MUTATE_OPTIONS);
screens = $(filter-out 0,$(SCREEN))
candidates = $(if $(screens),$(screened),$(of_founders))
screened = evo-sample -n $(SCREEN) --shape $(SHAPE) $(SAMPLE_OPTIONS) --seed $(call stage_seed,0) | \
  evo-eval -q --task '$(TASK)' $(if $(filter-out task,$(PHYSICS)),--physics '$(PHYSICS)') --seed $(SEED) \
    --failures skip --policy '$(controller_of_founders)'
controller_of_founders = $(or $(wildcard $(FOUNDERS)/policy.h5),\
  $(lastword $(sort $(wildcard $(FOUNDERS)/policies/gen-*.policy.h5))))
first_count = $(shell echo $$(( $(EVALS) < $(POP) ? $(EVALS) : $(POP) )))
later = $(shell echo $$(( $(EVALS) > $(POP) ? $(EVALS) - $(POP) : 0 )))
# The generations that have one controller, from 0 to this one.
last_shared = $(shell echo $$(( ($(later) + $(CHILDREN) - 1) / $(CHILDREN) )))
GENERATIONS = $(shell echo $$(( $(last_shared) + 1 + ($(CHAMPIONS) > 0) )))
ifdef GEN
TOGETHER = $(shell [ $(GEN) -gt $(last_shared) ] || echo yes)
# Robots that it adds to those of the one before.
born = $(shell left=$$(( $(later) - ($(GEN) - 1) * $(CHILDREN) )); echo $$(( left < $(CHILDREN) ? left : $(CHILDREN) )))
endif
slots = $(call counting,$(call lines_or,$(POPULATION),$(POP)))

all:

include $(dir $(lastword $(MAKEFILE_LIST)))evolve.mk

$(if $(filter yes,$(INHERIT)),$(error INHERIT is no or all in modular.mk, not 'yes': every robot starts with the controller of all))
$(if $(screens),$(if $(controller_of_founders),,\
  $(error SCREEN=$(SCREEN) needs FOUNDERS, a run of modular.mk or a record, whose controller says which bodies are the first)))
$(if $(screens),$(if $(shell [ $(SCREEN) -ge $(first_count) ] && echo yes),,$(error SCREEN=$(SCREEN) is less than POP=$(POP))))
$(if $(FOUNDER_STEPS),$(error FOUNDER_STEPS is no setting of modular.mk: all robots of a generation are trained together))
$(if $(EVALUATE),$(error EVALUATE is no setting of modular.mk: what is not trained has no controller))
$(if $(python_task),$(error TASK=$(TASK): one controller for all robots is for tasks of the suite))
$(if $(shell [ $(POP) -gt $$(( $(CHILDREN) * ($(GRACE) + 1) )) ] && echo yes),,$(error \
  POP=$(POP) leaves no place for robots out of GRACE; more than CHILDREN x (GRACE + 1) are needed, $(shell echo $$(( $(CHILDREN) * ($(GRACE) + 1) )))))

ifdef GEN
$(POPULATION):
	@mkdir -p '$(@D)'
ifeq ($(GEN),0)
	@$(first_robots)
else ifeq ($(TOGETHER),yes)
	@'$(SCRIPTS)stay' '$(RUN)' $(GEN) $$(( $(POP) - $(born) )) $(GRACE) $(LAYERS) > '$@.stay.tmp'
	@$(list_seen)
	@evo-mutate -n $(born) --seed $(call stage_seed,$(GEN)) $(MUTATE_OPTIONS) \
	  --avoid '$@.seen.tmp' '$@.stay.tmp' -o '$@.children.tmp'
	@cat '$@.stay.tmp' '$@.children.tmp' > '$@.tmp'
	@mv '$@.tmp' '$@' && rm '$@'.*.tmp
else
	@jq -c 'select(.fitness != null)' '$(PREVIOUS)/scores.jsonl' | evo-select --keep $(CHAMPIONS) | \
	  jq -c 'del(.fitness, .policy, .task, .behaviour, .final)' > '$@.tmp' && mv '$@.tmp' '$@'
endif
endif
