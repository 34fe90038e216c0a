#include "formats/io/files.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <system_error>

#include "libevo/base/error.h"

namespace evo {
namespace fs = std::filesystem;

std::string reason(int code) { return std::generic_category().message(code); }

namespace {

std::string read_descriptor(int descriptor, const std::string& label, std::size_t most,
                            const Glance& glance) {
  constexpr std::size_t chunk = std::size_t{1} << 16;
  std::string text;
  const auto too_long = [&](std::size_t bytes) {
    constexpr std::size_t mebibyte = std::size_t{1} << 20;
    return bytes % mebibyte == 0
               ? error(Failure::data, "{}: longer than {} MiB", label, bytes / mebibyte)
               : error(Failure::data, "{}: longer than {} bytes", label, bytes);
  };
  struct stat status {};
  if (::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode)) {
    const auto size = static_cast<std::size_t>(status.st_size);
    if (size > most) throw too_long(most);
    text.reserve(size + chunk);
  }
  std::size_t allowed = glance ? chunk : most;
  for (;;) {
    const std::size_t have = text.size();
    text.resize(have + chunk);
    const ssize_t got = ::read(descriptor, text.data() + have, chunk);
    const int code = errno;
    text.resize(have + static_cast<std::size_t>(got > 0 ? got : 0));
    if (got == 0) return text;
    if (got < 0 && code != EINTR)
      throw error(Failure::io, "{}: cannot be read: {}", label, reason(code));
    while (text.size() > allowed) {
      const std::size_t before = allowed;
      if (allowed < most)
        allowed = std::min(most, glance(std::string_view(text).substr(0, before)));
      if (allowed <= before) throw too_long(allowed);
    }
  }
}

// All of `bytes`, however the kernel slices them. The error code, or 0.
int write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t put = ::write(descriptor, bytes.data(), bytes.size());
    if (put < 0 && errno != EINTR) return errno;
    if (put > 0) bytes.remove_prefix(static_cast<std::size_t>(put));
  }
  return 0;
}

