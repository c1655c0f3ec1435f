// Which cells of an octree are run: large ones where few elements come, small ones with short programs where there are many.
// Comes before cell_groups.hpp, cell_sweep.hpp and chain_lanes.hpp.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "octomarch/base/parallel.hpp"
#include "octomarch/kernels/api.hpp"
#include "octomarch/program/octree.hpp"
#include "octomarch/render/stages.hpp"

namespace octomarch {

/// What becomes of an element in its cell, about.
struct Stay {
  double evaluations;
  double octants;  ///< that it comes to
};
inline constexpr Stay kStayOfPoint{1.0, 1.0};
inline constexpr Stay kStayOfRay{3.0, 1.5};

/// Weighs what instructions and groups cost, and makes cells that have paid. One for each thread.
template <class Real>
class CellChoice {
 public:
  using Cell = typename Octree<Real>::Cell;
  using Place = typename Octree<Real>::Place;

  /// Both must outlive this.
  CellChoice(Octree<Real>& octree, Sampler<Real>& sampler)
      : octree_(octree),
        maker_(octree, sampler),
        unpacker_(octree.unpacker()),
        alone_(octree.chain() == nullptr ? Alone{} : Alone(*octree.chain())) {}

  Octree<Real>& octree() { return octree_; }

  /// `stay`: of all elements. Counts for `stage`. Whoever chooses asks is_cancelled() before each child, since making one can take
  /// long. Both must outlive the choices that follow.
  void begin(const Stay& stay, const bool& cancelled, StageStats& stage) {
    stay_ = stay;
    cancelled_ = &cancelled;
    stage_ = &stage;
    forget_passing();
  }
  bool is_cancelled() const { return is_set(*cancelled_); }
  /// Gives up the cells that were made for the moment, where the octree is full.
  void forget_passing() { maker_.forget_passing(); }

  /// Are a cell's elements, so many in each octant, to be run by its children? For cells that are no leaves.
  bool goes_deeper(Cell& cell, const std::array<std::uint32_t, 8>& counts) {
    if (is_cancelled()) return false;
    const auto* const branch = cell.branch.load(std::memory_order_acquire);
    const double length = cell.part.length;
    double apart = 0.0;
    double price = 0.0;
    std::uint32_t all = 0;
    for (unsigned octant = 0; octant < 8; ++octant) {
      if (counts[octant] == 0) continue;
      all += counts[octant];
      apart += stay_.octants * entering_cost(counts[octant]);
      const Cell* const child = branch == nullptr ? nullptr : branch->children[octant].load(std::memory_order_acquire);
      if (child != nullptr) {
        __builtin_prefetch(child->branch.load(std::memory_order_relaxed));
        __builtin_prefetch(child->part.is_list() ? static_cast<const void*>(child->part.origins) : child->part.code);
        apart += running_cost(hoped_length(*child), counts[octant]);
      } else {
        apart += running_cost(hoped_length(cell), counts[octant]);
        price += price_of_child(cell);
      }
    }
    return is_worth(cell, entering_cost(all) + running_cost(length, all) - apart, price);
  }

  /// Lists of no more operands than this can be run lane by lane (chain_lanes.hpp).
  std::size_t most_operands() const { return alone_.most_operands; }
  bool fits_lanes(const Cell& cell) const {
    const std::size_t others = std::size_t{cell.part.operands} - 1;  // very many where it is no list
    return others < alone_.most_operands;
  }
  /// Are a cell's elements so few that each should rather run a part of its own, in a cell as small as is worth it? Where memory has
  /// ended lanes may not find a cell.
  bool go_alone(const Cell& cell, std::size_t count) const {
    return count <= alone_.few && fits_lanes(cell) && !octree_.is_full();
  }
  /// The same for points: one evaluation each has to pay for what lanes take, and those that are together here stay so.
  bool go_alone_as_points(const Cell& cell, std::size_t count) const {
    if (!go_alone(cell, count)) return false;
    const double length = std::min(cell.part.length, kShortAlone);
    const auto points = static_cast<std::uint32_t>(count);
    return points * alone_cost(length) < entering_cost(points) + running_cost(cell.part.length, points);
  }
  /// Is a cell's part so short that who goes alone need not look for a smaller one?
  bool is_short_alone(const Cell& cell) const {
    return cell.is_leaf || (cell.part.length <= kShortAlone && fits_lanes(cell));
  }
  /// Is a child to be made for one element, which is run lane by lane? For cells that are no leaves.
  bool is_worth_making_alone(Cell& cell, unsigned octant) {
    if (is_cancelled() || octree_.is_full()) return false;
    if (!cell.part.is_list()) return goes_deeper(cell, only(octant));
    // lanes have no room for the cell; to make a child at once paid even where only a few thousand rays came
    if (!fits_lanes(cell)) return true;
    const double length = cell.part.length;
    const double once = alone_.lane_cost * stay_.evaluations;
    const double apart = stay_.octants * kAloneCost + hoped_length(cell) * (once + stay_.octants * alone_.load_cost);
    return is_worth(cell, alone_cost(length) - apart, price_of_child(cell));
  }

  /// A child; where the octree is full, until the next call of begin() or forget_passing() only.
  Cell& child(Cell& parent, const Place& place, unsigned octant) {
    Cell* const known = parent.child(octant);
    return known != nullptr ? *known : make_child(parent, place, octant);
  }

