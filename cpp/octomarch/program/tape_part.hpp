// Parts of a tape: instructions that are left where others do not matter. prune.hpp makes them, the octree keeps them, kernels run
// them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "octomarch/program/program.hpp"

namespace octomarch {

/// An instruction of a packed part, three bytes; see packed_part.hpp.
struct PackedInstruction {
  std::uint8_t pattern;
  /// From where the one before stands in the tape to where this one does, the low byte first.
  std::array<std::uint8_t, 2> gap;
};
static_assert(sizeof(PackedInstruction) == 3);

/// Instructions and registers of a part of a tape, which somebody else holds; images and inputs are the tape's, and so are constants,
/// but for lists, whose are those of a table (chain.hpp).
struct TapePart {
  const Instruction* code = nullptr;          ///< in packed parts: one of each pattern; null in lists
  const PackedInstruction* packed = nullptr;  ///< null in parts that are not
  /// Where each instruction stands in the tape, ascending; null in packed parts and in final ones. In lists the numbers of their
  /// operands; where these are ready to be run, which margins are whose.
  const std::uint32_t* origins = nullptr;
  const std::uint16_t* results = nullptr;
  std::uint32_t length = 0;
  std::uint16_t result_count = 0;
  std::uint16_t result = 0;  ///< the first of them
  std::uint32_t registers = 0;
  std::uint32_t operands = 0;  ///< of lists, also when they are ready to be run

  /// Of parts that are ready to be run.
  std::span<const Instruction> instructions() const { return {code, length}; }
  bool is_list() const { return has_table() && code == nullptr; }
  /// Is it a list, or has it been one?
  bool has_table() const { return operands > 0; }
  std::span<const std::uint32_t> list() const { return {origins, operands}; }
};

/// A part and its memory.
struct HeldPart {
  std::vector<Instruction> code;
  std::vector<std::uint32_t> origins;
  std::vector<std::uint16_t> results;
  std::uint32_t registers = 0;

  /// As long as this is neither changed nor gone.
  TapePart view() const {
    return {code.data(),
            nullptr,
            origins.data(),
            results.data(),
            static_cast<std::uint32_t>(code.size()),
            static_cast<std::uint16_t>(results.size()),
            results.front(),
            registers};
  }
};

/// All of a tape.
HeldPart whole_of(const Tape& tape);

}  // namespace octomarch
