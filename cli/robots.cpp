#include "cli/robots.h"

#include <algorithm>
#include <filesystem>

#include "cli/command.h"
#include "cli/data.h"
#include "libevo/base/error.h"

namespace evo::cli {
namespace {

std::vector<Robot> with_policies_seen_from_here(std::vector<Robot> robots,
                                                const std::string& file) {
  if (file == standard_stream) return robots;
  for (Robot& robot : robots)
    if (const auto given = robot.policy(); given && std::filesystem::path(*given).is_relative())
      robot.document["policy"] =
          (std::filesystem::path(file).parent_path() / *given).lexically_normal().string();
  return robots;
}

// The same path as seen from another folder.
std::filesystem::path seen_from(const std::filesystem::path& folder,
                                const std::filesystem::path& path) {
  const auto plain = [](const std::filesystem::path& p) {
    return std::filesystem::absolute(p).lexically_normal();
  };
  return plain(path).lexically_relative(plain(folder / "x").parent_path());
}

}  // namespace

std::optional<double> number_of(const Robot& robot, const std::string& name) {
  const Json* at = &robot.document;
  for (std::size_t begin = 0; begin <= name.size();) {
    const std::size_t end = std::min(name.find('.', begin), name.size());
    const auto found = at->find(name.substr(begin, end - begin));  // none in what is no object
    if (found == at->end()) return std::nullopt;
    at = &*found;
    begin = end + 1;
  }
  return at->is_number() ? std::optional(at->get<double>()) : std::nullopt;
}

void RobotWriter::write(Robot robot) {
  if (const auto policy = robot.policy(); policy && target_ != standard_stream)
    robot.document["policy"] =
        seen_from(std::filesystem::path(target_).parent_path(), *policy).string();
  out_.line(robot_to_line(robot));
  ++written_;
}

void RobotWriter::finish() {
  out_.finish();
  say_detail(fmt::format("{} robots written to {}", written_,
                         target_ == standard_stream ? "standard output" : target_));
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

std::vector<Robot> read_robots(const std::vector<std::string>& files, BodyCheck check) {
  const std::vector<std::string> sources =
      files.empty() ? std::vector<std::string>{std::string(standard_stream)} : files;
  std::vector<Robot> robots;
  for (const std::string& source : sources) {
    refuse_task_as_file(source);
    for (Robot& robot : with_policies_seen_from_here(evo::read_robots(source, check), source))
      robots.push_back(std::move(robot));
    say_detail(fmt::format("{} robots read, the last from {}", robots.size(), input_label(source)));
  }
  return robots;
}

std::vector<Robot> robots_in(std::string_view bytes, const std::string& file, BodyCheck check) {
  return with_policies_seen_from_here(evo::robots_in(bytes, file, check), file);
}

std::set<std::string> read_ids(const std::vector<std::string>& files) {
  std::set<std::string> ids;
  if (files.empty()) return ids;
  for (const Robot& robot : read_robots(files)) ids.insert(robot.id);
  return ids;
}

}  // namespace evo::cli
