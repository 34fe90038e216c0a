# Evolution without generations, as one static graph. Robot k is proposed from
# exactly the scores of robots 0 .. k-W-1, so nobody waits for a generation, and the
# run is the same on one core and on a thousand, in any order of finishing:
#
#   make -f scripts/steady.mk METHOD=ga RUN=runs/walker TASK=Walker-v0 POP=25 EVALS=250 STEPS=512000 SEED=1 -j8
#
# METHOD is ga, neat or bo. WINDOW, W, is how many robots may be in training [POP]:
# at least the cores there are, or some of them wait. The robots are filed as
# generations of POP, by number. CHUNK robots are proposed and launched together
# [1], at most WINDOW of them; the result does not depend on it.

METHOD ?= ga
WINDOW ?= $(POP)
METHOD_SETTINGS = layout=steady
TRIAL = $(if $(filter ga,$(METHOD)),evo-mutate -n 0 $(MUTATE_OPTIONS);) \
  $(if $(filter neat,$(METHOD)),evo-neat -n $(POP) $(if $(filter-out default,$(NEAT)),--neat '$(NEAT)') --state-out /dev/null;)
GENERATIONS = $(call batches,$(EVALS),$(POP))
all_generations = $(make_part) GRAPH=yes graph

all:

include $(dir $(lastword $(MAKEFILE_LIST)))evolve.mk
SETTINGS := $(filter-out $(if $(filter neat,$(METHOD)),,neat=%) $(if $(filter ga,$(METHOD)),,mutate_options=''),$(SETTINGS))

$(if $(filter ga neat bo,$(METHOD)),,$(error METHOD may be ga, neat or bo; there is no '$(METHOD)'))
$(if $(shell [ '$(CHUNK)' -le '$(WINDOW)' ] && echo yes),,\
  $(error CHUNK is a number from 1 to WINDOW, which is $(WINDOW), not '$(CHUNK)'))

ifdef GRAPH
define newline


endef
finished := $(patsubst $(RUN)/gen-%/ranking.tsv,%,$(wildcard $(RUN)/gen-*/ranking.tsv))

# Proposals of robots 0 .. $(1)-1 are quick and stay here, one after another.
propose = mkdir -p '$(@D)' && evo-run propose '$(RUN)' --robots $(1) && : > '$@'

# Generation $(1), slots $(2)
train = $(train_slots) $(1) $(2)

# Generation $(1) of $(2) robots is over: one file each instead of several per robot.
rank = slots=$$(seq -f '$(@D)/%02.0f.json' 0 $$(( $(2) - 1 ))) && \
  cat $$slots > '$(@D)/scores.jsonl.tmp' && mv '$(@D)/scores.jsonl.tmp' '$(@D)/scores.jsonl' && \
  $(rank_generation) $(1) && rm -f $$slots '$(@D)'/*.proposed '$(@D)'/*.trained '$(@D)'/*.tmp

$(eval $(subst @@,$(newline),$(shell awk -v run='$(RUN)' -v population='$(POP)' -v window='$(WINDOW)' \
  -v evaluations='$(EVALS)' -v chunk='$(CHUNK)' -v finished='$(finished)' -f '$(SCRIPTS)steady.awk')))

.PHONY: graph
graph: | $(shell printf '$(RUN)/gen-%03d/ranking.tsv ' $$(seq 0 $$(( ($(EVALS) - 1) / $(POP) ))))
endif
