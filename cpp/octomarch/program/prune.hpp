// Pruning: the part of a tape that decides its results in a region. An operator whose operands differ there by so much that
// it always takes the same one is that operand, and what only the others needed is dropped. What is left gives the results
// of the whole tape at every point of the region, to the bit (but for the sign of a zero). The octree prunes cell by cell.
// M. Keeter, "Massively parallel rendering of complex closed-form implicit surfaces", ACM TOG 39(4), 2020; W. Barbier et al.,
// "Lipschitz pruning: hierarchical simplification of primitive-based SDFs", CGF 44(2), 2025.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "octomarch/program/program.hpp"
#include "octomarch/program/range.hpp"
#include "octomarch/program/region.hpp"

namespace octomarch {

/// Instructions and registers of a part of a tape; constants, images and inputs are the tape's.
struct TapePart {
  std::vector<Instruction> code;
  std::vector<std::uint16_t> results;
  std::uint32_t registers = 0;

  friend bool operator==(const TapePart&, const TapePart&) = default;
};

/// All of a tape.
TapePart whole_of(const Tape& tape);

/// Prunes parts of one tape; keeps its memory from call to call. One for each thread.
template <class Real>
class Pruner {
 public:
  /// `tape` must outlive this.
  explicit Pruner(const Tape& tape);

  /// What is left of a part in a region, which must lie in the part's own; nothing if that is all of it. O(part).
  std::optional<TapePart> prune(const TapePart& part, const Region<Real>& region);

 private:
  using Value = std::uint32_t;  ///< inputs first, then kMaxOutputs for each instruction

  struct Choice {
    bool is_made = false;
    bool is_negated = false;   ///< the complement of the operand
    bool is_constant = false;  ///< the instruction's first constant
    std::size_t operand = 0;
  };

  void load(const Region<Real>& region);
  void run(const Instruction& instruction, std::size_t index);
  Choice choose(const Instruction& instruction, const Range<Real>* in) const;
  void mark(const TapePart& part);
  TapePart emit(const TapePart& part);
  Value output(std::size_t index, std::size_t i) const {
    return static_cast<Value>(tape_.inputs + index * kMaxOutputs + i);
  }

  const Tape& tape_;
  const Real* constants_;
  std::vector<Instruction> code_;  ///< as it will be, but for its registers
  std::vector<std::array<Value, kMaxInputs>> inputs_;
  std::vector<char> is_needed_;
  std::vector<Range<Real>> ranges_;       ///< by value
  std::vector<Value> in_register_;        ///< by register
  std::vector<std::uint32_t> last_use_;   ///< by value
  std::vector<std::uint16_t> registers_;  ///< by value
  std::size_t dropped_ = 0;
};

}  // namespace octomarch
