// Ordering after Sethi and Ullman ("The generation of optimal code for arithmetic expressions", J. ACM 17(4), 1970):
// of two operands the one that needs more registers is computed first. Exact for trees; for shared values a heuristic.
#include "octomarch/program/allocate.hpp"

#include <algorithm>
#include <functional>
#include <queue>
#include <utility>

#include "octomarch/base/error.hpp"

namespace octomarch {

namespace {

constexpr std::uint32_t kMaxRegisters = 65535;

/// Registers that each operation needs when computed alone (its Sethi–Ullman number). Operations stand in an order in
/// which operands come first, so one pass does.
std::vector<std::uint32_t> register_needs(const DataFlow& flow) {
  std::vector<std::uint32_t> needs(flow.operations().size(), 1);
  for (std::size_t i = 0; i < needs.size(); ++i) {
    const Operation& operation = flow.operations()[i];
    std::array<std::uint32_t, kMaxInputs> operands{};
    std::size_t count = 0;
    for (const ValueId value : flow.inputs(operation)) {
      if (value >= kInputs) operands[count++] = needs[flow.owner(value)];
    }
    std::sort(operands.begin(), operands.begin() + static_cast<std::ptrdiff_t>(count), std::greater<>());
    std::uint32_t need = info(operation.op).outputs;
    for (std::uint32_t held = 0; held < count; ++held) need = std::max(need, operands[held] + held);
    needs[i] = need;
  }
  return needs;
}

/// Operations that `result` depends on, operands first, the needier operand before the other.
std::vector<std::uint32_t> schedule(const DataFlow& flow, ValueId result) {
  std::vector<std::uint32_t> order;
  if (result < kInputs) return order;
  const std::vector<std::uint32_t> needs = register_needs(flow);
  std::vector<char> seen(needs.size(), 0);
  std::vector<std::pair<std::uint32_t, bool>> stack{{flow.owner(result), false}};
  while (!stack.empty()) {
    const auto [index, operands_done] = stack.back();
    stack.pop_back();
    if (operands_done) {
      order.push_back(index);
      continue;
    }
    if (seen[index] != 0) continue;
    seen[index] = 1;
    stack.emplace_back(index, true);
    std::vector<std::uint32_t> operands;
    for (const ValueId value : flow.inputs(flow.operations()[index])) {
      if (value >= kInputs) operands.push_back(flow.owner(value));
    }
    // the stack returns the last first: ascending needs put the neediest on top, and of equals the first operand
    std::reverse(operands.begin(), operands.end());
    std::stable_sort(operands.begin(), operands.end(), [&](auto a, auto b) { return needs[a] < needs[b]; });
    for (const std::uint32_t operand : operands) stack.emplace_back(operand, false);
  }
  return order;
}

/// Hands out the lowest free register, so that the working set stays small and the same program is always the same.
class RegisterFile {
 public:
  std::uint16_t take() {
    if (!free_.empty()) {
      const std::uint16_t lowest = free_.top();
      free_.pop();
      return lowest;
    }
    if (count_ == kMaxRegisters)
      throw SceneError("shape needs more than 65535 registers: too many values live at once");
    return static_cast<std::uint16_t>(count_++);
  }
  void release(std::uint16_t index) { free_.push(index); }
  std::uint32_t count() const { return count_; }

 private:
  std::uint32_t count_ = kInputs;
  std::priority_queue<std::uint16_t, std::vector<std::uint16_t>, std::greater<>> free_;
};

/// For every value, the place in `order` where it is read last; one past the end for the result.
std::vector<std::uint32_t> last_uses(const DataFlow& flow, const std::vector<std::uint32_t>& order, ValueId result) {
  std::vector<std::uint32_t> last(flow.value_count(), 0);
  for (std::uint32_t place = 0; place < order.size(); ++place) {
    for (const ValueId value : flow.inputs(flow.operations()[order[place]])) last[value] = place;
  }
  last[result] = static_cast<std::uint32_t>(order.size());
  return last;
}

}  // namespace

Tape allocate(const DataFlow& flow, ValueId result) {
  const std::vector<std::uint32_t> order = schedule(flow, result);
  const std::vector<std::uint32_t> last = last_uses(flow, order, result);
  std::vector<std::uint16_t> register_of(flow.value_count(), 0);
  for (std::uint16_t i = 0; i < kInputs; ++i) register_of[i] = i;

  RegisterFile registers;
  Tape tape;
  tape.code.reserve(order.size());
  for (std::uint32_t place = 0; place < order.size(); ++place) {
    const Operation& operation = flow.operations()[order[place]];
    const OpcodeInfo& shape = info(operation.op);
    Instruction instruction{operation.op, {}, {}, static_cast<std::uint32_t>(tape.constants.size())};

    // Read operands, and free those that nobody reads again: an output may take their place.
    const std::span<const ValueId> inputs = flow.inputs(operation);
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      instruction.in[i] = register_of[inputs[i]];
      const bool listed_before = std::find(inputs.begin(), inputs.begin() + static_cast<std::ptrdiff_t>(i),
                                           inputs[i]) != inputs.begin() + static_cast<std::ptrdiff_t>(i);
      if (last[inputs[i]] == place && !listed_before) registers.release(register_of[inputs[i]]);
    }

    // Place outputs; one that nobody reads is written to a register that is free again at once.
    for (std::uint8_t i = 0; i < shape.outputs; ++i) {
      instruction.out[i] = register_of[operation.first_output + i] = registers.take();
    }
    for (std::uint8_t i = 0; i < shape.outputs; ++i) {
      const ValueId output = operation.first_output + i;
      if (last[output] == 0 && output != result) registers.release(register_of[output]);
    }

    const double* constants = flow.constants().data() + operation.constants;
    tape.constants.insert(tape.constants.end(), constants, constants + shape.constants);
    tape.code.push_back(instruction);
  }
  tape.constants_f32.assign(tape.constants.begin(), tape.constants.end());
  tape.registers = registers.count();
  tape.result = register_of[result];
  return tape;
}

}  // namespace octomarch
