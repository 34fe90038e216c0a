// Which of the compiled instruction sets the process uses.
#include "libevo/sim/targets.h"
//
#include <hwy/highway.h>
#include <hwy/targets.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "libevo/base/error.h"
#include "libevo/sim/isa.h"

namespace evo {
namespace {

struct Level {
  const char* name;      // of the psABI, as compilers take it
  std::int64_t targets;  // Highway's targets that this level allows
};

constexpr std::int64_t baseline = HWY_STATIC_TARGET;  // what every processor has
constexpr std::array<Level, 4> levels{{{"x86-64", baseline},
                                       {"x86-64-v2", baseline | HWY_SSE4},
                                       {"x86-64-v3", baseline | HWY_SSE4 | HWY_AVX2},
                                       {"x86-64-v4", baseline | HWY_SSE4 | HWY_AVX2 | HWY_AVX3}}};

// What this processor supports, whatever was selected before.
std::int64_t supported() {
  static const std::int64_t targets = [] {
    hwy::SetSupportedTargetsForTest(0);
    return hwy::SupportedTargets() | baseline;
  }();
  return targets;
}

}  // namespace

std::vector<std::string> available_isas() {
  std::vector<std::string> names;
  for (const Level& level : levels)
    if ((level.targets & ~supported() & HWY_TARGETS) == 0) names.emplace_back(level.name);
  return names;
}

std::string best_isa() { return available_isas().back(); }

void select_isa(const std::string& isa) {
  const std::vector<std::string> available = available_isas();
  std::string list;
  for (const std::string& name : available) list += (list.empty() ? "" : ", ") + name;
  for (const Level& level : levels) {
    if (isa != level.name) continue;
    if ((level.targets & ~supported() & HWY_TARGETS) != 0) break;
    hwy::SetSupportedTargetsForTest(supported() & level.targets);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    return;
  }
  throw error(Failure::usage, "instruction set '{}' is not available here; choose one of: {}{}",
              isa, list, did_you_mean(isa, available));
}

bool has_quick_divider() {
  static const bool quick = [] {
    __builtin_cpu_init();
    return __builtin_cpu_is("amd") != 0;
  }();
  return quick;
}

}  // namespace evo
