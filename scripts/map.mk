# Quality and diversity (MAP-Elites) as a pipeline: parents are drawn from an archive
# that keeps the fittest robot of every kind, so that what is good in its own way is
# not lost to what is ahead now.
#
#   make -f scripts/map.mk RUN=runs/stairs TASK=UpStepper-v0 POP=25 EVALS=500 STEPS=8000 TRAIN=gait INHERIT=yes SEED=1 -j8
#
# FEATURES are the archive's axes ('evo-archive --help'), of bodies or of how robots
# behave: FEATURES=behaviour.distance:8:0:40,behaviour.aloft:5:0:1. The run ends with the
# usual files and archive.jsonl, the elites by cells; archive.tsv is their map.

METHOD := map
TRIAL = evo-sample -n 0 $(SAMPLE_OPTIONS); evo-mutate -n 0 $(MUTATE_OPTIONS); evo-archive -q --features '$(FEATURES)';
first_population = mkdir -p '$(@D)' && \
  evo-sample -n $(call batch_size,0) --shape $(SHAPE) $(SAMPLE_OPTIONS) --seed $(call stage_seed,0) -o '$@'
GENERATIONS = $(call batches,$(EVALS),$(POP))
slots = $(call counting,$(call batch_size,$(GEN)))

# Trainings measure the behaviours that are asked for.
ifneq ($(findstring behaviour.,$(FEATURES)),)
ifeq ($(EVALUATE)$(filter --behaviour,$(TRAIN_OPTIONS)),)
override TRAIN_OPTIONS += --behaviour
endif
endif

all:

include $(dir $(lastword $(MAKEFILE_LIST)))evolve.mk

ifdef GEN
# Elites stay until a new robot is better.
to_file = $(if $(wildcard $(PREVIOUS)/elites.jsonl),cat elites.jsonl scores.jsonl,$(all_scores))

ifeq ($(GEN),0)
$(POPULATION):
	@$(first_population)
else
$(POPULATION):
	@mkdir -p '$(@D)'
	@cd '$(PREVIOUS)' && $(to_file) | evo-archive -q --features '$(FEATURES)' -o '../$(notdir $(GENERATION))/elites.jsonl'
	@$(list_seen)
	@evo-mutate -n $(call batch_size,$(GEN)) --seed $(call stage_seed,$(GEN)) $(MUTATE_OPTIONS) \
	  --avoid '$@.seen.tmp' '$(@D)/elites.jsonl' -o '$@'
	@rm '$@.seen.tmp'
endif
else
all: $(RUN)/archive.jsonl $(RUN)/archive.tsv

$(RUN)/archive.jsonl: | $(RUN)/history.jsonl
	@evo-archive -q --features '$(FEATURES)' '$(RUN)/history.jsonl' -o '$@'

$(RUN)/archive.tsv: | $(RUN)/history.jsonl
	@evo-archive -q --features '$(FEATURES)' --table '$(RUN)/history.jsonl' -o '$@'
endif
