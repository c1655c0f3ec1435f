// Between numpy and the core: arrays in, named arrays out, precision by name, and the calling thread's duties while
// workers run without the GIL.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "octomarch/base/error.hpp"
#include "octomarch/graph/scene.hpp"

namespace octomarch {

using Rows = pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;

/// The numbers of `rows`, which must be of shape (n, 3).
inline std::span<const double> triples(const Rows& rows, const char* argument) {
  if (rows.ndim() != 2 || rows.shape(1) != 3) {
    throw ArgumentError(std::string(argument) + " must be an array of shape (n, 3), got " +
                        pybind11::str(pybind11::getattr(rows, "shape")).cast<std::string>());
  }
  return {rows.data(), static_cast<std::size_t>(rows.size())};
}

template <class Value>
std::span<Value> contents(pybind11::array_t<Value>& array) {
  return {array.mutable_data(), static_cast<std::size_t>(array.size())};
}

/// A crop as Python gives it: x, y, width, height.
using CropBox = std::array<std::uint32_t, 4>;

/// The same as a Crop, which must lie within width × height and hold a pixel.
inline Crop crop_of(const CropBox& box, std::uint32_t width, std::uint32_t height) {
  const auto [x, y, across, down] = box;
  const bool inside =
      across >= 1 && down >= 1 && std::uint64_t{x} + across <= width && std::uint64_t{y} + down <= height;
  require(inside, "crop", "within the picture and not empty", pybind11::str(pybind11::cast(box)).cast<std::string>());
  return {x, y, across, down};
}

/// Calls work(T{}) with the floating-point type that `name` names; `argument` is what the user calls it.
template <class Work>
auto with_precision(const char* argument, const std::string& name, const Work& work) {
  if (name == "float32") return work(float{});
  if (name == "float64") return work(double{});
  throw ArgumentError(std::string(argument) + " must be one of 'float32', 'float64', got '" + name + "'");
}

/// Raises what the host has pending (Ctrl-C). Contract: the calling thread is a Python thread without the GIL.
inline void check_signals() {
  const pybind11::gil_scoped_acquire gil;
  if (PyErr_CheckSignals() != 0) throw pybind11::error_already_set();
}

/// Named arrays of one shape of rays or pixels, made on request.
class Results {
 public:
  explicit Results(std::vector<pybind11::ssize_t> shape) : shape_(std::move(shape)) {}

  template <class Value>
  std::span<Value> scalars(const char* name) {
    return add<Value>(name, shape_);
  }

  template <class Value>
  std::span<Value> vectors(const char* name) {
    std::vector<pybind11::ssize_t> shape = shape_;
    shape.push_back(3);
    return add<Value>(name, shape);
  }

  pybind11::dict take() { return std::move(arrays_); }

 private:
  template <class Value>
  std::span<Value> add(const char* name, const std::vector<pybind11::ssize_t>& shape) {
    pybind11::array_t<Value> array(shape);
    arrays_[name] = array;
    return contents(array);
  }

  std::vector<pybind11::ssize_t> shape_;
  pybind11::dict arrays_;
};

}  // namespace octomarch
