// Chains: tapes that take up one operand after the other, all made by the same instructions but for their constants, such as balls
// that are united. What is left of a chain in a region is a list of operands, so that rays in many regions can be marched side by
// side, each lane by operands of its own. Lowering comes before, packed_part.hpp and the octree after.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "octomarch/program/program.hpp"
#include "octomarch/program/tape_part.hpp"

namespace octomarch {

class Chain {
 public:
  /// A tape as a chain; nothing where it is none, or where its operands could be pruned in themselves. O(tape).
  static std::optional<Chain> of(const Tape& tape);

  /// Makes an operand from the coordinates in registers 0, 1, 2, which it leaves alone; it is the output of the last
  /// instruction. Constants are numbered from the operand's first.
  std::span<const Instruction> body() const { return body_; }
  /// Takes an operand up: its first input, and its output, are what has been taken up so far. Its constants are the tape's.
  const Instruction& combine() const { return combine_; }
  std::uint32_t registers() const { return combine_.out[0] + 1U; }
  /// Of the tape.
  std::size_t operands() const { return operands_; }
  /// Instructions of so many operands.
  std::size_t length(std::size_t operands) const { return head(operands); }
  std::size_t operands_of(const TapePart& part) const { return (part.length + 1) / (body_.size() + 1); }
  /// Which operand an instruction of the tape is of.
  std::uint32_t operand_at(std::uint32_t instruction) const {
    return static_cast<std::uint32_t>((instruction + 1) / (body_.size() + 1));
  }
  /// Of each operand.
  std::size_t constants() const { return constants_; }

  /// The first of an operand, in the tape's. The others follow.
  std::size_t first_constant(std::size_t operand) const {
    return operand == 0 ? 0 : operand * (constants_ + info(combine_.op).constants) - info(combine_.op).constants;
  }

  /// The operands that a part of the tape has, ascending; false where it has something else too. O(part).
  bool find_operands(const TapePart& part, std::vector<std::uint32_t>& operands) const;
  /// The part of such operands, which stay somebody else's. O(1).
  TapePart part_of(std::span<const std::uint32_t> operands) const;
  /// The instructions of such a part, and where they stand in the tape, both as long as it. O(part).
  void write_code(const TapePart& part, Instruction* code, std::uint32_t* origins) const;

 private:
  Chain() = default;

  bool find_body(const Tape& tape);
  bool has_only_such_operands(const Tape& tape) const;
  bool has_same_constants(const Tape& tape, const Instruction& combine) const;
  /// Where an operand begins in the tape. It is taken up just before the next.
  std::size_t head(std::size_t operand) const { return operand == 0 ? 0 : operand * (body_.size() + 1) - 1; }

  std::vector<Instruction> body_;
  Instruction combine_{};
  std::size_t operands_ = 0;
  std::size_t constants_ = 0;
};

}  // namespace octomarch
