// Folding and sharing of operations as they are emitted. Only identities that keep every bit are used, so that a
// simplified program gives the same distances as the graph read literally.
#include <algorithm>
#include <bit>
#include <cmath>
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
  return value >= inputs_ && operations_[owner_[value]].op == Opcode::kComplement;
}

void DataFlow::note_move(const Vec3& offset) {
  for (const double part : {offset.x, offset.y, offset.z}) farthest_move_ = std::max(farthest_move_, std::fabs(part));
}

std::optional<double> DataFlow::constant_of(ValueId value) const {
  if (value < inputs_ || operations_[owner_[value]].op != Opcode::kConstant) return std::nullopt;
  return constants_[operations_[owner_[value]].constants];
}

double DataFlow::image_number(const NodePtr& image) {
  const auto number = std::find(images_.begin(), images_.end(), image) - images_.begin();
  if (number == std::ssize(images_)) images_.push_back(image);
  return static_cast<double>(number);
}

/// Arithmetic with a constant has operations of its own; arithmetic of constants alone is done here where its result is
/// the one correctly rounded number.
void DataFlow::embed_constants(Request& request) {
  const std::optional<double> first = constant_of(request.in[0]);
  const std::optional<double> second = constant_of(request.in[1]);
  const auto with_second = [&](Opcode op) {
    if (!second) return;
    request.op = op;
    request.embedded = second;
  };
  const auto with_first = [&](Opcode op) {
    if (!first) return;
    request.op = op;
    request.embedded = first;
    request.in[0] = request.in[1];
  };
  switch (request.op) {
    case Opcode::kAdd:
      if (first && second) request.result = constant(*first + *second);
      else if (second) with_second(Opcode::kAddConstant);
      else with_first(Opcode::kAddConstant);
      break;
    case Opcode::kSubtract:
      if (first && second) request.result = constant(*first - *second);
      else if (first) with_first(Opcode::kSubtractFrom);
      else if (second) {
        request.op = Opcode::kAddConstant;
        request.embedded = -*second;
      }
      break;
    case Opcode::kMultiply:
      if (first && second) request.result = constant(*first * *second);
      else if (second) with_second(Opcode::kMultiplyConstant);
      else with_first(Opcode::kMultiplyConstant);
      if (request.embedded == 1.0) request.result = request.in[0];
      break;
    case Opcode::kDivide:
      if (first && second) request.result = constant(*first / *second);
      else if (second) with_second(Opcode::kDivideConstant);
      else with_first(Opcode::kDivideInto);
      break;
    // a < b ? a : b with the constant in front differs where the other is NaN
    case Opcode::kUnion: with_second(Opcode::kMinimumConstant); break;
    case Opcode::kIntersection: with_second(Opcode::kMaximumConstant); break;
    case Opcode::kComplement:
      if (first) request.result = constant(-*first);
      break;
    default: break;
  }
  request.in[1] = request.embedded ? 0 : request.in[1];
}

void DataFlow::simplify(Request& request) {
  Opcode& op = request.op;
  std::array<ValueId, kMaxInputs>& in = request.in;
  switch (op) {
    case Opcode::kUnion:
    case Opcode::kIntersection:
      if (in[0] == in[1]) {
        request.result = in[0];
        return;
      }
      // max(a, −b) has an operation of its own; a complement as second operand is such a −b
      if (op == Opcode::kIntersection && is_complement(in[1])) {
        op = Opcode::kDifference;
        in[1] = operations_[owner_[in[1]]].in[0];
      }
      break;
    case Opcode::kDifference:
      if (is_complement(in[1])) {
        op = Opcode::kIntersection;
        in[1] = operations_[owner_[in[1]]].in[0];
      }
      break;
    case Opcode::kComplement:
      if (is_complement(in[0])) request.result = operations_[owner_[in[0]]].in[0];
      break;
    case Opcode::kSelectUnion:
    case Opcode::kSelectIntersection:
    case Opcode::kSelectDifference:
    case Opcode::kMixUnion:
    case Opcode::kMixIntersection:
    case Opcode::kMixDifference:
    case Opcode::kMixMetaballs:
      if (in[2] == in[3]) request.result = in[2];
      break;
    default: break;
  }
  if (!request.result) embed_constants(request);
}

ValueId DataFlow::emit(Opcode op, std::span<const ValueId> inputs, std::span<const double> constants) {
  Request request{op, {}, {}, {}};
  std::copy(inputs.begin(), inputs.end(), request.in.begin());
  if (!inputs.empty()) simplify(request);
  if (request.result) return *request.result;
  if (request.embedded) return share(request.op, request.in, {&*request.embedded, 1});
  return share(request.op, request.in, constants);
}

ValueId DataFlow::share(Opcode op, const std::array<ValueId, kMaxInputs>& in, std::span<const double> constants) {
  std::uint64_t hash = static_cast<std::uint64_t>(op);
  for (const ValueId value : in) mix(hash, value);
  for (const double constant : constants) mix(hash, std::bit_cast<std::uint64_t>(constant));

  const std::uint32_t found = by_content_.find(hash, [&](std::uint32_t number) {
    const Operation& existing = operations_[number - 1];
    return existing.op == op && existing.in == in && same_bits(constants, constants_.data() + existing.constants);
  });
  if (found != 0) return operations_[found - 1].first_output;

  if (operations_.size() == kMaxOperations) {
    throw SceneError(
        "shape needs more than 2097152 instructions: a shared part is compiled anew at each of its places");
  }
  const auto index = static_cast<std::uint32_t>(operations_.size());
  const auto first_output = static_cast<ValueId>(owner_.size());
  operations_.push_back({op, in, static_cast<std::uint32_t>(constants_.size()), first_output});
  constants_.insert(constants_.end(), constants.begin(), constants.end());
  owner_.insert(owner_.end(), info(op).outputs, index);
  by_content_.insert(hash, index + 1);
  return first_output;
}

}  // namespace octomarch
