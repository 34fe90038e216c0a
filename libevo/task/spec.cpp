#include "libevo/task/spec.h"

#include <fmt/format.h>

#include <type_traits>

#include "libevo/base/overloaded.h"

namespace evo {
std::string part_name(const ObservationPart& part) {
  using namespace observation;
  return std::visit(
      Overloaded{
          [](const Velocity& p) { return fmt::format("velocity({})", p.of); },
          [](const Orientation& p) { return fmt::format("orientation({})", p.of); },
          [](const RelativePositions& p) { return fmt::format("relative_positions({})", p.of); },
          [](const Offset& p) { return fmt::format("offset({} from {})", p.of, p.from); },
          [](const Floor& p) { return fmt::format("floor({})", p.width); },
          [](const Ceiling& p) { return fmt::format("ceiling({})", p.width); },
          [](const GoalIndex&) { return std::string("goal_index"); },
          [](const GoalPosition&) { return std::string("goal_position"); },
          [](const GoalOffset&) { return std::string("goal_offset"); },
      },
      part);
}

int part_length(const ObservationPart& part, int points) {
  using namespace observation;
  return std::visit(Overloaded{
                        [](const Velocity&) { return 2; },
                        [](const Orientation&) { return 1; },
                        [&](const RelativePositions&) { return 2 * points; },
                        [](const Offset&) { return 2; },
                        [](const Floor& p) { return 2 * p.width + 1; },
                        [](const Ceiling& p) { return 2 * p.width + 1; },
                        [](const GoalIndex&) { return 1; },
                        [](const GoalPosition&) { return 1; },
                        [](const GoalOffset&) { return 1; },
                    },
                    part);
}

std::string part_object(const ObservationPart& part) {
  return std::visit(
      [](const auto& p) -> std::string {
        if constexpr (requires { p.of; })
          return p.of;
        else
          return "";
      },
      part);
}

}  // namespace evo
