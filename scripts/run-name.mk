# What make cannot have in the name of a folder: it splits names at spaces, and these
# characters mean something to it or to the shell.
open := (
special := ' " \ : ; % * ? [ | ~ $(open)
ifneq ($(word 2,x$(RUN)x),)
$(error RUN='$(RUN)': make cannot work in a folder whose name has spaces; choose another)
endif
$(foreach character,$(special),$(if $(findstring $(character),$(RUN)),\
  $(error RUN='$(RUN)': make cannot work in a folder whose name has $(character) in it; choose another)))
