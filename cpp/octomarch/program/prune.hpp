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

#include "octomarch/program/margins.hpp"
#include "octomarch/program/program.hpp"
#include "octomarch/program/range.hpp"
#include "octomarch/program/region.hpp"

namespace octomarch {

/// Instructions and registers of a part of a tape; constants, images and inputs are the tape's.
struct TapePart {
  std::vector<Instruction> code;
  std::vector<std::uint32_t> origins;  ///< where each instruction stands in the tape; empty in parts that are final
  std::vector<std::uint16_t> results;
  std::uint32_t registers = 0;

  friend bool operator==(const TapePart&, const TapePart&) = default;
};

/// All of a tape.
TapePart whole_of(const Tape& tape);

/// The points at which a region is sampled: the middles of its parts, kSamplesAcross along each axis.
inline constexpr std::size_t kSamplesAcross = 4;
inline constexpr std::size_t kSamples = kSamplesAcross * kSamplesAcross * kSamplesAcross;
template <class Real>
struct SamplePoints {
  alignas(64) Real x[kSamples];
  alignas(64) Real y[kSamples];
  alignas(64) Real z[kSamples];
};

/// Runs parts of tapes at samples. program/ has no kernels: whoever prunes brings this along. One for each thread.
template <class Real>
class Sampler {
 public:
  virtual ~Sampler() = default;
  /// Where each instruction of `part` takes which operand, as far as these differ by more than its gap. Nothing is written of
  /// those whose gap is infinite.
  virtual void compare(const TapePart& part, const SamplePoints<Real>& points, const Real* gaps, TakenAt* taken) = 0;
};

/// Which of two operands an operator takes, if that is known.
enum class Taken : std::uint8_t { kUnknown, kFirst, kSecond };

/// Prunes parts of one tape; keeps its memory from call to call. One for each thread.
template <class Real>
class Pruner {
 public:
  /// Decides by ranges alone. `tape` must outlive this.
  explicit Pruner(const Tape& tape);
  /// Decides by samples too. `margins`: of the tape; all must outlive this.
  Pruner(const Tape& tape, const std::vector<Margin>& margins, Sampler<Real>& sampler);

  /// What is left of a part in a region, which must lie in the part's own; nothing if that is all of it. O(part).
  std::optional<TapePart> prune(const TapePart& part, const Region<Real>& region);

 private:
  using Value = std::uint32_t;  ///< inputs first, then kMaxOutputs for each instruction

  /// At which samples a value matters. Where it does not, it may be off, but only to one side: what takes the smaller of two
  /// operands does not care if the other is larger than it should be.
  struct Need {
    std::uint64_t where = 0;
    bool may_be_larger = true;
    bool may_be_smaller = true;
  };

  struct Choice {
    bool is_made = false;
    bool is_negated = false;   ///< the complement of the operand
    bool is_constant = false;  ///< the instruction's first constant
    std::size_t operand = 0;
  };

  /// Fills taken_ and choices_; returns whether there is something that only ranges may tell.
  bool sample(const TapePart& part, const Region<Real>& region);
  bool set_gaps(const TapePart& part, const Region<Real>& region);
  void decide(const TapePart& part);
  void require_operands(const Instruction& instruction, std::size_t index, const Need& need);
  void load(const Region<Real>& region);
  template <bool kByRanges>
  void run(const Instruction& instruction, std::size_t index);
  static Choice among(Opcode op, Taken taken);
  Choice choose(const Instruction& instruction, const Range<Real>* in) const;
  void mark(const TapePart& part);
  TapePart emit(const TapePart& part);
  Value output(std::size_t index, std::size_t i) const {
    return static_cast<Value>(tape_.inputs + index * kMaxOutputs + i);
  }

  const Tape& tape_;
  const std::vector<Margin>* margins_ = nullptr;
  Sampler<Real>* sampler_ = nullptr;
  const Real* constants_;
  SamplePoints<Real> points_;
  std::vector<Real> gaps_;
  std::vector<TakenAt> taken_;
  std::vector<Need> needs_;        ///< by value
  std::vector<Taken> decisions_;   ///< by samples, of each instruction
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
