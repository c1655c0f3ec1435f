// Finds the chain of a tape; chain.cpp says what is done with it.
#include <algorithm>
#include <numeric>
#include <utility>

#include "octomarch/program/chain.hpp"
#include "octomarch/program/operand_reader.hpp"

namespace octomarch {

namespace {

using Kind = Chain::Kind;

constexpr std::uint32_t kCoordinates = 3;
/// Kinds that are told apart, of which the most frequent ones are kept.
constexpr std::size_t kMostCandidates = 128;
/// Of so many operands a kind must have one. Lanes that run several kinds take longer, and where a rare one is parts are run as those
/// of other tapes.
constexpr std::size_t kRare = 32;

/// Kinds, and how often they are met.
class Candidates {
 public:
  /// Which one it is; kMostCandidates where there are too many.
  std::size_t add(const Kind& kind) {
    if (latest_ >= all_.size() || all_[latest_].kind != kind) latest_ = find(kind);
    if (latest_ == kMostCandidates) return latest_;
    if (latest_ == all_.size()) all_.push_back({kind, 0});
    ++all_[latest_].count;
    return latest_;
  }

  /// The most frequent one that makes operands so too, whatever takes them up; null where there is none.
  const Kind* like(const Kind& kind) const {
    const Candidate* found = nullptr;
    for (const Candidate& other : all_) {
      const bool is_like = std::ranges::equal(other.kind.body(), kind.body());
      if (is_like && (found == nullptr || other.count > found->count)) found = &other;
    }
    return found == nullptr ? nullptr : &found->kind;
  }

  /// Those of which there are many. Of each candidate, which of them it is, or kMostKinds.
  std::vector<Kind> frequent(std::size_t many_that_choose, std::vector<std::uint8_t>& kind_of) const {
    std::vector<std::size_t> order(all_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, [&](std::size_t a, std::size_t b) {
      return all_[a].count != all_[b].count ? all_[a].count > all_[b].count : a < b;
    });
    std::size_t operands = 0;
    for (const Candidate& candidate : all_) operands += candidate.count;
    kind_of.assign(kMostCandidates + 1, static_cast<std::uint8_t>(Chain::kMostKinds));
    std::vector<Kind> kinds;
    for (const std::size_t i : order) {
      if (kinds.size() == Chain::kMostKinds || all_[i].count * kRare < operands) break;
      if (chooses(all_[i].kind) && all_[i].count < many_that_choose) continue;
      kind_of[i] = static_cast<std::uint8_t>(kinds.size());
      kinds.push_back(all_[i].kind);
    }
    return kinds;
  }

 private:
  struct Candidate {
    Kind kind;
    std::size_t count;
  };

  std::size_t find(const Kind& kind) const {
    return static_cast<std::size_t>(std::ranges::find(all_, kind, &Candidate::kind) - all_.begin());
  }

  std::vector<Candidate> all_;
  std::size_t latest_ = 0;
};

struct Found {
  std::uint32_t head;
  std::uint32_t length;
  std::size_t link;
  std::size_t candidate;
};

/// Finds the operands of a tape.
class OperandFinder {
 public:
  explicit OperandFinder(const Tape& tape)
      : tape_(tape), sources_(tape), links_(links_of(tape, sources_)), reader_(tape, sources_) {
    for (std::size_t i = 0; i < links_.size(); ++i) {
      if (links_[i].taken_up == kNoInstruction) continue;  // a coordinate, which no list could tell of
      if (const std::optional<Kind> kind = reader_.read(links_[i].operand, links_[i])) {
        add(links_[i].operand, *kind, i);
        joins_.push_back(links_[i].at);
      } else if (unites(tape, links_[i].at) && unites(tape, links_[i].operand)) {
        read_union(i);
      }
    }
    read_first();
  }

  /// In the order in which they are taken up.
  const std::vector<Found>& found() const { return found_; }
  /// Instructions that choose between operands and what has been taken up.
  const std::vector<std::uint32_t>& joins() const { return joins_; }
  const Candidates& candidates() const { return candidates_; }

 private:
  void add(std::uint32_t last, const Kind& kind, std::size_t link) {
    const auto length = static_cast<std::uint32_t>(kind.length);
    found_.push_back({last + 1 - length, length, link, candidates_.add(kind)});
  }

