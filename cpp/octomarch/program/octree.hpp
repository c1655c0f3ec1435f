// The octree of pruned programs: cells of space, each with what is left there of a tape. Cells are made when somebody comes to
// them, by any thread, so that the cost follows what is seen. prune.hpp comes before; render/ runs the parts.
//
// What a cell holds gives the bits of the whole tape, so it does not matter to any result which cells there are, who made them
// when, or where the memory ends.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "octomarch/base/arena.hpp"
#include "octomarch/base/hash_table.hpp"
#include "octomarch/program/chain.hpp"
#include "octomarch/program/packed_part.hpp"
#include "octomarch/program/prune.hpp"
#include "octomarch/program/shortcuts.hpp"

namespace octomarch {

template <class Real>
class CellMaker;

template <class Real>
class Octree {
 public:
  /// Halvings of a largest cell, at the most.
  static constexpr unsigned kLevels = 13;
  static constexpr std::size_t kTops = 24;  ///< largest cells, beyond which nobody looks

  struct Cell;
  struct alignas(Arena::kAlignment) Branch {
    std::array<std::atomic<Cell*>, 8> children{};
  };
  /// One cache line: whoever passes by looks at all of it.
  struct alignas(Arena::kAlignment) Cell {
    TapePart part;                         ///< of the tape, that decides in the cell's region
    std::atomic<Branch*> branch{nullptr};  ///< its children
    /// What runs of the part have cost so far that would have been cheaper in children, had there been any; see CellChoice.
    std::atomic<float> regret{0.0F};
    std::uint8_t stalled = 0;  ///< ancestors in a row, and itself, that left much of what they had
    bool is_leaf = false;
    std::uint8_t level = 0;  ///< see Place

    /// A child, if it has been made. `octant`: bit 0 is set for the upper half along x, bit 1 along y, bit 2 along z.
    Cell* child(unsigned octant) const {
      const Branch* const made = branch.load(std::memory_order_acquire);
      return made == nullptr ? nullptr : made->children[octant].load(std::memory_order_acquire);
    }
  };

  /// One of the largest cells, a cube: points that it holds and those before it do not are looked for below it.
  struct Top {
    Real lo[3];
    Real size;      ///< of its smallest cells
    Real per_size;  ///< 1 / size
    Real room;      ///< by which regions are larger than cells, since places of points are rounded
    Cell cell;
    std::once_flag is_walked;
    /// Of the tape, where it is run at points of the cell; made when first asked for, as the next. Empty where all parts are lists.
    std::vector<Margin> margins;
    std::vector<Margin> margins_of_lists;

    /// Where a point is, in smallest cells; false, and nothing, where it is not in this one.
    bool find(Real x, Real y, Real z, std::array<std::uint32_t, 3>& at) const {
      const Real cells[3] = {(x - lo[0]) * per_size, (y - lo[1]) * per_size, (z - lo[2]) * per_size};
      const auto is_within = [](Real c) { return (c >= Real(0)) & (c < Real(1U << kLevels)); };
      if (!(is_within(cells[0]) & is_within(cells[1]) & is_within(cells[2]))) return false;
      for (unsigned axis = 0; axis < 3; ++axis) at[axis] = static_cast<std::uint32_t>(cells[axis]);
      return true;
    }
  };

  /// Where a cell is.
  struct Place {
    Top* top;
    unsigned level = 0;                     ///< halvings
    std::array<std::uint32_t, 3> corner{};  ///< lower, in smallest cells

    Place child(unsigned octant) const;
    /// Holds all points that are found there, and a little more.
    Region<Real> region() const {
      const std::uint32_t across = 1U << (kLevels - level);
      Region<Real> region;
      for (unsigned axis = 0; axis < 3; ++axis) {
        const auto end = [&](std::uint32_t at) { return top->lo[axis] + static_cast<Real>(at) * top->size; };
        region.lo[axis] = end(corner[axis]) - top->room;
        region.hi[axis] = end(corner[axis] + across) + top->room;
      }
      return region;
    }
  };

  /// `focus`: where most of the shape is, in which it is subdivided until that no longer helps. `most_bytes`: memory at which no
  /// more cells are made. `tape` must outlive this.
  Octree(const Tape& tape, const Aabb& focus, std::size_t most_bytes);
  Octree(const Tape& tape, const Aabb& focus);
  Octree(const Octree&) = delete;

  const Tape& tape() const { return tape_; }
  /// The tape's, or null. Parts that have nothing but its operands are lists.
  const Chain* chain() const { return chain_ ? &*chain_ : nullptr; }
  /// That parts need at the most.
  std::uint32_t registers() const;

