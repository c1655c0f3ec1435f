// Lanes that each run a part of their own: the operands that decide in the cell in which the lane's ray or point is, where that
// has a list. For where so few share a cell that running it for them alone would leave most lanes empty. Comes before
// chain_march.hpp and chain_points.hpp.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "octomarch/kernels/api.hpp"
#include "octomarch/render/buffer.hpp"
#include "octomarch/render/cell_choice.hpp"

namespace octomarch {

template <class Function>
void for_each_lane(std::uint64_t lanes, Function&& f) {
  for (; lanes != 0; lanes &= lanes - 1) f(static_cast<std::size_t>(std::countr_zero(lanes)));
}

/// Sets of lanes are words; bit = lane. Keeps its memory; one for each thread.
template <class Real>
class ChainLanes {
 public:
  static constexpr std::size_t kLanes = kernels::kLanes;

  /// The octree must have a chain. `choice` must outlive this.
  explicit ChainLanes(CellChoice<Real>& choice);

  const kernels::ChainView<Real>& chain() const { return chain_; }
  kernels::ChainBlock<Real>& block() { return block_; }
  /// The field at each lane's point, once a kernel has run.
  const Real* field() const { return block_.registers + chain_.taken_up * kLanes; }

  /// Lets lanes that nobody needs take up one operand, the least: those of the others decide how long a block runs.
  void clear(std::uint64_t lanes) {
    for_each_lane(lanes, [&](std::size_t lane) { set_operands(lane, 1); });
  }
  void place(std::size_t lane, Real x, Real y, Real z) {
    block_.registers[lane] = x;
    block_.registers[kLanes + lane] = y;
    block_.registers[2 * kLanes + lane] = z;
  }

  /// Takes region and operands of the cells in which lanes' points are; returns which lanes have got any. Others are in cells of too
  /// many operands, where memory has ended, or nowhere.
  std::uint64_t enter(std::uint64_t lanes) {
    const std::uint64_t found = find_cells(lanes);
    for_each_lane(found, [&](std::size_t lane) { take(lane); });
    choice_.count_visits(static_cast<std::size_t>(std::popcount(found)));
    return found;
  }

 private:
  using Cell = typename Octree<Real>::Cell;
  using Place = typename Octree<Real>::Place;
  static constexpr unsigned kLevels = Octree<Real>::kLevels;

  /// Where a lane is, and the cell that it has come to.
  struct Path {
    typename Octree<Real>::Top* top = nullptr;
    std::array<std::uint32_t, 3> at{};  ///< a place in it, in smallest cells
    Cell* cell = nullptr;

    Place place(unsigned level) const {
      Place place{top, level, at};
      for (std::uint32_t& corner : place.corner) corner &= ~std::uint32_t{0} << (kLevels - level);
      return place;
    }
    /// Of the place, in the cell.
    unsigned octant() const {
      const unsigned shift = kLevels - 1 - cell->level;
      return (at[0] >> shift & 1U) | (at[1] >> shift & 1U) << 1U | (at[2] >> shift & 1U) << 2U;
    }
  };

  /// All go down level by level, so that they wait for memory together. A step down reads two lines, a shortcut one.
  std::uint64_t find_cells(std::uint64_t lanes) {
    std::uint64_t found = 0;
    std::uint64_t above = 0;
    for_each_lane(lanes, [&](std::size_t lane) { above |= std::uint64_t{begin_path(lane)} << lane; });
    while (above != 0) {
      std::uint64_t below = 0;
      for_each_lane(above, [&](std::size_t lane) {
        const Cell& cell = *paths_[lane].cell;
        if (choice_.is_short_alone(cell)) {
          found |= std::uint64_t{is_ready(cell)} << lane;
        } else {
          __builtin_prefetch(cell.branch.load(std::memory_order_relaxed));
          below |= std::uint64_t{1} << lane;
        }
      });
      above = 0;
      for_each_lane(below, [&](std::size_t lane) {
        Path& path = paths_[lane];
        if (Cell* const child = child_of(path)) {
          __builtin_prefetch(child);
          path.cell = child;
          above |= std::uint64_t{1} << lane;
        } else {
          found |= std::uint64_t{is_ready(*path.cell)} << lane;
        }
      });
    }
    return found;
  }

  /// Begins a lane's way down at the smallest cell that is known; false where its point is in none.
  bool begin_path(std::size_t lane) {
    const Real* const point = block_.registers + lane;
    Path& path = paths_[lane];
    path.top = choice_.octree().find(point[0], point[kLanes], point[2 * kLanes], path.at);
    if (path.top == nullptr) return false;
    path.cell = is_first(path.top) ? shortcuts_.find(path.at) : nullptr;
    if (path.cell == nullptr) path.cell = &path.top->cell;
    __builtin_prefetch(path.cell);
    return true;
  }

  bool is_first(const typename Octree<Real>::Top* top) const { return top == choice_.octree().tops().data(); }

