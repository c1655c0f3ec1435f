#include "octomarch/program/ball_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>

namespace octomarch {

namespace {

constexpr double kPi = std::numbers::pi;

/// About a shape of some area: what is seen of one is a quarter of that on the average (Cauchy), of one with hollows no more.
Ball ball_about(const Vec3& center, double radius, double area) {
  return {center, radius, std::sqrt(area / (4.0 * kPi))};
}

/// The ball about what an instruction makes, in the order of its inputs; nothing for what has no exact distance, or no end.
std::optional<Ball> ball_about(Opcode op, const auto& number) {
  const auto three = [&](std::size_t first) { return Vec3{number(first), number(first + 1), number(first + 2)}; };
  const auto box = [](const Vec3& center, const Vec3& half) {
    return ball_about(center, length(half), 8.0 * (half.x * half.y + half.y * half.z + half.z * half.x));
  };
  switch (op) {
    case Opcode::kSphere: return Ball{three(0), number(3), number(3)};
    case Opcode::kOriginSphere: return Ball{{}, number(0), number(0)};
    case Opcode::kBox: return box(three(0), three(3));
    case Opcode::kOriginBox: return box({}, three(0));
    case Opcode::kCappedCylinder: {
      const double radius = number(3);
      const double half = number(4);
      return ball_about(three(0), std::hypot(radius, half), 2.0 * kPi * radius * (radius + 2.0 * half));
    }
    case Opcode::kTorus: return ball_about(three(0), number(3) + number(4), 4.0 * kPi * kPi * number(3) * number(4));
    case Opcode::kCapsule: {
      const double way = length(three(3));
      const double radius = number(7);
      return ball_about(three(0) + three(3) * 0.5, way * 0.5 + radius, 2.0 * kPi * radius * (2.0 * radius + way));
    }
    default: return std::nullopt;
  }
}

/// Goes through a tape and keeps, of each register, the coordinate, ball or crowd that it holds.
template <class Real>
class BallReader {
 public:
  explicit BallReader(const Tape& tape)
      : tape_(tape),
        constants_(constants_of<Real>(tape)),
        holds_(tape.registers, Holds::kNothing),
        axis_(tape.registers),
        ball_(tape.registers) {
    for (std::uint16_t axis = 0; axis < kCoordinates; ++axis) {
      Vec3 along{};
      along.*kAxes[axis] = 1.0;
      holds_[axis] = Holds::kCoordinate;
      axis_[axis] = {along, 0.0};
    }
  }

  std::optional<Crowd> read() {
    if (tape_.inputs != kCoordinates || tape_.results.size() != 1) return std::nullopt;
    const bool is_crowd =
        std::ranges::all_of(tape_.code, [this](const Instruction& instruction) { return read(instruction); }) &&
        holds_[tape_.result()] == Holds::kCrowd;
    return is_crowd ? std::optional(std::move(crowd_)) : std::nullopt;
  }

 private:
  enum class Holds : std::uint8_t { kNothing, kCoordinate, kBall, kCrowd };
  static constexpr std::size_t kCoordinates = 3;
  /// A coordinate is along·p + offset.
  struct Axis {
    Vec3 along;
    double offset;
  };

  bool read(const Instruction& instruction) {
    const Real* const own = constants_ + instruction.constants;
    const auto number = [own](std::size_t i) { return static_cast<double>(own[i]); };
    switch (instruction.op) {
      case Opcode::kRotate: return turn(instruction, number);
      case Opcode::kUnion: return take_up(instruction.in[0]) && take_up(instruction.in[1]) && hold_crowd(instruction);
      case Opcode::kSmoothUnion:
        crowd_.blend = std::max(crowd_.blend, number(0));
        return (holds_[instruction.in[0]] == Holds::kBall || holds_[instruction.in[1]] == Holds::kBall) &&
               take_up(instruction.in[0]) && take_up(instruction.in[1]) && hold_crowd(instruction);
      default: {
        const std::optional<Ball> ball = ball_about(instruction.op, number);
        return ball && place(instruction, *ball);
      }
    }
  }

  bool has_coordinates(const Instruction& instruction) const {
    return std::all_of(instruction.in.begin(), instruction.in.begin() + kCoordinates,
                       [this](std::uint16_t taken) { return holds_[taken] == Holds::kCoordinate; });
  }

  bool turn(const Instruction& instruction, const auto& number) {
    if (!has_coordinates(instruction)) return false;
    std::array<Axis, kCoordinates> turned{};
    for (std::size_t row = 0; row < kCoordinates; ++row) {
      turned[row].offset = number(4 * row + 3);
      for (std::size_t k = 0; k < kCoordinates; ++k) {
        const Axis& from = axis_[instruction.in[k]];
        turned[row].along = turned[row].along + from.along * number(4 * row + k);
        turned[row].offset += from.offset * number(4 * row + k);
      }
    }
    for (std::size_t row = 0; row < kCoordinates; ++row) {
      holds_[instruction.out[row]] = Holds::kCoordinate;
      axis_[instruction.out[row]] = turned[row];
    }
    return true;
  }

  /// A ball that is known by three coordinates, which are square to each other.
  bool place(const Instruction& instruction, Ball ball) {
    if (!has_coordinates(instruction)) return false;
    Vec3 center{};
    double size = 0.0;
    double off = 0.0;  // how far they are from unit length and square to each other
    for (std::size_t k = 0; k < kCoordinates; ++k) {
      const Axis& axis = axis_[instruction.in[k]];
      center = center + axis.along * (ball.center.*kAxes[k] - axis.offset);
      size += std::fabs(ball.center.*kAxes[k]) + std::fabs(axis.offset);
      const Axis& next = axis_[instruction.in[(k + 1) % kCoordinates]];
      off += std::fabs(dot(axis.along, next.along)) + std::fabs(dot(axis.along, axis.along) - 1.0);
    }
    if (!(off < 1e-5)) return false;  // as where two are along one axis
    constexpr double kRoundings = 16.0 * static_cast<double>(std::numeric_limits<Real>::epsilon());
    ball.center = center;
    ball.radius += kRoundings * size;
    holds_[instruction.out[0]] = Holds::kBall;
    ball_[instruction.out[0]] = ball;
    return true;
  }

  bool take_up(std::uint16_t taken) {
    if (holds_[taken] == Holds::kBall) {
      crowd_.balls.push_back(ball_[taken]);
      return true;
    }
    return std::exchange(holds_[taken], Holds::kNothing) == Holds::kCrowd;
  }

  bool hold_crowd(const Instruction& instruction) {
    holds_[instruction.out[0]] = Holds::kCrowd;
    return true;
  }

  const Tape& tape_;
  const Real* constants_;
  std::vector<Holds> holds_;  ///< by register
  std::vector<Axis> axis_;    ///< likewise
  std::vector<Ball> ball_;    ///< likewise
  Crowd crowd_;
};

}  // namespace

template <class Real>
std::optional<Crowd> read_crowd(const Tape& tape) {
  return BallReader<Real>(tape).read();
}
template std::optional<Crowd> read_crowd<float>(const Tape& tape);
template std::optional<Crowd> read_crowd<double>(const Tape& tape);

}  // namespace octomarch
