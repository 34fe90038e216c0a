// What is left of trainings that are interrupted while they compute: the state
// after the last update of each, kept in memory and saved when the time that a
// scheduler grants runs out.
#pragma once

#include <condition_variable>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <thread>

#include "formats/training/identity.h"
#include "libevo/control/checkpoint.h"

namespace evo {

class Rescue {
 public:
  // `interrupted` gives the signal that asks to stop, or 0. `farewell` is said before the
  // process ends with 128 + the signal, half a second after an interrupt unless this
  // object is gone by then.
  Rescue(std::function<int()> interrupted, std::function<void()> farewell);
  ~Rescue();
  Rescue(const Rescue&) = delete;
  Rescue& operator=(const Rescue&) = delete;

  // The state of training `index` from which `path` lets it go on.
  void keep(std::size_t index, Checkpoint checkpoint, const std::filesystem::path& path,
            const TrainingIdentity& training);
  // It is over, or has saved itself.
  void forget(std::size_t index);

 private:
  struct Kept {
    Checkpoint checkpoint;
    std::filesystem::path path;
    TrainingIdentity training;
  };

  void watch();
  void save_and_end(int signal);

  std::function<int()> interrupted_;
  std::function<void()> farewell_;
  std::mutex mutex_;
  std::condition_variable over_;
  bool is_over_ = false;
  std::map<std::size_t, Kept> kept_;
  std::thread watcher_;
};

}  // namespace evo
