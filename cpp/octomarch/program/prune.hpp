// Pruning: the part of a tape that decides its results in a region. An operator whose operands differ there by so much that
// it always takes the same one is that operand, and what only the others needed is dropped. What is left gives the results
// of the whole tape at every point of the region, to the bit (but for the sign of a zero). The octree prunes cell by cell.
//
// Two ways tell which operand is taken. Samples: where operands differ in the middles of a region's parts by more than their
// slopes let them change from there, they do so everywhere. That costs an evaluation of a block of lanes, and says most. Ranges,
// by interval arithmetic, cost ten times as much, and say something where values jump or have no slopes, in repeats and
// expressions.
// M. Keeter, "Massively parallel rendering of complex closed-form implicit surfaces", ACM TOG 39(4), 2020; W. Barbier et al.,
// "Lipschitz pruning: hierarchical simplification of primitive-based SDFs", CGF 44(2), 2025.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "octomarch/program/chain.hpp"
#include "octomarch/program/margins.hpp"
#include "octomarch/program/program.hpp"
#include "octomarch/program/range.hpp"
#include "octomarch/program/region.hpp"
#include "octomarch/program/tape_part.hpp"

namespace octomarch {

/// The points at which a region is sampled: the middles of its parts, kSamplesAcross along each axis.
inline constexpr std::size_t kSamplesAcross = 4;
inline constexpr std::size_t kSamples = kSamplesAcross * kSamplesAcross * kSamplesAcross;
template <class Real>
struct SamplePoints {
  alignas(64) Real x[kSamples];
  alignas(64) Real y[kSamples];
  alignas(64) Real z[kSamples];
  double radius;  ///< of balls about the points that hold all of the region
};

/// Runs parts of tapes at samples. program/ has no kernels: whoever prunes brings this along. One for each thread.
template <class Real>
class Sampler {
 public:
  virtual ~Sampler() = default;
  /// Where each instruction of `part` takes which operand all over the balls about the points. `margins`: of the tape.
  virtual void compare(const TapePart& part, const SamplePoints<Real>& points, const Margin* margins,
                       TakenAt* taken) = 0;
};

/// Registers in use, each by how many names. The lowest that is free is taken first.
class RegisterNames {
 public:
  void clear() {
    free_.clear();
    names_.clear();
  }
  /// A register, by one name.
  std::uint16_t take();
  void name_again(std::uint16_t taken) { ++names_[taken]; }
  void drop_name(std::uint16_t taken) {
    if (--names_[taken] == 0) free_[taken / kBits] |= std::uint64_t{1} << taken % kBits;
  }
  /// Registers that were ever in use.
  std::uint32_t most() const { return static_cast<std::uint32_t>(names_.size()); }

 private:
  static constexpr std::size_t kBits = 64;
  std::vector<std::uint64_t> free_;
  std::vector<std::uint32_t> names_;
};

/// Prunes parts of one tape; keeps its memory from call to call. One for each thread.
template <class Real>
class Pruner {
 public:
  /// `sampler`: null to decide by ranges alone. `table`: constants of lists, or null where there are none. All must outlive this.
  explicit Pruner(const Tape& tape, Sampler<Real>* sampler = nullptr, const Real* table = nullptr);

  /// What is left of a part in a region, which must lie in the part's own; nothing if that is all of it. It is there until the
  /// next call, and the part must be somewhere else. `margins`: of the tape, where it is run at points of the region, or for
  /// lists; not read without a sampler. O(part).
  std::optional<TapePart> prune(const TapePart& part, const Region<Real>& region, const Margin* margins);
  /// The same for a list, by samples alone: which operands are left; false where they do not tell. `ready`: the same part, ready to be
  /// run. O(part), and half of the time.
  bool prune(const Chain& chain, const TapePart& list, const TapePart& ready, const Region<Real>& region,
             const Margin* margins, std::vector<std::uint32_t>& operands);

 private:
  /// At which samples a value matters. Where it does not, it may be off, but only to one side: what takes the smaller of two
  /// operands does not care if the other is larger than it should be.
  struct Need {
    std::uint64_t where = 0;
    bool may_be_larger = true;
    bool may_be_smaller = true;
  };

  /// What an instruction turns out to be: itself, one of its operands, the complement of one, or its first constant.
  enum class Choice : std::uint8_t {
    kItself,
    kFirst,
    kSecond,
    kThird,
    kFourth,
    kComplementOfFirst,
    kComplementOfSecond,
    kConstant,
  };

  /// Of an instruction, as bits: its inputs that nobody reads later, and its outputs that anybody reads.
  struct Uses {
    std::uint8_t last = 0;
    std::uint8_t read = 0;
  };

  // samples, in prune_samples.cpp:
  void sample(const TapePart& part, const Region<Real>& region);
  void require_operands(const Instruction& instruction, std::size_t index, const Need& need);

  bool wants_ranges(const TapePart& part) const;
  void choose_by_ranges(const TapePart& part, const Region<Real>& region);
  Choice choose(const Instruction& instruction, const Range<Real>* in) const;
  static Choice operand_of(Opcode op, bool is_second);
  static std::uint8_t inputs_read(Opcode op, Choice choice);
  static bool is_operand(Choice choice) { return choice >= Choice::kFirst && choice <= Choice::kFourth; }
  static std::size_t operand(Choice choice);
  void find_uses(const TapePart& part);
  void emit(const TapePart& part);

  const Tape& tape_;
  Sampler<Real>* const sampler_;
  const Margin* margins_ = nullptr;  ///< while it prunes
  const Real* const table_;
  const Real* constants_ = nullptr;  ///< likewise
  SamplePoints<Real> points_;
  std::vector<TakenAt> taken_;  ///< by instruction, as the next two
  std::vector<Choice> choices_;
  std::vector<Uses> uses_;
  std::vector<Need> needs_;          ///< by register, going backward
  std::vector<char> is_read_;        ///< likewise
  std::vector<Range<Real>> ranges_;  ///< by register, going forward
  RegisterNames registers_;
  std::vector<std::uint16_t> register_of_;  ///< which one takes the place of each; likewise
  HeldPart left_;
};

}  // namespace octomarch