  /// The largest cells, each about the one before.
  std::vector<Top>& tops() { return tops_; }
  /// The cell of points in none of them, which is a leaf with the whole tape.
  const Cell& outside() const { return outside_; }
  /// The way to a point's smallest cell: which of the tops, tops().size() standing for none, and below, for each level, three bits
  /// that say which octant. The numbers of points in one cell follow each other. O(tops).
  std::uint64_t way_to(Real x, Real y, Real z) const;
  /// The top below which a point is looked for, and where it is there, in smallest cells; null where it is in none. O(tops).
  Top* find(Real x, Real y, Real z, std::array<std::uint32_t, 3>& at) {
    for (Top& top : tops_) {
      if (top.find(x, y, z, at)) return &top;
    }
    return nullptr;
  }
  /// Of the chain's operands, Chain::table().
  const Real* table() const { return table_.data(); }
  /// To cells of the first of the tops, where there is a chain.
  Shortcuts<Cell, kLevels>& shortcuts() { return shortcuts_; }
  Unpacker unpacker() const { return Unpacker(constants_, chain()); }
  static constexpr unsigned kWayBits = 3 * kLevels;

  /// Has memory ended?
  bool is_full() const;
  std::size_t cells() const { return cells_.load(std::memory_order_relaxed); }
  /// Memory of cells and parts.
  std::size_t bytes() const { return bytes_.load(std::memory_order_relaxed); }

 private:
  friend class CellMaker<Real>;

  /// Memory for what one thread makes at a time.
  std::unique_ptr<Arena> lend();
  void give_back(std::unique_ptr<Arena> arena);
  bool is_small(const Place& place) const;
  /// Is the part that is the whole tape a list?
  bool is_one_list() const { return chain_ && chain_->is_whole(); }
  const Margin* margins(Top& top, const TapePart& part);
  TapePart whole() const;

  const Tape& tape_;
  std::optional<Chain> chain_;
  std::vector<Real> table_;
  std::vector<std::uint32_t> all_operands_;
  Shortcuts<Cell, kLevels> shortcuts_;
  Real focus_size_;
  std::size_t most_bytes_;
  HeldPart whole_;  ///< where the tape is more than its chain
  std::vector<std::uint32_t> constants_;
  std::atomic<std::size_t> cells_{0};
  std::atomic<std::size_t> bytes_{0};
  std::mutex mutex_;                            ///< of the next two
  HashTable<const TapePart*> parts_;            ///< the short ones
  std::vector<std::unique_ptr<Arena>> arenas_;  ///< that nobody has at the moment
  Cell outside_;
  std::vector<Top> tops_;
};

/// Makes cells of an octree; one for each thread.
template <class Real>
class CellMaker {
 public:
  using Cell = typename Octree<Real>::Cell;
  using Place = typename Octree<Real>::Place;

  /// Both must outlive this.
  CellMaker(Octree<Real>& octree, Sampler<Real>& sampler);
  CellMaker(const CellMaker&) = delete;
  ~CellMaker();

  /// A child of a cell that is no leaf, made now if need be. `place`: the child's. Where memory has ended it is no part of the
  /// octree, and gone with the next call of forget_passing(). O(part) where it is made, else O(1).
  Cell& child(Cell& parent, const Place& place, unsigned octant);
  void forget_passing() { passing_.clear(); }

 private:
  using Branch = typename Octree<Real>::Branch;

  Cell* make(const Cell& parent, const Place& place, Arena& arena);
  std::optional<TapePart> prune(const TapePart& part, const Region<Real>& region, const Margin* margins);
  TapePart kept(const TapePart& part, bool is_final, Arena& arena);

  Octree<Real>& octree_;
  Pruner<Real> pruner_;
  Packer packer_;
  Unpacker unpacker_;
  std::vector<std::uint32_t> operands_;
  std::unique_ptr<Arena> arena_;
  Arena passing_;
};

/// Is a tape long enough, and does enough of it go away in small cells, for an octree to be worth its cost? O(tape).
bool is_worth_an_octree(const Tape& tape, const Aabb& focus);

/// The octrees of one tape, kept from picture to picture. Safe from any thread.
class Octrees {
 public:
  /// An octree about the focus; null where the tape is too short for one to be worth its cost, or too little of it goes away in
  /// small cells. One that is full is given up.
  template <class Real>
  std::shared_ptr<Octree<Real>> get(const Tape& tape, const Aabb& focus);
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
