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
/// Stands for no instruction, but for coordinates.
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
/// In kinds, the register of what has been taken up, until it is known which ones they have.
constexpr std::uint16_t kTakenUp = std::numeric_limits<std::uint16_t>::max();

/// Can it take operands up? Where it subtracts, a part may need the complement of an operand.
constexpr bool combines(Opcode op) { return chooses_operand(op) && !chooses_attribute(op) && !subtracts(op); }

/// Which instructions made what each instruction of a tape reads.
class Sources {
 public:
  explicit Sources(const Tape& tape) : of_(tape.code.size()), weights_(tape.code.size(), 1.0) {
    std::vector<std::uint32_t> maker(tape.registers, kNone);
    for (std::uint32_t i = 0; i < tape.code.size(); ++i) {
      const Instruction& instruction = tape.code[i];
      const OpcodeInfo& shape = info(instruction.op);
      for (std::size_t k = 0; k < shape.inputs; ++k) {
        of_[i][k] = maker[instruction.in[k]];
        weights_[i] += weight(of_[i][k]);
      }
      for (std::size_t k = 0; k < shape.outputs; ++k) maker[instruction.out[k]] = i;
    }
    result_ = maker[tape.result()];
  }

  std::uint32_t of(std::uint32_t instruction, std::size_t input) const { return of_[instruction][input]; }
  /// Instructions that a value takes, if no two share any.
  double weight(std::uint32_t instruction) const { return instruction == kNone ? 0.0 : weights_[instruction]; }
  std::uint32_t result() const { return result_; }

 private:
  std::vector<std::array<std::uint32_t, kMaxInputs>> of_;
  std::vector<double> weights_;
  std::uint32_t result_;
};

/// What chooses between what has been taken up so far and one operand more.
struct Link {
  std::uint32_t at;
  std::uint32_t taken_up;  ///< what made it; likewise the next
  std::uint32_t operand;
  bool is_operand_first;
};

/// Which of the two that a link chooses between is what has been taken up? That which was made before, as it is where both are
/// short, unless the other is much longer.
bool is_added_to(const Sources& sources, std::uint32_t a, std::uint32_t b) {
  constexpr double kMuchLonger = 2.0;
  if (a == kNone || b == kNone) return b == kNone;
  const bool is_before = a < b;
  const double before = sources.weight(is_before ? a : b);
  const double after = sources.weight(is_before ? b : a);
  return is_before == (after <= kMuchLonger * before);
}

/// The links from the operand to which most of a tape is added to the result.
std::vector<Link> links_of(const Tape& tape, const Sources& sources) {
  std::vector<Link> links;
  for (std::uint32_t at = sources.result(); at != kNone && chooses_operand(tape.code[at].op);) {
    const std::uint32_t first = sources.of(at, 0);
    const std::uint32_t second = sources.of(at, 1);
    const bool is_operand_first = !subtracts(tape.code[at].op) && is_added_to(sources, second, first);
    links.push_back({at, is_operand_first ? second : first, is_operand_first ? first : second, is_operand_first});
    at = links.back().taken_up;
  }
  std::ranges::reverse(links);
  return links;
}

/// Reads single operands off a tape.
class KindReader {
 public:
  KindReader(const Tape& tape, const Sources& sources) : tape_(tape), sources_(sources) {}

  /// Of the operand that ends with an instruction and is taken up by a link, if lanes can run it. Registers are those of the
  /// operand alone, whatever they are in the tape.
  std::optional<Kind> read(std::uint32_t last, const Link& link) const {
    const std::uint32_t length = combines(tape_.code[link.at].op) ? length_of(last) : 0;
    const bool reads_taken_up = last != link.taken_up && last - link.taken_up < length;
    if (length == 0 || reads_taken_up) return std::nullopt;
    Kind kind;
    kind.length = length;
    read_body(last + 1 - length, kind);
    read_combine(link, kind);
    return kind;
  }

