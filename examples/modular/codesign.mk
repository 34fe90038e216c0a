# Bodies evolve while one controller learns on all of them:
#
#   make -f examples/modular/codesign.mk RUN=runs/codesign TASK=Walker-v0
#
# Every generation the shared controller trains STEPS steps on the present bodies, starting
# with what it learnt on those before, and what each body earns with it is its fitness. A body
# is safe for its first GRACE generations, since the controller does not know it yet; of the
# others the best stay. CHILDREN of all that stay take the free places. At the end the
# CHAMPIONS best go on alone from the shared controller, for OWN steps each.
# A generation that was interrupted goes on (make again); a run can get more GENERATIONS.

RUN ?= $(error give RUN=folder)
TASK ?= Walker-v0
SEED ?= 1
SHAPE ?= 5x5
POP ?= 64
CHILDREN ?= 16
GRACE ?= 1
GENERATIONS ?= 10
STEPS ?= 262144
CHAMPIONS ?= 4
OWN ?= 131072
TRAIN ?= modular
TRAIN_OPTIONS ?=

seed_of = $(shell echo $$(( 1000 * $(SEED) + $(1) )))
folder = $(RUN)/gen-$(1)
numbers := $(shell seq 0 $$(( $(GENERATIONS) - 1 )))
last := $(call folder,$(lastword $(numbers)))

$(if $(shell [ $(POP) -gt $$(( $(CHILDREN) * ($(GRACE) + 1) )) ] && echo yes),,$(error \
  POP=$(POP) leaves no place for bodies out of grace; more than CHILDREN x (GRACE + 1) are needed))

.DELETE_ON_ERROR:
all: $(RUN)/champions.jsonl

$(call folder,0)/bodies.jsonl:
	@mkdir -p '$(@D)'
	evo-sample -n $(POP) --shape $(SHAPE) --seed $(call seed_of,0) | jq -c '.born = -$(GRACE)' > '$@'

# $(1): a generation; $(2): the one before. The best of those out of grace stay; the founders
# never were in it, since all of them are equally new.
define generation
$(call folder,$(1))/bodies.jsonl: $(call folder,$(2))/scores.jsonl
	@mkdir -p '$$(@D)'
	jq -c 'select(.born > $(2) - $(GRACE))' '$$<' > '$$(@D)/young.tmp'
	jq -c 'select(.born <= $(2) - $(GRACE))' '$$<' | evo-select --keep \
	  $$$$(( $(POP) - $(CHILDREN) - $$$$(wc -l < '$$(@D)/young.tmp') )) -o '$$(@D)/old.tmp'
	cat '$$(@D)/old.tmp' '$$(@D)/young.tmp' > '$$(@D)/stay.tmp'
	cat $(RUN)/gen-*/bodies.jsonl > '$$(@D)/seen.tmp'
	evo-mutate -n $(CHILDREN) --seed $$(call seed_of,$(1)) --avoid '$$(@D)/seen.tmp' '$$(@D)/stay.tmp' | \
	  jq -c '.born = $(1)' > '$$(@D)/children.tmp'
	jq -c 'del(.fitness, .policy, .steps, .task)' '$$(@D)/stay.tmp' | cat - '$$(@D)/children.tmp' > '$$@'
	rm '$$(@D)'/*.tmp
endef
train = evo-train --task $(TASK) --train $(TRAIN) $(TRAIN_OPTIONS) --seed $(SEED) --resume
define learning
$(call folder,$(1))/scores.jsonl: $(call folder,$(1))/bodies.jsonl
	$(train) --steps $(STEPS) --shared '$(call folder,$(1))/shared.policy.h5' \
	  $(if $(2),--init '$(call folder,$(2))/shared.policy.h5') '$$<' -o '$$@'
endef
before = $(if $(filter-out 0,$(1)),$(shell echo $$(( $(1) - 1 ))))
$(foreach g,$(filter-out 0,$(numbers)),$(eval $(call generation,$(g),$(call before,$(g)))))
$(foreach g,$(numbers),$(eval $(call learning,$(g),$(call before,$(g)))))

# Parents are those of bodies, not of controllers: all start from the shared one.
$(RUN)/champions.jsonl: $(last)/scores.jsonl
	evo-select --keep $(CHAMPIONS) '$<' | jq -c 'del(.fitness, .policy, .steps, .task)' | \
	  $(train) --steps $(OWN) --train-set rollout=128 --train-set learning_rate=3e-4 --final-episodes 8 \
	  --init '$(last)/shared.policy.h5' --out-dir '$(RUN)/champions' -o '$@.tmp'
	evo-select '$@.tmp' -o '$@' && rm '$@.tmp'

.PRECIOUS: $(RUN)/%.jsonl
