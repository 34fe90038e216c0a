// A fixed set of worker threads and the one thing asked of them: run f(i) for
// i in [0, n). Which worker runs which i is left open, so f must depend on i
// alone; that is what makes results independent of the number of threads.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace evo {

// Cores this process may use (its affinity mask), at least 1.
int available_cores();

// More is asked for by mistake, and would take the processes of the whole machine.
inline constexpr int most_threads = 1024;

class ThreadPool {
 public:
  // `threads` counts the caller, which works too; 1 starts no thread.
  explicit ThreadPool(int threads);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  int threads() const;

  // Runs f(i, worker) for every i, worker in [0, threads()), and returns when
  // all are done. The exception of the smallest failing i is thrown again here.
  void run(std::size_t n, const std::function<void(std::size_t i, int worker)>& f);

 private:
  struct Shared;
  std::unique_ptr<Shared> shared_;
};

}  // namespace evo
