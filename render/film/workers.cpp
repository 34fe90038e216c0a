#include "render/film/workers.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <string>
#include <system_error>
#include <utility>

#include "formats/io/files.h"
#include "libevo/base/error.h"

namespace evo::render {
namespace {

constexpr std::size_t buffers_per_worker = 2;  // one being drawn, one being read
constexpr std::size_t message_bytes = 1024;    // room for an error even in a tiny frame

// What a worker says about a finished frame.
struct Report {
  std::int64_t failure = 0;  // a Failure, or 0: the frame is done
  std::uint64_t bytes = 0;   // of its message
};

// All of it, or false at the end of the stream.
template <typename T>
bool receive(int socket, T& value) {
  ssize_t got = 0;
  do got = ::recv(socket, &value, sizeof value, MSG_WAITALL);
  while (got < 0 && errno == EINTR);
  return got == static_cast<ssize_t>(sizeof value);
}

// False when nobody listens any more; no signal then.
template <typename T>
bool send(int socket, const T& value) {
  ssize_t put = 0;
  do put = ::send(socket, &value, sizeof value, MSG_NOSIGNAL);
  while (put < 0 && errno == EINTR);
  return put == static_cast<ssize_t>(sizeof value);
}

class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int value) : value_(value) {}
  Descriptor(Descriptor&& other) noexcept : value_(std::exchange(other.value_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(value_, other.value_);
    return *this;
  }
  ~Descriptor() { close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  void close() {
    if (value_ >= 0) ::close(std::exchange(value_, -1));
  }
  int get() const { return value_; }

 private:
  int value_ = -1;
};

// Two connected ends, one for the worker: reports go up, credits come down.
struct Connection {
  Descriptor ours;
  Descriptor theirs;
  Connection() {
    int ends[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
      throw error(Failure::work, "cannot open a socket pair: {}", reason(errno));
    ours = Descriptor(ends[0]);
    theirs = Descriptor(ends[1]);
  }
};

// Anonymous memory that forked processes share.
class SharedMemory {
 public:
  explicit SharedMemory(std::size_t bytes) : bytes_(bytes) {
    void* at = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (at == MAP_FAILED)
      throw error(Failure::work, "cannot get {} MiB of memory for frames: {}", bytes >> 20U,
                  reason(errno));
    data_ = static_cast<std::uint8_t*>(at);
  }
  ~SharedMemory() { ::munmap(data_, bytes_); }
  SharedMemory(const SharedMemory&) = delete;
  SharedMemory& operator=(const SharedMemory&) = delete;
  std::span<std::uint8_t> buffer(std::size_t index, std::size_t bytes) const {
    return {data_ + index * bytes, bytes};
  }

 private:
  std::size_t bytes_;
  std::uint8_t* data_ = nullptr;
};

Report put_message(Failure failure, std::string_view message, std::span<std::uint8_t> buffer) {
  const std::size_t bytes = std::min(message.size(), buffer.size());
  std::memcpy(buffer.data(), message.data(), bytes);
  return {static_cast<std::int64_t>(failure), bytes};
}

// The life of a worker: frames first, first + stride, ... into its buffers in turn.
void work(const FrameJob& job, const SharedMemory& memory, std::size_t buffer_bytes,
          std::size_t first, std::size_t stride, int socket) {
  const auto buffer_of = [&](std::size_t round) {
    return memory.buffer(first * buffers_per_worker + round % buffers_per_worker, buffer_bytes);
  };
  Report report;  // that all is well
  std::size_t round = 0;
  try {
    Painter painter;
    for (std::size_t frame = first; frame < job.frames; frame += stride, ++round) {
      char credit = 0;
      if (round >= buffers_per_worker && !receive(socket, credit)) return;
      job.draw(painter, frame, buffer_of(round).first(job.frame_bytes));
      if (!send(socket, report)) return;
    }
    return;
  } catch (const Error& failure) {
    report = put_message(failure.kind(), failure.what(), buffer_of(round));
  } catch (const std::exception& failure) {
    report = put_message(Failure::work, failure.what(), buffer_of(round));
  }
  (void)send(socket, report);
}

class Worker {
 public:
  Worker(const FrameJob& job, const SharedMemory& memory, std::size_t buffer_bytes,
         std::size_t index, std::size_t stride) {
    Connection connection;
    const pid_t parent = ::getpid();
    process_ = ::fork();
    if (process_ < 0)
      throw error(Failure::work, "cannot start a drawing process: {}", reason(errno));
    if (process_ == 0) {
      // Ends with its parent, however that one ends; an interrupt is the
      // parent's business.
      ::prctl(PR_SET_PDEATHSIG, SIGKILL);
      if (::getppid() != parent) ::_exit(0);
      std::signal(SIGINT, SIG_IGN);
      std::signal(SIGTERM, SIG_DFL);
      // Processes are the parallelism; llvmpipe's own threads only cost.
      ::setenv("LP_NUM_THREADS", "0", 1);
      connection.ours.close();
      work(job, memory, buffer_bytes, index, stride, connection.theirs.get());
      ::_exit(0);
    }
    socket_ = std::move(connection.ours);
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;
  ~Worker() {
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    reap();
  }

  Report next() {
    Report report;
    if (receive(socket_.get(), report)) return report;
    const int status = reap();
    if (WIFSIGNALED(status))
      throw error(Failure::work, "a drawing process was killed by signal {} ({})", WTERMSIG(status),
                  strsignal(WTERMSIG(status)));
    throw error(Failure::work, "a drawing process ended early with status {}", WEXITSTATUS(status));
  }

  // A buffer may be used again. That a worker has died shows at its next report.
  void give_back() const { (void)send(socket_.get(), 'c'); }

 private:
  int reap() {
    int status = 0;
    while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
    process_ = -1;
    return status;
  }

  pid_t process_ = -1;
  Descriptor socket_;
};

}  // namespace

void run_workers(const FrameJob& job) {
  if (job.frames == 0) return;
  const std::size_t stride =
      std::min(job.frames, static_cast<std::size_t>(std::max(1, job.workers)));
  const std::size_t buffer_bytes = std::max(job.frame_bytes, message_bytes);
  const SharedMemory memory(stride * buffers_per_worker * buffer_bytes);
  std::deque<Worker> workers;
  for (std::size_t k = 0; k < stride; ++k)
    workers.emplace_back(job, memory, buffer_bytes, k, stride);

  for (std::size_t frame = 0; frame < job.frames; ++frame) {
    const std::size_t who = frame % stride;
    const std::size_t round = frame / stride;
    const auto buffer =
        memory.buffer(who * buffers_per_worker + round % buffers_per_worker, buffer_bytes);
    const Report report = workers[who].next();
    if (report.failure != 0) {
      const auto message = buffer.first(static_cast<std::size_t>(report.bytes));
      throw Error(static_cast<Failure>(report.failure), {message.begin(), message.end()});
    }
    job.take(frame, buffer.first(job.frame_bytes));
    // Credit is only read by a worker that has another frame for this buffer.
    if (frame + buffers_per_worker * stride < job.frames) workers[who].give_back();
  }
}

}  // namespace evo::render
