#include "octomarch/base/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#ifdef __linux__
#include <sched.h>
#endif

namespace octomarch {

namespace {

constexpr std::chrono::milliseconds kPollInterval{20};

/// What workers and the calling thread share.
struct Shared {
  std::atomic<std::size_t> next{0};
  std::atomic<std::size_t> done{0};
  bool cancelled = false;  ///< written atomically; a plain bool so that kernels can poll it without <atomic>
  std::mutex mutex;
  std::condition_variable ended;
  std::size_t running = 0;
  std::exception_ptr error;

  void cancel() { __atomic_store_n(&cancelled, true, __ATOMIC_RELAXED); }
  void fail(std::exception_ptr e) {
    const std::lock_guard lock(mutex);
    if (!error) error = std::move(e);
    cancel();
  }
};

/// Starts the calling worker on a processor of its own where there are as many workers as processors: left to itself
/// the kernel often begins two new threads on one, and moves them apart only after the few milliseconds that a small
/// picture takes. The thread is not bound: it may move from then on.
void spread_out([[maybe_unused]] std::size_t worker, [[maybe_unused]] std::size_t workers) {
#ifdef __linux__
  cpu_set_t allowed;
  if (sched_getaffinity(0, sizeof allowed, &allowed) != 0) return;
  if (workers == 1 || workers != static_cast<std::size_t>(CPU_COUNT(&allowed))) return;
  std::size_t cpu = 0;
  for (std::size_t to_skip = worker; cpu < CPU_SETSIZE; ++cpu) {
    if (CPU_ISSET(cpu, &allowed) && to_skip-- == 0) break;
  }
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(cpu, &one);
  if (sched_setaffinity(0, sizeof one, &one) == 0) sched_setaffinity(0, sizeof allowed, &allowed);
#endif
}

}  // namespace

unsigned thread_count(unsigned threads) {
  if (threads != 0) return threads;
#ifdef __linux__
  cpu_set_t allowed;
  if (sched_getaffinity(0, sizeof allowed, &allowed) == 0) return static_cast<unsigned>(CPU_COUNT(&allowed));
#endif
  return std::max(1U, std::thread::hardware_concurrency());
}

void parallel_for(std::size_t tasks, unsigned threads,
                  const std::function<void(std::size_t, std::size_t, const bool&)>& body, const Listener& listener) {
  Shared shared;
  const std::size_t count = std::min<std::size_t>(std::max(threads, 1U), tasks);
  const auto work = [&](std::size_t worker) {
    try {
      spread_out(worker, count);
      for (;;) {
        const std::size_t task = shared.next.fetch_add(1, std::memory_order_relaxed);
        if (task >= tasks || is_set(shared.cancelled)) break;
        body(task, worker, shared.cancelled);
        shared.done.fetch_add(1, std::memory_order_relaxed);
      }
    } catch (...) {
      shared.fail(std::current_exception());
    }
    const std::lock_guard lock(shared.mutex);
    --shared.running;
    shared.ended.notify_one();
  };

  if (listener.progress) listener.progress(0, tasks);
  std::vector<std::jthread> workers;
  std::exception_ptr not_started;
  shared.running = count;
  for (std::size_t worker = 0; worker < count; ++worker) {
    try {
      workers.emplace_back(work, worker);
    } catch (...) {
      const std::lock_guard lock(shared.mutex);
      --shared.running;
      not_started = std::current_exception();
    }
  }
  if (workers.empty() && not_started) std::rethrow_exception(not_started);  // fewer than asked for still do the work

  std::unique_lock lock(shared.mutex);
  while (shared.running > 0) {
    if (shared.ended.wait_for(lock, kPollInterval, [&] { return shared.running == 0; })) break;
    lock.unlock();
    try {
      if (!is_set(shared.cancelled)) {
        if (listener.poll) listener.poll();
        if (listener.progress) listener.progress(shared.done.load(std::memory_order_relaxed), tasks);
      }
    } catch (...) {
      shared.fail(std::current_exception());
    }
    lock.lock();
  }
  lock.unlock();
  workers.clear();
  if (shared.error) std::rethrow_exception(shared.error);
  if (listener.progress) listener.progress(tasks, tasks);
}

}  // namespace octomarch
