// One instruction of the tape: what the lowering emits, the allocator places in registers, the kernels execute.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace octomarch {

enum class Opcode : std::uint16_t {
#define OCTOMARCH_OPCODE(op, mnemonic, inputs, outputs, constants) k##op,
#include "octomarch/program/opcodes.def"
#undef OCTOMARCH_OPCODE
};

/// What an operator makes of inputs that are different coordinates: nothing of its own, a number whose derivatives are had at
/// less cost than others', or coordinates again, but for constants.
enum class OfCoordinates : std::uint8_t { kAnything, kNumber, kCoordinates };

/// Shape of an opcode: how many registers it reads and writes, how many constants it takes.
struct OpcodeInfo {
  const char* mnemonic;
  std::uint8_t inputs;
  std::uint8_t outputs;
  std::uint8_t constants;
  OfCoordinates of_coordinates;
};

inline constexpr OpcodeInfo kOpcodes[] = {
#define OCTOMARCH_OPCODE(op, mnemonic, inputs, outputs, constants) \
  {mnemonic, inputs, outputs, constants, OfCoordinates::kAnything},
#define OCTOMARCH_AXIS_OPCODE(op, mnemonic, inputs, outputs, constants) \
  {mnemonic, inputs, outputs, constants, OfCoordinates::kNumber},
#define OCTOMARCH_CELL_OPCODE(op, mnemonic, inputs, outputs, constants) \
  {mnemonic, inputs, outputs, constants, OfCoordinates::kCoordinates},
#include "octomarch/program/opcodes.def"
#undef OCTOMARCH_OPCODE
};

inline constexpr std::size_t kOpcodeCount = sizeof(kOpcodes) / sizeof(kOpcodes[0]);
inline constexpr std::size_t kMaxInputs = 4;
inline constexpr std::size_t kMaxOutputs = 3;

constexpr const OpcodeInfo& info(Opcode op) { return kOpcodes[static_cast<std::size_t>(op)]; }

/// Registers are whole blocks of lanes. An output may reuse the register of an input: every kernel reads all inputs of
/// a batch before it writes.
struct Instruction {
  Opcode op;
  std::array<std::uint16_t, kMaxOutputs> out;
  std::array<std::uint16_t, kMaxInputs> in;
  std::uint32_t constants;  ///< index of the first constant

  friend bool operator==(const Instruction&, const Instruction&) = default;
};

inline constexpr std::uint8_t kNoAxis = 3;

/// How an instruction is run for gradients. On coordinates: its inputs are different ones, `axes` says which, and then the others.
/// Else some inputs may be coordinates (kNoAxis where not), of which somebody has to store the derivatives.
struct AxisStep {
  std::array<std::uint8_t, 3> axes;
  bool is_on_coordinates;
};

static_assert(sizeof(Instruction) == 20, "the tape is streamed at every step: keep it small");

}  // namespace octomarch
