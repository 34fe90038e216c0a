#include "formats/run/run_policy.h"

#include <utility>
#include <vector>

namespace evo {

std::optional<RunPolicy> policy_of(const RunFolder& folder, const Robot& robot) {
  std::vector<RunPolicy> places{{{}, folder.policy(robot.id), std::nullopt}};
  for (const int generation : folder.generations()) {
    if (!folder.settings().shares(generation)) continue;
    const std::filesystem::path file = folder.shared_policy(generation);
    const auto named = robot.policy();
    if (named && std::filesystem::path(*named).filename() == file.filename())
      places.push_back({{}, file, generation});
  }
  places.push_back({{}, folder.path() / "best.policy.h5", std::nullopt});
  for (RunPolicy& found : places) {
    if (!std::filesystem::is_regular_file(found.file)) continue;
    found.policy = read_policy(found.file);
    for (const Robot& one : found.policy.robots)
      if (one.id == robot.id) found.policy.robot = one;
    if (found.policy.robot.id == robot.id) return std::move(found);
  }
  return std::nullopt;
}

}  // namespace evo
