// Lines of descent among the robots of a run.
#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace evo {

// From the first ancestor to the robot itself, each by the first parent it names that is
// among `robots` (each with its document as `robot`), whose places `by_id` tells. Files
// edited by hand may make a robot its own ancestor: the line ends there.
template <typename Robots>
std::vector<std::size_t> lineage(const Robots& robots,
                                 const std::map<std::string, std::size_t>& by_id,
                                 std::size_t robot) {
  std::vector<std::size_t> line;
  for (bool more = true; more;) {
    line.push_back(robot);
    more = false;
    for (const std::string& id : robots[robot].robot.parents())
      if (const auto known = by_id.find(id); known != by_id.end()) {
        robot = known->second;
        more = std::find(line.begin(), line.end(), robot) == line.end();
        break;
      }
  }
  std::reverse(line.begin(), line.end());
  return line;
}

}  // namespace evo
