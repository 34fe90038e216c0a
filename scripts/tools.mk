# Where a pipeline finds the tools: in the folder EVO_BIN, if it is given; in this
# checkout, if it was built; beside this file, if it was installed (PREFIX/share/evo/scripts);
# else in PATH.
built := $(wildcard $(SCRIPTS)../build/release/bin/evo-train $(SCRIPTS)../../../bin/evo-train)
tools := $(or $(EVO_BIN),$(dir $(firstword $(built))))
export PATH := $(if $(tools),$(abspath $(tools)):)$(PATH)
