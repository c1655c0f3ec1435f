// The program as text, for people: what runs, on which registers, with which constants.
#include <algorithm>
#include <cstdio>
#include <string>

#include "octomarch/program/program.hpp"

namespace octomarch {

namespace {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

std::string register_list(const std::uint16_t* registers, std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += (i == 0 ? "r" : " r") + std::to_string(registers[i]);
  return text;
}

std::string padded(std::string text, std::size_t width) {
  if (text.size() < width) text.append(width - text.size(), ' ');
  return text;
}

std::string line(const Tape& tape, std::size_t index) {
  const Instruction& instruction = tape.code[index];
  const OpcodeInfo& shape = info(instruction.op);
  std::string text =
      padded(std::to_string(index), 5) + padded(register_list(instruction.out.data(), shape.outputs), 12);
  text += "= " + padded(shape.mnemonic, 20) + padded(register_list(instruction.in.data(), shape.inputs), 16);
  for (std::size_t i = 0; i < shape.constants; ++i) {
    text += (i == 0 ? "" : ", ") + number(tape.constants[instruction.constants + i]);
  }
  while (text.back() == ' ') text.pop_back();
  return text + "\n";
}

std::string point(const Vec3& p) { return "(" + number(p.x) + ", " + number(p.y) + ", " + number(p.z) + ")"; }

}  // namespace

std::string listing(const Program& program) {
  const Tape& tape = program.distance();
  std::string text = "distance program: " + std::to_string(tape.code.size()) + " instructions, " +
                     std::to_string(tape.registers) + " registers; r0 r1 r2 = x y z, result in r" +
                     std::to_string(tape.result()) + "\n";
  for (std::size_t i = 0; i < tape.code.size(); ++i) text += line(tape, i);
  const auto neighbours = std::count_if(tape.code.begin(), tape.code.end(), [](const Instruction& instruction) {
    return instruction.op == Opcode::kRepeatNeighbour;
  });
  if (neighbours > 0) {
    text += "repeats look at the neighbouring cell along " + std::to_string(neighbours) +
            (neighbours == 1 ? " coordinate" : " coordinates") + ": their content is not symmetric in its cell\n";
  }
  if (!(program.site().anchor == Vec3{})) text += "x y z count from " + point(program.site().anchor) + "\n";
  text += "bounds " + point(program.bounds().lo) + " .. " + point(program.bounds().hi) + "\n";
  text += "lipschitz " + number(program.lipschitz()) + "\n";
  return text;
}

}  // namespace octomarch
