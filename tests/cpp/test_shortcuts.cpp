// program/shortcuts.hpp: what is remembered of a place is found from all places that share it, and from no other.
#include <set>
#include <vector>

#include <doctest/doctest.h>

#include "octomarch/program/shortcuts.hpp"

namespace octomarch {
namespace {

struct Cell {
  unsigned level = 0;
};
constexpr unsigned kLevels = 13;
using Ways = Shortcuts<Cell, kLevels>;

TEST_CASE("there are one to eight shortcuts for each thing, but for very many") {
  for (const std::size_t things : {1U, 2U, 3U, 7U, 8U, 63U, 200U, 1'000U, 4'096U, 100'000U, 262'143U}) {
    CAPTURE(things);
    const std::size_t count = Ways(things).bytes() / sizeof(void*);
    CHECK(count >= things);
    CHECK(count <= 8 * things);
    CHECK(count == std::size_t{1} << 3 * Ways(things).levels());
  }
  CHECK(Ways(std::size_t{1} << 40).levels() == 7);
  CHECK(Ways().bytes() <= sizeof(void*));
}

TEST_CASE("a cell is found where it was remembered") {
  for (const std::size_t things : {1U, 20U, 3'000U}) {
    CAPTURE(things);
    Ways ways(things);
    const unsigned below = kLevels - ways.levels();
    std::vector<Cell> cells(64);
    const auto place = [&](std::size_t i) {
      const auto corner = [&](std::size_t number) {
        return static_cast<std::uint32_t>(number * 0x9E3779B9U) % (1U << ways.levels()) << below;
      };
      return Ways::Place{corner(i), corner(i + 100), corner(i + 200)};
    };
    std::set<Ways::Place> known;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      CHECK((ways.find(place(i)) != nullptr) == known.contains(place(i)));
      ways.remember(place(i), cells[i]);
      known.insert(place(i));
      Ways::Place last = place(i);
      for (std::uint32_t& at : last) at += (1U << below) - 1U;
      CHECK(ways.find(place(i)) == &cells[i]);
      CHECK(ways.find(last) == &cells[i]);
    }
  }
}

}  // namespace
}  // namespace octomarch
