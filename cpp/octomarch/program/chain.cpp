#include "octomarch/program/chain.hpp"

#include <algorithm>
#include <numeric>
#include <type_traits>

#include "octomarch/program/margins.hpp"

namespace octomarch {

namespace {

void add_once(std::uint32_t operand, std::vector<std::uint32_t>& operands) {
  if (operands.empty() || operands.back() != operand) operands.push_back(operand);
}

}  // namespace

bool operator==(const Chain::Kind& a, const Chain::Kind& b) {
  const auto end_of_a = a.instructions.begin() + static_cast<std::ptrdiff_t>(a.length) + 1;
  return a.length == b.length && std::equal(a.instructions.begin(), end_of_a, b.instructions.begin()) &&
         a.of_combine == b.of_combine;
}

template <class Real>
std::vector<Real> Chain::table(const Tape& tape) const {
  std::vector<Real> table(operands() * columns_ + kinds_.size() * kMostOfCombine);
  Real* next = table.data();
  for (std::size_t operand = 0; operand < operands(); ++operand, next += columns_) {
    const Real* const own = constants_of<Real>(tape) + first_constants_[operand];
    std::copy_n(own, kind_of(operand).constants, next);
    if (!has_one_kind()) next[columns_ - 1] = static_cast<Real>(kind_of_[operand]);
  }
  for (const Kind& kind : kinds_) {
    for (const double constant : kind.of_combine) *next++ = static_cast<Real>(constant);
  }
  return table;
}
template std::vector<float> Chain::table(const Tape& tape) const;
template std::vector<double> Chain::table(const Tape& tape) const;

template <class Real>
std::vector<Margin> Chain::margins(const Tape& tape, const Region<Real>& region) const {
  std::vector<std::uint32_t> all(operands());
  std::iota(all.begin(), all.end(), 0U);
  const TapePart list = part_of(all);
  std::vector<std::uint32_t> origins(list.length);
  Tape of_list;
  of_list.code.resize(list.length);
  write_code(list, of_list.code.data(), origins.data());
  if constexpr (std::is_same_v<Real, float>) {
    of_list.constants_f32 = table<float>(tape);
  } else {
    of_list.constants = table<double>(tape);
  }
  of_list.registers = registers();
  of_list.results = {taken_up_};
  const std::vector<Margin> by_instruction = margins_of(of_list, region);
  std::vector<Margin> margins(2 * operands());
  for (std::size_t i = 0; i < list.length; ++i) margins[origins[i]] = by_instruction[i];
  return margins;
}
template std::vector<Margin> Chain::margins(const Tape& tape, const Region<float>& region) const;
template std::vector<Margin> Chain::margins(const Tape& tape, const Region<double>& region) const;

bool Chain::find_operands(const TapePart& part, std::vector<std::uint32_t>& operands) const {
  operands.clear();
  for (std::size_t i = 0; i < part.length; ++i) {
    const std::uint32_t owner = owners_[part.origins[i]];
    if (owner == kOther) return false;
    if (owner != kNobody) add_once(owner, operands);
  }
  // most are in order: only where an operand that is made before others is taken up after them they are not
  if (!std::ranges::is_sorted(operands)) std::ranges::sort(operands);
  return !operands.empty();
}

void Chain::find_operands_of_list(const TapePart& left, std::vector<std::uint32_t>& operands) {
  operands.clear();
  for (std::size_t i = 0; i < left.length; ++i) add_once(left.origins[i] / 2, operands);
}

TapePart Chain::part_of(std::span<const std::uint32_t> operands) const {
  std::size_t length = 0;
  for (const std::uint32_t operand : operands) length += kind_of(operand).length + 1;
  TapePart part;
  part.origins = operands.data();
  part.results = &taken_up_;
  part.length = static_cast<std::uint32_t>(length - 1);
  part.operands = static_cast<std::uint32_t>(operands.size());
  part.result_count = 1;
  part.result = taken_up_;
  part.registers = registers();
  return part;
}

void Chain::write_code(const TapePart& list, Instruction* code, std::uint32_t* origins) const {
  for (std::size_t i = 0; i < list.operands; ++i) {
    const std::uint32_t operand = list.origins[i];
    const auto first = static_cast<std::uint32_t>(operand * columns_);
    const Kind& kind = kind_of(operand);
    const Instruction* next = kind.instructions.data();
    do {  // not counted: that would be unrolled into vectors, though it is a few instructions
      *code = *next;
      code++->constants += first;
      *origins++ = 2 * operand;
    } while (next++->out[0] != kind.operand());
    if (i == 0) {
      code[-1].out[0] = taken_up_;
    } else {
      *code++ = kind.combine();
      *origins++ = 2 * operand + 1;
    }
  }
}

}  // namespace octomarch
