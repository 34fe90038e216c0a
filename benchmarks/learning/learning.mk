# How well and how fast the training profiles and the simple baselines learn:
# every task x body x method x seed is one training; ends with learning.tsv and
# times.tsv.
#
#   make -f benchmarks/learning/learning.mk RUN=runs/learning -j8
#
# Killed and given again it goes on. STEPS is for Walker-v0, OTHER_STEPS for the
# rest. Bodies: those of bodies.jsonl that belong to no task, and the one named
# after the task (the best that the benchmark's authors published for it).

SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.SUFFIXES:
.SECONDARY:
MAKEFLAGS += --no-builtin-rules --no-print-directory

HERE := $(dir $(lastword $(MAKEFILE_LIST)))
export PATH := $(or $(abspath $(wildcard $(HERE)../../build/release/bin)),/usr/local/bin):$(PATH)

RUN         ?= $(error give RUN=folder, such as RUN=runs/learning)
TASKS       ?= Walker-v0 BridgeWalker-v0 Carrier-v0 UpStepper-v0 Climber-v0 Jumper-v0 Balancer-v0 Thrower-v0
METHODS     ?= default paper sine random
SEEDS       ?= 1 2 3 4 5
STEPS       ?= 512000
OTHER_STEPS ?= 65536

bodies = A biped chequered $(1)
TRAININGS := $(foreach task,$(TASKS),$(foreach method,$(METHODS),$(foreach body,$(call bodies,$(task)),\
  $(foreach seed,$(SEEDS),$(RUN)/$(task)/$(body)/$(method)-$(seed)))))

method_options = $(if $(filter sine random,$(1)),--algo $(1),--train $(1))

.PHONY: all
all: $(RUN)/learning.tsv $(RUN)/times.tsv

# $(1) folder of the training, $(2) task, $(3) body, $(4) method, $(5) seed.
# The seconds are processor time.
define training
$(1)/result.json: | $(HERE)bodies.jsonl
	@mkdir -p '$$(@D)'
	@TIMEFORMAT=%U; { time jq -c 'select(.name == "$(3)") | del(.name)' '$(HERE)bodies.jsonl' | \
	  evo-train --task '$(2)' $(call method_options,$(4)) --seed $(5) -q -j1 --out-dir '$$(@D)' \
	    --steps $(if $(filter Walker-v0,$(2)),$(STEPS),$(OTHER_STEPS)) \
	    --curve '$$(@D)/curve.tsv' --resume -o '$$(@D)/robot.json'; } 2> '$$(@D)/seconds'
	@jq -c --arg task '$(2)' --arg body '$(3)' --arg method '$(4)' --argjson seed $(5) \
	  --argjson last "$$$$(tail -n 1 '$$(@D)/curve.tsv' | cut -f 2)" --argjson seconds "$$$$(cat '$$(@D)/seconds')" \
	  '{$$$$task, $$$$body, $$$$method, $$$$seed, steps, best: .fitness, $$$$last, jittered: .final.mean, $$$$seconds}' \
	  '$$(@D)/robot.json' > '$$@.tmp' && mv '$$@.tmp' '$$@'
endef
$(foreach t,$(TASKS),$(foreach m,$(METHODS),$(foreach b,$(call bodies,$(t)),$(foreach s,$(SEEDS),\
  $(eval $(call training,$(RUN)/$(t)/$(b)/$(m)-$(s),$(t),$(b),$(m),$(s)))))))

$(RUN)/learning.tsv: $(TRAININGS:%=%/result.json)
	@cat $^ | jq -rs -f '$(HERE)learning.jq' > '$@.tmp' && mv '$@.tmp' '$@'

# How soon `default` has what `paper` has at its end.
with_curve := $$result[0] + {curve: (split("\n")[1:-1] | \
  map(split("\t") | {step: .[0] | tonumber, best: .[2] | tonumber}))}
$(RUN)/times.tsv: $(RUN)/learning.tsv
	@for folder in $(filter $(foreach seed,$(SEEDS),%/default-$(seed) %/paper-$(seed)),$(TRAININGS)); do \
	  jq -Rsc --slurpfile result "$$folder/result.json" '$(with_curve)' "$$folder/curve.tsv"; \
	done | jq -rs -f '$(HERE)times.jq' > '$@.tmp' && mv '$@.tmp' '$@'