  /// Where a union is added by a union, what it unites may as well be added one by one.
  void read_union(std::size_t index) {
    const ChainLink& link = links_[index];
    std::vector<std::uint32_t> operands;
    std::vector<std::uint32_t> unions;
    std::vector<std::uint32_t> to_see = {link.operand};
    while (!to_see.empty()) {
      const std::uint32_t at = to_see.back();
      to_see.pop_back();
      if (at == kNoInstruction || sources_.reads(at) != 1) return;  // it is no instruction's, or of something else too
      if (!unites(tape_, at)) {
        operands.push_back(at);
        continue;
      }
      unions.push_back(at);
      to_see.insert(to_see.end(), {sources_.of(at, 0), sources_.of(at, 1)});
    }
    std::ranges::sort(operands);
    for (const std::uint32_t last : operands) {
      const std::optional<Kind> kind = reader_.read(last, {link.at, link.taken_up, last, false});
      if (kind) add(last, *kind, index);
    }
    joins_.insert(joins_.end(), unions.begin(), unions.end());
    joins_.push_back(link.at);
  }

  /// Of the first it does not matter what would take it up. Where operands are made by links of their own it may be so too.
  void read_first() {
    for (std::size_t i = std::min(links_.size(), Chain::kLongest); i-- > 0;) {
      const std::uint32_t last = links_[i].taken_up;
      const std::optional<Kind> kind = reader_.read(last, links_[i]);
      const Kind* const like = kind ? candidates_.like(*kind) : nullptr;
      if (!kind || (i > 0 && like == nullptr)) continue;
      std::erase_if(found_, [i](const Found& operand) { return operand.link < i; });
      add(last, like == nullptr ? *kind : Kind(*like), i);
      std::ranges::rotate(found_, found_.end() - 1);
      break;
    }
  }

  const Tape& tape_;
  const Sources sources_;
  const std::vector<ChainLink> links_;
  const OperandReader reader_;
  std::vector<Found> found_;
  std::vector<std::uint32_t> joins_;
  Candidates candidates_;
};

/// A register that no kind has.
std::uint16_t register_above(const std::vector<Kind>& kinds) {
  std::uint16_t above = kCoordinates;
  for (const Kind& kind : kinds) {
    for (const Instruction& instruction : kind.body()) {
      for (const std::uint16_t out : instruction.out) above = std::max(above, static_cast<std::uint16_t>(out + 1));
    }
  }
  return above;
}

}  // namespace

std::optional<Chain> Chain::of(const Tape& tape, std::size_t many_that_choose) {
  if (tape.inputs != kCoordinates || tape.results.size() != 1) return std::nullopt;
  const OperandFinder finder(tape);
  Chain chain;
  std::vector<std::uint8_t> kind_of;
  chain.kinds_ = finder.candidates().frequent(many_that_choose, kind_of);
  chain.owners_.assign(tape.code.size(), kOther);
  for (const std::uint32_t join : finder.joins()) chain.owners_[join] = kNobody;
  std::size_t length = 0;
  for (const Found& operand : finder.found()) {
    if (kind_of[operand.candidate] == kMostKinds) continue;
    const auto number = static_cast<std::uint32_t>(chain.operands());
    std::fill_n(chain.owners_.begin() + operand.head, operand.length, number);
    chain.first_constants_.push_back(tape.code[operand.head].constants);
    chain.kind_of_.push_back(kind_of[operand.candidate]);
    length += operand.length + 1;
  }
  if (2 * length <= tape.code.size()) return std::nullopt;
  chain.is_whole_ = std::ranges::find(chain.owners_, kOther) == chain.owners_.end();
  if (chain.is_whole_) chain.owners_ = {};
  chain.length_ = length - 1;
  chain.columns_ = std::ranges::max(chain.kinds_, {}, &Kind::constants).constants + (chain.has_one_kind() ? 0 : 1);
  if (chain.columns_ == 0) return std::nullopt;  // all operands are alike
  chain.name_taken_up(register_above(chain.kinds_));
  return chain;
}

/// Gives the combines of kinds that register, and their constants in the table.
void Chain::name_taken_up(std::uint16_t taken_up) {
  taken_up_ = taken_up;
  std::size_t constants = operands() * columns_;
  for (Kind& kind : kinds_) {
    Instruction& combine = kind.instructions[kind.length];
    combine.out[0] = taken_up;
    std::ranges::replace(combine.in, OperandReader::kTakenUp, taken_up);
    combine.constants = static_cast<std::uint32_t>(std::exchange(constants, constants + kMostOfCombine));
  }
}

}  // namespace octomarch
