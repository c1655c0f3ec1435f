#include "octomarch/program/prune.hpp"

#include <algorithm>
#include <bit>
#include <numeric>
#include <type_traits>

#include "octomarch/program/operator_ranges.hpp"

namespace octomarch {

namespace {

/// Which of two operands is the smaller, by `reach` at least: −1 the first, 1 the second, 0 if that is not known. Of equal
/// operands a gradient is the one's that has a slope, so ties are left open.
template <class Real>
int smaller_by(const Range<Real>& a, const Range<Real>& b, Real reach) {
  if (reach == Real(0)) {
    if (a.hi < b.lo) return -1;
    return b.hi < a.lo ? 1 : 0;
  }
  const Range<Real> gap = a - b;
  if (gap.hi <= -reach) return -1;
  return gap.lo >= reach ? 1 : 0;
}

/// Can something else than the order of two distances tell that an instruction is one of its operands, or a constant?
constexpr bool is_chosen_by_ranges(Opcode op) {
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

HeldPart whole_of(const Tape& tape) {
  std::vector<std::uint32_t> origins(tape.code.size());
  std::iota(origins.begin(), origins.end(), 0U);
  return {tape.code, std::move(origins), tape.results, tape.registers};
}

std::uint16_t RegisterNames::take() {
  std::size_t word = 0;
  while (word < free_.size() && free_[word] == 0) ++word;
  if (word == free_.size()) free_.push_back(~std::uint64_t{0});
  const std::size_t taken = word * kBits + static_cast<std::size_t>(std::countr_zero(free_[word]));
  free_[word] &= free_[word] - 1;
  if (taken >= names_.size()) names_.resize(taken + 1);
  names_[taken] = 1;
  return static_cast<std::uint16_t>(taken);
}

template <class Real>
Pruner<Real>::Pruner(const Tape& tape, Sampler<Real>* sampler, const Real* table)
    : tape_(tape), sampler_(sampler), table_(table) {}

template <class Real>
std::optional<TapePart> Pruner<Real>::prune(const TapePart& part, const Region<Real>& region, const Margin* margins) {
  margins_ = margins;
  constants_ = part.has_table() ? table_ : constants_of<Real>(tape_);
  choices_.assign(part.length, Choice::kItself);
  uses_.resize(part.length);
  if (sampler_ != nullptr) sample(part, region);
  find_uses(part);
  if (wants_ranges(part)) {
    choose_by_ranges(part, region);
    find_uses(part);
  }
  const bool is_all = std::all_of(choices_.begin(), choices_.end(), [](Choice c) { return c == Choice::kItself; });
  if (is_all) return std::nullopt;
  emit(part);
  return left_.view();
}

/// Is there something of which samples say nothing?
template <class Real>
bool Pruner<Real>::wants_ranges(const TapePart& part) const {
  for (std::size_t i = 0; i < part.length; ++i) {
    if (uses_[i].read == 0 || choices_[i] != Choice::kItself) continue;
    const Opcode op = part.code[i].op;
    if (is_chosen_by_ranges(op)) return true;
    if (chooses_operand(op) && (sampler_ == nullptr || !is_known(margins_[part.origins[i]]))) return true;
  }
  return false;
}

template <class Real>
typename Pruner<Real>::Choice Pruner<Real>::operand_of(Opcode op, bool is_second) {
  if (chooses_attribute(op)) return is_second ? Choice::kFourth : Choice::kThird;
  if (is_second) return subtracts(op) ? Choice::kComplementOfSecond : Choice::kSecond;
  return Choice::kFirst;
}

/// Which operand a choice is, or is the complement of.
template <class Real>
std::size_t Pruner<Real>::operand(Choice choice) {
  switch (choice) {
    case Choice::kSecond:
    case Choice::kComplementOfSecond: return 1;
    case Choice::kThird: return 2;
    case Choice::kFourth: return 3;
    default: return 0;
  }
}

template <class Real>
std::uint8_t Pruner<Real>::inputs_read(Opcode op, Choice choice) {
  if (choice == Choice::kItself) return static_cast<std::uint8_t>((1U << info(op).inputs) - 1U);
  return choice == Choice::kConstant ? std::uint8_t{0} : static_cast<std::uint8_t>(1U << operand(choice));
}

/// Works out what values can be, and so which instructions are one of their operands.
template <class Real>
void Pruner<Real>::choose_by_ranges(const TapePart& part, const Region<Real>& region) {
  ranges_.resize(part.registers);
  for (std::uint32_t i = 0; i < tape_.inputs; ++i) {  // a normal can be any
    ranges_[i] = i < 3 ? Range<Real>(region.lo[i], region.hi[i]) : Range<Real>::whole();
  }
  for (std::size_t i = 0; i < part.length; ++i) {
    if (uses_[i].read == 0) continue;
    const Instruction& instruction = part.code[i];
    const OpcodeInfo& shape = info(instruction.op);
    Range<Real> in[kMaxInputs];
    for (std::size_t k = 0; k < shape.inputs; ++k) in[k] = ranges_[instruction.in[k]];
    Choice& choice = choices_[i];
    if (choice == Choice::kItself) choice = choose(instruction, in);
    Range<Real> out[kMaxOutputs];
    const Real* const constants = constants_ + instruction.constants;
    if (is_operand(choice)) {
      out[0] = in[operand(choice)];
    } else if (choice == Choice::kConstant) {
      operator_ranges(Opcode::kConstant, constants, in, out);
    } else if (choice != Choice::kItself) {
      operator_ranges(Opcode::kComplement, constants, in + operand(choice), out);
    } else {
      operator_ranges(instruction.op, constants, in, out);
    }
    for (std::size_t k = 0; k < shape.outputs; ++k) ranges_[instruction.out[k]] = out[k];
  }
}

template <class Real>
typename Pruner<Real>::Choice Pruner<Real>::choose(const Instruction& instruction, const Range<Real>* in) const {
  const Real* const p = constants_ + instruction.constants;
  const Opcode op = instruction.op;
  if (chooses_operand(op)) {
    const Range<Real> second = subtracts(op) ? -in[1] : in[1];
    const Real reach = blend_reach(op, p);
    const int smaller = takes_larger(op) ? smaller_by(-in[0], -second, reach) : smaller_by(in[0], second, reach);
    return smaller == 0 ? Choice::kItself : operand_of(op, smaller > 0);
  }
  switch (op) {
    case Opcode::kWhere: {
      const Truth is_false = in[0] == Range<Real>(Real(0));
      if (in[0].is_whole()) return Choice::kItself;
      if (!is_false.may_hold) return Choice::kSecond;
      return is_false.may_fail ? Choice::kItself : Choice::kThird;
    }
    case Opcode::kMinimumConstant:
      if (in[0].hi < p[0]) return Choice::kFirst;
      return in[0].lo >= p[0] ? Choice::kConstant : Choice::kItself;
    case Opcode::kMaximumConstant:
      if (in[0].lo > p[0]) return Choice::kFirst;
      return in[0].hi <= p[0] ? Choice::kConstant : Choice::kItself;
    case Opcode::kAbsolute:
      if (in[0].lo > Real(0)) return Choice::kFirst;
      return in[0].hi < Real(0) ? Choice::kComplementOfFirst : Choice::kItself;
    case Opcode::kClamp: return in[0].lo > p[0] && in[0].hi < p[1] ? Choice::kFirst : Choice::kItself;
    default: return Choice::kItself;
  }
}

/// Finds what the results still need, now that choices have been made, and where each value is read last.
template <class Real>
void Pruner<Real>::find_uses(const TapePart& part) {
  is_read_.assign(part.registers, 0);
  for (std::size_t i = 0; i < part.result_count; ++i) is_read_[part.results[i]] = 1;
  for (std::size_t i = part.length; i-- > 0;) {
    const Instruction& instruction = part.code[i];
    Uses& uses = uses_[i] = {};
    for (std::size_t k = 0; k < info(instruction.op).outputs; ++k) {
      char& is_read = is_read_[instruction.out[k]];
      if (is_read != 0) uses.read = static_cast<std::uint8_t>(uses.read | 1U << k);
      is_read = 0;
    }
    if (uses.read == 0) continue;
    const unsigned reads = inputs_read(instruction.op, choices_[i]);
    for (std::size_t k = 0; k < kMaxInputs; ++k) {
      if ((reads >> k & 1U) == 0) continue;
      char& is_read = is_read_[instruction.in[k]];
      if (is_read == 0) uses.last = static_cast<std::uint8_t>(uses.last | 1U << k);
      is_read = 1;
    }
  }
}

/// Gives what is read registers of its own, in the order of the part. What is one of its operands becomes one more name of
/// that one's register.
template <class Real>
void Pruner<Real>::emit(const TapePart& part) {
  left_.code.clear();
  left_.origins.clear();
  left_.results.clear();
  registers_.clear();
  register_of_.resize(part.registers);
  for (std::uint32_t i = 0; i < tape_.inputs; ++i) register_of_[i] = registers_.take();
  for (std::uint32_t i = 0; i < tape_.inputs; ++i) {
    if (is_read_[i] == 0) registers_.drop_name(register_of_[i]);
  }
  for (std::size_t i = 0; i < part.length; ++i) {
    if (uses_[i].read == 0) continue;
    const Instruction& instruction = part.code[i];
    const Choice choice = choices_[i];
    std::array<std::uint16_t, kMaxInputs> in;
    for (std::size_t k = 0; k < kMaxInputs; ++k) in[k] = register_of_[instruction.in[k]];
    if (is_operand(choice)) {
      registers_.name_again(in[operand(choice)]);
      register_of_[instruction.out[0]] = in[operand(choice)];
    }
    for (std::size_t k = 0; k < kMaxInputs; ++k) {
      if ((uses_[i].last >> k & 1U) != 0) registers_.drop_name(in[k]);
    }
    if (is_operand(choice)) continue;
    Instruction left{instruction.op, {}, {}, instruction.constants};
    const std::size_t inputs = info(instruction.op).inputs;
    if (choice == Choice::kItself) {
      std::copy_n(in.begin(), inputs, left.in.begin());
    } else if (choice == Choice::kConstant) {
      left.op = Opcode::kConstant;
    } else {
      left.op = Opcode::kComplement;
      left.in[0] = in[operand(choice)];
    }
    const std::size_t outputs = info(instruction.op).outputs;
    for (std::size_t k = 0; k < outputs; ++k) register_of_[instruction.out[k]] = left.out[k] = registers_.take();
    for (std::size_t k = 0; k < outputs; ++k) {
      if ((uses_[i].read >> k & 1U) == 0) registers_.drop_name(left.out[k]);
    }
    left_.code.push_back(left);
    left_.origins.push_back(part.origins[i]);
  }
  for (std::size_t i = 0; i < part.result_count; ++i) left_.results.push_back(register_of_[part.results[i]]);
  left_.registers = registers_.most();
}

template class Pruner<float>;
template class Pruner<double>;

}  // namespace octomarch
