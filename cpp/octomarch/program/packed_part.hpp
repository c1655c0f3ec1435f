// Parts in an eighth of their memory, for those that are run less than they wait to be pruned: the instructions of a part differ
// in little but where they come from. prune.hpp comes before, the octree keeps them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "octomarch/base/arena.hpp"
#include "octomarch/program/chain.hpp"
#include "octomarch/program/tape_part.hpp"

namespace octomarch {

/// Packs parts; keeps its memory from call to call.
class Packer {
 public:
  /// The same part packed, in the arena; nothing where its instructions differ too much to gain by it. O(length).
  std::optional<TapePart> pack(const TapePart& part, Arena& arena);

 private:
  std::optional<std::uint8_t> pattern_of(const Instruction& instruction);

  std::vector<Instruction> patterns_;  ///< instructions but for their constants
  std::vector<PackedInstruction> packed_;
  std::array<std::uint8_t, 256> guesses_;  ///< by hash
};

/// Where the constants of each instruction of a tape begin. O(tape).
std::vector<std::uint32_t> constant_offsets(const Tape& tape);

/// Unpacks parts, one at a time.
class Unpacker {
 public:
  /// `constants`: where those of each instruction of the tape begin; not read for lists. `chain`: the tape's, or null where there are no
  /// lists. They must outlive this.
  explicit Unpacker(std::span<const std::uint32_t> constants, const Chain* chain = nullptr)
      : constants_(constants), chain_(chain) {}

  /// The part ready to be run or pruned, until the next call. O(length) where it is packed or a list, else O(1).
  TapePart ready(const TapePart& part);

 private:
  void reserve(std::size_t length);

  std::span<const std::uint32_t> constants_;  // rather than the tape, of which they are a fifth: they stay in the cache
  const Chain* chain_;
  std::vector<Instruction> code_;
  std::vector<std::uint32_t> origins_;
};

}  // namespace octomarch
