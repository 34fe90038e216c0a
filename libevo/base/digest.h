// SHA-256, which names robots, marks the settings of trainings and seals files.
#pragma once

#include <string>
#include <string_view>

namespace evo {

// 64 lower-case hex digits.
std::string sha256_hex(std::string_view text);

}  // namespace evo