class Descriptor {
 public:
  explicit Descriptor(int value) : value_(value) {}
  ~Descriptor() {
    if (value_ >= 0) ::close(value_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int value() const { return value_; }

 private:
  int value_;
};

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

constexpr int most_writers = 1000;  // of one file at the same time

fs::path temporary_name(const fs::path& destination, int k) {
  fs::path name = destination;
  name.replace_filename(fmt::format(".{}{}.tmp", destination.filename().string().substr(0, 200),
                                    k == 0 ? "" : fmt::format(".{}", k)));
  return name;
}

// A file of that name for this process alone: a new one, or what a killed process left,
// which holds no lock any more. Else -1, and errno; EEXIST where somebody writes it.
int open_alone(const fs::path& path) {
  int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  const bool made = file >= 0;
  if (!made && errno == EEXIST) {
    file = ::open(path.c_str(), O_WRONLY | O_NOFOLLOW | O_CLOEXEC);
    if (file < 0) errno = EEXIST;  // another user's, or a link
  }
  if (file < 0) return -1;
  // Where there are no locks, what is there already is left alone.
  const bool locked = ::flock(file, LOCK_EX | LOCK_NB) == 0;
  const bool no_locks = !locked && errno != EWOULDBLOCK;
  struct stat opened {};
  struct stat named {};
  const bool still_named = ::fstat(file, &opened) == 0 && ::stat(path.c_str(), &named) == 0 &&
                           opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
  if ((locked || (made && no_locks)) && still_named && ::ftruncate(file, 0) == 0) return file;
  ::close(file);
  errno = EEXIST;
  return -1;
}

// A rename survives a power cut only once the folder is on disk, too. Not every
// file system can do it; the file itself is safe either way.
void sync_folder(const fs::path& file) {
  const Descriptor opened(::open(folder_of(file).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (opened.value() >= 0) (void)::fsync(opened.value());
}

fs::path follow_links(const fs::path& path) {
  std::error_code failed;
  if (!fs::is_symlink(path, failed)) return path;
  const fs::path target = fs::canonical(path, failed);
  return failed ? path : target;
}

Error cannot_create(const fs::path& path, const std::string& why) {
  return error(Failure::cannot_create, "{}: cannot be created: {}", path.string(), why);
}

}  // namespace

std::string read_file(const fs::path& path, std::size_t most, const Glance& glance) {
  const Descriptor opened(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (opened.value() < 0)
    throw error(Failure::no_input, "{}: cannot be opened: {}", path.string(), reason(errno));
  struct stat status {};
  if (::fstat(opened.value(), &status) == 0 && S_ISDIR(status.st_mode))
    throw error(Failure::no_input, "{}: is a folder, a file is needed", path.string());
  return read_descriptor(opened.value(), path.string(), most, glance);
}

std::string read_input(const std::string& name, std::size_t most, const Glance& glance) {
  return name == standard_stream ? read_descriptor(STDIN_FILENO, input_label(name), most, glance)
                                 : read_file(name, most, glance);
}

std::string input_label(const std::string& name) {
  return name == standard_stream ? "standard input" : name;
}

// ---- AtomicFile -------------------------------------------------------------

AtomicFile::AtomicFile(const fs::path& path) : label_(path), destination_(follow_links(path)) {
  struct stat status {};
  if (::stat(destination_.c_str(), &status) == 0) {
    if (S_ISDIR(status.st_mode)) throw cannot_create(label_, "it is a folder");
    in_place_ = !S_ISREG(status.st_mode);
    if (!in_place_) mode_ = status.st_mode & 0777U;
  }
  if (in_place_) {
    temporary_ = destination_;
    descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor_ < 0) throw cannot_create(label_, reason(errno));
    return;
  }
  if (!destination_.has_filename()) throw cannot_create(label_, "no file is named");
  if (destination_.filename().string().size() > NAME_MAX)
    throw cannot_create(label_, reason(ENAMETOOLONG));
  for (int k = 0; k < most_writers; ++k) {
    temporary_ = temporary_name(destination_, k);
    descriptor_ = open_alone(temporary_);
    if (descriptor_ >= 0) return;
    if (errno != EEXIST) break;
  }
  throw cannot_create(label_, reason(errno));
}

AtomicFile::~AtomicFile() { discard(); }

int AtomicFile::name_file(Existing existing) const {
  // A rename replaces; a second name for the file does not.
  if (existing == Existing::replaced)
    return ::rename(temporary_.c_str(), destination_.c_str()) == 0 ? 0 : errno;
  if (::link(temporary_.c_str(), destination_.c_str()) != 0) return errno;
  ::unlink(temporary_.c_str());
  return 0;
}

void AtomicFile::discard() {
  if (descriptor_ < 0) return;
  if (!in_place_) ::unlink(temporary_.c_str());  // while it is locked
  ::close(descriptor_);
  descriptor_ = -1;
}

void AtomicFile::write(std::string_view bytes) {
  if (const int code = write_all(descriptor_, bytes))
    throw error(Failure::io, "{}: cannot be written: {}", label_.string(), reason(code));
}

void AtomicFile::commit(Existing existing) {
  if (mode_) (void)::fchmod(descriptor_, *mode_);
  const bool synced = in_place_ || ::fsync(descriptor_) == 0;
  int code = synced ? 0 : errno;
  if (synced && !in_place_) code = name_file(existing);
  if (code != 0) {
    discard();
    if (code == EEXIST) throw cannot_create(label_, "it exists already");
    throw error(Failure::io, "{}: cannot be written: {}", label_.string(), reason(code));
  }
  const bool closed = ::close(descriptor_) == 0;
  descriptor_ = -1;
  if (!closed)
    throw error(Failure::io, "{}: cannot be written: {}", label_.string(), reason(errno));
  if (!in_place_) sync_folder(destination_);
}

void make_folders(const fs::path& folder) {
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (failure)
    throw error(Failure::cannot_create, "{}: this folder cannot be made: {}", folder.string(),
                failure.message());
}

void write_file(const fs::path& path, std::string_view bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
}

void write_output(const std::string& name, std::string_view bytes) {
  if (name != standard_stream) return write_file(name, bytes);
  if (const int code = write_all(STDOUT_FILENO, bytes))
    throw error(Failure::io, "standard output: cannot be written: {}", reason(code));
}

// ---- LineWriter -------------------------------------------------------------

LineWriter::LineWriter(const std::string& target) {
  if (target != standard_stream) file_.emplace(target);
}

void LineWriter::line(std::string_view text) {
  buffer_.append(text);
  buffer_.push_back('\n');
  // A file nobody reads before finish() may be written in larger pieces.
  constexpr std::size_t piece = std::size_t{1} << 16;
  if (file_) {
    if (buffer_.size() < piece) return;
    file_->write(buffer_);
  } else if (const int code = write_all(STDOUT_FILENO, buffer_)) {
    buffer_.clear();
    throw error(Failure::io, "standard output: cannot be written: {}", reason(code));
  }
  buffer_.clear();
}

void LineWriter::finish() {
  if (!file_) return;
  file_->write(buffer_);
  buffer_.clear();
  file_->commit();
}

}  // namespace evo
