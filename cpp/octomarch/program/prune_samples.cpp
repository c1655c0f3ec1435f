// Pruning by samples: the points of a region, and what follows from which operands are taken where. prune.cpp does the rest.
#include <algorithm>
#include <cmath>
#include <limits>

#include "octomarch/program/prune.hpp"

namespace octomarch {

namespace {

constexpr std::uint64_t kEverywhere = ~std::uint64_t{0};

/// Can something else than the order of two distances drop an instruction?
constexpr bool is_decided_by_ranges(Opcode op) {
  switch (op) {
    case Opcode::kWhere:
    case Opcode::kMinimumConstant:
    case Opcode::kMaximumConstant:
    case Opcode::kAbsolute:
    case Opcode::kClamp: return true;
    default: return false;
  }
}

}  // namespace

/// Sets the points at which a region is sampled, and by how much the operands of each instruction must differ there.
template <class Real>
bool Pruner<Real>::set_gaps(const TapePart& part, const Region<Real>& region) {
  constexpr auto kAcross = static_cast<Real>(kSamplesAcross);
  Real middles[3][kSamplesAcross];
  double half_diagonal = 0.0;
  double farthest = 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Real size = region.hi[axis] - region.lo[axis];
    for (std::size_t i = 0; i < kSamplesAcross; ++i) {
      middles[axis][i] = region.lo[axis] + size * ((static_cast<Real>(i) + Real(0.5)) / kAcross);
    }
    half_diagonal += static_cast<double>(size) * static_cast<double>(size);
    farthest = std::max(
        {farthest, std::fabs(static_cast<double>(region.lo[axis])), std::fabs(static_cast<double>(region.hi[axis]))});
  }
  for (std::size_t i = 0; i < kSamples; ++i) {
    points_.x[i] = middles[0][i % kSamplesAcross];
    points_.y[i] = middles[1][i / kSamplesAcross % kSamplesAcross];
    points_.z[i] = middles[2][i / (kSamplesAcross * kSamplesAcross)];
  }
  // middles are rounded
  const double radius = std::sqrt(half_diagonal) * (0.5 / static_cast<double>(kAcross)) * (1.0 + 1e-6) +
                        8.0 * static_cast<double>(std::numeric_limits<Real>::epsilon()) * farthest;
  gaps_.resize(part.code.size());
  bool wants_ranges = false;
  for (std::size_t i = 0; i < part.code.size(); ++i) {
    const Margin& margin = (*margins_)[part.origins[i]];
    const auto gap = static_cast<Real>(static_cast<double>(margin.slope) * radius + static_cast<double>(margin.room));
    const Opcode op = part.code[i].op;
    const bool is_known = chooses_operand(op) && gap < std::numeric_limits<Real>::infinity();
    wants_ranges = wants_ranges || (!is_known && (chooses_operand(op) || is_decided_by_ranges(op)));
    gaps_[i] = is_known ? gap : std::numeric_limits<Real>::infinity();
  }
  return wants_ranges;
}

template <class Real>
bool Pruner<Real>::sample(const TapePart& part, const Region<Real>& region) {
  const bool wants_ranges = set_gaps(part, region);
  taken_.assign(part.code.size(), {});
  sampler_->compare(part, points_, gaps_.data(), taken_.data());
  decide(part);
  return wants_ranges;
}

/// Finds where values matter, from the results back, and so which operands are taken wherever that matters.
template <class Real>
void Pruner<Real>::decide(const TapePart& part) {
  const auto wire = [&](const Instruction& instruction, std::size_t index) {
    const OpcodeInfo& shape = info(instruction.op);
    for (std::size_t k = 0; k < shape.inputs; ++k) inputs_[index][k] = in_register_[instruction.in[k]];
    for (std::size_t k = 0; k < shape.outputs; ++k) in_register_[instruction.out[k]] = output(index, k);
  };
  for (std::size_t i = 0; i < part.code.size(); ++i) wire(part.code[i], i);
  needs_.assign(tape_.inputs + part.code.size() * kMaxOutputs, {});
  decisions_.assign(part.code.size(), Taken::kUnknown);
  for (const std::uint16_t result : part.results) needs_[in_register_[result]] = {kEverywhere, false, false};
  for (std::size_t i = part.code.size(); i-- > 0;) {
    Need need = needs_[output(i, 0)];
    for (std::size_t k = 1; k < info(part.code[i].op).outputs; ++k) need.where |= needs_[output(i, k)].where;
    if (need.where != 0) require_operands(part.code[i], i, need);
  }
}

/// Where an instruction that matters as `need` says makes its operands matter.
template <class Real>
void Pruner<Real>::require_operands(const Instruction& instruction, std::size_t index, const Need& need) {
  const std::array<Value, kMaxInputs>& in = inputs_[index];
  const Opcode op = instruction.op;
  if (!chooses_operand(op)) {
    for (std::size_t k = 0; k < info(op).inputs; ++k) needs_[in[k]] = {kEverywhere, false, false};
    return;
  }
  // without an operand the smaller of two can only become larger; of attributes that do not show, nothing is asked
  const bool may_be_off = chooses_attribute(op) || (takes_larger(op) ? need.may_be_smaller : need.may_be_larger);
  const std::uint64_t where = may_be_off ? need.where : kEverywhere;
  const TakenAt& taken = taken_[index];
  const std::uint64_t first = where & ~taken.second;
  const std::uint64_t second = where & ~taken.first;
  if (second == 0) decisions_[index] = Taken::kFirst;
  else if (first == 0) decisions_[index] = Taken::kSecond;
  const auto require = [&](Value operand, std::uint64_t there, bool may_be_larger, bool may_be_smaller) {
    if (there == 0) return;
    Need& other = needs_[operand];
    other.where |= there;
    other.may_be_larger = other.may_be_larger && may_be_larger;
    other.may_be_smaller = other.may_be_smaller && may_be_smaller;
  };
  if (chooses_attribute(op)) {
    require(in[2], first, false, false);
    require(in[3], second, false, false);
    if (decisions_[index] != Taken::kUnknown) return;
  }
  const bool is_larger_taken = takes_larger(op);
  require(in[0], first, !is_larger_taken, is_larger_taken);
  const bool is_negative_larger_taken = is_larger_taken != subtracts(op);
  require(in[1], second, !is_negative_larger_taken, is_negative_larger_taken);
}

template bool Pruner<float>::sample(const TapePart&, const Region<float>&);
template bool Pruner<double>::sample(const TapePart&, const Region<double>&);

}  // namespace octomarch
