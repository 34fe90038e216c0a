# Searches for records: every task evolved by one recipe, its best robot made the
# task's record where it beats the one there is.
#
#   nice make -f scripts/records.mk RUN=runs/records SEED=1 -j8
#   nice make -f scripts/records.mk RUN=runs/records TASKS="Thrower-v0 Lifter-v0" EVALS=3000 SEED=2 -j8
#   nice make -f scripts/records.mk RUN=runs/lines TRAIN=lineage POP=16 EVALS=84 STEPS=65536 \
#     FOUNDER_STEPS=131072 SAMPLE_OPTIONS='--encoding cppn' MUTATE_OPTIONS='--attempts 1' -j8
#   nice make -f scripts/records.mk RUN=runs/leaps PIPELINE=rounds RECIPE=sequence TASKS=Jumper-v0 -j8
#
# The recipe is PIPELINE [ga] with any of its settings; without others, bodies and
# open-loop gaits evolve together, 8 million steps per task. After an interruption the same command
# goes on; other settings need another RUN.

SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.SUFFIXES:
MAKEFLAGS += --no-builtin-rules --no-print-directory

SCRIPTS  := $(dir $(lastword $(MAKEFILE_LIST)))
include $(SCRIPTS)command-line.mk
TASKS    ?= $(shell grep -v '^\#' '$(SCRIPTS)../records/published.tsv' | tail -n +2 | cut -f 1)
POP      ?= 25
EVALS    ?= 1000
STEPS    ?= 8000
TRAIN    ?= gait
INHERIT  ?= yes
export POP EVALS STEPS TRAIN INHERIT

# The last of several rounds has the best robot.
ifeq ($(PIPELINE),rounds)
goal :=
over = "$$(printf '%s\n' '$(RUN)/$@'/[1-9] | tail -n 1)"
else
goal = '$(RUN)/$@/history.jsonl'
over = '$(RUN)/$@'
endif

.PHONY: all $(TASKS)
all: $(TASKS)

# Status 73: the record is better.
$(TASKS):
	+@$(MAKE) -s -f '$(SCRIPTS)$(PIPELINE).mk' RUN='$(RUN)/$@' TASK='$@' $(goal)
	@status=0; flock '$(SCRIPTS)../records' '$(SCRIPTS)add-record' $(over) || status=$$?; \
	  [ $$status -eq 0 ] || [ $$status -eq 73 ]
