#include "cli/robots.h"

#include <charconv>
#include <filesystem>

#include "libevo/base/error.h"

namespace evo::cli {
namespace {

void make_policy_path_relative_to_here(Robot& robot, const std::string& file) {
  const auto given = robot.policy();
  if (file == standard_stream || !given) return;
  const std::filesystem::path policy = *given;
  if (policy.is_relative())
    robot.document["policy"] =
        (std::filesystem::path(file).parent_path() / policy).lexically_normal().string();
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

void RobotWriter::write(Robot robot) {
  if (const auto policy = robot.policy(); policy && target_ != standard_stream)
    robot.document["policy"] =
        seen_from(std::filesystem::path(target_).parent_path(), *policy).string();
  out_.line(robot_to_line(robot));
}

void OrderedWriter::put(std::size_t index, Robot robot) {
  const std::lock_guard lock(mutex_);
  waiting_.emplace(index, std::move(robot));
  for (auto first = waiting_.begin(); first != waiting_.end() && first->first == next_; ++next_) {
    out_.write(std::move(first->second));
    first = waiting_.erase(first);
  }
}

std::vector<Robot> read_robots(const std::vector<std::string>& files, BodyCheck check) {
  const std::vector<std::string> sources =
      files.empty() ? std::vector<std::string>{std::string(standard_stream)} : files;
  std::vector<Robot> robots;
  for (const std::string& source : sources) {
    for (Robot& robot : evo::read_robots(source, check)) {
      make_policy_path_relative_to_here(robot, source);
      robots.push_back(std::move(robot));
    }
  }
  return robots;
}

std::set<std::string> read_ids(const std::vector<std::string>& files) {
  std::set<std::string> ids;
  if (files.empty()) return ids;
  for (const Robot& robot : read_robots(files, BodyCheck::any)) ids.insert(robot.id);
  return ids;
}

Shape parse_shape(const std::string& text) {
  Shape shape;
  const char* end = text.data() + text.size();
  const auto rows = std::from_chars(text.data(), end, shape.rows);
  const bool has_x = rows.ec == std::errc() && rows.ptr != end && *rows.ptr == 'x';
  const auto cols = has_x ? std::from_chars(rows.ptr + 1, end, shape.cols) : rows;
  if (!has_x || cols.ec != std::errc() || cols.ptr != end || shape.rows < 1 || shape.cols < 1 ||
      shape.rows > 1000 || shape.cols > 1000)
    throw error(Failure::usage,
                "--shape: '{}' is not ROWSxCOLS with numbers from 1 to 1000, such as 5x5", text);
  return shape;
}

std::vector<std::string> split_list(const std::string& text) {
  std::vector<std::string> pieces;
  std::size_t start = 0;
  while (start <= text.size()) {
    const std::size_t comma = std::min(text.find(',', start), text.size());
    if (comma > start) pieces.push_back(text.substr(start, comma - start));
    start = comma + 1;
  }
  return pieces;
}

std::vector<double> parse_numbers(const std::string& text, const std::string& what) {
  std::vector<double> numbers;
  for (const std::string& piece : split_list(text)) {
    double number = 0.0;
    const char* end = piece.data() + piece.size();
    const auto result = std::from_chars(piece.data(), end, number);
    if (result.ec != std::errc() || result.ptr != end)
      throw error(Failure::usage, "{}: '{}' is not a number", what, piece);
    numbers.push_back(number);
  }
  return numbers;
}

}  // namespace evo::cli
