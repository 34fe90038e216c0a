// What every document begins with, `format` and `version`, and their one check.
#pragma once

#include "formats/io/hdf5.h"
#include "formats/io/node.h"

namespace evo {

struct Format {
  const char* name;
  int version;  // that is written; older ones are read, too
};

// All formats of the suite.
namespace format {
inline constexpr Format robot{"evo/robot", 1};
inline constexpr Format task{"evo/task", 1};
inline constexpr Format physics{"evo/physics", 1};
inline constexpr Format training{"evo/training", 1};
inline constexpr Format neat{"evo/neat", 1};
inline constexpr Format neat_state{"evo/neat-state", 1};
inline constexpr Format run{"evo/run", 1};
inline constexpr Format recipe{"evo/recipe", 1};
inline constexpr Format env{"evo/env", 1};
inline constexpr Format policy{"evo/policy", 1};
inline constexpr Format checkpoint{"evo/checkpoint", 1};
inline constexpr Format rollout{"evo/rollout", 1};
}  // namespace format

// Another format, or a version that this program does not know, is refused with
// its place: Error(data). What people write by hand need not say either; `required` is for what
// programs write, which has to say both.
enum class Head { required, optional };
void check_format(const Node& document, const Format& format, Head head = Head::optional);
void check_format(const hdf5::Reader& file, const Format& format, Head head);

}  // namespace evo
