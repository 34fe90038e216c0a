#include "cli/env/stream.h"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>

#include "libevo/base/error.h"

namespace evo::cli {
namespace {

constexpr std::chrono::microseconds longest_look{200};
constexpr unsigned longest_put_off = 1024;  // waits

bool comes_soon(int descriptor) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point end = Clock::now() + longest_look;
  pollfd input{descriptor, POLLIN, 0};
  while (::poll(&input, 1, 0) == 0)
    if (Clock::now() > end) return false;
  return true;
}

}  // namespace

void LookOut::wait(int descriptor) {
  if (left_ > 0) {
    --left_;
  } else if (comes_soon(descriptor)) {
    put_off_ = 0;
  } else {
    left_ = put_off_ = std::clamp(2 * put_off_, 1U, longest_put_off);
  }
}

// As read(2), begun again after signals.
std::size_t InputStream::read_some(std::span<std::byte> target) {
  if (eager_) look_out_.wait(descriptor_);
  for (;;) {
    const ssize_t n = ::read(descriptor_, target.data(), target.size());
    if (n >= 0) return static_cast<std::size_t>(n);
    if (errno != EINTR)
      throw error(Failure::io, "cannot read standard input: {}", std::strerror(errno));
  }
}

bool InputStream::fill() {
  begin_ = 0;
  end_ = read_some(buffer_);
  return end_ > 0;
}

std::size_t InputStream::read(std::span<std::byte> target) {
  std::size_t got = 0;
  while (got < target.size()) {
    const std::size_t rest = target.size() - got;
    if (begin_ == end_ && rest >= buffer_.size()) {  // past the buffer
      const std::size_t n = read_some(target.subspan(got));
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
  const std::size_t endless = 4 * longest;
  std::size_t length = 0;
  bool any = false;
  while (begin_ < end_ || fill()) {
    any = true;
    const auto* text = reinterpret_cast<const char*>(buffer_.data());
    const auto* newline = static_cast<const char*>(std::memchr(text + begin_, '\n', end_ - begin_));
    const std::size_t stop = newline == nullptr ? end_ : static_cast<std::size_t>(newline - text);
    length += stop - begin_;
    if (length <= longest) line.append(text + begin_, stop - begin_);
    begin_ = newline == nullptr ? end_ : stop + 1;
    if (newline != nullptr) break;
    if (length > endless) return Line::endless;
  }
  if (!any) return Line::none;
  return length > longest ? Line::too_long : Line::whole;
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
