#include "formats/io/lock.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

namespace evo {

LockFile::LockFile(const std::filesystem::path& file)
    : descriptor_(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {}

LockFile::~LockFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

bool LockFile::take(std::uint64_t byte) const {
  if (descriptor_ < 0) return true;
  struct flock range = {};
  range.l_type = F_WRLCK;
  range.l_whence = SEEK_SET;
  range.l_start = static_cast<off_t>(byte);
  range.l_len = 1;
  // The lock belongs to the open file, not to the process: the other kind is lost as soon as any
  // descriptor of the file is closed.
  if (::fcntl(descriptor_, F_OFD_SETLK, &range) == 0) return true;
  return errno != EAGAIN && errno != EACCES;  // else there are no locks here
}

}  // namespace evo
