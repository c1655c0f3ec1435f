// base/arena.hpp: memory for many small things.
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include <doctest/doctest.h>

#include "octomarch/base/arena.hpp"

namespace octomarch {
namespace {

struct alignas(64) Line {
  int number = 0;
};

bool is_aligned(const void* place, std::size_t alignment) {
  return reinterpret_cast<std::uintptr_t>(place) % alignment == 0;
}

TEST_CASE("what an arena has made stays where it is, aligned and apart") {
  Arena arena;
  std::vector<Line*> lines;
  std::vector<std::span<const std::uint16_t>> arrays;
  for (int i = 0; i < 3000; ++i) {
    lines.push_back(arena.make<Line>(Line{i}));
    std::vector<std::uint16_t> numbers(static_cast<std::size_t>(i % 97));
    std::iota(numbers.begin(), numbers.end(), static_cast<std::uint16_t>(i));
    arrays.emplace_back(arena.copy(std::span<const std::uint16_t>(numbers)), numbers.size());
  }
  for (int i = 0; i < 3000; ++i) {
    const auto k = static_cast<std::size_t>(i);
    CHECK(is_aligned(lines[k], 64));
    CHECK(lines[k]->number == i);
    for (std::size_t j = 0; j < arrays[k].size(); ++j) CHECK(arrays[k][j] == k + j);
  }
  CHECK(arena.bytes() > 3000 * sizeof(Line));
  CHECK(arena.bytes() < 4 * (3000 * sizeof(Line) + 3000 * 97));
}

TEST_CASE("an arena takes what is larger than its blocks, and forgets all at once") {
  Arena arena;
  CHECK(arena.bytes() == 0);
  const std::vector<double> many(1U << 20U, 0.5);
  const double* const copied = arena.copy(std::span<const double>(many));
  CHECK(copied[many.size() - 1] == 0.5);
  CHECK(arena.bytes() >= many.size() * sizeof(double));
  arena.clear();
  CHECK(arena.bytes() == 0);
  CHECK(arena.make<int>(7) != nullptr);
}

}  // namespace
}  // namespace octomarch
