// Reads crowds of shapes from tapes, as balls about them. Lowering comes before, ball_tree.hpp after.
#pragma once

#include <optional>
#include <vector>

#include "octomarch/base/types.hpp"
#include "octomarch/program/program.hpp"

namespace octomarch {

inline constexpr double Vec3::* kAxes[] = {&Vec3::x, &Vec3::y, &Vec3::z};

/// A shape's distance is nowhere less than that from the ball.
struct Ball {
  Vec3 center;
  double radius;
  double bulk;  ///< the radius of a ball that looks as large as the shape does, from anywhere on the average
};

struct Crowd {
  std::vector<Ball> balls;
  double blend = 0.0;  ///< the largest k of its blends
};

/// The balls about all shapes of a tape that does nothing but turn and make shapes that have exact distances and an end, blend them
/// one by one, and unite them and what they have become; else nothing. A shape that is taken up twice counts twice. O(tape).
template <class Real>
std::optional<Crowd> read_crowd(const Tape& tape);

}  // namespace octomarch
