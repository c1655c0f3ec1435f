// What tests of trees of balls share: the tree of a program, and its field.
#pragma once

#include <optional>
#include <vector>

#include "octomarch/kernels/dispatch.hpp"
#include "octomarch/program/ball_tree.hpp"
#include "octomarch/render/buffer.hpp"

namespace octomarch {

inline constexpr bool kNotCancelled = false;

template <class Real>
std::optional<BallTree<Real>> tree_of(const Program& program) {
  return BallTree<Real>::of(program.distance(), kNotCancelled);
}

template <class Real>
std::vector<double> fields_at(const Program& program, const std::vector<Vec3>& points) {
  const std::size_t size = kernels::padded_lanes(points.size());
  VectorBuffer<Real> places(size);
  for (std::size_t i = 0; i < points.size(); ++i) {
    places.x[i] = static_cast<Real>(points[i].x);
    places.y[i] = static_cast<Real>(points[i].y);
    places.z[i] = static_cast<Real>(points[i].z);
  }
  const Tape& tape = program.distance();
  const kernels::TapeView<Real> view{tape.code.data(), tape.code.size(), constants_of<Real>(tape),
                                     tape.registers,   tape.result(),    nullptr};
  Buffer<Real> memory(tape.registers * kernels::kLanes);
  Buffer<Real> values(size);
  kernels::available_isas().back().table<Real>().distance(view, memory.data(), places.read(), points.size(),
                                                          &kNotCancelled, values.data());
  return {values.data(), values.data() + points.size()};
}

}  // namespace octomarch
