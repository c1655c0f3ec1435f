#include "octomarch/program/chain.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "octomarch/program/choices.hpp"

namespace octomarch {

namespace {

constexpr std::uint16_t kCoordinates = 3;
/// Instructions of an operand: whoever runs chains lane by lane has room for the constants of 128 operands, in 64 lanes.
constexpr std::size_t kLongest = 8;

/// Can it take operands up? Where it subtracts, a part may need the complement of an operand.
constexpr bool combines(Opcode op) { return chooses_operand(op) && !chooses_attribute(op) && !subtracts(op); }

/// Gives the values that an operand is made of registers of their own, whatever registers they have in the tape.
class Renamer {
 public:
  explicit Renamer(std::size_t registers) : names_(registers, kNone) {
    std::iota(names_.begin(), names_.begin() + kCoordinates, std::uint16_t{0});
  }

  /// Forgets the operand before, but not what has been taken up.
  void begin_operand() {
    for (std::uint16_t& name : names_) {
      if (name >= kCoordinates && name != kTakenUp) name = kNone;
    }
    next_ = kCoordinates;
    constants_ = 0;
  }

  /// One of its instructions; constants are numbered from its first.
  Instruction rename(const Instruction& instruction) {
    const OpcodeInfo& shape = info(instruction.op);
    Instruction renamed{instruction.op, {}, {}, constants_};
    for (std::size_t k = 0; k < shape.inputs; ++k) renamed.in[k] = names_[instruction.in[k]];
    for (std::size_t k = 0; k < shape.outputs; ++k) renamed.out[k] = names_[instruction.out[k]] = next_++;
    constants_ += shape.constants;
    return renamed;
  }

  /// What is in a register has been taken up.
  void take_up(std::uint16_t taken) {
    std::ranges::replace(names_, kTakenUp, kNone);
    names_[taken] = kTakenUp;
  }
  bool is_taken_up(std::uint16_t taken) const { return names_[taken] == kTakenUp; }

  std::uint16_t name(std::uint16_t taken) const { return names_[taken]; }
  std::uint16_t next() const { return next_; }
  std::uint32_t constants() const { return constants_; }

 private:
  static constexpr std::uint16_t kNone = std::numeric_limits<std::uint16_t>::max();
  static constexpr std::uint16_t kTakenUp = kNone - 1;

  std::vector<std::uint16_t> names_;  ///< by register of the tape
  std::uint16_t next_ = kCoordinates;
  std::uint32_t constants_ = 0;
};

}  // namespace

std::optional<Chain> Chain::of(const Tape& tape) {
  Chain chain;
  if (tape.inputs != kCoordinates || tape.results.size() != 1 || !chain.find_body(tape)) return std::nullopt;
  return chain.has_only_such_operands(tape) ? std::optional(std::move(chain)) : std::nullopt;
}

/// Takes the first operand for what all are like.
bool Chain::find_body(const Tape& tape) {
  const std::vector<Instruction>& code = tape.code;
  const auto first = std::ranges::find_if(code, [](const Instruction& i) { return combines(i.op); });
  const auto two_bodies = static_cast<std::size_t>(first - code.begin());
  const std::size_t size = two_bodies / 2;
  if (first == code.end() || size == 0 || size > kLongest || two_bodies % 2 != 0) return false;
  if ((code.size() + 1) % (size + 1) != 0) return false;
  // besides coordinates and the operand's, what has been taken up
  if (tape.registers > kCoordinates + size * kMaxOutputs + 1) return false;
  Renamer renamer(tape.registers);
  for (std::size_t k = 0; k < size; ++k) {
    if (!runs_by_lanes(code[k].op)) return false;
    body_.push_back(renamer.rename(code[k]));
  }
  if (info(body_.back().op).outputs != 1) return false;
  constants_ = renamer.constants();
  const std::uint16_t taken_up = renamer.next();
  combine_ = {first->op, {taken_up}, {taken_up, body_.back().out[0]}, first->constants};
  operands_ = (code.size() + 1) / (size + 1);
  return true;
}

bool Chain::has_only_such_operands(const Tape& tape) const {
  Renamer renamer(tape.registers);
  for (std::size_t i = 0; i < operands_; ++i) {
    renamer.begin_operand();
    const Instruction* const its = tape.code.data() + head(i);
    for (std::size_t k = 0; k < body_.size(); ++k) {
      const bool has_its_constants = its[k].constants == first_constant(i) + body_[k].constants;
      if (its[k].op != body_[k].op || !has_its_constants || renamer.rename(its[k]) != body_[k]) return false;
    }
    std::uint16_t result = its[body_.size() - 1].out[0];
    if (i > 0) {
      const Instruction& combine = its[body_.size()];
      const bool reads_both = combine.op == combine_.op && renamer.is_taken_up(combine.in[0]) &&
                              renamer.name(combine.in[1]) == combine_.in[1];
      if (!reads_both || !has_same_constants(tape, combine)) return false;
      result = combine.out[0];
    }
    renamer.take_up(result);
  }
  return renamer.is_taken_up(tape.result());
}

bool Chain::has_same_constants(const Tape& tape, const Instruction& combine) const {
  const double* const constants = tape.constants.data();
  const std::size_t count = info(combine_.op).constants;
  return std::equal(constants + combine.constants, constants + combine.constants + count,
                    constants + combine_.constants);
}

bool Chain::find_operands(const TapePart& part, std::vector<std::uint32_t>& operands) const {
  operands.clear();
  for (std::size_t i = 0; i < part.length;) {
    const std::uint32_t at = part.origins[i];
    const std::uint32_t operand = operand_at(at);
    const std::size_t count = body_.size() + (i > 0 ? 1 : 0);
    // origins ascend
    if (at != head(operand) || i + count > part.length || part.origins[i + count - 1] != at + count - 1) return false;
    operands.push_back(operand);
    i += count;
  }
  return !operands.empty();
}

TapePart Chain::part_of(std::span<const std::uint32_t> operands) const {
  TapePart part;
  part.origins = operands.data();
  part.results = combine_.out.data();
  part.length = static_cast<std::uint32_t>(length(operands.size()));
  part.result_count = 1;
  part.result = combine_.out[0];
  part.registers = registers();
  return part;
}

void Chain::write_code(const TapePart& part, Instruction* code, std::uint32_t* origins) const {
  const std::size_t count = operands_of(part);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t operand = part.origins[i];
    auto at = static_cast<std::uint32_t>(head(operand));
    const auto first = static_cast<std::uint32_t>(first_constant(operand));
    for (const Instruction& instruction : body_) {
      *code = instruction;
      code++->constants += first;
      *origins++ = at++;
    }
    if (i == 0) {
      code[-1].out[0] = combine_.out[0];
    } else {
      *code++ = combine_;
      *origins++ = at;
    }
  }
}

}  // namespace octomarch
