#include "cli/robots.h"

#include <unistd.h>

#include <filesystem>

#include "cli/command.h"
#include "cli/data.h"
#include "formats/io/files.h"
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

}  // namespace

std::vector<Robot> read_robots(const std::vector<std::string>& files, BodyCheck check) {
  const std::vector<std::string> sources =
      files.empty() ? std::vector<std::string>{std::string(standard_stream)} : files;
  if (files.empty() && isatty(STDIN_FILENO) == 1)
    log::info("reading robots from the terminal; Ctrl-D ends them, Ctrl-C the command");
  std::vector<Robot> robots;
  for (const std::string& source : sources) {
    refuse_task_as_file(source);
    for (Robot& robot : with_policies_seen_from_here(evo::read_robots(source, check), source))
      robots.push_back(std::move(robot));
    log::debug(fmt::format("{} robots read, the last from {}", robots.size(), input_label(source)));
  }
  return robots;
}

std::vector<Robot> robots_in(std::string_view bytes, const std::string& file, BodyCheck check) {
  return with_policies_seen_from_here(evo::robots_in(bytes, file, check), file);
}

std::set<std::string> read_ids(const std::vector<std::string>& files) {
  std::set<std::string> ids;
  for (const std::string& file : files) {
    refuse_task_as_file(file);
    ids.merge(evo::read_ids(file));
  }
  return ids;
}

}  // namespace evo::cli
