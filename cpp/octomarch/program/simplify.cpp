// Folding and sharing of operations as they are emitted. Only identities that keep every bit are used, so that a
// simplified program gives the same distances as the graph read literally.
#include <bit>
#include <cstring>

#include "octomarch/base/error.hpp"
#include "octomarch/base/hash.hpp"
#include "octomarch/program/dataflow.hpp"

namespace octomarch {

namespace {

/// A few nodes that each place the one before twice make exponentially many places; this is where that ends.
constexpr std::size_t kMaxOperations = std::size_t{1} << 21U;

bool same_bits(std::span<const double> a, const double* b) {
  return a.empty() || std::memcmp(a.data(), b, a.size_bytes()) == 0;
}

}  // namespace

bool DataFlow::is_complement(ValueId value) const {
  return value >= kInputs && operations_[owner_[value]].op == Opcode::kComplement;
}

bool DataFlow::simplify(Opcode& op, std::array<ValueId, kMaxInputs>& in, ValueId& result) const {
  switch (op) {
    case Opcode::kUnion:
    case Opcode::kIntersection:
      if (in[0] == in[1]) {
        result = in[0];
        return true;
      }
      // max(a, −b) has an operation of its own; a complement as second operand is such a −b
      if (op == Opcode::kIntersection && is_complement(in[1])) {
        op = Opcode::kDifference;
        in[1] = operations_[owner_[in[1]]].in[0];
      }
      return false;
    case Opcode::kDifference:
      if (is_complement(in[1])) {
        op = Opcode::kIntersection;
        in[1] = operations_[owner_[in[1]]].in[0];
      }
      return false;
    case Opcode::kComplement:
      if (is_complement(in[0])) {
        result = operations_[owner_[in[0]]].in[0];
        return true;
      }
      return false;
    case Opcode::kSelectUnion:
    case Opcode::kSelectIntersection:
    case Opcode::kSelectDifference:
      if (in[2] == in[3]) {
        result = in[2];
        return true;
      }
      return false;
    default: return false;
  }
}

ValueId DataFlow::emit(Opcode op, std::span<const ValueId> inputs, std::span<const double> constants) {
  std::array<ValueId, kMaxInputs> in{};
  std::copy(inputs.begin(), inputs.end(), in.begin());
  ValueId result = 0;
  if (simplify(op, in, result)) return result;
  return share(op, in, constants);
}

ValueId DataFlow::share(Opcode op, const std::array<ValueId, kMaxInputs>& in, std::span<const double> constants) {
  std::uint64_t hash = static_cast<std::uint64_t>(op);
  for (const ValueId value : in) mix(hash, value);
  for (const double constant : constants) mix(hash, std::bit_cast<std::uint64_t>(constant));

  const auto [begin, end] = by_content_.equal_range(hash);
  for (auto candidate = begin; candidate != end; ++candidate) {
    const Operation& existing = operations_[candidate->second];
    if (existing.op == op && existing.in == in && same_bits(constants, constants_.data() + existing.constants)) {
      return existing.first_output;
    }
  }

  if (operations_.size() == kMaxOperations) {
    throw SceneError(
        "shape needs more than 2097152 instructions: a shared part is compiled anew at each of its places");
  }
  const auto index = static_cast<std::uint32_t>(operations_.size());
  const auto first_output = static_cast<ValueId>(owner_.size());
  operations_.push_back({op, in, static_cast<std::uint32_t>(constants_.size()), first_output});
  constants_.insert(constants_.end(), constants.begin(), constants.end());
  owner_.insert(owner_.end(), info(op).outputs, index);
  by_content_.emplace(hash, index);
  return first_output;
}

}  // namespace octomarch
