// Work over all cores with a calling thread that stays free to listen: to the host's interrupts, and for progress.
#pragma once

#include <cstddef>
#include <functional>

namespace octomarch {

/// What the calling thread does while workers run; either may be empty.
struct Listener {
  std::function<void()> poll;  ///< every 20 ms; throws to cancel the work
  std::function<void(std::size_t done, std::size_t all)>
      progress;  ///< on the calling thread: first, every 20 ms, and last
};

/// Reads a flag that another thread may be setting.
inline bool is_set(const bool& flag) { return __atomic_load_n(&flag, __ATOMIC_RELAXED); }

/// Threads to use for a request: `threads` itself, or one per core this process may run on when 0.
unsigned thread_count(unsigned threads);

/// Runs body(task, worker, cancelled) for every task in [0, tasks), on `threads` new threads, tasks handed out in
/// order. An exception from a body or the listener stops the rest (`cancelled` becomes true, to be polled by long
/// bodies) and is thrown here once all workers have ended. Threads are made per call: a pool would not survive a fork.
void parallel_for(std::size_t tasks, unsigned threads,
                  const std::function<void(std::size_t task, std::size_t worker, const bool& cancelled)>& body,
                  const Listener& listener);

}  // namespace octomarch
