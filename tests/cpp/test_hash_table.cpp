// The table under node interning and the compiler: what is inserted is found until it is erased, whatever else comes and goes.
#include <cstdint>
#include <random>
#include <unordered_map>
#include <vector>

#include <doctest/doctest.h>

#include "octomarch/base/hash_table.hpp"

namespace octomarch {
namespace {

auto equal_to(std::uint32_t wanted) {
  return [wanted](std::uint32_t value) { return value == wanted; };
}

TEST_CASE("an empty table has nothing") {
  HashTable<std::uint32_t> table;
  CHECK(table.size() == 0);
  CHECK(table.find(7, [](std::uint32_t) { return true; }) == 0);
  table.erase(7, [](std::uint32_t) { return true; });
  CHECK(table.size() == 0);
}

TEST_CASE("values under one hash are told apart") {
  HashTable<std::uint32_t> table;
  for (std::uint32_t value = 1; value <= 100; ++value) table.insert(42, value);
  CHECK(table.size() == 100);
  for (std::uint32_t value = 1; value <= 100; ++value) CHECK(table.find(42, equal_to(value)) == value);
  CHECK(table.find(43, [](std::uint32_t) { return true; }) == 0);
  table.erase(42, equal_to(50));
  CHECK(table.find(42, equal_to(50)) == 0);
  CHECK(table.find(42, equal_to(100)) == 100);
}

TEST_CASE("tables that grow and shrink agree with the standard library's") {
  // few distinct low bits, so that runs are long and wrap round the end
  std::mt19937_64 random(1);  // NOLINT(bugprone-random-generator-seed): the same run each time
  for (const std::uint64_t spread : {3U, 17U, 1000U}) {
    HashTable<std::uint32_t> table;
    std::unordered_map<std::uint32_t, std::uint64_t> expected;
    for (int phase = 0; phase < 4; ++phase) {
      const std::uint64_t inserts_of_ten = phase % 2 == 0 ? 8 : 1;
      for (int i = 0; i < 1500; ++i) {
        const auto value = static_cast<std::uint32_t>(1 + random() % 2000);
        const auto known = expected.find(value);
        if (random() % 10 < inserts_of_ten) {
          if (known != expected.end()) continue;
          const std::uint64_t hash = (random() % spread) * 0xFFFFFFFFFFFFFFFDULL;
          table.insert(hash, value);
          expected.emplace(value, hash);
        } else if (known != expected.end()) {
          table.erase(known->second, equal_to(value));
          expected.erase(known);
        }
      }
      CHECK(table.size() == expected.size());
      for (const auto& [value, hash] : expected) CHECK(table.find(hash, equal_to(value)) == value);
    }
    for (const auto& [value, hash] : expected) table.erase(hash, equal_to(value));
    CHECK(table.size() == 0);
  }
}

}  // namespace
}  // namespace octomarch
