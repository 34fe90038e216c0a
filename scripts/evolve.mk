# What the pipelines share: settings, the run folder, training by slots, the
# final files. A pipeline sets METHOD and GENERATIONS, their number, gives `slots` and a
# rule for $(POPULATION), and includes this file.
#
# With WINDOW there are no generations, but one static graph: robot k is proposed from
# exactly the scores of robots 0 .. k-WINDOW-1, so nobody waits for a generation, and the
# run is the same on one core and on a thousand, in any order of finishing. Robots are filed
# as generations of POP, by number; CHUNK of them are proposed and launched together, which
# changes nothing. The first POP come from `first_population`, where a pipeline has it.
#
# A generation is one recursive make, so that a long run stays as quick as a
# short one. Rules ask only whether a file exists (order-only prerequisites);
# every file appears under its name when it is whole. Killing the run at any
# moment and giving the same command again goes on where it was. What cost steps is
# .PRECIOUS: told to end, make would delete the results of those that are just ending.

# A recipe ends with make, even if make alone is killed.
ifneq ($(wildcard /usr/bin/setpriv),)
SHELL := /usr/bin/setpriv
.SHELLFLAGS := --pdeathsig TERM /bin/bash -eu -o pipefail -c
ends_with_us := setpriv --pdeathsig TERM
else
SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
endif
.SUFFIXES:
MAKEFLAGS += --no-builtin-rules --no-print-directory

SCRIPTS := $(dir $(lastword $(MAKEFILE_LIST)))
include $(SCRIPTS)tools.mk

# 00 01 02 .. for a count
counting = $(shell seq -f %02.0f 0 $$(( $(1) - 1 )))
# How many batches of $(2) hold $(1) evaluations, and the size of batch $(1).
batches = $(shell echo $$(( ($(1) + $(2) - 1) / $(2) )))
batch_size = $(shell left=$$(( $(EVALS) - $(1) * $(POP) )); echo $$(( left < $(POP) ? left : $(POP) )))
# Scores of these generations (FIRST [STEP] LAST), one after the other. Robots in them name
# their policies as seen from a generation's folder: this is to be done in one.
scores_of = seq $(1) | xargs printf '../gen-%03d/scores.jsonl\n' | xargs cat
all_scores = $(call scores_of,0 $$(( $(GEN) - 1 )))
# The ids that children must not have, in a file that is gone with the recipe.
list_seen = '$(SCRIPTS)seen' '$(RUN)' $(GEN) > '$@.seen.tmp'
# The number of lines of a file, or a number where there is none yet.
lines_or = $(if $(wildcard $(1)),$(shell wc -l < '$(1)'),$(2))

# The first robots of a method that may have FOUNDERS, a run, a record or a file: POP of them, or `first_count`.
first_count ?= $(POP)
robot_of_record := {format: "evo/robot", version, id: .robot, body, fitness}
of_founders = $(if $(wildcard $(FOUNDERS)/record.json),jq -c '$(robot_of_record)' '$(FOUNDERS)/record.json',\
  evo-convert --unique '$(FOUNDERS)$(if $(wildcard $(FOUNDERS)/.),/history.jsonl)')
candidates ?= $(of_founders)
best_founders = robots=$$($(candidates)); \
  '$(SCRIPTS)founders' $(first_count) '$(if $(screens),SCREEN=$(SCREEN),$(FOUNDERS))' <<< "$$robots"
unscored = jq -c '{format, version, id, body}'
first_robots = $(if $(FOUNDERS),$(best_founders) | $(unscored) > '$@.tmp' && mv '$@.tmp' '$@',\
    evo-sample -n $(first_count) --shape $(SHAPE) $(SAMPLE_OPTIONS) --seed $(call stage_seed,0) -o '$@')
try_founders = $(if $(FOUNDERS),$(check_founders),evo-sample -n 0 $(SAMPLE_OPTIONS))
check_founders = [ '$(INHERIT)' != all ] || [ -d '$(FOUNDERS)/policies' ] || [ -e '$(FOUNDERS)/policy.h5' ] || \
    { echo '$(FOUNDERS): has no policies to go on from; INHERIT=yes trains founders anew' >&2; exit 66; }; \
  $(best_founders)

SETTINGS = method=$(METHOD) $(METHOD_SETTINGS)
include $(SCRIPTS)command-line.mk
# A task may be a class in Python, FILE.py:CLASS: a program that stands as EVALUATE trains in it.
python_task := $(if $(EVALUATE),,$(if $(findstring .py:,$(TASK)),'$(SCRIPTS)python-task' '$(TASK)'))
train_in_python := $(python_task) --run '$(RUN)' --steps $(STEPS) --seed $(SEED) --train '$(TRAIN)' \
  --failures skip $(TRAIN_OPTIONS)
