// Aligned arrays for kernels: the scratch memory that each worker keeps. loaded_tape.hpp makes programs run in them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <new>

#include "octomarch/kernels/api.hpp"

namespace octomarch {

/// Zeroed, aligned to kernels::kAlignment; never copied.
template <class T>
class Buffer {
 public:
  Buffer() = default;
  explicit Buffer(std::size_t size)
      : data_(static_cast<T*>(::operator new[](size * sizeof(T), std::align_val_t{kernels::kAlignment}))), size_(size) {
    std::fill_n(data_.get(), size, T{});
  }

  T* data() { return data_.get(); }
  const T* data() const { return data_.get(); }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }
  std::size_t size() const { return size_; }

 private:
  struct Free {
    void operator()(T* p) const { ::operator delete[](p, std::align_val_t{kernels::kAlignment}); }
  };
  std::unique_ptr<T[], Free> data_;
  std::size_t size_ = 0;
};

/// Three rows of a vector quantity.
template <class T>
struct VectorBuffer {
  VectorBuffer() = default;
  explicit VectorBuffer(std::size_t size) : x(size), y(size), z(size) {}

  kernels::Vectors<T> view() { return {x.data(), y.data(), z.data()}; }
  kernels::Vectors<const T> read() const { return from(0); }
  /// From element i on.
  kernels::Vectors<const T> from(std::size_t i) const { return {x.data() + i, y.data() + i, z.data() + i}; }

  Buffer<T> x;
  Buffer<T> y;
  Buffer<T> z;
};

/// Which elements of some rows were chosen, in their order; `size` at the most.
class IndexList {
 public:
  explicit IndexList(std::size_t size) : indices_(size) {}

  void clear() { count_ = 0; }
  void push(std::size_t index) { indices_[count_++] = static_cast<std::uint32_t>(index); }
  std::size_t operator[](std::size_t i) const { return indices_[i]; }
  const std::uint32_t* data() const { return indices_.data(); }
  std::size_t size() const { return count_; }
  bool empty() const { return count_ == 0; }

 private:
  Buffer<std::uint32_t> indices_;
  std::size_t count_ = 0;
};

/// A double as Real, no farther out than the largest finite number.
template <class Real>
Real clamped(double value) {
  constexpr double kLargest = static_cast<double>(std::numeric_limits<Real>::max());
  return static_cast<Real>(std::clamp(value, -kLargest, kLargest));
}

/// 16 units of rounding error, the relative part of every hit epsilon (see March in graph/scene.hpp).
template <class Real>
inline constexpr Real kUlpFloor = std::numeric_limits<Real>::epsilon() * Real(8);

}  // namespace octomarch