 private:
  /// How many instructions make a value, if they follow each other, few as they are, read nothing but coordinates and each
  /// other, and can be run by lanes; else 0.
  std::uint32_t length_of(std::uint32_t last) const {
    if (last == kNone || info(tape_.code[last].op).outputs != 1) return 0;
    std::uint32_t read = 1;  // bit = instructions before the last
    std::uint32_t length = 0;
    for (; read >> length != 0; ++length) {
      const std::uint32_t at = last - length;
      const bool is_read = (read >> length & 1U) != 0;
      if (!is_read || !runs_by_lanes(tape_.code[at].op)) return 0;
      for (std::size_t k = 0; k < info(tape_.code[at].op).inputs; ++k) {
        const std::uint32_t source = sources_.of(at, k);
        if (source == kNone) continue;
        if (last - source >= Chain::kLongest) return 0;
        read |= 1U << (last - source);
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

  /// The first that makes operands so too, whatever takes them up; null where there is none.
  const Kind* like(const Kind& kind) const {
    const auto is_like = [&](const Candidate& other) { return std::ranges::equal(other.kind.body(), kind.body()); };
    const auto found = std::ranges::find_if(all_, is_like);
    return found == all_.end() ? nullptr : &found->kind;
  }

  /// Those of which there are many. Of each candidate, which of them it is, or kMostKinds.
  std::vector<Kind> frequent(std::vector<std::uint8_t>& kind_of) const {
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
  std::size_t candidate;
  bool is_first;  ///< taken up by no link, as others are added to it
};

/// Operands by where they begin.
std::vector<Found> read_operands(const Tape& tape, Candidates& candidates) {
  const Sources sources(tape);
  const std::vector<Link> links = links_of(tape, sources);
  const KindReader reader(tape, sources);
  std::vector<Found> found;
  const auto made = [&](std::uint32_t last, const Kind& kind, bool is_first) {
    return Found{last + 1 - static_cast<std::uint32_t>(kind.length), candidates.add(kind), is_first};
  };
  for (const Link& link : links) {
    if (link.operand == kNone || link.operand + 1 != link.at) continue;  // what is made elsewhere too
    if (const std::optional<Kind> kind = reader.read(link.operand, link))
      found.push_back(made(link.operand, *kind, false));
  }
  // Of the first it does not matter what would take it up. Where operands are made by links of their own it may be so too.
  for (std::size_t i = std::min(links.size(), Chain::kLongest); i-- > 0;) {
    const std::optional<Kind> kind = reader.read(links[i].taken_up, links[i]);
    const Kind* const like = kind ? candidates.like(*kind) : nullptr;
    if (!kind || (i > 0 && like == nullptr)) continue;
    std::erase_if(found, [&](const Found& operand) { return operand.head <= links[i].taken_up; });
    found.insert(found.begin(), made(links[i].taken_up, like == nullptr ? *kind : Kind(*like), true));
    break;
  }
  return found;
}

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

std::optional<Chain> Chain::of(const Tape& tape) {
  if (tape.inputs != kCoordinates || tape.results.size() != 1) return std::nullopt;
  Chain chain;
  Candidates candidates;
  std::vector<std::uint8_t> kind_of;
  const std::vector<Found> found = read_operands(tape, candidates);
  chain.kinds_ = candidates.frequent(kind_of);
  std::size_t length = 0;
  for (const auto& [head, candidate, is_first] : found) {
    if (kind_of[candidate] == kMostKinds) continue;
    chain.has_first_ = chain.has_first_ || is_first;
    chain.heads_.push_back(head);
    chain.kind_of_.push_back(kind_of[candidate]);
    length += chain.kinds_[kind_of[candidate]].length + 1;
  }
  if (2 * length <= tape.code.size()) return std::nullopt;
  chain.is_whole_ = length == tape.code.size() + 1;  // the first is not taken up
  chain.columns_ = std::ranges::max(chain.kinds_, {}, &Kind::constants).constants + (chain.kinds_.size() > 1 ? 1 : 0);
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
