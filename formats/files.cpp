#include "formats/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "libevo/base/error.h"

namespace evo {
namespace fs = std::filesystem;
namespace {

// strerror, without its static buffer.
std::string reason(int code) { return std::generic_category().message(code); }

std::string read_descriptor(int descriptor, const std::string& label) {
  std::string text;
  struct stat status {};
  if (::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode))
    text.reserve(static_cast<std::size_t>(status.st_size) + 1);
  constexpr std::size_t chunk = std::size_t{1} << 16;
  for (;;) {
    const std::size_t have = text.size();
    text.resize(have + chunk);
    const ssize_t got = ::read(descriptor, text.data() + have, chunk);
    const int code = errno;
    text.resize(have + static_cast<std::size_t>(got > 0 ? got : 0));
    if (got == 0) return text;
    if (got < 0 && code != EINTR)
      throw error(Failure::io, "{}: cannot be read: {}", label, reason(code));
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

// A rename survives a power cut only once the folder is on disk, too. Not every
// file system can do it; the file itself is safe either way.
void sync_folder(const fs::path& file) {
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  const Descriptor opened(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
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

std::string read_file(const fs::path& path) {
  const Descriptor opened(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (opened.value() < 0)
    throw error(Failure::no_input, "{}: cannot be opened: {}", path.string(), reason(errno));
  struct stat status {};
  if (::fstat(opened.value(), &status) == 0 && S_ISDIR(status.st_mode))
    throw error(Failure::no_input, "{}: is a folder, a file is needed", path.string());
  return read_descriptor(opened.value(), path.string());
}

std::string read_input(const std::string& name) {
  return name == standard_stream ? read_descriptor(STDIN_FILENO, input_label(name))
                                 : read_file(name);
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
  }
  if (in_place_) {
    temporary_ = destination_;
    descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor_ < 0) throw cannot_create(label_, reason(errno));
    return;
  }
  if (!destination_.has_filename()) throw cannot_create(label_, "no file is named");
  // The process and a number make the name; a leftover of a killed process with
  // the same number makes O_EXCL refuse it, and the next number is tried.
  constexpr int most_leftovers = 1000;
  for (int k = 0; k < most_leftovers; ++k) {
    temporary_ = destination_;
    temporary_.replace_filename(
        fmt::format(".{}.{}-{}.tmp", destination_.filename().string(), ::getpid(), k));
    descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ >= 0) return;
    if (errno != EEXIST) break;
  }
  throw cannot_create(label_, reason(errno));
}

AtomicFile::~AtomicFile() { discard(); }

void AtomicFile::discard() {
  if (descriptor_ < 0) return;
  ::close(descriptor_);
  descriptor_ = -1;
  if (!in_place_) ::unlink(temporary_.c_str());
}

void AtomicFile::write(std::string_view bytes) {
  if (const int code = write_all(descriptor_, bytes))
    throw error(Failure::io, "{}: cannot be written: {}", label_.string(), reason(code));
}

void AtomicFile::commit() {
  const bool synced = in_place_ || ::fsync(descriptor_) == 0;
  if (!synced || (!in_place_ && ::rename(temporary_.c_str(), destination_.c_str()) != 0)) {
    const int code = errno;
    discard();
    throw error(Failure::io, "{}: cannot be written: {}", label_.string(), reason(code));
  }
  const bool closed = ::close(descriptor_) == 0;
  descriptor_ = -1;
  if (!closed)
    throw error(Failure::io, "{}: cannot be written: {}", label_.string(), reason(errno));
  if (!in_place_) sync_folder(destination_);
}

void write_file(const fs::path& path, std::string_view bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
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
