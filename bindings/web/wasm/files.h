// Files where there is no file system: those that the program was given.
#pragma once

#include <map>
#include <string>

namespace evo {

// Texts by path, "tasks/Walker-v0.yaml".
std::map<std::string, std::string>& given_files();

}  // namespace evo
