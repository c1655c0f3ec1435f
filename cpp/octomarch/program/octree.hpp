// The octree of pruned programs: cells of space, each with what is left there of a tape. Cells are made when somebody comes to
// them, by any thread, so that the cost follows what is seen. prune.hpp comes before; render/ runs the parts.
//
// What a cell holds gives the bits of the whole tape, so it does not matter to any result which cells there are, who made them
// when, or where the memory ends.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <tuple>
#include <unordered_map>

#include "octomarch/program/prune.hpp"

namespace octomarch {

template <class Real>
class Octree {
 public:
  struct Cell {
    Region<Real> region;
    Real middle[3];                        ///< where children meet
    std::shared_ptr<const TapePart> part;  ///< of the tape, that decides in the region
    unsigned stalled;                      ///< ancestors in a row, and itself, that left much of what they had
    bool is_leaf;
    bool is_shorter = true;  ///< did it leave out much of what its parent has?
    std::array<std::atomic<Cell*>, 8> children{};

    /// Which child holds a point.
    unsigned octant_of(Real x, Real y, Real z) const {
      return static_cast<unsigned>(x >= middle[0]) | static_cast<unsigned>(y >= middle[1]) << 1U |
             static_cast<unsigned>(z >= middle[2]) << 2U;
    }

    ~Cell() {
      for (auto& child : children) delete child.load(std::memory_order_relaxed);
    }
  };

  /// `focus`: where most of the shape is, in which it is subdivided until that no longer helps; `reach`: how far from its middle
  /// points will be. `tape` must outlive this.
  /// `most_bytes`: memory at which no more cells are made.
  Octree(const Tape& tape, const Aabb& focus, double reach, std::size_t most_bytes);
  Octree(const Tape& tape, const Aabb& focus, double reach);
  Octree(const Octree&) = delete;

  const Tape& tape() const { return tape_; }
  double reach() const { return reach_; }
  /// For a pruner of its cells' parts.
  const std::vector<Margin>& margins() const { return margins_; }
  /// The largest cells: one about the focus, and one about all that is in reach, for points that are not in the first.
  std::array<Cell, 2>& tops() { return tops_; }
  /// The cell of all other points, which is a leaf with the whole tape.
  const Cell& outside() const { return outside_; }
  /// A child of a cell that is no leaf, made now if need be; null where memory has ended. Safe from any thread, `pruner` being
  /// the thread's own. O(part) where it is made, else O(1).
  Cell* child(Cell& parent, unsigned octant, Pruner<Real>& pruner);
  /// A child that is the caller's own, and no part of the octree.
  std::unique_ptr<Cell> make_apart(const Cell& parent, unsigned octant, Pruner<Real>& pruner) const;

  /// Has memory ended?
  bool is_full() const;
  std::size_t cells() const { return cells_.load(std::memory_order_relaxed); }
  /// Memory of cells and parts.
  std::size_t bytes() const { return bytes_.load(std::memory_order_relaxed); }

 private:
  Cell* make_child(Cell& parent, unsigned octant, Pruner<Real>& pruner);
  std::shared_ptr<const TapePart> shared(std::shared_ptr<const TapePart> part);
  bool is_small(const Region<Real>& region) const;

  const Tape& tape_;
  Real focus_size_;
  double reach_;
  std::size_t most_bytes_;
  std::vector<Margin> margins_;
  std::atomic<std::size_t> cells_{0};
  std::atomic<std::size_t> bytes_{0};
  std::mutex parts_mutex_;
  std::unordered_multimap<std::size_t, std::shared_ptr<const TapePart>> parts_;  ///< the short ones, by their hash
  Cell outside_;
  std::array<Cell, 2> tops_;
};

/// Is a tape long enough, and does enough of it go away in small cells, for an octree to be worth its cost? O(tape).
bool is_worth_an_octree(const Tape& tape, const Aabb& focus);

/// The octrees of one tape, kept from picture to picture. Safe from any thread.
class Octrees {
 public:
  /// An octree about the focus that reaches at least so far from its middle; null where the tape is too short for one to be
  /// worth its cost, or too little of it goes away in small cells. One that reached less, or is full, is given up.
  template <class Real>
  std::shared_ptr<Octree<Real>> get(const Tape& tape, const Aabb& focus, double reach);
  /// Memory of the one that is kept.
  template <class Real>
  std::size_t bytes();

 private:
  std::mutex mutex_;
  std::optional<bool> is_worth_it_;
  std::tuple<std::shared_ptr<Octree<float>>, std::shared_ptr<Octree<double>>> kept_;
};

/// Those of a program's tapes.
struct ProgramOctrees {
  Octrees distance;
  Octrees attributes;
  Octrees surface;

  template <class Real>
  std::size_t bytes() {
    return distance.bytes<Real>() + attributes.bytes<Real>() + surface.bytes<Real>();
  }
};

}  // namespace octomarch
