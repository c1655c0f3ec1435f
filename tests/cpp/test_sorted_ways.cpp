// render/sorted_ways.hpp: elements in the order of their cells.
#include <algorithm>
#include <array>
#include <random>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "octomarch/render/sorted_ways.hpp"

namespace octomarch {
namespace {

using Pairs = std::vector<std::pair<std::uint64_t, std::size_t>>;
constexpr unsigned kWayBits = Octree<float>::kWayBits;

/// Pairs that have much in common, as neighbouring rays' have.
Pairs some_ways(std::size_t count, std::mt19937_64& random) {
  Pairs ways;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t kept = ~std::uint64_t{0} << (3 * (random() % 14));
    const std::uint64_t top = random() % 3;
    ways.emplace_back(top << kWayBits | ((random() & kept) & ((std::uint64_t{1} << kWayBits) - 1)), i);
  }
  return ways;
}

TEST_CASE("ways are sorted, equal ones by their elements") {
  std::mt19937_64 random(4);  // NOLINT(bugprone-random-generator-seed): the same numbers each time
  SortedWays sorted;
  for (const std::size_t count : {0UL, 1UL, 2UL, 95UL, 96UL, 5000UL, 5UL}) {
    Pairs ways = some_ways(count, random);
    sorted.clear();
    for (const auto& [way, element] : ways) sorted.add({way, element});
    sorted.sort();
    std::sort(ways.begin(), ways.end());
    REQUIRE(sorted.size() == count);
    for (std::size_t k = 0; k < count; ++k) CHECK(sorted.element(k) == ways[k].second);
  }
}

TEST_CASE("octants are where their ways begin and end") {
  std::mt19937_64 random(5);  // NOLINT(bugprone-random-generator-seed): likewise
  for (const std::size_t count : {1UL, 10UL, 400UL}) {
    Pairs ways = some_ways(count, random);
    SortedWays sorted;
    for (const auto& [way, element] : ways) sorted.add({way, element});
    sorted.sort();
    std::sort(ways.begin(), ways.end());
    std::size_t begin = 0;
    for (std::size_t top = 0; top < 3; ++top) {
      const std::size_t end = sorted.end_of_top(begin, top);
      for (std::size_t k = 0; k < count; ++k) CHECK((ways[k].first >> kWayBits == top) == (k >= begin && k < end));
      if (end > begin) {
        std::array<std::size_t, 9> bounds;
        sorted.find_octants(0, begin, end, bounds);
        CHECK(bounds.front() == begin);
        CHECK(bounds.back() == end);
        for (unsigned octant = 0; octant < 8; ++octant) {
          for (std::size_t k = bounds[octant]; k < bounds[octant + 1]; ++k) {
            CHECK(Way(ways[k].first, 0).octant(0) == octant);
          }
        }
      }
      begin = end;
    }
    CHECK(begin == count);
  }
}

}  // namespace
}  // namespace octomarch
