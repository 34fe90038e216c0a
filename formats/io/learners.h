// Files that trainings in Python leave behind, which are told apart and not read.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace evo {

// What bytes (or the beginning and end of them) are, if they are a model of
// Stable-Baselines3, a file of PyTorch or a pickle, and what makes a policy file of it.
std::optional<std::string> learner_file(std::string_view bytes);

// Throws Error(data) for such a file; everything else is left to who reads it.
void refuse_learner_file(const std::filesystem::path& path);

}  // namespace evo
