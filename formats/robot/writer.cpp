#include "formats/robot/writer.h"

#include <filesystem>
#include <utility>

namespace evo {
namespace {

// The same path as seen from another folder.
std::filesystem::path seen_from(const std::filesystem::path& folder,
                                const std::filesystem::path& path) {
  const auto plain = [](const std::filesystem::path& p) {
    return std::filesystem::absolute(p).lexically_normal();
  };
  return plain(path).lexically_relative(plain(folder / "x").parent_path());
}

}  // namespace

void RobotWriter::write(Robot robot) {
  if (const auto policy = robot.policy(); policy && target_ != standard_stream)
    robot.document["policy"] =
        seen_from(std::filesystem::path(target_).parent_path(), *policy).string();
  out_.line(robot_to_line(robot));
}

void OrderedWriter::put(std::size_t index, Robot robot) {
  const std::lock_guard lock(mutex_);
  waiting_.emplace(index, std::move(robot));
  while (!waiting_.empty() && waiting_.begin()->first == next_) {
    // Out of the map before it is written: writing may fail.
    auto first = waiting_.extract(waiting_.begin());
    ++next_;
    out_.write(std::move(first.mapped()));
  }
}

}  // namespace evo
