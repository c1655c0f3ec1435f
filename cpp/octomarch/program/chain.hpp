// Chains: the operands of a tape that it unites, intersects or blends one after the other, where they are short and of a few kinds:
// balls and boxes, say, which differ in their constants. What is left of such a tape in a region is mostly a list of operands, so
// that rays in many regions can be marched side by side, each lane by operands of its own. Lowering comes before, packed_part.hpp
// and the octree after.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "octomarch/program/choices.hpp"
#include "octomarch/program/program.hpp"
#include "octomarch/program/region.hpp"
#include "octomarch/program/tape_part.hpp"

namespace octomarch {

class Chain {
 public:
  /// Instructions of an operand.
  static constexpr std::size_t kLongest = 24;
  static constexpr std::size_t kMostKinds = 8;

  /// Constants of what takes operands up.
  static constexpr std::size_t kMostOfCombine = 2;

  /// What operands are alike in: all but their constants.
  struct Kind {
    std::array<Instruction, kLongest + 1> instructions{};
    std::size_t length = 0;     ///< of the body
    std::size_t constants = 0;  ///< likewise
    std::array<double, kMostOfCombine> of_combine{};

    /// Makes an operand from the coordinates in registers 0, 1, 2, which it leaves alone; it is the output of the last
    /// instruction. Constants are numbered from the operand's first.
    std::span<const Instruction> body() const { return {instructions.data(), length}; }
    std::uint16_t operand() const { return instructions[length - 1].out[0]; }  ///< its register, which nothing else has
    /// Takes an operand up: one of its inputs, and its output, are what has been taken up so far. Its constants, the same for all
    /// operands, are the table's.
    const Instruction& combine() const { return instructions[length]; }
    bool takes_operand_first() const { return combine().in[1] == combine().out[0]; }
    friend bool operator==(const Kind& a, const Kind& b);
  };

  /// Parts of other tapes are pruned inside of operands too. So operands that choose by themselves are to be so many that most cells
  /// hold whole ones.
  static constexpr std::size_t kManyThatChoose = 1000;
  /// The chain of a tape; nothing where that would be less than half of it. `many_that_choose`: of a kind. O(tape).
  static std::optional<Chain> of(const Tape& tape, std::size_t many_that_choose = kManyThatChoose);

  std::span<const Kind> kinds() const { return kinds_; }
  std::size_t operands() const { return kind_of_.size(); }
  /// Instructions of all.
  std::size_t length() const { return length_; }
  const Kind& kind_of(std::size_t operand) const {
    return kinds_[has_one_kind() ? 0 : kind_of_[operand]];  // without a look at memory where there is nothing to see
  }
  bool has_one_kind() const { return kinds_.size() == 1; }
  /// Is there nothing else in the tape?
  bool is_whole() const { return is_whole_; }
  /// The register of what has been taken up.
  std::uint16_t taken_up() const { return taken_up_; }
  std::uint32_t registers() const { return taken_up_ + 1U; }

  /// What the table has of each operand: its constants and, where there are several kinds, behind them as many zeros as it has fewer
  /// than others, and its kind.
  std::size_t columns() const { return columns_; }
  /// The constants of lists: rows of one operand after the other, then what their combines go by. O(operands).
  template <class Real>
  std::vector<Real> table(const Tape& tape) const;
  /// Margins of lists that are run at points of a region, where their code says (write_code). `table`: table(). O(operands).
  template <class Real>
  std::vector<Margin> margins(const std::vector<Real>& table, const Region<Real>& region) const;

  /// The operands that a part of the tape has something of, ascending; false where it has something else too. All of them gives the
  /// part's bits where it gives the tape's, since what an operand is without is what does not matter. Not for whole chains. O(part).
  bool find_operands(const TapePart& part, std::vector<std::uint32_t>& operands) const;
  /// The same for what ranges leave of a list that was ready to be run. O(part).
  static bool find_operands_of_list(const TapePart& left, std::vector<std::uint32_t>& operands);
  /// The part of such operands, which stay somebody else's: a list. O(operands).
  TapePart part_of(std::span<const std::uint32_t> operands) const;
  /// The instructions of a list, and which margins are theirs, both as long as it. O(part).
  void write_code(const TapePart& list, Instruction* code, std::uint32_t* origins) const;
  /// Bytes of what is kept of operands and instructions.
  std::size_t bytes() const {
    return operands() * (sizeof(std::uint32_t) + 1) + owners_.size() * sizeof(std::uint32_t);
  }

 private:
  Chain() = default;

  void name_taken_up(std::uint16_t taken_up);
  /// Owners of instructions that are no operand's: of those that choose between operands, and of others.
  static constexpr std::uint32_t kNobody = std::numeric_limits<std::uint32_t>::max() - 1;
  static constexpr std::uint32_t kOther = kNobody + 1;

  std::vector<Kind> kinds_;
  // by operand:
  std::vector<std::uint32_t> first_constants_;  ///< in the tape's; the others follow
  std::vector<std::uint8_t> kind_of_;
  std::vector<std::uint32_t> owners_;  ///< by instruction of the tape: its operand; empty where there is nothing else
  std::size_t length_ = 0;
  std::size_t columns_ = 0;
  std::uint16_t taken_up_ = 0;
  bool is_whole_ = false;
};

}  // namespace octomarch
