// Where there are no threads: the caller does all the work.
#include "libevo/base/parallel.h"

namespace evo {

int available_cores() { return 1; }

struct ThreadPool::Shared {};

ThreadPool::ThreadPool(int) {}
ThreadPool::~ThreadPool() = default;

int ThreadPool::threads() const { return 1; }

// In order, so that the first failure is the smallest.
void ThreadPool::run(std::size_t n, const std::function<void(std::size_t, int)>& f) {
  for (std::size_t i = 0; i < n; ++i) f(i, 0);
}

}  // namespace evo
