# Evolution in rounds: the best robots of each are the first generation of the next.
#
#   make -f scripts/rounds.mk RUN=runs/carrier TASK=Carrier-v0 RECIPE=network SEED=1 -j8
#   make -f scripts/rounds.mk RUN=runs/two ROUND_1='POP=16 EVALS=64 STEPS=65536' ROUND_2='POP=4 EVALS=4 STEPS=524288' -j8
#
# Every round is a run of ga.mk of its own, RUN/1, RUN/2, .., that trains its founders anew or, with
# INHERIT=all, goes on from what they have learnt. Longer trainings there spend most steps on the
# robots that short trainings put first; as long ones begin selection afresh, which has become
# strict by the end of a run. Robots are compared within a round only. The report is that of the
# last round.
#
# RECIPE names settings of the rounds, as measured in benchmarks/learning/recipes.md:
#
#   network   36 robots of 65 536 steps (the first twelve 131 072), then the eight best with
#             524 288 and 16 of their children with 262 144: 11 million steps, for walking, pushing and carrying
#   moments   16 sequences of actions of 131 072 steps, then a network along each of the two best,
#             1.4 million: 4.9 million steps, for climbing, stairs and walking; what it makes
#             observes, and keeps its return from perturbed starts
#   long      moments, then four million steps more of its better network, in larger batches;
#             what moments has made goes on so, too
#   easier    a network for the best body of FOUNDERS, 700 000 steps on each of some worlds that
#             are easier (EASIER [those in tasks/easier]), then two million on the task itself:
#             where networks stand in front of what they have to get over
#   sequence  sequences of actions, 100 robots of 131 072 steps, then 90: 25 million, for
#             leaps, stairs and gaps
#   shape     3100 robots of 8 192 steps: 25 million, where a posture decides
#
# ROUND_1, ROUND_2, .. ROUND_9 are settings of ga.mk for one round, instead of the recipe's;
# all others hold for every round. Round n has the seed SEED + n - 1. After an interruption
# the same command continues; other settings need another RUN.

SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.SUFFIXES:
MAKEFLAGS += --no-builtin-rules --no-print-directory

SCRIPTS := $(dir $(lastword $(MAKEFILE_LIST)))
include $(SCRIPTS)command-line.mk

few_changes := MUTATE_OPTIONS='--attempts 1'
lines := TRAIN=lineage INHERIT=yes $(few_changes)
actions := STEPS=131072 TRAIN=sequence INHERIT=yes $(few_changes)
postures := STEPS=8192 TRAIN=sequence INHERIT=yes
network_1 := POP=12 EVALS=36 STEPS=65536 FOUNDER_STEPS=131072 SAMPLE_OPTIONS='--encoding cppn' $(lines)
network_2 := POP=8 EVALS=24 STEPS=262144 FOUNDER_STEPS=524288 $(lines)
moments_1 := POP=8 EVALS=16 SAMPLE_OPTIONS='--weights 0.2,0.02,0.03,0.25,0.5' $(actions)
moments_2 := POP=2 EVALS=2 STEPS=1400000 TRAIN=moments INHERIT=all
long_1 := $(moments_1)
long_2 := $(moments_2)
long_3 := POP=1 EVALS=1 STEPS=4000000 TRAIN=long INHERIT=all
sequence_1 := POP=24 EVALS=100 SAMPLE_OPTIONS='--weights 0.2,0.02,0.03,0.25,0.5' $(actions)
sequence_2 := POP=16 EVALS=90 $(actions)
shape_1 := POP=50 EVALS=2000 $(postures)
shape_2 := POP=25 EVALS=1100 $(postures)

numbers := 1 2 3 4 5 6 7 8 9
after = $(words x $(wordlist 1,$(1),$(numbers)))
ifeq ($(RECIPE),easier)
EASIER ?= $(sort $(basename $(notdir $(wildcard $(SCRIPTS)../tasks/easier/$(TASK)-[1-9].yaml))))
$(if $(EASIER),,$(error there is no easier world for $(TASK) in tasks/easier; give EASIER, tasks by name or file))
$(if $(word 9,$(EASIER)),$(error EASIER is at most eight tasks; TASK itself is the last round))
$(if $(FOUNDERS),,$(error RECIPE=easier is for bodies that are there: give FOUNDERS, a run, a record or a file))
daring := TRAIN=long TRAIN_OPTIONS='--train-set failure_weight=0.2'
$(foreach n,$(wordlist 1,$(words $(EASIER)),$(numbers)),$(eval easier_$n := \
  TASK=$(word $n,$(EASIER)) POP=1 EVALS=1 STEPS=700000 $(daring) $(if $(filter-out 1,$n),INHERIT=all)))
easier_$(call after,$(words $(EASIER))) := POP=1 EVALS=1 STEPS=2000000 INHERIT=all $(daring)
endif
own := $(strip $(foreach n,$(numbers),$(if $(ROUND_$n),$n)))
ifeq ($(own),)
own := $(strip $(foreach n,$(numbers),$(if $($(RECIPE)_$n),$n)))
$(if $(own),,$(error there is no RECIPE '$(RECIPE)'; choose network, moments, long, easier, sequence or shape, or give ROUND_1, ROUND_2, ..))
$(foreach n,$(own),$(eval ROUND_$n = $$($(RECIPE)_$n)))
endif
rounds := $(wordlist 1,$(words $(own)),$(numbers))
$(if $(filter-out $(own),$(rounds)),$(error ROUND_$(firstword $(filter-out $(own),$(rounds))) is missing: rounds are numbered from 1 on))
last := $(lastword $(rounds))
# What a round decides, nobody else does.
decided := $(foreach setting,POP EVALS STEPS FOUNDER_STEPS TRAIN INHERIT SAMPLE_OPTIONS MUTATE_OPTIONS,\
  $(if $(and $(filter command,$(origin $(setting))),$(filter $(setting)=%,$(foreach n,$(rounds),$(ROUND_$n)))),$(setting)))
$(if $(strip $(decided)),$(error $(firstword $(decided)) is decided round by round; give it in ROUND_1, ROUND_2, ..))

.PHONY: all rounds $(rounds:%=round-%)
all: round-$(last)

# What the rounds are called, for those who read their folders.
rounds:
	@echo '$(rounds)'

# One after the other: round n wants round n - 1.
before_1 :=
$(foreach n,$(rounds),$(eval before_$(call after,$n) := $n))
$(foreach n,$(filter-out 1,$(rounds)),$(eval round-$n: round-$(before_$n)))

$(rounds:%=round-%): round-%:
	+@$(MAKE) -f '$(SCRIPTS)ga.mk' RUN='$(RUN)/$*' SEED=$$(( $(SEED) + $* - 1 )) $(ROUND_$*) \
	  $(if $(before_$*),FOUNDERS='$(RUN)/$(before_$*)') $(if $(filter $(last),$*),,'$(RUN)/$*/history.jsonl')
