// Finds the chain of a tape; chain.cpp says what is done with it.
#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "octomarch/program/chain.hpp"

namespace octomarch {

namespace {

using Kind = Chain::Kind;

constexpr std::uint16_t kCoordinates = 3;
/// Kinds that are told apart, of which the most frequent ones are kept.
constexpr std::size_t kMostCandidates = 128;
/// Of so many operands a kind must have one. Lanes that run several kinds take longer, and where a rare one is parts are run as those
/// of other tapes.
constexpr std::size_t kRare = 32;
/// Operands that choose by themselves are not longer than this.
constexpr std::size_t kLongestThatChooses = 8;
/// Stands for no instruction, but for coordinates.
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
/// In kinds, the register of what has been taken up, until it is known which ones they have.
constexpr std::uint16_t kTakenUp = std::numeric_limits<std::uint16_t>::max();

constexpr bool chooses_distance(Opcode op) { return chooses_operand(op) && !chooses_attribute(op); }
/// Can it take operands up? Where it subtracts, a part may need the complement of an operand.
constexpr bool combines(Opcode op) { return chooses_distance(op) && !subtracts(op); }

/// Which instructions made what each instruction of a tape reads.
class Sources {
 public:
  explicit Sources(const Tape& tape)
      : of_(tape.code.size()), weights_(tape.code.size(), 1.0), reads_(tape.code.size(), 0) {
    std::vector<std::uint32_t> maker(tape.registers, kNone);
    for (std::uint32_t i = 0; i < tape.code.size(); ++i) {
      const Instruction& instruction = tape.code[i];
      const OpcodeInfo& shape = info(instruction.op);
      for (std::size_t k = 0; k < shape.inputs; ++k) {
        const std::uint32_t source = of_[i][k] = maker[instruction.in[k]];
        if (source == kNone) continue;
        weights_[i] += weights_[source];
        ++reads_[source];
      }
      for (std::size_t k = 0; k < shape.outputs; ++k) maker[instruction.out[k]] = i;
    }
    result_ = maker[tape.result()];
  }

  std::uint32_t of(std::uint32_t instruction, std::size_t input) const { return of_[instruction][input]; }
  /// Instructions that a value takes, if no two share any.
  double weight(std::uint32_t instruction) const { return instruction == kNone ? 0.0 : weights_[instruction]; }
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
struct Link {
  std::uint32_t at;
  std::uint32_t taken_up;  ///< what made it; likewise the next
  std::uint32_t operand;
  bool is_operand_first;
};

bool unites(const Tape& tape, std::uint32_t at) { return at != kNone && tape.code[at].op == Opcode::kUnion; }

/// Of the two that a link chooses between, is what the second made what has been taken up? So it is where that is much longer than an
/// operand more would be. What a union has united can be added to the other one by one, if the link unites too.
bool is_second_taken_up(const Tape& tape, const Sources& sources, std::uint32_t at) {
  const std::uint32_t first = sources.of(at, 0);
  const std::uint32_t second = sources.of(at, 1);
  if (subtracts(tape.code[at].op) || second == kNone) return false;
  if (first == kNone) return true;
  if (unites(tape, at) && unites(tape, second)) return false;
  const bool adds_first = unites(tape, at) && unites(tape, first);
  return sources.weight(second) > (adds_first ? 0.0 : sources.weight(first)) + Chain::kLongest;
}

/// The links from the operand to which most of a tape is added to the result.
std::vector<Link> links_of(const Tape& tape, const Sources& sources) {
  std::vector<Link> links;
  for (std::uint32_t at = sources.result(); at != kNone && chooses_distance(tape.code[at].op);) {
    const std::uint32_t first = sources.of(at, 0);
    const std::uint32_t second = sources.of(at, 1);
    const bool is_operand_first = is_second_taken_up(tape, sources, at);
    links.push_back({at, is_operand_first ? second : first, is_operand_first ? first : second, is_operand_first});
    at = links.back().taken_up;
  }
  std::ranges::reverse(links);
  return links;
}

/// Does what makes an operand choose between parts of it?
bool chooses(const Kind& kind) {
  return std::ranges::any_of(kind.body(), [](const Instruction& i) { return chooses_distance(i.op); });
}

/// Reads single operands off a tape.
class KindReader {
 public:
  KindReader(const Tape& tape, const Sources& sources) : tape_(tape), sources_(sources) {}