evaluate := $(or $(EVALUATE),$(if $(python_task),$(train_in_python)))
$(if $(python_task),$(if $(VIDEO_OPTIONS),$(error VIDEO_OPTIONS are of evo-render, which knows no task in Python)))
# The tool that trains slots; scripts/train-slots says what it is given.
TRAINER ?= $(if $(evaluate),$(SCRIPTS)evaluate-slots,evo-run train -j $(CORES))
# Whether a generation is one training of all its robots, which a pipeline says.
ifeq ($(origin TOGETHER),environment)
TOGETHER :=
endif
export LAUNCH TRAINER TRIES TOGETHER
train_slots = exec '$(SCRIPTS)train-slots' '$(RUN)'
rank_generation = '$(SCRIPTS)rank' '$(RUN)'

$(if $(filter all,$(INHERIT)),$(if $(FOUNDERS),,$(error INHERIT=all is for FOUNDERS that have controllers)))
# Given as it is, quotes and all.
export EVO_EVALUATE := $(evaluate)

BEST := $(RUN)/best.json $(if $(EVALUATE),,$(RUN)/best.policy.h5 $(RUN)/best.$(VIDEO) \
  $(if $(python_task),,$(RUN)/report.html))

# One seed per purpose and generation.
stage_seed = $$(( $(SEED) * 1000000 + $(1) ))

ifneq ($(WINDOW),)
GENERATIONS = $(call batches,$(EVALS),$(POP))
all_generations = $(make_part) GRAPH=yes graph
$(if $(shell [ '$(CHUNK)' -le '$(WINDOW)' ] && echo yes),,\
  $(error CHUNK is a number from 1 to WINDOW, which is $(WINDOW), not '$(CHUNK)'))
endif

ifdef GRAPH
# ---- the robots of a run without generations ---------------------------------

ifneq ($(strip $(first_population)),)
founders := $(RUN)/gen-000/population.jsonl
$(founders):
	@$(first_population)
endif

# Proposals of robots 0 .. $(1)-1 are quick and stay here, one after another.
propose = mkdir -p '$(@D)' && evo-run propose '$(RUN)' --robots $(1) && : > '$@'

# Generation $(1), slots $(2)
train = $(train_slots) $(1) $(2)

