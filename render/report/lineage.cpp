#include "render/report/lineage.h"

#include "formats/run/lineage.h"

namespace evo::report {

std::optional<std::vector<Change>> changes(const Body& parent, const Body& child) {
  if (parent.rows != child.rows || parent.cols != child.cols) return std::nullopt;
  std::vector<Change> found;
  for (int row = 0; row < child.rows; ++row)
    for (int col = 0; col < child.cols; ++col)
      if (parent.at(row, col) != child.at(row, col))
        found.push_back({row, col, parent.at(row, col), child.at(row, col)});
  return found;
}

std::optional<std::size_t> parent(const Run& run, std::size_t robot) {
  for (const std::string& id : run.robots[robot].robot.parents())
    if (const auto known = run.by_id.find(id); known != run.by_id.end()) return known->second;
  return std::nullopt;
}

std::vector<std::size_t> lineage(const Run& run, std::size_t robot) {
  return evo::lineage(run.robots, run.by_id, robot);
}

}  // namespace evo::report
