// The program before it has registers: operations over values, each made once. The lowering emits into it; every
// emission is folded and shared here (see simplify.cpp); the allocator (allocate.hpp) turns it into a tape.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "octomarch/program/instruction.hpp"

namespace octomarch {

using ValueId = std::uint32_t;

/// Values 0, 1, 2 are the coordinates x, y, z.
inline constexpr ValueId kInputs = 3;

struct Operation {
  Opcode op;
  std::array<ValueId, kMaxInputs> in;
  std::uint32_t constants;  ///< index of the first in DataFlow::constants()
  ValueId first_output;
};

class DataFlow {
 public:
  /// The first output of `op` on these inputs: of an operation that exists already where there is an equal one, of a
  /// simpler one where an identity that keeps every bit allows it. O(1) expected.
  ValueId emit(Opcode op, std::span<const ValueId> inputs, std::span<const double> constants = {});

  const std::vector<Operation>& operations() const { return operations_; }
  const std::vector<double>& constants() const { return constants_; }
  std::size_t value_count() const { return owner_.size(); }
  /// Index of the operation that makes a value; contract: not an input.
  std::uint32_t owner(ValueId value) const { return owner_[value]; }
  std::span<const ValueId> inputs(const Operation& operation) const {
    return {operation.in.data(), info(operation.op).inputs};
  }

 private:
  bool simplify(Opcode& op, std::array<ValueId, kMaxInputs>& in, ValueId& result) const;
  bool is_complement(ValueId value) const;
  ValueId share(Opcode op, const std::array<ValueId, kMaxInputs>& in, std::span<const double> constants);

  std::vector<Operation> operations_;
  std::vector<double> constants_;
  std::vector<std::uint32_t> owner_ = std::vector<std::uint32_t>(kInputs, UINT32_MAX);
  std::unordered_multimap<std::uint64_t, std::uint32_t> by_content_;
};

}  // namespace octomarch
