#include "render/film/workers.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <string_view>
#include <vector>

#include "formats/io/files.h"
#include "libevo/base/error.h"

namespace evo::render {
namespace {

constexpr int pipe_bytes = 1 << 20;  // that Linux lets anyone have

// What a worker says of a frame; then come its bytes, or those of a message.
struct Report {
  std::int64_t failure = 0;  // a Failure, or 0: the frame is done
  std::uint64_t bytes = 0;
};

// All bytes, or false where nobody is at the other end any more.
bool write_all(int pipe, const void* bytes, std::size_t count) {
  for (std::size_t done = 0; done < count;) {
    const ssize_t put = ::write(pipe, static_cast<const char*>(bytes) + done, count - done);
    if (put < 0 && errno != EINTR) return false;
    done += static_cast<std::size_t>(std::max<ssize_t>(put, 0));
  }
  return true;
}

// The life of a worker: frames first, first + stride, ...
void work(const FrameJob& job, std::size_t first, std::size_t stride, int pipe) {
  const auto fail = [pipe](Failure kind, std::string_view message) {
    const Report report{static_cast<std::int64_t>(kind), message.size()};
    if (write_all(pipe, &report, sizeof report)) write_all(pipe, message.data(), message.size());
  };
  try {
    Painter painter;
    std::vector<std::uint8_t> bytes(job.frame_bytes);
    for (std::size_t frame = first; frame < job.frames; frame += stride) {
      job.draw(painter, frame, bytes);
      const Report done{0, bytes.size()};
      if (!write_all(pipe, &done, sizeof done) || !write_all(pipe, bytes.data(), bytes.size()))
        return;
    }
  } catch (const Error& failure) {
    fail(failure.kind(), failure.what());
  } catch (const std::exception& failure) {
    fail(Failure::work, failure.what());
  }
}

class Worker {
 public:
  Worker(const FrameJob& job, std::size_t index, std::size_t stride) {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0)
      throw error(Failure::work, "cannot open a pipe: {}", reason(errno));
    // Where the system allows it, a worker draws the next frame before this one is read.
    ::fcntl(ends[1], F_SETPIPE_SZ, pipe_bytes);
    const pid_t parent = ::getpid();
    process_ = ::fork();
    if (process_ == 0) {
      // Ends with its parent, however that one ends; an interrupt is the
      // parent's business.
      ::prctl(PR_SET_PDEATHSIG, SIGKILL);
      if (::getppid() != parent) ::_exit(0);
      std::signal(SIGINT, SIG_IGN);
      std::signal(SIGTERM, SIG_DFL);
      // Processes are the parallelism; llvmpipe's own threads only cost.
      ::setenv("LP_NUM_THREADS", "0", 1);
      ::close(ends[0]);
      work(job, index, stride, ends[1]);
      ::_exit(0);
    }
    const int failure = errno;
    ::close(ends[1]);
    pipe_ = ends[0];
    if (process_ > 0) return;
    ::close(pipe_);
    throw error(Failure::work, "cannot start a drawing process: {}", reason(failure));
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;
  ~Worker() {
    ::close(pipe_);
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    reap();
  }

  // The bytes of its next frame. Throws what drawing it threw.
  void next(std::vector<std::uint8_t>& bytes) {
    Report report;
    receive(&report, sizeof report);
    bytes.resize(report.bytes);
    receive(bytes.data(), bytes.size());
    if (report.failure != 0)
      throw Error(static_cast<Failure>(report.failure), {bytes.begin(), bytes.end()});
  }

 private:
  void receive(void* bytes, std::size_t count) {
    for (std::size_t done = 0; done < count;) {
      const ssize_t got = ::read(pipe_, static_cast<char*>(bytes) + done, count - done);
      if (got == 0 || (got < 0 && errno != EINTR)) throw death();
      done += static_cast<std::size_t>(std::max<ssize_t>(got, 0));
    }
  }

  Error death() {
    const int status = reap();
    if (WIFSIGNALED(status))
      return error(Failure::work, "a drawing process was killed by signal {} ({})",
                   WTERMSIG(status), strsignal(WTERMSIG(status)));
    return error(Failure::work, "a drawing process ended early with status {}",
                 WEXITSTATUS(status));
  }

  int reap() {
    int status = 0;
    while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
    process_ = -1;
    return status;
  }

  pid_t process_ = -1;
  int pipe_ = -1;
};

}  // namespace

void run_workers(const FrameJob& job) {
  if (job.frames == 0) return;
  const std::size_t stride =
      std::min(job.frames, static_cast<std::size_t>(std::max(1, job.workers)));
  std::deque<Worker> workers;
  for (std::size_t k = 0; k < stride; ++k) workers.emplace_back(job, k, stride);
  std::vector<std::uint8_t> bytes;
  for (std::size_t frame = 0; frame < job.frames; ++frame) {
    workers[frame % stride].next(bytes);
    job.take(frame, bytes);
  }
}

}  // namespace evo::render
