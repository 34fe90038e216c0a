// The command line that a run was begun with, from the settings it was given.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace evo {

// A word of a shell's command line, quoted where it has to be.
std::string shell_word(const std::string& text);

// "make -f scripts/ga.mk RUN=runs/walker TASK=Walker-v0 ..", quoted for a shell and for
// make. `setting` gives a setting of run.yaml by its name, "" where there is none; what
// the pipelines take by themselves is left out. `variables` are make's, and count in
// place of the run's own; "" leaves one out.
std::string run_command(const std::function<std::string(const std::string&)>& setting,
                        const std::vector<std::pair<std::string, std::string>>& variables);

}  // namespace evo
