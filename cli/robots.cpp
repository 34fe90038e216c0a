#include "cli/robots.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <limits>

#include "cli/command.h"
#include "cli/data.h"
#include "formats/io/files.h"
#include "formats/io/values.h"
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

std::vector<Robot> pick(std::vector<Robot> robots, const std::optional<std::string>& places) {
  if (!places) return robots;
  constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max();
  const std::size_t dash = places->find('-');
  const std::int64_t first = parse_whole(places->substr(0, dash), "--pick", 0, most);
  std::int64_t last = first;
  if (dash != std::string::npos)
    last = dash + 1 == places->size()
               ? most
               : parse_whole(places->substr(dash + 1), "--pick", first, most);
  const auto count = static_cast<std::int64_t>(robots.size());
  const auto begin = robots.begin() + std::min(first, count);
  const auto end = last >= count ? robots.end() : robots.begin() + last + 1;
  return {std::make_move_iterator(begin), std::make_move_iterator(end)};
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
