# What the command line of a pipeline may say.

# The settings of every pipeline, those that some have besides, and what make gives itself.
settings := RUN TASK POP EVALS STEPS FOUNDER_STEPS SEED SHAPE ALGO TRAIN TRAIN_OPTIONS INHERIT PHYSICS EVALUATE \
  VIDEO VIDEO_OPTIONS LAUNCH CHUNK CORES TRIES TRAINER
settings_ga := FOUNDERS SAMPLE_OPTIONS MUTATE MUTATE_OPTIONS
settings_map := FEATURES SAMPLE_OPTIONS MUTATE_OPTIONS
settings_race := RUNGS PARENTS SAMPLE_OPTIONS MUTATE_OPTIONS
settings_neat := NEAT
settings_bo :=
settings_steady := METHOD WINDOW NEAT MUTATE_OPTIONS
settings_rounds := RECIPE $(foreach n,1 2 3 4 5 6 7 8 9,ROUND_$n) $(settings_ga)
settings_compare := TASKS METHODS SEEDS PLOT $(foreach method,ga map race neat steady,$(settings_$(method)))
settings_records := TASKS PIPELINE $(settings_rounds) $(settings_compare)
parts := GEN GRAPH

# Make by itself ignores a name that is mistyped, and a long run is not what was asked for.
# Below another makefile the command line is that one's.
pipeline := $(basename $(notdir $(firstword $(MAKEFILE_LIST))))
ifeq ($(MAKELEVEL),0)
ifneq ($(flavor settings_$(pipeline)),undefined)
settings += $(settings_$(pipeline))
given := $(foreach name,$(.VARIABLES),$(if $(filter command,$(origin $(name))),$(name)))
unknown := $(firstword $(filter-out $(settings) $(parts),$(given)))
alike = $(findstring $(1),$(2))$(findstring $(2),$(1))
near := $(strip $(foreach name,$(settings),$(if $(call alike,$(name),$(unknown)),$(name))))
owners := $(strip $(foreach name,ga map race neat steady,$(if $(filter $(unknown),$(settings_$(name))),$(name).mk)))
$(if $(unknown),$(error $(pipeline).mk has no setting $(unknown)$(if $(owners), (a setting of $(owners))); it has $(sort $(or $(near),$(settings)))))
# Shells take apart what has these; options and programs are handed on as they are.
define line_break


endef
quote := '
plain := $(filter-out RUN %_OPTIONS EVALUATE MUTATE LAUNCH TRAINER ROUND_%,$(settings))
$(foreach name,$(filter $(settings),$(given)),$(if $(findstring $(line_break),$($(name))),\
  $(error $(name) has a line break in it)))
$(foreach name,$(filter $(plain),$(given)),$(if $(findstring $(quote),$($(name))),\
  $(error $(name)=$($(name)) has a quote in it)))
endif
endif

# What make cannot have in the name of a folder: it splits names at spaces, and these
# characters mean something to it or to the shell.
open := (
special := ' " \ : ; % * ? [ | ~ & < > ` ! $(open)
ifneq ($(word 2,x$(RUN)x),)
$(error RUN='$(RUN)': make cannot work in a folder whose name has spaces; choose another)
endif
$(foreach character,$(special),$(if $(findstring $(character),$(RUN)),\
  $(error RUN='$(RUN)': make cannot work in a folder whose name has $(character) in it; choose another)))