# Generation $(1) of $(2) robots is over: one file each instead of several per robot.
rank = slots=$$(seq -f '$(@D)/%02.0f.json' 0 $$(( $(2) - 1 ))) && \
  cat $$slots > '$(@D)/scores.jsonl.tmp' && mv '$(@D)/scores.jsonl.tmp' '$(@D)/scores.jsonl' && \
  $(rank_generation) $(1) && rm -f $$slots '$(@D)'/*.proposed '$(@D)'/*.trained '$(@D)'/*.tmp

$(eval $(subst @@,$(line_break),$(shell PATH='$(PATH)' evo-run plan '$(RUN)' \
  pop=$(POP) evals=$(EVALS) window=$(WINDOW) chunk=$(CHUNK) | sed 's/$$/@@/')))

.PHONY: graph
graph: | $(shell printf '$(RUN)/gen-%03d/ranking.tsv ' $$(seq 0 $$(( $(GENERATIONS) - 1 ))))

else ifndef GEN
# ---- the whole run -----------------------------------------------------------

.PHONY: all generations
all: $(BEST)
	$(if $(dry_run)$(silent),,@printf 'made: %s\n' $(BEST) >&2)

# The letters stand in the first word; without any, that is an option with dashes.
letters := $(filter-out -%,$(firstword $(MAKEFLAGS)))
dry_run := $(findstring n,$(letters))
silent := $(findstring s,$(letters))

# One tool watches all trainings and alone writes about them, a line a
# generation, live curves on a terminal; `make -s` does without.
watch := env -u MAKELEVEL evo-inspect --watch '$(RUN)' >&2 & \
  watcher=$$!; trap 'kill $$watcher 2> /dev/null && wait $$watcher || true' EXIT;

# One make at a time works on a run. The system takes the lock away however the shell
# that holds it ends; where files cannot be locked there is none, and no result needs it.
alone := { exec 200<> '$(RUN)/run.yaml'; } 2> /dev/null || true; \
  flock -w 10 -E 99 200 2> /dev/null || [ $$? -ne 99 ] || \
  { echo '$(RUN): another make is at work on this run; give the command again when it has ended' >&2; exit 1; };

# First the population, then its slots, whose number it may decide.
make_part = $(ends_with_us) $(MAKE) -f $(firstword $(MAKEFILE_LIST))
all_generations ?= for ((gen = 0; gen < $(GENERATIONS); gen++)); do \
	  folder=$$(printf '$(RUN)/gen-%03d' $$gen); \
	  [ -e "$$folder/ranking.tsv" ] || { \
	    $(if $(dry_run),,$(make_part) -s GEN=$$gen "$$folder/population.jsonl" &&) \
	    $(make_part) GEN=$$gen "$$folder/ranking.tsv"; } || exit; \
	done
generations: | $(RUN)/run.yaml
	+@$(if $(dry_run),,$(alone)) { $(if $(dry_run)$(silent),,$(watch)) $(all_generations); } 200>&-

# Every setting of the run. A changed one is refused, never mixed in. Options that a tool
# is given only later, generations later perhaps, are tried before the run keeps them:
# TRIAL is what the method does for that, without making a robot.
$(RUN)/run.yaml: FORCE
	@[ -e '$@' ] || { evo-sample -n 0 --shape '$(SHAPE)'; $(TRIAL) $(if $(python_task),$(train_in_python);) } < /dev/null > /dev/null
	@evo-run init '$(RUN)' $(SETTINGS)
FORCE:

$(RUN)/history.jsonl: | generations
	@cd '$(RUN)/gen-000' && $(call scores_of,0 $$(( $(GENERATIONS) - 1 ))) | evo-convert --unique -o ../history.jsonl

$(RUN)/best.json: | $(RUN)/history.jsonl
	@evo-select --keep 1 '$(RUN)/history.jsonl' -o '$@'

$(RUN)/best.policy.h5: | $(RUN)/best.json
	@cp '$(RUN)/'"$$(jq -r .policy '$(RUN)/best.json')" '$@.tmp' && mv '$@.tmp' '$@'

$(RUN)/best.rollout.h5: | $(RUN)/best.policy.h5
	@evo-eval --policy '$(RUN)/best.policy.h5' --seed $(SEED) --rollout '$@' '$(RUN)/best.json' > /dev/null

$(RUN)/best.$(VIDEO): | $(RUN)/best.$(if $(python_task),policy,rollout).h5
	$(if $(dry_run)$(silent),,@echo 'rendering $@...' >&2)
	@$(if $(python_task),$(python_task) --video '$(RUN)/best.policy.h5' '$@',\
	  evo-render '$(RUN)/best.rollout.h5' $(VIDEO_OPTIONS) -o '$@')

$(RUN)/report.html: | $(RUN)/best.$(VIDEO)
	@evo-report '$(RUN)' -o '$@'

else
# ---- one generation ----------------------------------------------------------

# However many came before: of those it reads no file but of the previous one.
folder_of = $(shell printf '$(RUN)/gen-%03d' $$(( $(1) )))
GENERATION := $(call folder_of,$(GEN))
PREVIOUS := $(if $(filter-out 0,$(GEN)),$(call folder_of,$(GEN) - 1))
POPULATION := $(GENERATION)/population.jsonl
SLOTS := $(foreach slot,$(slots),$(GENERATION)/$(slot).json)

# Slots by launches: 07.json, or 05-09.trained for several.
launched := $(if $(TOGETHER),$(words $(slots)),$(CHUNK))
ifeq ($(launched),1)
TRAINED := $(SLOTS)
else
TRAINED := $(shell awk -v n=$(words $(slots)) -v size='$(launched)' -v folder='$(GENERATION)' 'BEGIN { \
  for (first = 0; first < n; first = last + 1) { last = (first + size < n ? first + size : n) - 1; \
    printf first == last ? "%s/%02d.json " : "%s/%02d-%02d.trained ", folder, first, last } }')
endif

.PRECIOUS: $(SLOTS) $(TRAINED) $(GENERATION)/ranking.tsv

# The robots of one launch, trained as run.yaml says.
$(TRAINED): | $(POPULATION)
	@$(train_slots) $(GEN) $(basename $(@F))

$(GENERATION)/scores.jsonl: | $(TRAINED)
	@cd '$(@D)' && seq -f %02.0f.json 0 $$(( $(words $(slots)) - 1 )) | xargs -r cat > '$(@F).tmp' && mv '$(@F).tmp' '$(@F)'

$(GENERATION)/ranking.tsv: | $(GENERATION)/scores.jsonl
	@$(rank_generation) $(GEN)
endif
