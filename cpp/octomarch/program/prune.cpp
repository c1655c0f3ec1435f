#include "octomarch/program/prune.hpp"

#include <algorithm>
#include <numeric>
#include <type_traits>

#include "octomarch/program/operator_ranges.hpp"

namespace octomarch {

namespace {

/// Which of two operands is the smaller, by `reach` at least. Of equal operands a gradient is the one's that has a slope, so
/// ties are left open.
template <class Real>
Taken smaller_by(const Range<Real>& a, const Range<Real>& b, Real reach) {
  if (reach == Real(0)) {
    if (a.hi < b.lo) return Taken::kFirst;
    return b.hi < a.lo ? Taken::kSecond : Taken::kUnknown;
  }
  const Range<Real> gap = a - b;
  if (gap.hi <= -reach) return Taken::kFirst;
  return gap.lo >= reach ? Taken::kSecond : Taken::kUnknown;
}

}  // namespace

TapePart whole_of(const Tape& tape) {
  std::vector<std::uint32_t> origins(tape.code.size());
  std::iota(origins.begin(), origins.end(), 0U);
  return {tape.code, std::move(origins), tape.results, tape.registers};
}

template <class Real>
Pruner<Real>::Pruner(const Tape& tape) : tape_(tape) {
  if constexpr (std::is_same_v<Real, float>) {
    constants_ = tape.constants_f32.data();
  } else {
    constants_ = tape.constants.data();
  }
}

template <class Real>
Pruner<Real>::Pruner(const Tape& tape, const std::vector<Margin>& margins, Sampler<Real>& sampler) : Pruner(tape) {
  margins_ = &margins;
  sampler_ = &sampler;
}

template <class Real>
std::optional<TapePart> Pruner<Real>::prune(const TapePart& part, const Region<Real>& region) {
  const std::size_t values = tape_.inputs + part.code.size() * kMaxOutputs;
  code_ = part.code;
  inputs_.resize(part.code.size());
  ranges_.resize(values);
  in_register_.resize(part.registers);
  dropped_ = 0;
  load(region);
  const bool wants_ranges = sampler_ == nullptr || sample(part, region);
  load(region);
  if (wants_ranges) {
    for (std::size_t i = 0; i < part.code.size(); ++i) run<true>(part.code[i], i);
  } else {
    for (std::size_t i = 0; i < part.code.size(); ++i) run<false>(part.code[i], i);
  }
  if (dropped_ == 0) return std::nullopt;
  mark(part);
  return emit(part);
}

/// Coordinates over the region; a normal can be any.
template <class Real>
void Pruner<Real>::load(const Region<Real>& region) {
  for (std::uint32_t i = 0; i < tape_.inputs; ++i) {
    ranges_[i] = i < 3 ? Range<Real>(region.lo[i], region.hi[i]) : Range<Real>::whole();
    in_register_[i] = i;
  }
}

/// Works out what an instruction's outputs can be, or that it is one of its operands.
template <class Real>
template <bool kByRanges>
void Pruner<Real>::run(const Instruction& instruction, std::size_t index) {
  const OpcodeInfo& shape = info(instruction.op);
  Range<Real> in[kMaxInputs];
  for (std::size_t i = 0; i < shape.inputs; ++i) {
    inputs_[index][i] = in_register_[instruction.in[i]];
    if constexpr (kByRanges) in[i] = ranges_[inputs_[index][i]];
  }
  Choice choice = sampler_ != nullptr ? among(instruction.op, decisions_[index]) : Choice{};
  if constexpr (kByRanges) {
    if (!choice.is_made) choice = choose(instruction, in);
  }
  if (choice.is_made && !choice.is_negated && !choice.is_constant) {
    in_register_[instruction.out[0]] = inputs_[index][choice.operand];
    ++dropped_;
    return;
  }
  if (choice.is_negated) {
    code_[index].op = Opcode::kComplement;
    inputs_[index][0] = inputs_[index][choice.operand];
    if constexpr (kByRanges) in[0] = in[choice.operand];
    ++dropped_;
  } else if (choice.is_constant) {
    code_[index].op = Opcode::kConstant;
    ++dropped_;
  }
  Range<Real> out[kMaxOutputs];
  if constexpr (kByRanges) operator_ranges(code_[index].op, constants_ + instruction.constants, in, out);
  for (std::size_t i = 0; i < shape.outputs; ++i) {
    const Value value = output(index, i);
    if constexpr (kByRanges) ranges_[value] = out[i];
    in_register_[instruction.out[i]] = value;
  }
}

template <class Real>
typename Pruner<Real>::Choice Pruner<Real>::among(Opcode op, Taken taken) {
  if (taken == Taken::kUnknown) return {};
  const bool is_second = taken == Taken::kSecond;
  if (chooses_attribute(op)) return {true, false, false, is_second ? 3U : 2U};
  return {true, is_second && subtracts(op), false, is_second ? 1U : 0U};
}

template <class Real>
typename Pruner<Real>::Choice Pruner<Real>::choose(const Instruction& instruction, const Range<Real>* in) const {
  const Real* const p = constants_ + instruction.constants;
  const Opcode op = instruction.op;
  if (chooses_operand(op)) {
    const Range<Real> second = subtracts(op) ? -in[1] : in[1];
    const Real reach = blend_reach(op, p);
    return among(op, takes_larger(op) ? smaller_by(-in[0], -second, reach) : smaller_by(in[0], second, reach));
  }
  switch (op) {
    case Opcode::kWhere: {
      const Truth is_false = in[0] == Range<Real>(Real(0));
      if (in[0].is_whole()) return {};
      if (!is_false.may_hold) return {true, false, false, 1};
      return is_false.may_fail ? Choice{} : Choice{true, false, false, 2};
    }
    case Opcode::kMinimumConstant:
      if (in[0].hi < p[0]) return {true, false, false, 0};
      return in[0].lo >= p[0] ? Choice{true, false, true, 0} : Choice{};
    case Opcode::kMaximumConstant:
      if (in[0].lo > p[0]) return {true, false, false, 0};
      return in[0].hi <= p[0] ? Choice{true, false, true, 0} : Choice{};
    case Opcode::kAbsolute:
      if (in[0].lo > Real(0)) return {true, false, false, 0};
      return in[0].hi < Real(0) ? Choice{true, true, false, 0} : Choice{};
    case Opcode::kClamp: return in[0].lo > p[0] && in[0].hi < p[1] ? Choice{true, false, false, 0} : Choice{};
    default: return {};
  }
}

/// Finds the instructions that the results still need, and where each value is read last.
template <class Real>
void Pruner<Real>::mark(const TapePart& part) {
  is_needed_.assign(part.code.size(), 0);
  last_use_.assign(ranges_.size(), 0);
  constexpr std::uint32_t kToTheEnd = UINT32_MAX;
  const auto need = [&](Value value, std::uint32_t by) {
    last_use_[value] = std::max(last_use_[value], by);
    if (value >= tape_.inputs) is_needed_[(value - tape_.inputs) / kMaxOutputs] = 1;
  };
  for (const std::uint16_t result : part.results) need(in_register_[result], kToTheEnd);
  for (std::size_t i = part.code.size(); i-- > 0;) {
    if (is_needed_[i] == 0) continue;
    for (std::size_t k = 0; k < info(code_[i].op).inputs; ++k) need(inputs_[i][k], static_cast<std::uint32_t>(i + 1));
  }
}

/// Gives what is needed registers, the lowest that are free, in the order of the part.
template <class Real>
TapePart Pruner<Real>::emit(const TapePart& part) {
  TapePart result;
  registers_.resize(ranges_.size());
  std::vector<char> taken(tape_.inputs, 1);
  const auto take = [&]() -> std::uint16_t {
    const auto free = std::find(taken.begin(), taken.end(), 0);
    if (free == taken.end()) {
      taken.push_back(1);
      return static_cast<std::uint16_t>(taken.size() - 1);
    }
    *free = 1;
    return static_cast<std::uint16_t>(free - taken.begin());
  };
  for (std::uint32_t i = 0; i < tape_.inputs; ++i) {
    registers_[i] = static_cast<std::uint16_t>(i);
    if (last_use_[i] == 0) taken[i] = 0;
  }
  for (std::size_t i = 0; i < code_.size(); ++i) {
    if (is_needed_[i] == 0) continue;
    Instruction instruction = code_[i];
    const OpcodeInfo& shape = info(instruction.op);
    for (std::size_t k = 0; k < kMaxInputs; ++k) {
      if (k >= shape.inputs) {
        instruction.in[k] = 0;
        continue;
      }
      const Value value = inputs_[i][k];
      instruction.in[k] = registers_[value];
      if (last_use_[value] == i + 1) taken[registers_[value]] = 0;
    }
    for (std::size_t k = 0; k < shape.outputs; ++k) instruction.out[k] = registers_[output(i, k)] = take();
    for (std::size_t k = 0; k < shape.outputs; ++k) {
      if (last_use_[output(i, k)] == 0) taken[registers_[output(i, k)]] = 0;
    }
    for (std::size_t k = shape.outputs; k < kMaxOutputs; ++k) instruction.out[k] = 0;
    result.code.push_back(instruction);
    result.origins.push_back(part.origins[i]);
  }
  for (const std::uint16_t register_of : part.results) result.results.push_back(registers_[in_register_[register_of]]);
  result.registers = static_cast<std::uint32_t>(taken.size());
  return result;
}

template class Pruner<float>;
template class Pruner<double>;

}  // namespace octomarch
