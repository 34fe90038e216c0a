#include "libevo/base/parallel.h"

#include <sched.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace evo {

int available_cores() {
  cpu_set_t set;
  CPU_ZERO(&set);
  if (sched_getaffinity(0, sizeof set, &set) != 0)
    return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  return std::max(1, CPU_COUNT(&set));
}

struct ThreadPool::Shared {
  // Also when the constructor of the pool fails halfway.
  ~Shared() {
    {
      const std::lock_guard lock(mutex);
      stop = true;
    }
    wake.notify_all();
    for (std::thread& worker : workers) worker.join();
  }

  std::vector<std::thread> workers;
  std::mutex mutex;
  std::condition_variable wake;
  std::condition_variable finished;
  std::size_t generation = 0;  // counts calls of run, so that a worker joins each once
  std::size_t busy = 0;
  bool stop = false;

  const std::function<void(std::size_t, int)>* job = nullptr;
  std::size_t count = 0;
  std::atomic<std::size_t> next = 0;
  std::exception_ptr failure;
  std::size_t failed_index = 0;

  void work(int worker) {
    for (std::size_t i = next.fetch_add(1); i < count; i = next.fetch_add(1)) {
      try {
        (*job)(i, worker);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!failure || i < failed_index) {
          failure = std::current_exception();
          failed_index = i;
        }
        // Every smaller i has been begun already, so the smallest failure is found.
        next = count;
      }
    }
  }

  void loop(int worker) {
    std::size_t seen = 0;
    std::unique_lock lock(mutex);
    for (;;) {
      wake.wait(lock, [&] { return stop || generation != seen; });
      if (stop) return;
      seen = generation;
      lock.unlock();
      work(worker);
      lock.lock();
      if (--busy == 0) finished.notify_one();
    }
  }
};

ThreadPool::ThreadPool(int threads) : shared_(std::make_unique<Shared>()) {
  shared_->workers.reserve(static_cast<std::size_t>(std::max(threads, 1)));
  try {
    for (int worker = 1; worker < threads; ++worker)
      shared_->workers.emplace_back([shared = shared_.get(), worker] { shared->loop(worker); });
  } catch (const std::system_error&) {
    // Those that are there share the work.
  }
}

ThreadPool::~ThreadPool() = default;

int ThreadPool::threads() const { return static_cast<int>(shared_->workers.size()) + 1; }

void ThreadPool::run(std::size_t n, const std::function<void(std::size_t, int)>& f) {
  {
    const std::lock_guard lock(shared_->mutex);
    shared_->job = &f;
    shared_->count = n;
    shared_->next = 0;
    shared_->failure = nullptr;
    shared_->busy = shared_->workers.size();
    ++shared_->generation;
  }
  shared_->wake.notify_all();
  shared_->work(0);
  std::unique_lock lock(shared_->mutex);
  shared_->finished.wait(lock, [&] { return shared_->busy == 0; });
  if (shared_->failure) std::rethrow_exception(shared_->failure);
}

}  // namespace evo
