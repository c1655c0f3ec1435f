#include "octomarch/program/chain.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <type_traits>

#include "octomarch/program/margins.hpp"

namespace octomarch {

namespace {

void add_once(std::uint32_t operand, std::vector<std::uint32_t>& operands) {
  if (operands.empty() || operands.back() != operand) operands.push_back(operand);
}

/// Goes through a part's code and says which instructions read coordinates that are still in their registers.
class CoordinateReads {
 public:
  bool step(const Instruction& instruction) {
    const OpcodeInfo& shape = info(instruction.op);
    bool reads = false;
    for (std::size_t k = 0; k < shape.inputs; ++k) reads = reads || is_coordinate(instruction.in[k]);
    for (std::size_t k = 0; k < shape.outputs; ++k) {
      if (instruction.out[k] < kCoordinates) is_gone_[instruction.out[k]] = true;
    }
    return reads;
  }

 private:
  static constexpr std::size_t kCoordinates = 3;
  bool is_coordinate(std::uint16_t taken) const { return taken < kCoordinates && !is_gone_[taken]; }

  std::array<bool, kCoordinates> is_gone_{};
};

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
std::vector<Margin> Chain::margins(const std::vector<Real>& table, const Region<Real>& region) const {
  std::vector<std::uint32_t> all(operands());
  std::iota(all.begin(), all.end(), 0U);
  const TapePart list = part_of(all);
  std::vector<std::uint32_t> origins(list.length);
  Tape of_list;
  of_list.code.resize(list.length);
  write_code(list, of_list.code.data(), origins.data());
  if constexpr (std::is_same_v<Real, float>) {
    of_list.constants_f32 = table;
  } else {
    of_list.constants = table;
  }
  of_list.registers = registers();
  of_list.results = {taken_up_};
  const std::vector<Margin> by_instruction = margins_of(of_list, region);
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::vector<Margin> margins(2 * operands(), Margin{kInfinity, kInfinity});
  for (std::size_t i = 0; i < list.length; ++i) {
    // those of a body have one for all, and so none: operands are taken or left whole
    if (origins[i] % 2 == 1) margins[origins[i]] = by_instruction[i];
  }
  return margins;
}
template std::vector<Margin> Chain::margins(const std::vector<float>& table, const Region<float>& region) const;
template std::vector<Margin> Chain::margins(const std::vector<double>& table, const Region<double>& region) const;

/// Where an instruction that chooses reads a coordinate, that is what is left of something that has no instruction any more.
bool Chain::find_operands(const TapePart& part, std::vector<std::uint32_t>& operands) const {
  operands.clear();
  CoordinateReads reads;
  for (std::size_t i = 0; i < part.length; ++i) {
    const bool reads_coordinate = reads.step(part.code[i]);
    const std::uint32_t owner = owners_[part.origins[i]];
    if (owner == kOther || (owner == kNobody && reads_coordinate)) return false;
    if (owner != kNobody) add_once(owner, operands);
  }
  // most are in order: only where an operand that is made before others is taken up after them they are not
  if (!std::ranges::is_sorted(operands)) std::ranges::sort(operands);
  return !operands.empty();
}

bool Chain::find_operands_of_list(const TapePart& left, std::vector<std::uint32_t>& operands) {
  operands.clear();
  CoordinateReads reads;
  for (std::size_t i = 0; i < left.length; ++i) {
    const bool chooses = left.origins[i] % 2 == 1;
    if (reads.step(left.code[i]) && chooses) return false;
    if (!chooses) add_once(left.origins[i] / 2, operands);
  }
  return !operands.empty();
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
