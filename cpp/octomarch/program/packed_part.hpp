// Long parts in a fifth of their memory, for those that are rarely run but wait to be pruned: the instructions of a part differ in
// little but where they come from. prune.hpp comes before, the octree keeps them.
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

  std::vector<Instruction> patterns_;      ///< instructions but for their constants
  std::vector<std::uint8_t> of_;           ///< each instruction's pattern
  std::array<std::uint8_t, 256> guesses_;  ///< by hash
};

/// Unpacks parts, one at a time.
class Unpacker {
 public:
  /// `tape` must outlive this.
  explicit Unpacker(const Tape& tape) : tape_(tape) {}

  /// The part ready to be run or pruned, until the next call. O(length) where it is packed, else O(1).
  TapePart ready(const TapePart& part);

 private:
  const Tape& tape_;
  std::vector<Instruction> code_;
};

}  // namespace octomarch
