# How well a training profile does on all tasks, as one number.
#
#   make -f benchmarks/learning/score.mk RUN=runs/score METHODS="default paper sine" -j8
#   make -f benchmarks/learning/score.mk RUN=runs/daily SIZE=daily METHODS="default mine.yaml" -j2
#
# A row is a task and a body, its score
#
#   (return - random) / (paper - random), at most 1.2, mean over seeds,
#
# of the best controller, from the official start and in the mean of perturbed ones ("jittered"),
# where `random` is the mean return of random actions and `paper` what the
# benchmark's paper ends with on this task after 235 to 750 robots (references.tsv).
# A method's score is the mean over rows; the run ends with score.tsv (rows) and
# summary.tsv (methods). Killed and given again it goes on.
#
# SIZE=full: 32 tasks, body A and the published body where bodies.jsonl has it,
# 262 144 steps, 5 seeds. PUBLISHED=FILE.jsonl names more robots by their `task`.
# SIZE=daily: the rows of daily.tsv, 131 072 steps, 2 seeds; about four core minutes per
# method. Each training is one process at low priority when make is (nice -n 10 make ...).
# METHODS: training profiles by name or file, `sine`, `random`, `by-sequence` (scripts/by-sequence).

SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.SUFFIXES:
MAKEFLAGS += --no-builtin-rules --no-print-directory

HERE := $(dir $(lastword $(MAKEFILE_LIST)))
export PATH := $(or $(BIN),$(abspath $(wildcard $(HERE)../../build/release/bin)),/usr/local/bin):$(PATH)

RUN       ?= $(error give RUN=folder, such as RUN=runs/score)
SIZE      ?= full
METHODS   ?= default
PUBLISHED ?=
BODIES    := $(HERE)bodies.jsonl $(PUBLISHED)

ifeq ($(SIZE),daily)
  STEPS ?= 131072
  SEEDS ?= 1 2
  ROWS  ?= $(shell grep -v '^\#' '$(HERE)daily.tsv' | tr '\t' /)
else
  STEPS ?= 262144
  SEEDS ?= 1 2 3 4 5
  tasks := $(shell cut -f 1 '$(HERE)references.tsv' | tail -n +2 | sort -u)
  named := $(shell cat $(BODIES) | jq -r '.task // .name' | sort -u)
  ROWS  ?= $(foreach t,$(tasks),$(t)/A $(if $(filter $(t),$(named)),$(t)/published))
endif

label = $(basename $(notdir $(1)))
TRAININGS := $(foreach m,$(METHODS),$(foreach s,$(SEEDS),$(foreach r,$(ROWS),$(RUN)/$(r)/$(call label,$(m))-$(s))))

.PHONY: all
all: $(RUN)/summary.tsv
	@cat '$<'

task_of = $(firstword $(subst /, ,$(1)))
body_of = $(lastword $(subst /, ,$(1)))
# The program and its options for method $(1), DIR is where its files go.
trainer = $(if $(filter by-sequence,$(1)),$(HERE)../../scripts/by-sequence --out-dir DIR,evo-train $(if \
  $(filter sine random gait,$(1)),--algo $(1),--train '$(1)') -q -j1 --out-dir DIR --failures skip --curve DIR/curve.tsv --resume)

# $(1) row, $(2) method, $(3) seed. The seconds are processor time.
define training
$(RUN)/$(1)/$(call label,$(2))-$(3)/result.json: | $(BODIES)
	@mkdir -p '$$(@D)'
	@TIMEFORMAT=%U; { time cat $(BODIES) | jq -c --arg name '$(if $(filter published,$(call body_of,$(1))),$(call task_of,$(1)),$(call body_of,$(1)))' \
	    'select((.task // .name) == $$$$name) | {format, version, body}' | head -n 1 | \
	  $(subst DIR,'$$(@D)',$(call trainer,$(2))) --task '$(call task_of,$(1))' --seed $(3) --steps $(STEPS) > '$$(@D)/robot.json'; } \
	  2> '$$(@D)/seconds'
	@best=$$$$(jq .fitness '$$(@D)/robot.json'); policy=$$$$(jq -r '.policy // empty' '$$(@D)/robot.json'); \
	[ -z "$$$$policy" ] || best=$$$$(evo-eval -q --seed $(3) --policy '$$(@D)'/"$$$${policy##*/}" '$$(@D)/robot.json' | jq .fitness); \
	jq -c --arg task '$(call task_of,$(1))' --arg body '$(call body_of,$(1))' --arg method '$(call label,$(2))' \
	  --argjson seed $(3) --argjson best "$$$$best" --argjson seconds "$$$$(tail -n 1 '$$(@D)/seconds')" \
	  '{$$$$task, $$$$body, $$$$method, $$$$seed, steps, $$$$best, jittered: .final.mean, $$$$seconds}' \
	  '$$(@D)/robot.json' > '$$@.tmp' && mv '$$@.tmp' '$$@'
endef
$(foreach m,$(METHODS),$(foreach s,$(SEEDS),$(foreach r,$(ROWS),$(eval $(call training,$(r),$(m),$(s))))))

$(RUN)/score.tsv: $(TRAININGS:%=%/result.json) $(HERE)references.tsv
	@cat $(filter %.json,$^) | jq -rs --rawfile references '$(HERE)references.tsv' -f '$(HERE)score.jq' > '$@.tmp' && mv '$@.tmp' '$@'

$(RUN)/summary.tsv: $(RUN)/score.tsv
	@awk -F '\t' 'BEGIN { OFS = "\t"; print "method", "score", "jittered_score", "rows", "core_minutes" } \
	  NR > 1 { n[$$3]++; s[$$3] += $$11; j[$$3] += $$12; c[$$3] += $$5 * $$10 / 60 } \
	  END { for (m in n) print m, sprintf("%.3f", s[m] / n[m]), sprintf("%.3f", j[m] / n[m]), n[m], sprintf("%.1f", c[m]) }' \
	  '$<' | { read -r head; echo "$$head"; sort; } > '$@.tmp' && mv '$@.tmp' '$@'

# What random actions earn: references.tsv again, its `paper` column kept.
.PHONY: references
references:
	@mkdir -p '$(RUN)'
	@printf 'task\tbody\trandom\tpaper\n' > '$(RUN)/references.tsv'
	@tail -n +2 '$(PAPER)' | awk -F '\t' '$$1 == "fig40" { print $$2, $$5 }' | while read -r task paper; do \
	  for body in A published; do \
	    name=$$body; [ $$body = A ] || name=$$task; \
	    robot="$$(cat $(BODIES) | jq -c --arg name "$$name" 'select((.task // .name) == $$name) | {format, version, body}' | head -n 1)"; \
	    [ -n "$$robot" ] || continue; \
	    echo "$$robot" | evo-eval --task "$$task" --random --episodes 16 | \
	      jq -r --arg task "$$task" --arg body $$body --arg paper "$$paper" \
	        '[$$task, $$body, (.fitness * 1000 | round / 1000), $$paper] | @tsv' >> '$(RUN)/references.tsv'; \
	  done; done
