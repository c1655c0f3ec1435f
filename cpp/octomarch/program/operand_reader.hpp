// Reads operands off a tape: which instructions made what, the links along which operands are added to each other, and what single
// operands are alike in. chain_of.cpp finds chains by it.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "octomarch/program/chain.hpp"

namespace octomarch {

/// Stands for no instruction, but for coordinates.
inline constexpr std::uint32_t kNoInstruction = std::numeric_limits<std::uint32_t>::max();

/// Which instructions made what each instruction of a tape reads.
class Sources {
 public:
  /// O(tape).
  explicit Sources(const Tape& tape);

  std::uint32_t of(std::uint32_t instruction, std::size_t input) const { return of_[instruction][input]; }
  /// Instructions that a value takes, if no two share any.
  double weight(std::uint32_t instruction) const { return instruction == kNoInstruction ? 0.0 : weights_[instruction]; }
  /// How often what an instruction made is read.
  std::uint32_t reads(std::uint32_t instruction) const { return reads_[instruction]; }
  std::uint32_t result() const { return result_; }

 private:
  std::vector<std::array<std::uint32_t, kMaxInputs>> of_;
  std::vector<double> weights_;
  std::vector<std::uint32_t> reads_;
  std::uint32_t result_;
};

/// What chooses between what has been taken up so far and one operand more.
struct ChainLink {
  std::uint32_t at;
  std::uint32_t taken_up;  ///< what made it; likewise the next
  std::uint32_t operand;
  bool is_operand_first;
};

/// Does an instruction unite without a blend, so that it does not matter in which order?
inline bool unites(const Tape& tape, std::uint32_t at) {
  return at != kNoInstruction && tape.code[at].op == Opcode::kUnion;
}

/// The links from the operand to which most of a tape is added to the result. O(links).
std::vector<ChainLink> links_of(const Tape& tape, const Sources& sources);

/// Does what makes an operand choose between parts of it?
bool chooses(const Chain::Kind& kind);

/// Reads single operands.
class OperandReader {
 public:
  /// In kinds that are read, the register of what has been taken up.
  static constexpr std::uint16_t kTakenUp = std::numeric_limits<std::uint16_t>::max();

  /// Both must outlive this.
  OperandReader(const Tape& tape, const Sources& sources) : tape_(tape), sources_(sources) {}

  /// Of the operand that ends with an instruction and is taken up by a link, if lanes can run it. Registers are those of the
  /// operand alone, whatever they are in the tape. O(1).
  std::optional<Chain::Kind> read(std::uint32_t last, const ChainLink& link) const;

 private:
  std::uint32_t length_of(std::uint32_t last) const;
  void read_body(std::uint32_t head, Chain::Kind& kind) const;
  std::uint16_t renamed(std::uint32_t source, std::uint16_t taken, const Instruction& own) const;
  void read_combine(const ChainLink& link, Chain::Kind& kind) const;

  const Tape& tape_;
  const Sources& sources_;
};

}  // namespace octomarch
