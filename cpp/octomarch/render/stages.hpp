// What each stage of a picture did: exact counts of the work, and how long it took. Comes before cell_choice.hpp and field.hpp,
// which count for the stage that asks.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "octomarch/kernels/api.hpp"

namespace octomarch {

/// Of one worker, or summed over all.
struct StageStats {
  std::uint64_t count = 0;    ///< rays, cones or points that the stage had to do with
  kernels::Counters work;     ///< evaluations are of the field, or of the stage's own expressions
  std::uint64_t without = 0;  ///< points of those that have no gradient: their normals face the ray
  std::uint64_t cells_visited =
      0;  ///< groups of rays or points that the program of their cell was run for, and visits of rays and points alone
  std::uint64_t cells_made = 0;
  double cell_seconds = 0.0;  ///< that making them took
  double seconds = 0.0;       ///< of all of the stage

  StageStats& operator+=(const StageStats& part) {
    count += part.count;
    work += part.work;
    without += part.without;
    cells_visited += part.cells_visited;
    cells_made += part.cells_made;
    cell_seconds += part.cell_seconds;
    seconds += part.seconds;
    return *this;
  }
};

/// Counts a tape's run over points, so many times.
template <class Real>
void count_run(const kernels::TapeView<Real>& tape, std::size_t points, std::size_t times,
               kernels::Counters& counters) {
  const std::size_t slots = kernels::padded_lanes(points) * times;
  counters.lane_slots += slots;
  counters.instructions += slots * tape.length;
}

/// Adds the seconds of its own life to a sum.
class ScopedTimer {
 public:
  explicit ScopedTimer(double& seconds) : seconds_(seconds) {}
  ScopedTimer(const ScopedTimer&) = delete;
  ScopedTimer& operator=(const ScopedTimer&) = delete;
  ~ScopedTimer() { seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  double& seconds_;
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace octomarch
