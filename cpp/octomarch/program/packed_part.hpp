// Parts in an eighth of their memory, for those that are run less than they wait to be pruned: the instructions of a part differ
// in little but where they come from. prune.hpp comes before, the octree keeps them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "octomarch/base/arena.hpp"
#include "octomarch/program/tape_part.hpp"

namespace octomarch {

/// Packs parts; keeps its memory from call to call.
class Packer {
 public:
  /// The same part packed, in the arena; nothing where its instructions differ too much. O(length).
  std::optional<TapePart> pack(const TapePart& part, Arena& arena);

 private:
  std::optional<std::uint8_t> pattern_of(const Instruction& instruction);

  std::vector<Instruction> patterns_;  ///< instructions but for their constants
  std::vector<PackedInstruction> packed_;
  std::array<std::uint8_t, 256> guesses_;  ///< by hash
};

/// Unpacks parts, one at a time.
class Unpacker {
 public:
  /// O(tape).
  explicit Unpacker(const Tape& tape);

  /// The part ready to be run or pruned, until the next call. O(length) where it is packed, else O(1).
  TapePart ready(const TapePart& part);

 private:
  std::vector<std::uint32_t> constants_;  ///< of the tape's instructions
  std::vector<Instruction> code_;
  std::vector<std::uint32_t> origins_;
};

}  // namespace octomarch
