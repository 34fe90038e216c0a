# What each ingredient of the profile moments adds, on the bodies of the records of sequences:
#
#   make -f benchmarks/learning/ladder.mk RUN=runs/ladder SEEDS="1 2 3" -j2
#
# Each has what the one before has, and its own: default; bad ends count a fifth (lineage);
# batches of 32 x 128 steps; starts and judging perturbed; moments of the record's sequence. A
# training per task, ingredient and seed, RUN/TASK/INGREDIENT-SEED. Ends with ladder.tsv, a row per training:
# what its network earns from the official start, and in the mean of 64 starts perturbed by 1e-3
# voxels that nothing was chosen by. Killed and given again it goes on; more SEEDS add to it.

SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.SUFFIXES:
MAKEFLAGS += --no-builtin-rules --no-print-directory

HERE := $(dir $(lastword $(MAKEFILE_LIST)))
include $(HERE)../../scripts/tools.mk

RUN     ?= $(error give RUN=folder, such as RUN=runs/ladder)
TASKS   ?= UpStepper-v0 ObstacleTraverser-v0 GapJumper-v0 Hurdler-v0 PlatformJumper-v0
LADDER  ?= default lineage batches perturbed moments
SEEDS   ?= 1 2 3
RECORDS := $(HERE)../../records/

batches := --train-set environments=32 --train-set minibatches=16 --train-set evaluation_interval=10
options_default   := --train default
options_lineage   := --train lineage
options_batches   := --train lineage $(batches)
options_perturbed := --train moments --train-set moment_share=0
options_moments   := --train moments
# The first three know nothing of the sequence.
sequence = $(if $(filter perturbed moments,$(1)),--init '$(RECORDS)$(2)-sequence/policy.h5')

ROWS := $(foreach seed,$(SEEDS),$(foreach ingredient,$(LADDER),$(foreach task,$(TASKS),$(RUN)/$(task)/$(ingredient)-$(seed)/row.tsv)))

.PHONY: all
all: $(RUN)/ladder.tsv
	@cat '$<'

task_of = $(lastword $(subst /, ,$(dir $(1))))
ingredient_of = $(firstword $(subst -, ,$(notdir $(1))))
seed_of = $(lastword $(subst -, ,$(1)))

$(RUN)/%/row.tsv:
	@mkdir -p '$(@D)'
	@evo-train -q --task $(call task_of,$*) $(options_$(call ingredient_of,$*)) $(call sequence,$(call ingredient_of,$*),$(call task_of,$*)) \
	  --steps 2000000 --seed $(call seed_of,$*) --out-dir '$(@D)' --resume '$(RECORDS)$(call task_of,$*)-sequence/policy.h5' > '$(@D)/trained.json'
	@earns() { evo-eval -q "$$@" '$(@D)'/*.policy.h5 | jq .fitness; }; \
	official=$$(earns); perturbed=$$(earns --seed 990017 --episodes 64 --jitter 1e-3); \
	printf '%s\t%s\t%s\t%.3f\t%.3f\n' $(call task_of,$*) $(call ingredient_of,$*) $(call seed_of,$*) "$$official" "$$perturbed" \
	  > '$@.tmp' && mv '$@.tmp' '$@'

$(RUN)/ladder.tsv: $(ROWS)
	@{ printf 'task\tingredient\tseed\tofficial\tperturbed\n'; cat $^; } > '$@.tmp' && mv '$@.tmp' '$@'
