// The instruction sets that the stepping kernels were compiled for.
#pragma once

#include <string>
#include <vector>

namespace evo {

// Those of this processor, slowest first: "x86-64", "x86-64-v2", "x86-64-v3",
// "x86-64-v4".
std::vector<std::string> available_isas();
std::string best_isa();
// Restricts the process to one of available_isas(); Error(usage) otherwise. Not
// while another thread steps.
void select_isa(const std::string& isa);

// Whether the divider of this processor is quick enough to take all the roots and
// quotients of a register of eight doubles, as AMD's is (26 cycles measured on Zen 4; 40
// where the multipliers had better help).
bool has_quick_divider();

}  // namespace evo
