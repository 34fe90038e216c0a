# The settings of a pipeline: what scripts/settings.tsv says of them, and what the command
# line may say.

pipeline := $(basename $(notdir $(firstword $(MAKEFILE_LIST))))
# Settings of other pipelines that go on to those.
others_rounds := ga
others_compare := ga map race neat bo
others_records := rounds compare $(others_compare)

define line_break


endef
# GNU screen has a variable of this name for every shell.
ifeq ($(origin WINDOW),environment)
WINDOW :=
endif
$(eval $(subst @@,$(line_break),$(shell awk -v pipeline=$(pipeline) -v evolves=$(if $(METHOD),yes) \
  -f '$(SCRIPTS)settings.awk' '$(SCRIPTS)settings.tsv')))

# Whether it is one of some words; a number; a number from 1.
without_digits = $(subst 0,,$(subst 1,,$(subst 2,,$(subst 3,,$(subst 4,,$(subst 5,,$(subst 6,,$(subst 7,,$(subst 8,,$(subst 9,,$(1)))))))))))
is_number = $(if $(and $(filter 1,$(words x$(1)x)),$(filter 0,$(1))$(filter-out 0%,$(1))),$(if $(without_digits),,yes))
must_be_one = $(if $(filter $(words_$(1)),$($(1))),,$(error $(1) is $(either_$(1)), not '$($(1))'))
must_be_number = $(if $(call is_number,$($(1))),,$(error $(1) is a number from 0, not '$($(1))'))
must_be_count = $(if $(filter-out 0,$(if $(call is_number,$($(1))),$($(1)))),,$(error $(1) is a number from 1, not '$($(1))'))

# Make by itself ignores a name that is mistyped, and a long run is not what was asked for.
# Below another makefile the command line is that one's.
ifeq ($(MAKELEVEL),0)
ifneq ($(filter $(pipeline),$(foreach name,$(known),$(owners_$(name)))),)
belongs = $(filter $(pipeline) $(others_$(pipeline)) $(if $(METHOD)$(others_$(pipeline)),all),$(owners_$(1)))
settings := $(foreach name,$(known),$(if $(call belongs,$(name)),$(name)))
parts := GEN GRAPH
given := $(foreach name,$(.VARIABLES),$(if $(filter command,$(origin $(name))),$(name)))
unknown := $(firstword $(filter-out $(settings) $(parts),$(given)))
alike = $(findstring $(1),$(2))$(findstring $(2),$(1))
near := $(strip $(foreach name,$(settings),$(if $(call alike,$(name),$(unknown)),$(name))))
owners := $(if $(unknown),$(patsubst %,%.mk,$(filter-out compare rounds records,$(owners_$(unknown)))))
$(if $(unknown),$(error $(pipeline).mk has no setting $(unknown)$(if $(owners), (a setting of $(owners))); it has $(sort $(or $(near),$(settings)))))
# Shells take apart what has these; options and programs are handed on as they are.
quote := '
plain := $(foreach name,$(filter-out RUN,$(settings)),$(if $(filter options command,$(type_$(name))),,$(name)))
$(foreach name,$(filter $(settings),$(given)),$(if $(findstring $(line_break),$($(name))),\
  $(error $(name) has a line break in it)))
$(foreach name,$(filter $(plain),$(given)),$(if $(findstring $(quote),$($(name))),\
  $(error $(name)=$($(name)) has a quote in it)))
endif
endif
$(checks)

# make help
.PHONY: help
.DEFAULT_GOAL := all
help:
	@evo-run settings $(pipeline)
RUN ?= $(if $(filter help,$(MAKECMDGOALS)),none,$(error give RUN=folder, such as RUN=runs/first))

# What make cannot have in the name of a folder: it splits names at spaces, and these
# characters mean something to it or to the shell.
open := (
special := ' " \ : ; % * ? [ | ~ & < > ` ! $(open)
ifneq ($(word 2,x$(RUN)x),)
$(error RUN='$(RUN)': make cannot work in a folder whose name has spaces; choose another)
endif
$(foreach character,$(special),$(if $(findstring $(character),$(RUN)),\
  $(error RUN='$(RUN)': make cannot work in a folder whose name has $(character) in it; choose another)))
