// Populations on their way through a tool: in from files or standard input,
// out as JSON Lines.
#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "formats/io/files.h"
#include "formats/robot/robot.h"

namespace evo::cli {

// Every robot of the named files in order; standard input when none is named. A
// policy or rollout file stands for the robot it holds. `policy` paths inside a
// document are relative to its file and come back relative to the current
// folder.
std::vector<Robot> read_robots(const std::vector<std::string>& files,
                               BodyCheck check = BodyCheck::robot);
// The same of one file whose bytes were read.
std::vector<Robot> robots_in(std::string_view bytes, const std::string& file,
                             BodyCheck check = BodyCheck::robot);

// Ids of every robot in the files, for --avoid.
std::set<std::string> read_ids(const std::vector<std::string>& files);

// A number of the robot's document, within objects by dots: "fitness", "final.mean".
// Nothing where there is none.
std::optional<double> number_of(const Robot& robot, const std::string& name);

// Robots on their way out, one JSON document per line. `policy` paths are written
// relative to the folder of the file, or to the current one for standard output.
class RobotWriter {
 public:
  explicit RobotWriter(const std::string& target) : target_(target), out_(target) {}

  void write(Robot robot);
  void finish();

 private:
  std::string target_;
  LineWriter out_;
  std::size_t written_ = 0;
};

// Robots finished in any order by several threads, written in the order of their
// numbers as soon as all before them are there.
class OrderedWriter {
 public:
  explicit OrderedWriter(const std::string& target) : out_(target) {}

  void put(std::size_t index, Robot robot);
  void finish() { out_.finish(); }

 private:
  std::mutex mutex_;
  std::map<std::size_t, Robot> waiting_;
  std::size_t next_ = 0;
  RobotWriter out_;
};

}  // namespace evo::cli