  /// The child in which a path's place is, made if that is worth it, else null.
  Cell* child_of(const Path& path) {
    Cell& cell = *path.cell;
    const unsigned octant = path.octant();
    if (Cell* const child = cell.child(octant)) {
      if (is_first(path.top) && child->level <= shortcuts_.levels()) shortcuts_.remember(path.at, *child);
      return child;
    }
    // which may be for the moment only
    if (!choice_.is_worth_making_alone(cell, octant)) return nullptr;
    return &choice_.child(cell, path.place(cell.level + 1U), octant);
  }

  bool is_ready(const Cell& cell) const {
    __builtin_prefetch(cell.part.origins);
    return choice_.fits_lanes(cell);
  }

  /// Copies region and operands of a lane's cell.
  void take(std::size_t lane) {
    const Path& path = paths_[lane];
    const TapePart& part = path.cell->part;
    const Region<Real> region = path.place(path.cell->level).region();
    block_.lo.x[lane] = region.lo[0];
    block_.lo.y[lane] = region.lo[1];
    block_.lo.z[lane] = region.lo[2];
    block_.hi.x[lane] = region.hi[0];
    block_.hi.y[lane] = region.hi[1];
    block_.hi.z[lane] = region.hi[2];
    set_operands(lane, part.operands);
    (this->*take_operands_)(lane, part.list());
  }

  /// How many operands a lane has from now on. They are to be taken.
  void set_operands(std::size_t lane, std::size_t count) {
    if (kinds_.size() > 1) {
      Real* const kinds = block_.columns + (chain_.columns - 1) * kLanes + lane;
      for (auto j = static_cast<std::size_t>(block_.operands[lane]); j-- > count;) {
        kinds[j * chain_.columns * kLanes] = kernels::kNoKind<Real>;
      }
    }
    block_.operands[lane] = static_cast<Real>(count);
  }

  using TakeOperands = void (ChainLanes::*)(std::size_t lane, std::span<const std::uint32_t> operands);

  template <std::size_t kColumns>
  void take_operands(std::size_t lane, std::span<const std::uint32_t> operands) {
    const Real* const table = choice_.octree().table();
    const std::size_t columns = kColumns == kManyColumns ? chain_.columns : kColumns;
    Real* to = block_.columns + lane;
    for (const std::uint32_t operand : operands) {
      const Real* const from = table + operand * columns;
      for (std::size_t k = 0; k < columns; ++k, to += kLanes) *to = from[k];
    }
  }
  static constexpr std::size_t kManyColumns = 0;

  /// A loop without a count is a quarter faster.
  static TakeOperands take_operands_of(std::size_t columns) {
    constexpr std::size_t kMostCounted = 20;
    const auto pick = [&]<std::size_t... kColumns>(std::index_sequence<kColumns...>) {
      constexpr TakeOperands kAll[] = {&ChainLanes::template take_operands<kColumns>...};
      return kAll[columns <= kMostCounted ? columns : kManyColumns];
    };
    return pick(std::make_index_sequence<kMostCounted + 1>{});
  }

  CellChoice<Real>& choice_;
  Shortcuts<Cell, kLevels>& shortcuts_;
  std::vector<kernels::KindView<Real>> kinds_;
  kernels::ChainView<Real> chain_{};
  TakeOperands take_operands_;
  Buffer<Real> memory_;
  kernels::ChainBlock<Real> block_{};
  std::array<Path, kLanes> paths_{};
};

template <class Real>
ChainLanes<Real>::ChainLanes(CellChoice<Real>& choice) : choice_(choice), shortcuts_(choice.octree().shortcuts()) {
  const Real* const table = choice.octree().table();
  const Chain& chain = *choice.octree().chain();
  for (const Chain::Kind& kind : chain.kinds()) {
    kinds_.push_back({kind.instructions.data(), kind.length, kind.combine(), table + kind.combine().constants});
  }
  chain_ = {kinds_.data(), kinds_.size(), chain.columns(), chain.taken_up()};
  take_operands_ = take_operands_of(chain_.columns);
  constexpr std::size_t kRowsOfBlock = 19;
  const std::size_t rows_of_operands = choice.most_operands() * chain_.columns;
  const std::size_t registers = chain.registers();
  const std::size_t rows = kRowsOfBlock + registers + rows_of_operands;
  memory_ = Buffer<Real>(rows * kLanes);
  Real* next = memory_.data();
  const auto take_rows = [&](std::size_t count) { return std::exchange(next, next + count * kLanes); };
  const auto take_row = [&] { return take_rows(1); };
  const auto take_vector = [&] { return kernels::Vectors<Real>{take_row(), take_row(), take_row()}; };
  block_.origin = take_vector();
  block_.direction = take_vector();
  for (Real** row : {&block_.t_max, &block_.epsilon, &block_.t, &block_.before, &block_.stride, &block_.boldness}) {
    *row = take_row();
  }
  block_.lo = take_vector();
  block_.hi = take_vector();
  block_.operands = take_row();
  block_.registers = take_rows(registers);
  block_.columns = next;
  std::fill_n(next, rows_of_operands * kLanes, kernels::kNoKind<Real>);
  clear(~std::uint64_t{0});
}

}  // namespace octomarch
