#include "cli/journal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <system_error>
#include <thread>

#include "cli/command.h"
#include "formats/io/files.h"
#include "formats/io/json.h"
#include "formats/run/run.h"
#include "libevo/base/error.h"
#include "libevo/base/random.h"

namespace evo::cli {

namespace fs = std::filesystem;

double seconds_since_1970() {
  using namespace std::chrono;
  const auto now = system_clock::now().time_since_epoch();
  return static_cast<double>(duration_cast<milliseconds>(now).count()) / 1000.0;
}

Journal::Journal(const std::optional<std::string>& folder) {
  if (!folder) return;
  folder_ = *folder;
  make_folders(folder_);
  lock_.emplace(folder_ / "lock");
}

std::optional<std::string> Journal::killed_on(const std::string& name) const {
  if (!lock_ || !fs::is_regular_file(mark(name))) return std::nullopt;
  return marked_machine(mark(name));
}

void Journal::take(const std::string& name) const {
  if (!lock_) return;
  bool told = false;
  const std::uint64_t byte = derive_seed(0, name) >> 2U;  // a positive offset of a file
  while (!lock_->take(byte) && interrupted() == 0) {
    if (!told) log::info(fmt::format("{}: waiting for another process that trains it", name));
    told = true;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
}

void Journal::begun(const std::string& name) const {
  if (!lock_) return;
  const Json here = {{"host", this_machine()}, {"process", ::getpid()}};
  write_file(mark(name), here.dump() + "\n");
}

void Journal::ended(const std::string& name) const {
  if (!lock_) return;
  std::error_code ignored;
  fs::remove(mark(name), ignored);
}

// One write() to a file opened for appending stays in one piece between the processes of a
// machine, on network file systems, too.
void Journal::add(const std::string& name, const Work& work) const {
  if (!lock_) return;
  const fs::path file = folder_ / (this_machine() + ".jsonl");
  const Json line = {{"robot", name},
                     {"started", work.started},
                     {"seconds", work.seconds},
                     {"steps", work.steps},
                     {"finished", work.finished}};
  const std::string text = line.dump() + "\n";
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (descriptor < 0)
    throw error(Failure::cannot_create, "{}: cannot be created: {}", file.string(),
                std::generic_category().message(errno));
  const ssize_t written = ::write(descriptor, text.data(), text.size());
  const int code = errno;
  ::close(descriptor);
  if (written != static_cast<ssize_t>(text.size()))
    throw error(Failure::io, "{}: cannot be written: {}", file.string(),
                std::generic_category().message(code));
}

}  // namespace evo::cli
