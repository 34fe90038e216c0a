#include "training/rescue.h"

#include <unistd.h>

#include <chrono>
#include <system_error>
#include <utility>

#include "formats/training/policy.h"

namespace evo {

using std::chrono::milliseconds;

constexpr milliseconds glance{50};     // at the signal
constexpr milliseconds patience{500};  // for trainings to come to the end of an update

Rescue::Rescue(std::function<int()> interrupted, std::function<void()> farewell)
    : interrupted_(std::move(interrupted)), farewell_(std::move(farewell)) {
  try {
    watcher_ = std::thread([this] { watch(); });
  } catch (const std::system_error&) {
    // Without a thread to spare, interrupts wait for the end of an update.
  }
}

Rescue::~Rescue() {
  {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
  }
  over_.notify_all();
  if (watcher_.joinable()) watcher_.join();
}

void Rescue::keep(std::size_t index, Checkpoint checkpoint, const std::filesystem::path& path,
                  const TrainingIdentity& training) {
  const std::lock_guard lock(mutex_);
  kept_[index] = {std::move(checkpoint), path, training};
}

void Rescue::forget(std::size_t index) {
  const std::lock_guard lock(mutex_);
  kept_.erase(index);
}

void Rescue::watch() {
  std::unique_lock lock(mutex_);
  while (!over_.wait_for(lock, glance, [&] { return is_over_; })) {
    if (interrupted_() == 0) continue;
    if (over_.wait_for(lock, patience, [&] { return is_over_; })) return;
    save_and_end(interrupted_());
  }
}

// With the lock held, so that no training takes its state away meanwhile.
void Rescue::save_and_end(int signal) {
  for (const auto& [index, kept] : kept_) {
    try {
      write_checkpoint(kept.path, kept.checkpoint, kept.training);
    } catch (const std::exception&) {
      // The other ones still count; an older checkpoint may be there.
    }
  }
  try {
    farewell_();
  } catch (const std::exception&) {
    // Without memory for words.
  }
  ::_exit(128 + signal);
}

}  // namespace evo
