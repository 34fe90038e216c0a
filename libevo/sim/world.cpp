#include "libevo/sim/world.h"

#include <fmt/format.h>

#include <map>
#include <set>
#include <utility>

namespace evo {

std::optional<WorldDefect> defect(const World& world) {
  std::set<std::string> names;
  std::map<std::pair<int, int>, const Object*> owners;
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    const auto& [name, body, x, y] = world.objects[i];
    if (!names.insert(name).second)
      return WorldDefect{i, fmt::format("two objects are named '{}'", name)};
    if (x < 0 || y < 0)
      return WorldDefect{
          i, fmt::format("object '{}' lies at cell ({}, {}); cells count from 0", name, x, y)};
    for (int row = 0; row < body.rows; ++row) {
      for (int col = 0; col < body.cols; ++col) {
        if (body.at(row, col) == Voxel::empty) continue;
        const std::pair cell{x + col, y + body.rows - 1 - row};
        if (const auto [owner, free] = owners.emplace(cell, &world.objects[i]); !free)
          return WorldDefect{i, fmt::format("objects '{}' and '{}' overlap at cell ({}, {})",
                                            owner->second->name, name, cell.first, cell.second)};
      }
    }
  }
  return std::nullopt;
}

}  // namespace evo
