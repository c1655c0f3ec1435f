#include "octomarch/program/packed_part.hpp"

#include <algorithm>

#include "octomarch/base/hash.hpp"

namespace octomarch {

namespace {

std::size_t guess_at(const Instruction& pattern) {
  std::uint64_t hash = static_cast<std::uint64_t>(pattern.op);
  for (const std::uint16_t out : pattern.out) mix(hash, out);
  for (const std::uint16_t in : pattern.in) mix(hash, in);
  return hash & 0xFFU;
}

}  // namespace

std::optional<TapePart> Packer::pack(const TapePart& part, Arena& arena) {
  patterns_.clear();
  of_.clear();
  guesses_.fill(0);
  for (const Instruction& instruction : part.instructions()) {
    const std::optional<std::uint8_t> pattern = pattern_of(instruction);
    if (!pattern) return std::nullopt;
    of_.push_back(*pattern);
  }
  TapePart packed = part;
  packed.code = arena.copy(std::span<const Instruction>(patterns_));
  packed.patterns = arena.copy(std::span<const std::uint8_t>(of_));
  packed.origins = arena.copy(std::span(part.origins, part.length));
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
  if (index == guesses_.size()) return std::nullopt;
  if (known == patterns_.end()) patterns_.push_back(pattern);
  guess = static_cast<std::uint8_t>(index);
  return guess;
}

TapePart Unpacker::ready(const TapePart& part) {
  if (part.patterns == nullptr) return part;
  code_.resize(part.length);
  for (std::size_t i = 0; i < part.length; ++i) {
    code_[i] = part.code[part.patterns[i]];
    code_[i].constants = tape_.code[part.origins[i]].constants;
  }
  TapePart unpacked = part;
  unpacked.code = code_.data();
  unpacked.patterns = nullptr;
  return unpacked;
}

}  // namespace octomarch
