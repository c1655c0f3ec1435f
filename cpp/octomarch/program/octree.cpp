#include "octomarch/program/octree.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string_view>
#include <utility>

namespace octomarch {

namespace {

/// A part this short is run as it is: another level would cost more than it saves.
constexpr std::size_t kShort = 12;
/// Parts that repeat are short ones.
constexpr std::size_t kShared = 64;
/// A cell that leaves more than this of its parent's part gains nothing; after so many in a row there are no more.
constexpr double kStall = 0.8;
constexpr unsigned kStalls = 3;
/// That counts for cells smaller than this part of the focus: from far away all of it is alike.
constexpr double kDetail = 1.0 / 16.0;
/// Where it ends, cells are made for the moment only.
constexpr std::size_t kMostBytes = std::size_t{1} << 29;
/// A long tape gets more: as much for each of its instructions, which holds the large cells from which small ones come.
constexpr std::size_t kMostBytesOfInstruction = 2048;
/// Tapes shorter than this are run whole.
constexpr std::size_t kLong = 48;

/// A row of shapes in their order is cut only in cells as small as its gaps, so that the more there is to gain, the more levels
/// may pass without gain.
unsigned most_stalls(std::size_t length) { return kStalls + static_cast<unsigned>(std::bit_width(length / kShared)); }

template <class Real>
Region<Real> octant_of(const Region<Real>& region, const Real (&middle)[3], unsigned octant) {
  Region<Real> child = region;
  for (unsigned axis = 0; axis < 3; ++axis) {
    ((octant >> axis & 1U) != 0 ? child.lo : child.hi)[axis] = middle[axis];
  }
  return child;
}

template <class Real>
void set_middle(const Region<Real>& region, Real (&middle)[3]) {
  for (unsigned axis = 0; axis < 3; ++axis) {
    middle[axis] = region.lo[axis] + (region.hi[axis] - region.lo[axis]) * Real(0.5);
  }
}

template <class Real>
Region<Real> cube_about(const Aabb& focus, double half) {
  const double middle[3] = {0.5 * (focus.lo.x + focus.hi.x), 0.5 * (focus.lo.y + focus.hi.y),
                            0.5 * (focus.lo.z + focus.hi.z)};
  Region<Real> cube;
  for (unsigned axis = 0; axis < 3; ++axis) {
    cube.lo[axis] = static_cast<Real>(middle[axis] - half);
    cube.hi[axis] = static_cast<Real>(middle[axis] + half);
  }
  return cube;
}

double longest_side(const Aabb& box) {
  return std::max({box.hi.x - box.lo.x, box.hi.y - box.lo.y, box.hi.z - box.lo.z});
}

std::size_t bytes_of(const TapePart& part) {
  return sizeof(TapePart) + part.code.size() * sizeof(Instruction) + part.origins.size() * sizeof(std::uint32_t) +
         part.results.size() * sizeof(std::uint16_t);
}

std::size_t hash_of(const TapePart& part) {
  const auto* bytes = reinterpret_cast<const char*>(part.code.data());
  return std::hash<std::string_view>()({bytes, part.code.size() * sizeof(Instruction)});
}

}  // namespace

template <class Real>
Octree<Real>::Octree(const Tape& tape, const Aabb& focus, double reach)
    : Octree(tape, focus, reach, std::max(kMostBytes, tape.code.size() * kMostBytesOfInstruction)) {}

template <class Real>
Octree<Real>::Octree(const Tape& tape, const Aabb& focus, double reach, std::size_t most_bytes)
    : tape_(tape), focus_size_(static_cast<Real>(longest_side(focus))), most_bytes_(most_bytes) {
  constexpr Real kFar = std::numeric_limits<Real>::infinity();
  auto whole = std::make_shared<const TapePart>(whole_of(tape));
  outside_.region = {{-kFar, -kFar, -kFar}, {kFar, kFar, kFar}};
  outside_.part = whole;
  outside_.is_leaf = true;
  const double half = 0.5 * longest_side(focus);
  reach_ = std::max(reach, half);
  tops_[0].region = cube_about<Real>(focus, half);
  tops_[1].region = cube_about<Real>(focus, reach_);
  for (Cell& top : tops_) {
    set_middle(top.region, top.middle);
    top.part = whole;
    top.stalled = 0;
    top.is_leaf = is_small(top.region);
  }
  margins_ = margins_of(tape, tops_[1].region);
  cells_ = 1 + tops_.size();
  bytes_ = sizeof(*this) + bytes_of(*whole) + margins_.size() * sizeof(Margin);
}

template <class Real>
bool Octree<Real>::is_full() const {
  return bytes() > most_bytes_;
}

template <class Real>
typename Octree<Real>::Cell* Octree<Real>::child(Cell& parent, unsigned octant, Pruner<Real>& pruner) {
  Cell* const known = parent.children[octant].load(std::memory_order_acquire);
  return known != nullptr ? known : make_child(parent, octant, pruner);
}

/// Makes a child, or takes the one that another thread has made meanwhile; none where memory has ended.
template <class Real>
typename Octree<Real>::Cell* Octree<Real>::make_child(Cell& parent, unsigned octant, Pruner<Real>& pruner) {
  if (is_full()) return nullptr;
  std::unique_ptr<Cell> cell = make_apart(parent, octant, pruner);
  if (cell->part != parent.part) cell->part = shared(std::move(cell->part));
  Cell* expected = nullptr;
  if (!parent.children[octant].compare_exchange_strong(expected, cell.get(), std::memory_order_acq_rel))
    return expected;
  cells_.fetch_add(1, std::memory_order_relaxed);
  bytes_.fetch_add(sizeof(Cell), std::memory_order_relaxed);
  return cell.release();
}

template <class Real>
std::unique_ptr<typename Octree<Real>::Cell> Octree<Real>::make_apart(const Cell& parent, unsigned octant,
                                                                      Pruner<Real>& pruner) const {
  auto cell = std::make_unique<Cell>();
  cell->region = octant_of(parent.region, parent.middle, octant);
  set_middle(cell->region, cell->middle);
  std::optional<TapePart> part = pruner.prune(*parent.part, cell->region);
  const std::size_t before = parent.part->code.size();
  const std::size_t after = part ? part->code.size() : before;
  const bool is_stalled = static_cast<double>(after) > kStall * static_cast<double>(before);
  const bool is_detail = cell->region.hi[0] - cell->region.lo[0] < focus_size_ * Real(kDetail);
  cell->is_shorter = !is_stalled;
  cell->stalled = is_detail && is_stalled ? parent.stalled + 1 : 0;
  cell->is_leaf = after <= kShort || cell->stalled >= most_stalls(after) || is_small(cell->region);
  // little less is no less: what costs memory must save work
  if (part && after > kShared && is_stalled) part.reset();
  if (part && cell->is_leaf) part->origins = {};
  cell->part = part ? std::make_shared<const TapePart>(std::move(*part)) : parent.part;
  return cell;
}

/// Equal short parts are one.
template <class Real>
std::shared_ptr<const TapePart> Octree<Real>::shared(std::shared_ptr<const TapePart> part) {
  const std::size_t size = bytes_of(*part);
  if (part->code.size() > kShared) {
    bytes_.fetch_add(size, std::memory_order_relaxed);
    return part;
  }
  const std::size_t hash = hash_of(*part);
  const std::scoped_lock lock(parts_mutex_);
  const auto [first, last] = parts_.equal_range(hash);
  for (auto known = first; known != last; ++known) {
    if (*known->second == *part) return known->second;
  }
  bytes_.fetch_add(size, std::memory_order_relaxed);
  return parts_.emplace(hash, std::move(part))->second;
}

/// Too small to be halved?
template <class Real>
bool Octree<Real>::is_small(const Region<Real>& region) const {
  for (unsigned axis = 0; axis < 3; ++axis) {
    const Real largest = std::max(std::fabs(region.lo[axis]), std::fabs(region.hi[axis]));
    if (!(region.hi[axis] - region.lo[axis] > largest * std::numeric_limits<Real>::epsilon() * Real(64))) return true;
  }
  return !(region.hi[0] - region.lo[0] > focus_size_ * Real(1e-4));
}

bool is_worth_an_octree(const Tape& tape, const Aabb& focus) {
  if (tape.code.size() < kLong || !(longest_side(focus) > 0.0)) return false;  // a point has no parts
  Pruner<double> pruner(tape);
  const TapePart whole = whole_of(tape);
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
    const std::optional<TapePart> part = pruner.prune(whole, cell);
    left += part ? part->code.size() : tape.code.size();
  }
  return static_cast<double>(left) < 0.7 * kProbes * static_cast<double>(tape.code.size());
}

template <class Real>
std::shared_ptr<Octree<Real>> Octrees::get(const Tape& tape, const Aabb& focus, double reach) {
  const std::scoped_lock lock(mutex_);
  if (!is_worth_it_) is_worth_it_ = is_worth_an_octree(tape, focus);
  if (!*is_worth_it_) return nullptr;
  auto& kept = std::get<std::shared_ptr<Octree<Real>>>(kept_);
  if (!kept || kept->reach() < reach || kept->is_full()) kept = std::make_shared<Octree<Real>>(tape, focus, reach);
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
template std::shared_ptr<Octree<float>> Octrees::get(const Tape&, const Aabb&, double);
template std::shared_ptr<Octree<double>> Octrees::get(const Tape&, const Aabb&, double);
template class Octree<float>;
template class Octree<double>;

}  // namespace octomarch
