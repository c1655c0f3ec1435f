// Memory that is given back all at once. For many small things that live as long as each other, side by side in the order in
// which they were made.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace octomarch {

class Arena {
 public:
  static constexpr std::size_t kAlignment = 64;  ///< of what asks for it; a cache line

  /// Makes a thing that needs no destructor.
  template <class T, class... Arguments>
  T* make(Arguments&&... arguments) {
    static_assert(std::is_trivially_destructible_v<T> && alignof(T) <= kAlignment);
    return ::new (take(sizeof(T), alignof(T))) T(std::forward<Arguments>(arguments)...);
  }

  /// Copies an array.
  template <class T>
  const T* copy(std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= kAlignment);
    T* const copied = static_cast<T*>(take(values.size_bytes(), alignof(T)));
    std::uninitialized_copy(values.begin(), values.end(), copied);
    return copied;
  }

  /// Forgets all that was made.
  void clear() {
    blocks_.clear();
    next_ = end_ = nullptr;
    bytes_ = 0;
  }

  /// Memory taken from the heap.
  std::size_t bytes() const { return bytes_; }

 private:
  static constexpr std::size_t kFirst = std::size_t{1} << 12;
  static constexpr std::size_t kLargest = std::size_t{1} << 20;

  void* take(std::size_t size, std::size_t alignment) {
    void* place = next_;
    auto room = static_cast<std::size_t>(end_ - next_);
    if (next_ == nullptr || std::align(alignment, size, place, room) == nullptr) {
      add_block(size);
      place = next_;
    }
    next_ = static_cast<std::byte*>(place) + size;
    return place;
  }

  /// Blocks grow with what they add to, so that little is left over.
  void add_block(std::size_t size) {
    const std::size_t block = std::max(std::clamp(bytes_, kFirst, kLargest), size);
    blocks_.emplace_back(static_cast<std::byte*>(::operator new(block, std::align_val_t{kAlignment})));
    next_ = blocks_.back().get();
    end_ = next_ + block;
    bytes_ += block;
  }

  struct Release {
    void operator()(std::byte* block) const { ::operator delete(block, std::align_val_t{kAlignment}); }
  };

  std::vector<std::unique_ptr<std::byte, Release>> blocks_;
  std::byte* next_ = nullptr;
  std::byte* end_ = nullptr;
  std::size_t bytes_ = 0;
};

}  // namespace octomarch
