// Bytes as text.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace evo {

std::string base64(std::string_view bytes);
// Nothing unless it is base64.
std::optional<std::vector<std::uint8_t>> from_base64(std::string_view text);

}  // namespace evo
