#include "octomarch/program/packed_part.hpp"

#include <algorithm>

#include "octomarch/base/hash.hpp"

namespace octomarch {

namespace {

/// Stands for no instruction, where a gap is larger than the largest.
constexpr std::uint8_t kSkip = 255;
constexpr std::uint32_t kLargestGap = 65535;

PackedInstruction pack_one(std::uint8_t pattern, std::uint32_t gap) {
  return {pattern, {static_cast<std::uint8_t>(gap & 0xFFU), static_cast<std::uint8_t>(gap >> 8U)}};
}

std::size_t guess_at(const Instruction& pattern) {
  std::uint64_t hash = static_cast<std::uint64_t>(pattern.op);
  for (const std::uint16_t out : pattern.out) mix(hash, out);
  for (const std::uint16_t in : pattern.in) mix(hash, in);
  return hash & 0xFFU;
}

}  // namespace

std::optional<TapePart> Packer::pack(const TapePart& part, Arena& arena) {
  patterns_.clear();
  packed_.clear();
  guesses_.fill(0);
  std::uint32_t before = 0;
  for (std::size_t i = 0; i < part.length; ++i) {
    const std::optional<std::uint8_t> pattern = pattern_of(part.code[i]);
    if (!pattern) return std::nullopt;
    for (; part.origins[i] - before > kLargestGap; before += kLargestGap) {
      packed_.push_back(pack_one(kSkip, kLargestGap));
    }
    packed_.push_back(pack_one(*pattern, part.origins[i] - before));
    before = part.origins[i];
  }
  if (patterns_.size() > part.length / 2) return std::nullopt;
  TapePart packed = part;
  packed.code = arena.copy(std::span<const Instruction>(patterns_));
  packed.packed = arena.copy(std::span<const PackedInstruction>(packed_));
  packed.origins = nullptr;
  packed.results = arena.copy(std::span(part.results, part.result_count));
  return packed;
}

std::optional<std::uint8_t> Packer::pattern_of(const Instruction& instruction) {
  Instruction pattern = instruction;
  pattern.constants = 0;
  std::uint8_t& guess = guesses_[guess_at(pattern)];
  if (guess < patterns_.size() && patterns_[guess] == pattern) return guess;
  const auto known = std::find(patterns_.begin(), patterns_.end(), pattern);
  const auto index = static_cast<std::size_t>(known - patterns_.begin());
  if (index == kSkip) return std::nullopt;
  if (known == patterns_.end()) patterns_.push_back(pattern);
  guess = static_cast<std::uint8_t>(index);
  return guess;
}

std::vector<std::uint32_t> constant_offsets(const Tape& tape) {
  std::vector<std::uint32_t> constants(tape.code.size());
  std::ranges::transform(tape.code, constants.begin(), &Instruction::constants);
  return constants;
}

void Unpacker::reserve(std::size_t length) {
  if (code_.size() >= length) return;
  code_.resize(length);
  origins_.resize(length);
}

TapePart Unpacker::ready(const TapePart& part) {
  if (part.packed == nullptr && !part.is_list()) return part;
  reserve(part.length);
  TapePart unpacked = part;
  unpacked.code = code_.data();
  unpacked.packed = nullptr;
  unpacked.origins = origins_.data();
  if (part.is_list()) {
    chain_->write_code(part, code_.data(), origins_.data());
    return unpacked;
  }
  std::uint32_t origin = 0;
  const PackedInstruction* next = part.packed;
  for (std::size_t i = 0; i < part.length; ++next) {
    origin += next->gap[0] + std::uint32_t{next->gap[1]} * 256;
    if (next->pattern == kSkip) continue;
    code_[i] = part.code[next->pattern];
    code_[i].constants = constants_[origin];
    origins_[i++] = origin;
  }
  return unpacked;
}

}  // namespace octomarch
