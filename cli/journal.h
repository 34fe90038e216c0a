// What trainings say of themselves to whoever drives or watches them, as files in a folder
// (evo-train --journal): which are under way on which machine, and what each of them took.
//
//   journal/ID.running     {"host":..,"process":..} while robot ID is in training; a process
//                          that is killed leaves it behind
//   journal/HOST.jsonl     a line for each training that ended, of each machine to its own file
//   journal/lock           by which two processes do not train the same robot at a time
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "formats/io/lock.h"

namespace evo::cli {

// To the millisecond.
double seconds_since_1970();

class Journal {
 public:
  // Makes the folder; without one nothing is kept or known. Throws Error(cannot_create).
  explicit Journal(const std::optional<std::string>& folder);

  // The machine on which a training of this name (a robot's id) was killed, if it was.
  std::optional<std::string> killed_on(const std::string& name) const;
  // Waits while another process is at it, and says so, until interrupted.
  void take(const std::string& name) const;
  void begun(const std::string& name) const;
  void ended(const std::string& name) const;

  struct Work {
    double started = 0.0;  // seconds since 1970
    double seconds = 0.0;
    std::int64_t steps = 0;  // environment steps taken
    bool finished = false;   // or interrupted
  };
  // Throws Error(cannot_create, io).
  void add(const std::string& name, const Work& work) const;

 private:
  std::filesystem::path mark(const std::string& name) const {
    return folder_ / (name + ".running");
  }

  std::filesystem::path folder_;
  std::optional<LockFile> lock_;  // nothing: no folder
};

}  // namespace evo::cli
