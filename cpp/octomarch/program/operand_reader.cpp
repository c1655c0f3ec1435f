#include "octomarch/program/operand_reader.hpp"

#include <algorithm>

#include "octomarch/program/choices.hpp"

namespace octomarch {

namespace {

constexpr std::uint16_t kFirstRegister = 3;  ///< behind those of coordinates
/// Operands that choose by themselves are not longer than this.
constexpr std::size_t kLongestThatChooses = 8;

constexpr bool chooses_distance(Opcode op) { return chooses_operand(op) && !chooses_attribute(op); }
/// Can it take operands up? Where it subtracts, a part may need the complement of an operand.
constexpr bool combines(Opcode op) { return chooses_distance(op) && !subtracts(op); }

/// Of the two that a link chooses between, is what the second made what has been taken up? So it is where that is much longer than an
/// operand more would be. What a union has united can be added to the other one by one, if the link unites too.
bool is_second_taken_up(const Tape& tape, const Sources& sources, std::uint32_t at) {
  const std::uint32_t first = sources.of(at, 0);
  const std::uint32_t second = sources.of(at, 1);
  if (subtracts(tape.code[at].op) || second == kNoInstruction) return false;
  if (first == kNoInstruction) return true;
  if (unites(tape, at) && unites(tape, second)) return false;
  const bool adds_first = unites(tape, at) && unites(tape, first);
  return sources.weight(second) > (adds_first ? 0.0 : sources.weight(first)) + Chain::kLongest;
}

}  // namespace

Sources::Sources(const Tape& tape)
    : of_(tape.code.size()), weights_(tape.code.size(), 1.0), reads_(tape.code.size(), 0) {
  std::vector<std::uint32_t> maker(tape.registers, kNoInstruction);
  for (std::uint32_t i = 0; i < tape.code.size(); ++i) {
    const Instruction& instruction = tape.code[i];
    const OpcodeInfo& shape = info(instruction.op);
    for (std::size_t k = 0; k < shape.inputs; ++k) {
      const std::uint32_t source = of_[i][k] = maker[instruction.in[k]];
      if (source == kNoInstruction) continue;
      weights_[i] += weights_[source];
      ++reads_[source];
    }
    for (std::size_t k = 0; k < shape.outputs; ++k) maker[instruction.out[k]] = i;
  }
  result_ = maker[tape.result()];
}

std::vector<ChainLink> links_of(const Tape& tape, const Sources& sources) {
  std::vector<ChainLink> links;
  for (std::uint32_t at = sources.result(); at != kNoInstruction && chooses_distance(tape.code[at].op);) {
    const std::uint32_t first = sources.of(at, 0);
    const std::uint32_t second = sources.of(at, 1);
    const bool is_operand_first = is_second_taken_up(tape, sources, at);
    links.push_back({at, is_operand_first ? second : first, is_operand_first ? first : second, is_operand_first});
    at = links.back().taken_up;
  }
  std::ranges::reverse(links);
  return links;
}

bool chooses(const Chain::Kind& kind) {
  return std::ranges::any_of(kind.body(), [](const Instruction& i) { return chooses_distance(i.op); });
}

std::optional<Chain::Kind> OperandReader::read(std::uint32_t last, const ChainLink& link) const {
  const std::uint32_t length = combines(tape_.code[link.at].op) ? length_of(last) : 0;
  if (length == 0) return std::nullopt;
  Chain::Kind kind;
  kind.length = length;
  read_body(last + 1 - length, kind);
  read_combine(link, kind);
  if (length > kLongestThatChooses && chooses(kind)) return std::nullopt;
  return kind;
}

/// How many instructions make a value, if they follow each other, few as they are, read nothing but coordinates and each
/// other, are read by nobody else, and can be run by lanes; else 0.
std::uint32_t OperandReader::length_of(std::uint32_t last) const {
  if (last == kNoInstruction || info(tape_.code[last].op).outputs != 1) return 0;
  std::array<std::uint32_t, Chain::kLongest> reads{1};  // of what is made so many instructions before the last
  std::uint32_t length = 0;
  for (std::uint32_t unread = 1; unread > 0; ++length) {
    if (length == Chain::kLongest || length > last) return 0;
    const std::uint32_t at = last - length;
    if (reads[length] == 0 || reads[length] != sources_.reads(at) || !runs_by_lanes(tape_.code[at].op)) return 0;
    --unread;
    for (std::size_t k = 0; k < info(tape_.code[at].op).inputs; ++k) {
      const std::uint32_t source = sources_.of(at, k);
      if (source == kNoInstruction) continue;
      if (last - source >= Chain::kLongest) return 0;
      if (reads[last - source]++ == 0) ++unread;
    }
  }
  return length;
}

void OperandReader::read_body(std::uint32_t head, Chain::Kind& kind) const {
  std::uint16_t next = kFirstRegister;
  for (std::uint32_t i = 0; i < kind.length; ++i) {
    const Instruction& taken = tape_.code[head + i];
    const OpcodeInfo& shape = info(taken.op);
    Instruction& own = kind.instructions[i];
    own.op = taken.op;
    own.constants = static_cast<std::uint32_t>(kind.constants);
    for (std::size_t k = 0; k < shape.inputs; ++k) {
      const std::uint32_t source = sources_.of(head + i, k);
      own.in[k] =
          source == kNoInstruction ? taken.in[k] : renamed(source, taken.in[k], kind.instructions[source - head]);
    }
    for (std::size_t k = 0; k < shape.outputs; ++k) own.out[k] = next++;
    kind.constants += shape.constants;
  }
}

/// Of what an instruction has left in a register of the tape.
std::uint16_t OperandReader::renamed(std::uint32_t source, std::uint16_t taken, const Instruction& own) const {
  std::size_t k = 0;
  while (tape_.code[source].out[k] != taken) ++k;
  return own.out[k];
}

void OperandReader::read_combine(const ChainLink& link, Chain::Kind& kind) const {
  const Instruction& taken = tape_.code[link.at];
  Instruction& combine = kind.instructions[kind.length];
  combine.op = taken.op;
  combine.out[0] = kTakenUp;
  combine.in[0] = link.is_operand_first ? kind.operand() : kTakenUp;
  combine.in[1] = link.is_operand_first ? kTakenUp : kind.operand();
  std::copy_n(tape_.constants.begin() + taken.constants, info(taken.op).constants, kind.of_combine.begin());
}

}  // namespace octomarch
