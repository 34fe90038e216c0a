# What to expect of a recipe of scripts/rounds.mk, where records are the best of many tries: every
# task with several seeds.
#
#   make -f benchmarks/learning/seeds.mk RUN=runs/seeds RECIPE=moments SEEDS="1 2 3 4 5" -j2
#
# A run per task and seed, RUN/TASK-SEED. Ends with seeds.tsv, a row per run: what its best robot
# earns from the official start, and in the mean of 64 starts perturbed by 1e-4 voxels that
# nothing was chosen by; and with summary.tsv, a row per task: means over seeds with half of
# their 95 % interval (Student's t), how many seeds have the paper's end or more from perturbed
# starts, and that end (references.tsv). Killed and given again it goes on; more SEEDS add to it.

SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.SUFFIXES:
MAKEFLAGS += --no-builtin-rules --no-print-directory

HERE := $(dir $(lastword $(MAKEFILE_LIST)))
SCRIPTS := $(HERE)../../scripts/
include $(SCRIPTS)tools.mk

RUN    ?= $(error give RUN=folder, such as RUN=runs/seeds)
RECIPE ?= moments
TASKS  ?= Walker-v0 Pusher-v0 Carrier-v0 UpStepper-v0 DownStepper-v0 ObstacleTraverser-v0 Climber-v0 Jumper-v0
SEEDS  ?= 1 2 3 4 5
# Runs get what stands in their command, and nothing that was given to this make.
MAKEOVERRIDES :=

ROWS := $(foreach seed,$(SEEDS),$(foreach task,$(TASKS),$(RUN)/$(task)-$(seed)/$(RECIPE).tsv))

.PHONY: all
all: $(RUN)/summary.tsv
	@cat '$<'

task_of = $(patsubst %-$(lastword $(subst -, ,$(1))),%,$(1))
seed_of = $(lastword $(subst -, ,$(1)))

$(RUN)/%/$(RECIPE).tsv:
	+@$(MAKE) -s -f '$(SCRIPTS)rounds.mk' RUN='$(@D)' TASK='$(call task_of,$*)' SEED='$(call seed_of,$*)' RECIPE='$(RECIPE)' VIDEO=apng
	@rounds=$$($(MAKE) -s -f '$(SCRIPTS)rounds.mk' RUN='$(@D)' TASK='$(call task_of,$*)' RECIPE='$(RECIPE)' rounds); \
	cd '$(@D)'; last=$${rounds##* }; best=$$last/best.json; \
	official=$$(evo-eval -q --seed $(call seed_of,$*) --policy "$$last/best.policy.h5" "$$best" | jq .fitness); \
	perturbed=$$(evo-eval -q --seed 990017 --episodes 64 --jitter 1e-4 --policy "$$last/best.policy.h5" "$$best" | jq .fitness); \
	steps=$$(for round in $$rounds; do cat "$$round/history.jsonl"; done | jq -s 'map(.steps) | add'); \
	seconds=$$(for round in $$rounds; do cat "$$round"/timings/*.jsonl; done | jq -s 'map(.seconds) | add | round'); \
	printf '%s\t%s\t%s\t%.3f\t%.3f\t%s\t%s\n' '$(call task_of,$*)' '$(call seed_of,$*)' '$(RECIPE)' "$$official" "$$perturbed" \
	  "$$steps" "$$seconds" > '$(@F).tmp' && mv '$(@F).tmp' '$(@F)'

$(RUN)/seeds.tsv: $(ROWS)
	@{ printf 'task\tseed\trecipe\tofficial\tperturbed\tsteps\tseconds\n'; cat $^; } > '$@.tmp' && mv '$@.tmp' '$@'

$(RUN)/summary.tsv: $(RUN)/seeds.tsv $(HERE)references.tsv
	@jq -rR -n --rawfile references '$(HERE)references.tsv' -f '$(HERE)seeds.jq' '$<' > '$@.tmp' && mv '$@.tmp' '$@'
