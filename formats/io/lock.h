// Advisory locks, by which processes on the same files keep out of each other's way.
#pragma once

#include <cstdint>
#include <filesystem>

namespace evo {

// A file whose bytes stand for what can be worked on: each can be taken by one process
// at a time. The system gives back what a process held, however it ends. Nothing may
// rest on it: where the file cannot be made, or its file system has no locks, whatever
// is asked for is granted.
class LockFile {
 public:
  explicit LockFile(const std::filesystem::path& file);
  ~LockFile();
  LockFile(const LockFile&) = delete;
  LockFile& operator=(const LockFile&) = delete;

  // Held until this object ends. False if another one, here or in another process or
  // on another machine, has it.
  bool take(std::uint64_t byte) const;

 private:
  int descriptor_ = -1;  // none: nothing can be locked
};

}  // namespace evo