  /// Of the operand that ends with an instruction and is taken up by a link, if lanes can run it. Registers are those of the
  /// operand alone, whatever they are in the tape.
  std::optional<Kind> read(std::uint32_t last, const Link& link) const {
    const std::uint32_t length = combines(tape_.code[link.at].op) ? length_of(last) : 0;
    if (length == 0) return std::nullopt;
    Kind kind;
    kind.length = length;
    read_body(last + 1 - length, kind);
    read_combine(link, kind);
    if (length > kLongestThatChooses && chooses(kind)) return std::nullopt;
    return kind;
  }

 private:
  /// How many instructions make a value, if they follow each other, few as they are, read nothing but coordinates and each
  /// other, are read by nobody else, and can be run by lanes; else 0.
  std::uint32_t length_of(std::uint32_t last) const {
    if (last == kNone || info(tape_.code[last].op).outputs != 1) return 0;
    std::array<std::uint32_t, Chain::kLongest> reads{1};  // of what is made so many instructions before the last
    std::uint32_t length = 0;
    for (std::uint32_t unread = 1; unread > 0; ++length) {
      if (length == Chain::kLongest || length > last) return 0;
      const std::uint32_t at = last - length;
      if (reads[length] == 0 || reads[length] != sources_.reads(at) || !runs_by_lanes(tape_.code[at].op)) return 0;
      --unread;
      for (std::size_t k = 0; k < info(tape_.code[at].op).inputs; ++k) {
        const std::uint32_t source = sources_.of(at, k);
        if (source == kNone) continue;
        if (last - source >= Chain::kLongest) return 0;
        if (reads[last - source]++ == 0) ++unread;
      }
    }
    return length;
  }

  void read_body(std::uint32_t head, Kind& kind) const {
    std::uint16_t next = kCoordinates;
    for (std::uint32_t i = 0; i < kind.length; ++i) {
      const Instruction& taken = tape_.code[head + i];
      const OpcodeInfo& shape = info(taken.op);
      Instruction& own = kind.instructions[i];
      own.op = taken.op;
      own.constants = static_cast<std::uint32_t>(kind.constants);
      for (std::size_t k = 0; k < shape.inputs; ++k) {
        const std::uint32_t source = sources_.of(head + i, k);
        own.in[k] = source == kNone ? taken.in[k] : renamed(source, taken.in[k], kind.instructions[source - head]);
      }
      for (std::size_t k = 0; k < shape.outputs; ++k) own.out[k] = next++;
      kind.constants += shape.constants;
    }
  }

  /// Of what an instruction has left in a register of the tape.
  std::uint16_t renamed(std::uint32_t source, std::uint16_t taken, const Instruction& own) const {
    std::size_t k = 0;
    while (tape_.code[source].out[k] != taken) ++k;
    return own.out[k];
  }

  void read_combine(const Link& link, Kind& kind) const {
    const Instruction& taken = tape_.code[link.at];
    Instruction& combine = kind.instructions[kind.length];
    combine.op = taken.op;
    combine.out[0] = kTakenUp;
    combine.in[0] = link.is_operand_first ? kind.operand() : kTakenUp;
    combine.in[1] = link.is_operand_first ? kTakenUp : kind.operand();
    std::copy_n(tape_.constants.begin() + taken.constants, info(taken.op).constants, kind.of_combine.begin());
  }

  const Tape& tape_;
  const Sources& sources_;
};

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
      if (links_[i].taken_up == kNone) continue;  // a coordinate, which no list could tell of
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
    const Link& link = links_[index];
    std::vector<std::uint32_t> operands;
    std::vector<std::uint32_t> unions;
    std::vector<std::uint32_t> to_see = {link.operand};
    while (!to_see.empty()) {
      const std::uint32_t at = to_see.back();
      to_see.pop_back();
      if (at == kNone || sources_.reads(at) != 1) return;  // it is no instruction's, or of something else too
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
  const std::vector<Link> links_;
  const KindReader reader_;
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
    std::ranges::replace(combine.in, kTakenUp, taken_up);
    combine.constants = static_cast<std::uint32_t>(std::exchange(constants, constants + kMostOfCombine));
  }
}

}  // namespace octomarch
