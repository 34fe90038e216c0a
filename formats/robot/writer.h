// Robots on their way out of a program, as JSON Lines.
#pragma once

#include <cstddef>
#include <map>
#include <mutex>
#include <string>

#include "formats/io/files.h"
#include "formats/robot/robot.h"

namespace evo {

// One JSON document per line. `policy` paths are written
// relative to the folder of the file, or to the current one for standard output.
class RobotWriter {
 public:
  explicit RobotWriter(const std::string& target) : target_(target), out_(target) {}

  void write(Robot robot);
  void finish() { out_.finish(); }

 private:
  std::string target_;
  LineWriter out_;
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

}  // namespace evo
