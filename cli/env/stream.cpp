#include "cli/env/stream.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "libevo/base/error.h"

namespace evo::cli {
namespace {

// As read(2), begun again after signals.
std::size_t read_some(int descriptor, std::span<std::byte> target) {
  for (;;) {
    const ssize_t n = ::read(descriptor, target.data(), target.size());
    if (n >= 0) return static_cast<std::size_t>(n);
    if (errno != EINTR)
      throw error(Failure::io, "cannot read standard input: {}", std::strerror(errno));
  }
}

}  // namespace

bool InputStream::fill() {
  begin_ = 0;
  end_ = read_some(descriptor_, buffer_);
  return end_ > 0;
}

std::size_t InputStream::read(std::span<std::byte> target) {
  std::size_t got = 0;
  while (got < target.size()) {
    const std::size_t rest = target.size() - got;
    if (begin_ == end_ && rest >= buffer_.size()) {  // past the buffer
      const std::size_t n = read_some(descriptor_, target.subspan(got));
      if (n == 0) break;
      got += n;
      continue;
    }
    if (begin_ == end_ && !fill()) break;
    const std::size_t n = std::min(rest, end_ - begin_);
    std::memcpy(target.data() + got, buffer_.data() + begin_, n);
    begin_ += n;
    got += n;
  }
  return got;
}

std::size_t InputStream::skip(std::size_t bytes) {
  std::size_t skipped = 0;
  while (skipped < bytes && (begin_ < end_ || fill())) {
    const std::size_t n = std::min(bytes - skipped, end_ - begin_);
    begin_ += n;
    skipped += n;
  }
  return skipped;
}

InputStream::Line InputStream::read_line(std::string& line, std::size_t longest) {
  line.clear();
  bool too_long = false;
  bool any = false;
  while (begin_ < end_ || fill()) {
    any = true;
    const auto* text = reinterpret_cast<const char*>(buffer_.data());
    const auto* newline = static_cast<const char*>(std::memchr(text + begin_, '\n', end_ - begin_));
    const std::size_t stop = newline == nullptr ? end_ : static_cast<std::size_t>(newline - text);
    too_long |= line.size() + (stop - begin_) > longest;
    if (!too_long) line.append(text + begin_, stop - begin_);
    begin_ = newline == nullptr ? end_ : stop + 1;
    if (newline != nullptr) break;
  }
  if (!any) return Line::none;
  return too_long ? Line::too_long : Line::whole;
}

void write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(descriptor, bytes.data(), bytes.size());
    if (n >= 0) {
      bytes.remove_prefix(static_cast<std::size_t>(n));
    } else if (errno == EPIPE) {
      throw ClientGone{};
    } else if (errno != EINTR) {
      throw error(Failure::io, "cannot write standard output: {}", std::strerror(errno));
    }
  }
}

}  // namespace evo::cli
