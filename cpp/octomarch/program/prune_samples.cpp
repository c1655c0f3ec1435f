// Pruning by samples: the points of a region, and what follows from which operands are taken where. prune.cpp does the rest.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "octomarch/program/prune.hpp"

namespace octomarch {

namespace {

constexpr std::uint64_t kEverywhere = ~std::uint64_t{0};

/// Sets the points at which a region is sampled.
template <class Real>
void set_points(const Region<Real>& region, SamplePoints<Real>& points) {
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
    points.x[i] = middles[0][i % kSamplesAcross];
    points.y[i] = middles[1][i / kSamplesAcross % kSamplesAcross];
    points.z[i] = middles[2][i / (kSamplesAcross * kSamplesAcross)];
  }
  // middles are rounded
  points.radius = std::sqrt(half_diagonal) * (0.5 / static_cast<double>(kAcross)) * (1.0 + 1e-6) +
                  8.0 * static_cast<double>(std::numeric_limits<Real>::epsilon()) * farthest;
}

}  // namespace

/// Finds where values matter, from the results back, and so which operands are taken wherever that matters.
template <class Real>
void Pruner<Real>::sample(const TapePart& part, const Region<Real>& region) {
  set_points(region, points_);
  taken_.resize(part.length);
  sampler_->compare(part, points_, margins_, taken_.data());
  needs_.assign(part.registers, {});
  for (std::size_t i = 0; i < part.result_count; ++i) needs_[part.results[i]] = {kEverywhere, false, false};
  for (std::size_t i = part.length; i-- > 0;) {
    const Instruction& instruction = part.code[i];
    Need need = std::exchange(needs_[instruction.out[0]], {});
    for (std::size_t k = 1; k < info(instruction.op).outputs; ++k) {
      need.where |= std::exchange(needs_[instruction.out[k]], {}).where;
    }
    if (need.where != 0) require_operands(instruction, i, need);
  }
}

/// Where an instruction that matters as `need` says makes its operands matter.
template <class Real>
void Pruner<Real>::require_operands(const Instruction& instruction, std::size_t index, const Need& need) {
  const std::array<std::uint16_t, kMaxInputs>& in = instruction.in;
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
  if (second == 0 || first == 0) choices_[index] = operand_of(op, first == 0);
  const auto require = [&](std::uint16_t operand, std::uint64_t there, bool may_be_larger, bool may_be_smaller) {
    if (there == 0) return;
    Need& other = needs_[operand];
    other.where |= there;
    other.may_be_larger = other.may_be_larger && may_be_larger;
    other.may_be_smaller = other.may_be_smaller && may_be_smaller;
  };
  if (chooses_attribute(op)) {
    require(in[2], first, false, false);
    require(in[3], second, false, false);
    if (first == 0 || second == 0) return;
  }
  const bool is_larger_taken = takes_larger(op);
  require(in[0], first, !is_larger_taken, is_larger_taken);
  const bool is_negative_larger_taken = is_larger_taken != subtracts(op);
  require(in[1], second, !is_negative_larger_taken, is_negative_larger_taken);
}

/// As require_operands(), where each operand is read by what takes it up and by nothing else.
template <class Real>
bool Pruner<Real>::prune(const Chain& chain, const TapePart& list, const TapePart& ready, const Region<Real>& region,
                         const Margin* margins, std::vector<std::uint32_t>& operands) {
  set_points(region, points_);
  taken_.resize(ready.length);
  sampler_->compare(ready, points_, margins, taken_.data());
  operands.clear();
  Need need{kEverywhere, false, false};  // of what has been taken up
  std::size_t at = list.length;
  for (std::size_t i = list.operands; i-- > 1;) {
    const std::uint32_t operand = list.origins[i];
    const Chain::Kind& kind = chain.kind_of(operand);
    if (!is_known(margins[ready.origins[--at]])) return false;
    const bool is_larger_taken = takes_larger(kind.combine().op);
    const bool may_be_off = is_larger_taken ? need.may_be_smaller : need.may_be_larger;
    const std::uint64_t where = may_be_off ? need.where : kEverywhere;
    TakenAt taken = taken_[at];
    if (kind.takes_operand_first()) std::swap(taken.first, taken.second);
    at -= kind.length;
    if ((where & ~taken.first) == 0) continue;
    operands.push_back(operand);
    need = {where & ~taken.second, !is_larger_taken, is_larger_taken};
    if (need.where == 0) break;
  }
  if (need.where != 0) operands.push_back(list.origins[0]);
  std::ranges::reverse(operands);
  return true;
}

template void Pruner<float>::sample(const TapePart&, const Region<float>&);
template void Pruner<double>::sample(const TapePart&, const Region<double>&);
template bool Pruner<float>::prune(const Chain&, const TapePart&, const TapePart&, const Region<float>&, const Margin*,
                                   std::vector<std::uint32_t>&);
template bool Pruner<double>::prune(const Chain&, const TapePart&, const TapePart&, const Region<double>&,
                                    const Margin*, std::vector<std::uint32_t>&);

}  // namespace octomarch