  /// What is to be run for a cell, until the next call.
  TapePart part(const Cell& cell) { return unpacker_.ready(cell.part); }
  void count_visits(std::size_t visits) { stage_->cells_visited += visits; }

 private:
  // Nanoseconds, about:
  static constexpr double kGroupCost = 150.0;      ///< of a group by itself
  static constexpr double kElementCost = 10.0;     ///< and of each of its elements
  static constexpr double kInstructionCost = 1.0;  ///< of an instruction of an evaluation by itself
  static constexpr double kBatchCost = 1.6;        ///< and for each batch
  static constexpr double kAloneCost = 60.0;       ///< of an element that comes to a cell alone
  static constexpr double kLoadCost = 0.32;        ///< and of a constant there by itself
  static constexpr double kLaneCost = 0.25;        ///< and of an instruction for each evaluation
  /// A group that has more of an operand's constants than this, all elements together, is faster than they alone.
  static constexpr std::size_t kFew = 128;
  /// And where there are few operands, and so few cells, rays meet again later: for so many operands one element more may go alone.
  static constexpr std::size_t kOperandsOfFew = 64;
  /// Whoever goes alone takes a part as short as this, in instructions, as he finds it.
  static constexpr std::uint32_t kShortAlone = 52;
  /// Lanes that run several kinds, each for all of them, are faster only where rays hardly ever meet again.
  static constexpr std::size_t kOperandsOfFewMixed = 4096;
  /// What has to be gained for a child to be made, by itself and for each instruction of its parent. That is a half and a
  /// thirtieth of what it takes, since the smaller cells below it will gain more.
  static constexpr double kCellPrice = 2000.0;
  static constexpr double kPruningPrice = 1.0;
  /// The part of it for a cell with a list, which is made in half the time, takes a third of the memory, and is found by rays that
  /// gain even by few operands less.
  static constexpr double kListPrice = 0.125;
  /// What is hoped for from the smaller cells below one, beside its own program, and at the least.
  static constexpr double kHope = 0.25;
  static constexpr double kLeast = 8.0;

  /// Rows of lanes, which are to stay in a cache: for so many operands at the most, or for these columns of theirs.
  static constexpr std::size_t kMostOperands = 128;
  static constexpr std::size_t kMostRows = 2048;

  /// What going alone depends on; nothing does where a tape has no chain.
  struct Alone {
    std::size_t most_operands = 0;
    std::size_t few = 0;     ///< elements that are better alone
    double load_cost = 0.0;  ///< of an instruction by itself
    double lane_cost = 0.0;  ///< and for each evaluation

    Alone() = default;
    explicit Alone(const Chain& chain) {
      most_operands = std::min(kMostOperands, kMostRows / chain.columns());
      few = std::min(kFew / (chain.columns() * chain.kinds().size()),
                     chain.operands() / (chain.has_one_kind() ? kOperandsOfFew : kOperandsOfFewMixed));
      lane_cost = kLaneCost * static_cast<double>(chain.kinds().size());
      load_cost =
          kLoadCost * static_cast<double>(chain.operands() * chain.columns()) / static_cast<double>(chain.length());
    }
  };

  static double entering_cost(std::uint32_t count) { return kGroupCost + kElementCost * count; }

  double running_cost(double length, std::uint32_t count) const {
    const std::size_t batches = kernels::padded_batches(count) / kernels::kWidestBatch;
    return stay_.evaluations * length * (kInstructionCost + static_cast<double>(batches) * kBatchCost);
  }

  /// Of an element that stays in one cell with a list of this length.
  double alone_cost(double length) const {
    return kAloneCost + length * (alone_.lane_cost * stay_.evaluations + alone_.load_cost);
  }

  static double price_of_child(const Cell& cell) {
    const double price = kCellPrice + kPruningPrice * cell.part.length;
    return cell.part.is_list() ? kListPrice * price : price;
  }

  /// One element, in an octant.
  static std::array<std::uint32_t, 8> only(unsigned octant) {
    std::array<std::uint32_t, 8> counts{};
    counts[octant] = 1;
    return counts;
  }

  static double hoped_length(const Cell& cell) {
    const double length = cell.part.length;
    return cell.is_leaf ? length : std::max(kHope * length, std::min(kLeast, length));
  }

  /// Are children worth their price? They are made when having done without them has cost as much, so that little is lost whether
  /// others come or not.
  static bool is_worth(Cell& cell, double gain, double price) {
    if (gain <= 0.0) return false;
    if (price == 0.0) return true;
    const double regret = static_cast<double>(cell.regret.load(std::memory_order_relaxed)) + gain;
    const bool is_due = regret >= price;
    // what threads add at the same time may get lost
    cell.regret.store(is_due ? 0.0F : static_cast<float>(regret), std::memory_order_relaxed);
    return is_due;
  }

  Cell& make_child(Cell& parent, const Place& place, unsigned octant) {
    const ScopedTimer timer(stage_->cell_seconds);
    ++stage_->cells_made;
    return maker_.child(parent, place, octant);
  }

  Octree<Real>& octree_;
  CellMaker<Real> maker_;
  Unpacker unpacker_;
  Alone alone_;
  Stay stay_ = kStayOfPoint;
  const bool* cancelled_ = nullptr;
  StageStats* stage_ = nullptr;
};

}  // namespace octomarch
