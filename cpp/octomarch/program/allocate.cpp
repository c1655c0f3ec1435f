// Ordering after Sethi and Ullman ("The generation of optimal code for arithmetic expressions", J. ACM 17(4), 1970):
// of two operands the one that needs more registers is computed first. Exact for trees; for shared values a heuristic.
#include "octomarch/program/allocate.hpp"

#include <algorithm>
#include <functional>
#include <numeric>
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
      if (value >= flow.input_count()) operands[count++] = needs[flow.owner(value)];
    }
    std::sort(operands.begin(), operands.begin() + static_cast<std::ptrdiff_t>(count), std::greater<>());
    std::uint32_t need = info(operation.op).outputs;
    for (std::uint32_t held = 0; held < count; ++held) need = std::max(need, operands[held] + held);
    needs[i] = need;
  }
  return needs;
}

/// Operations that `results` depend on, operands first, the needier operand before the other.
std::vector<std::uint32_t> schedule(const DataFlow& flow, std::span<const ValueId> results) {
  std::vector<std::uint32_t> order;
  const std::vector<std::uint32_t> needs = register_needs(flow);
  std::vector<char> seen(needs.size(), 0);
  std::vector<std::pair<std::uint32_t, bool>> stack;
  for (const ValueId result : results) {
    if (result >= flow.input_count()) stack.emplace_back(flow.owner(result), false);
  }
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
    // the stack returns the last first: ascending needs put the neediest on top, and of equals the first operand
    const std::size_t first = stack.size();
    for (const ValueId value : flow.inputs(flow.operations()[index])) {
      if (value < flow.input_count()) continue;
      std::size_t place = first;
      while (place < stack.size() && needs[stack[place].first] < needs[flow.owner(value)]) ++place;
      stack.emplace(stack.begin() + static_cast<std::ptrdiff_t>(place), flow.owner(value), false);
    }
  }
  return order;
}

/// Hands out the lowest free register, so that the working set stays small and the same program is always the same.
class RegisterFile {
 public:
  explicit RegisterFile(std::uint32_t inputs) : count_(inputs) {}

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
  std::uint32_t count_;
  std::priority_queue<std::uint16_t, std::vector<std::uint16_t>, std::greater<>> free_;
};

/// For every value, the place in `order` where it is read last; one past the end for results.
std::vector<std::uint32_t> last_uses(const DataFlow& flow, const std::vector<std::uint32_t>& order,
                                     std::span<const ValueId> results) {
  std::vector<std::uint32_t> last(flow.value_count(), 0);
  for (std::uint32_t place = 0; place < order.size(); ++place) {
    for (const ValueId value : flow.inputs(flow.operations()[order[place]])) last[value] = place;
  }
  for (const ValueId result : results) last[result] = static_cast<std::uint32_t>(order.size());
  return last;
}

/// The normal takes registers only where it is looked at.
std::uint32_t inputs_that_are_read(const DataFlow& flow, const std::vector<std::uint32_t>& order,
                                   std::span<const ValueId> results) {
  const auto is_normal = [&](ValueId value) { return value >= kPointInputs && value < flow.input_count(); };
  const bool in_code = std::any_of(order.begin(), order.end(), [&](std::uint32_t index) {
    const std::span<const ValueId> inputs = flow.inputs(flow.operations()[index]);
    return std::any_of(inputs.begin(), inputs.end(), is_normal);
  });
  return in_code || std::any_of(results.begin(), results.end(), is_normal) ? kSurfaceInputs : kPointInputs;
}

}  // namespace

Tape allocate(const DataFlow& flow, std::span<const ValueId> results) {
  const std::vector<std::uint32_t> order = schedule(flow, results);
  const std::vector<std::uint32_t> last = last_uses(flow, order, results);
  const std::uint32_t inputs_read = inputs_that_are_read(flow, order, results);
  std::vector<std::uint16_t> register_of(flow.value_count(), 0);
  std::iota(register_of.begin(), register_of.begin() + flow.input_count(), std::uint16_t{0});

  RegisterFile registers(inputs_read);
  Tape tape;
  tape.inputs = inputs_read;
  tape.images = flow.images();
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
      const bool is_result = std::find(results.begin(), results.end(), output) != results.end();
      if (last[output] == 0 && !is_result) registers.release(register_of[output]);
    }

    const double* constants = flow.constants().data() + operation.constants;
    tape.constants.insert(tape.constants.end(), constants, constants + shape.constants);
    tape.code.push_back(instruction);
  }
  tape.constants_f32.assign(tape.constants.begin(), tape.constants.end());
  tape.registers = registers.count();
  for (const ValueId result : results) tape.results.push_back(register_of[result]);
  return tape;
}

}  // namespace octomarch
