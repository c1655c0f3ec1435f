// The program before it has registers: operations over values, each made once. The lowering emits into it; every
// emission is folded and shared here (see simplify.cpp); the allocator (allocate.hpp) turns it into a tape.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "octomarch/base/hash_table.hpp"
#include "octomarch/graph/node.hpp"
#include "octomarch/program/instruction.hpp"

namespace octomarch {

using ValueId = std::uint32_t;

/// Values 0, 1, 2 are the coordinates x, y, z.
inline constexpr ValueId kPointInputs = 3;
/// Where surfaces are looked at, values 3, 4, 5 are their normal.
inline constexpr ValueId kSurfaceInputs = 6;

struct Operation {
  Opcode op;
  std::array<ValueId, kMaxInputs> in;
  std::uint32_t constants;  ///< index of the first in DataFlow::constants()
  ValueId first_output;
};

class DataFlow {
 public:
  explicit DataFlow(ValueId inputs = kPointInputs) : inputs_(inputs), owner_(inputs, UINT32_MAX) {}

  ValueId input_count() const { return inputs_; }
  /// The first output of `op` on these inputs: of an operation that exists already where there is an equal one, of a
  /// simpler one where an identity that keeps every bit allows it. O(1) expected.
  ValueId emit(Opcode op, std::span<const ValueId> inputs, std::span<const double> constants = {});

  /// The same number everywhere.
  ValueId constant(double value) { return emit(Opcode::kConstant, {}, {{value}}); }
  /// The number of a value that is constant.
  std::optional<double> constant_of(ValueId value) const;
  /// Notes that coordinates are moved back by as much, to an operator's own origin.
  void note_move(const Vec3& offset);
  /// The largest component of all those moves.
  double farthest_move() const { return farthest_move_; }
  /// The number by which instructions name an image or a grid.
  double image_number(const NodePtr& image);

  const std::vector<NodePtr>& images() const { return images_; }
  const std::vector<Operation>& operations() const { return operations_; }
  const std::vector<double>& constants() const { return constants_; }
  std::size_t value_count() const { return owner_.size(); }
  /// Index of the operation that makes a value; contract: not an input.
  std::uint32_t owner(ValueId value) const { return owner_[value]; }
  std::span<const ValueId> inputs(const Operation& operation) const {
    return {operation.in.data(), info(operation.op).inputs};
  }

 private:
  /// An operation as it is asked for, and as it is simplified.
  struct Request {
    Opcode op;
    std::array<ValueId, kMaxInputs> in;
    std::optional<double> embedded;  ///< constant that takes the place of an operand
    std::optional<ValueId> result;   ///< where no operation is needed
  };
  void simplify(Request& request);
  void embed_constants(Request& request);
  bool is_complement(ValueId value) const;
  ValueId share(Opcode op, const std::array<ValueId, kMaxInputs>& in, std::span<const double> constants);

  ValueId inputs_;
  std::vector<Operation> operations_;
  std::vector<double> constants_;
  std::vector<NodePtr> images_;
  std::vector<std::uint32_t> owner_;
  double farthest_move_ = 0.0;
  HashTable<std::uint32_t> by_content_;  ///< indices of operations, plus 1
};

}  // namespace octomarch
