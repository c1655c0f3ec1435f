#include "octomarch/program/octree.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include "octomarch/base/hash.hpp"

namespace octomarch {

namespace {

/// A part this short is run as it is: another level would cost more than it saves.
constexpr std::size_t kShort = 12;
/// Parts that repeat are short ones, and leaves'.
constexpr std::size_t kShared = 64;
/// Parts longer than this that are no leaves' are packed: it costs a hundredth of a picture's time, and halves the memory.
constexpr std::size_t kPacked = 16;
/// A cell that leaves more than this of its parent's part gains nothing; after so many in a row there are no more.
constexpr double kStall = 0.8;
constexpr unsigned kStalls = 3;
/// That counts for cells smaller than this part of the focus: from far away all of it is alike.
constexpr double kDetail = 1.0 / 16.0;
/// Where it ends, cells are made for the moment only.
constexpr std::size_t kMostBytes = std::size_t{1} << 29;
/// A long tape gets more: as much for each of its instructions, which holds the large cells from which small ones come.
constexpr std::size_t kMostBytesOfInstruction = 2048;
/// The first of the largest cells is so much larger than the focus: rays are marched from a little outside of a solid's bounds.
constexpr double kRoomAbout = 1.125;
/// Each is so much larger than the one before.
constexpr double kGrowth = 4.0;
/// Smallest cells across one.
template <class Real>
constexpr Real kAcross = static_cast<Real>(1U << Octree<Real>::kLevels);
/// Tapes shorter than this are run whole.
constexpr std::size_t kLong = 48;

/// A row of shapes in their order is cut only in cells as small as its gaps, so that the more there is to gain, the more levels
/// may pass without gain.
unsigned most_stalls(std::size_t length) { return kStalls + static_cast<unsigned>(std::bit_width(length / kShared)); }

/// Each of 13 bits moves to three times its place (H. S. Warren, "Hacker's Delight", 2nd ed., 7-2: halves, quarters, ... are drawn
/// apart).
constexpr std::uint64_t spread(std::uint32_t number) {
  std::uint64_t bits = number;
  bits = (bits | bits << 16U) & 0x0000'FF00'00FFULL;
  bits = (bits | bits << 8U) & 0x00F0'0F00'F00FULL;
  bits = (bits | bits << 4U) & 0x0C30'C30C'30C3ULL;
  bits = (bits | bits << 2U) & 0x2492'4924'9249ULL;
  return bits;
}

double longest_side(const Aabb& box) {
  return std::max({box.hi.x - box.lo.x, box.hi.y - box.lo.y, box.hi.z - box.lo.z});
}

bool are_equal(const TapePart& a, const TapePart& b) {
  const auto are_same = [](const auto* first, const auto* second, std::size_t count) {
    return first == second || (first != nullptr && second != nullptr && std::equal(first, first + count, second));
  };
  return a.length == b.length && a.registers == b.registers && are_same(a.results, b.results, a.result_count) &&
         are_same(a.code, b.code, a.length) && are_same(a.origins, b.origins, a.length);
}

/// Parts of one tape differ in their constants, or hardly.
std::uint64_t hash_of(const TapePart& part) {
  std::uint64_t hash = part.length;
  for (const Instruction& instruction : part.instructions()) mix(hash, instruction.constants);
  return hash;
}

}  // namespace

template <class Real>
typename Octree<Real>::Place Octree<Real>::Place::child(unsigned octant) const {
  Place place{top, level + 1, corner};
  for (unsigned axis = 0; axis < 3; ++axis) place.corner[axis] += (octant >> axis & 1U) << (kLevels - place.level);
  return place;
}

template <class Real>
Octree<Real>::Octree(const Tape& tape, const Aabb& focus)
    : Octree(tape, focus, std::max(kMostBytes, tape.code.size() * kMostBytesOfInstruction)) {}

template <class Real>
Octree<Real>::Octree(const Tape& tape, const Aabb& focus, std::size_t most_bytes)
    : tape_(tape),
      chain_(Chain::of(tape)),
      table_(chain_ ? chain_->table<Real>(tape) : std::vector<Real>{}),
      shortcuts_(chain_ ? Shortcuts<Cell, kLevels>(chain_->operands()) : Shortcuts<Cell, kLevels>()),
      focus_size_(static_cast<Real>(longest_side(focus))),
      most_bytes_(most_bytes),
      constants_(is_one_list() ? std::vector<std::uint32_t>{} : constant_offsets(tape)) {
  constexpr double kFarthest = static_cast<double>(std::numeric_limits<Real>::max()) / 16.0;
  if (is_one_list()) {
    all_operands_.resize(chain_->operands());
    std::iota(all_operands_.begin(), all_operands_.end(), 0U);
  } else {
    whole_ = whole_of(tape);
  }
  outside_.part = whole();
  outside_.is_leaf = true;
  tops_ = std::vector<Top>(kTops);
  const double middle[3] = {0.5 * (focus.lo.x + focus.hi.x), 0.5 * (focus.lo.y + focus.hi.y),
                            0.5 * (focus.lo.z + focus.hi.z)};
  double half = 0.5 * longest_side(focus) * kRoomAbout;
  for (Top& top : tops_) {
    top.size = static_cast<Real>(2.0 * half / static_cast<double>(kAcross<Real>));
    top.per_size = Real(1) / top.size;
    double farthest = 0.0;
    for (unsigned axis = 0; axis < 3; ++axis) {
      top.lo[axis] = static_cast<Real>(middle[axis] - half);
      farthest = std::max(farthest, std::fabs(middle[axis]) + 2.0 * half);
    }
    top.room = static_cast<Real>(8.0 * static_cast<double>(std::numeric_limits<Real>::epsilon()) * farthest);
    top.cell.part = whole();
    top.cell.is_leaf = is_small({&top, 0, {}});
    half = std::min(half * kGrowth, kFarthest);
  }
  cells_ = 1 + tops_.size();
  bytes_ = sizeof(*this) + tops_.size() * sizeof(Top) + constants_.size() * sizeof(std::uint32_t) +
           whole_.code.size() * (sizeof(Instruction) + sizeof(std::uint32_t)) +
           all_operands_.size() * sizeof(std::uint32_t) + table_.size() * sizeof(Real) +
           (chain_ ? chain_->bytes() : 0) + shortcuts_.bytes();
}

template <class Real>
TapePart Octree<Real>::whole() const {
  return is_one_list() ? chain_->part_of(all_operands_) : whole_.view();
}

template <class Real>
std::uint32_t Octree<Real>::registers() const {
  return std::max(tape_.registers, chain_ ? chain_->registers() : 0U);
}

template <class Real>
std::uint64_t Octree<Real>::way_to(Real x, Real y, Real z) const {
  for (std::size_t i = 0; i < tops_.size(); ++i) {
    std::array<std::uint32_t, 3> at;
    if (!tops_[i].find(x, y, z, at)) continue;
    std::uint64_t way = static_cast<std::uint64_t>(i) << kWayBits;
    for (unsigned axis = 0; axis < 3; ++axis) way |= spread(at[axis]) << axis;
    return way;
  }
  return static_cast<std::uint64_t>(tops_.size()) << kWayBits;
}

template <class Real>
bool Octree<Real>::is_full() const {
  return bytes() > most_bytes_;
}

/// The farther points may be, the larger are roundings, so that each of the largest cells has margins of its own.
template <class Real>
const Margin* Octree<Real>::margins(Top& top, const TapePart& part) {
  std::call_once(top.is_walked, [&] {
    const Region<Real> region = Place{&top, 0, {}}.region();
    if (!is_one_list()) top.margins = margins_of(tape_, region);
    if (chain_) top.margins_of_lists = chain_->margins(table_, region);
    const std::size_t count = top.margins.size() + top.margins_of_lists.size();
    bytes_.fetch_add(count * sizeof(Margin), std::memory_order_relaxed);
  });
  return part.is_list() ? top.margins_of_lists.data() : top.margins.data();
}

template <class Real>
std::unique_ptr<Arena> Octree<Real>::lend() {
  const std::scoped_lock lock(mutex_);
  if (arenas_.empty()) return std::make_unique<Arena>();
  std::unique_ptr<Arena> arena = std::move(arenas_.back());
  arenas_.pop_back();
  return arena;
}

template <class Real>
void Octree<Real>::give_back(std::unique_ptr<Arena> arena) {
  const std::scoped_lock lock(mutex_);
  arenas_.push_back(std::move(arena));
}

/// Too small to be halved?
template <class Real>
bool Octree<Real>::is_small(const Place& place) const {
  if (place.level == kLevels) return true;
  const Region<Real> region = place.region();
  for (unsigned axis = 0; axis < 3; ++axis) {
    const Real largest = std::max(std::fabs(region.lo[axis]), std::fabs(region.hi[axis]));
    if (!(region.hi[axis] - region.lo[axis] > largest * std::numeric_limits<Real>::epsilon() * Real(64))) return true;
  }
  return false;
}

template <class Real>
CellMaker<Real>::CellMaker(Octree<Real>& octree, Sampler<Real>& sampler)
    : octree_(octree),
      pruner_(octree.tape(), &sampler, octree.table()),
      unpacker_(octree.unpacker()),
      arena_(octree.lend()) {}

template <class Real>
CellMaker<Real>::~CellMaker() {
  octree_.give_back(std::move(arena_));
}

/// Where another thread makes the same branch or child meanwhile, that one is taken.
template <class Real>
typename Octree<Real>::Cell& CellMaker<Real>::child(Cell& parent, const Place& place, unsigned octant) {
  if (Cell* const known = parent.child(octant)) return *known;
  if (octree_.is_full()) return *make(parent, place, passing_);
  const std::size_t before = arena_->bytes();
  Branch* branch = parent.branch.load(std::memory_order_acquire);
  if (branch == nullptr) {
    auto* const made = arena_->make<Branch>();
    if (parent.branch.compare_exchange_strong(branch, made, std::memory_order_acq_rel)) branch = made;
  }
  Cell* const cell = make(parent, place, *arena_);
  octree_.bytes_.fetch_add(arena_->bytes() - before, std::memory_order_relaxed);
  Cell* other = nullptr;
  if (!branch->children[octant].compare_exchange_strong(other, cell, std::memory_order_acq_rel)) return *other;
  octree_.cells_.fetch_add(1, std::memory_order_relaxed);
  return *cell;
}

template <class Real>
typename Octree<Real>::Cell* CellMaker<Real>::make(const Cell& parent, const Place& place, Arena& arena) {
  Cell* const cell = arena.make<Cell>();
  cell->level = static_cast<std::uint8_t>(place.level);
  const Region<Real> region = place.region();
  const std::optional<TapePart> part = prune(parent.part, region, octree_.margins(*place.top, parent.part));
  const std::uint32_t before = parent.part.length;
  const std::uint32_t after = part ? part->length : before;
  const bool is_stalled = after > kStall * before;
  const bool is_detail = region.hi[0] - region.lo[0] < octree_.focus_size_ * Real(kDetail);
  if (is_detail && is_stalled) cell->stalled = static_cast<std::uint8_t>(parent.stalled + 1);
  cell->is_leaf = after <= kShort || cell->stalled >= most_stalls(after) || octree_.is_small(place);
  // little less is no less: what costs memory must save work
  const bool is_kept = part && (after <= kShared || !is_stalled);
  cell->part = is_kept ? kept(*part, cell->is_leaf, arena) : parent.part;
  return cell;
}

/// Nothing where all is left.
template <class Real>
std::optional<TapePart> CellMaker<Real>::prune(const TapePart& part, const Region<Real>& region,
                                               const Margin* margins) {
  const TapePart ready = unpacker_.ready(part);
  const Chain* const chain = octree_.chain();
  if (!part.is_list()) {
    const std::optional<TapePart> left = pruner_.prune(ready, region, margins);
    return left && chain != nullptr && chain->find_operands(*left, operands_) ? chain->part_of(operands_) : left;
  }
  if (!pruner_.prune(*chain, part, ready, region, margins, operands_)) {
    const std::optional<TapePart> left = pruner_.prune(ready, region, margins);
    if (!left || !Chain::find_operands_of_list(*left, operands_)) return std::nullopt;
  }
  if (operands_.size() == part.operands) return std::nullopt;
  return chain->part_of(operands_);
}

/// A part in memory that stays. Equal short parts are one, but for lists, which are short anyway.
template <class Real>
TapePart CellMaker<Real>::kept(const TapePart& part, bool is_final, Arena& arena) {
  if (part.is_list()) {
    return octree_.chain()->part_of({arena.copy(std::span<const std::uint32_t>(operands_)), operands_.size()});
  }
  if (part.length > kPacked && !is_final) {
    if (const std::optional<TapePart> packed = packer_.pack(part, arena)) return *packed;
  }
  TapePart result = part;
  if (is_final) result.origins = nullptr;
  const auto copy = [&] {
    result.code = arena.copy(part.instructions());
    result.results = arena.copy(std::span(part.results, part.result_count));
    if (!is_final) result.origins = arena.copy(std::span(part.origins, part.length));
  };
  if (part.length > kShared || &arena == &passing_) {
    copy();
    return result;
  }
  const std::uint64_t hash = hash_of(part);
  const std::scoped_lock lock(octree_.mutex_);
  const TapePart* const known =
      octree_.parts_.find(hash, [&](const TapePart* other) { return are_equal(*other, result); });
  if (known != nullptr) return *known;
  copy();
  octree_.parts_.insert(hash, arena.make<TapePart>(result));
  return result;
}

bool is_worth_an_octree(const Tape& tape, const Aabb& focus) {
  if (tape.code.size() < kLong || !(longest_side(focus) > 0.0)) return false;  // a point has no parts
  Pruner<double> pruner(tape);
  const HeldPart whole = whole_of(tape);
  // a few cells on a diagonal stand for all
  constexpr int kProbes = 4;
  constexpr double kSize = 1.0 / 16.0;
  std::size_t left = 0;
  for (int probe = 0; probe < kProbes; ++probe) {
    const double at = (probe + 0.5) / kProbes;
    Region<double> cell;
    const double lo[3] = {focus.lo.x, focus.lo.y, focus.lo.z};
    const double hi[3] = {focus.hi.x, focus.hi.y, focus.hi.z};
    for (unsigned axis = 0; axis < 3; ++axis) {
      cell.lo[axis] = lo[axis] + (hi[axis] - lo[axis]) * (at - 0.5 * kSize);
      cell.hi[axis] = lo[axis] + (hi[axis] - lo[axis]) * (at + 0.5 * kSize);
    }
    const std::optional<TapePart> part = pruner.prune(whole.view(), cell, nullptr);
    left += part ? part->length : tape.code.size();
  }
  return static_cast<double>(left) < 0.7 * kProbes * static_cast<double>(tape.code.size());
}

template <class Real>
std::shared_ptr<Octree<Real>> Octrees::get(const Tape& tape, const Aabb& focus) {
  const std::scoped_lock lock(mutex_);
  if (!is_worth_it_) is_worth_it_ = is_worth_an_octree(tape, focus);
  if (!*is_worth_it_) return nullptr;
  auto& kept = std::get<std::shared_ptr<Octree<Real>>>(kept_);
  if (!kept || kept->is_full()) kept = std::make_shared<Octree<Real>>(tape, focus);
  return kept;
}

template <class Real>
std::size_t Octrees::bytes() {
  const std::scoped_lock lock(mutex_);
  const auto& kept = std::get<std::shared_ptr<Octree<Real>>>(kept_);
  return kept ? kept->bytes() : 0;
}

template std::size_t Octrees::bytes<float>();
template std::size_t Octrees::bytes<double>();
template std::shared_ptr<Octree<float>> Octrees::get(const Tape&, const Aabb&);
template std::shared_ptr<Octree<double>> Octrees::get(const Tape&, const Aabb&);
template class Octree<float>;
template class Octree<double>;
template class CellMaker<float>;
template class CellMaker<double>;

}  // namespace octomarch
