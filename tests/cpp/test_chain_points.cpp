// render/chain_points.hpp: points of which few share a cell have the bits of the whole program.
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <numeric>
#include <vector>

#include "clouds.hpp"
#include "parts.hpp"
#include <doctest/doctest.h>

#include "octomarch/render/chain_points.hpp"
#include "octomarch/render/field.hpp"

namespace octomarch {
namespace {

constexpr std::size_t kMany = 4000;

/// All over a program's bounds and beyond; some hold no number, or are where no cell is.
template <class Real>
VectorBuffer<Real> scattered_points(const Program& program) {
  Random random(51);  // NOLINT(bugprone-random-generator-seed): the same numbers each time
  VectorBuffer<Real> points(kernels::padded_lanes(kMany));
  const double reach = 1.2 * program.bounds().hi.x;
  for (Buffer<Real>* row : {&points.x, &points.y, &points.z}) {
    for (std::size_t i = 0; i < kMany; ++i) (*row)[i] = static_cast<Real>(uniform(random, -reach, reach));
  }
  points.x[3] = std::numeric_limits<Real>::quiet_NaN();
  points.y[4] = Real(1e30);
  points.z[5] = -std::numeric_limits<Real>::infinity();
  points.z[6] = std::numeric_limits<Real>::max();
  return points;
}

template <class Real>
struct Found {
  std::vector<Real> values;
  StageStats stage;

  bool is_same(const Found& other) const {
    return values.size() <= other.values.size() &&
           std::memcmp(values.data(), other.values.data(), values.size() * sizeof(Real)) == 0;
  }
};

template <class Real>
Found<Real> distances(const Program& program, std::shared_ptr<Octree<Real>> octree, const kernels::Isa& isa,
                      std::size_t count = kMany) {
  const bool never = false;
  const SharedField<Real> shared{&program, std::move(octree), nullptr, nullptr, false};
  Field<Real> field(shared, isa.table<Real>(), kMany);
  const VectorBuffer<Real> points = scattered_points<Real>(program);
  Buffer<Real> out(kernels::padded_lanes(kMany));
  Found<Real> found;
  field.distance(points.read(), count, never, out.data(), found.stage);
  found.values.assign(out.data(), out.data() + count);
  return found;
}

TEST_CASE_TEMPLATE("points alone are measured as by the whole program", Real, float, double) {
  const auto program = cloud(3000);
  const Found<Real> expected = distances<Real>(*program, nullptr, kernels::find_isa("scalar"));
  for (const kernels::Isa& isa : kernels::available_isas()) {
    CAPTURE(isa.name);
    const auto octree = std::make_shared<Octree<Real>>(program->distance(), *program->focus());
    for (int round = 0; round < 8; ++round) CHECK(distances(*program, octree, isa).is_same(expected));
    constexpr std::size_t kFew = 500;  // hardly two of them in a cell
    const Found<Real> found = distances(*program, octree, isa, kFew);
    CHECK(found.is_same(expected));
    CHECK(found.stage.cells_visited > kFew / 2);
  }
}

TEST_CASE_TEMPLATE("points that would go alone are measured alike where memory ends", Real, float, double) {
  const auto program = cloud(3000);
  const kernels::Isa& isa = kernels::find_isa("scalar");
  const Found<Real> expected = distances<Real>(*program, nullptr, isa);
  for (const std::size_t most_bytes : {std::size_t{0}, std::size_t{1'200'000}, std::size_t{2'000'000}}) {
    CAPTURE(most_bytes);
    const auto octree = std::make_shared<Octree<Real>>(program->distance(), *program->focus(), most_bytes);
    for (int round = 0; round < 3; ++round) CHECK(distances(*program, octree, isa).is_same(expected));
  }
}

TEST_CASE_TEMPLATE("points among several kinds, each alone, and those that lanes have nothing for", Real, float,
                   double) {
  int next = 0;
  const auto program =
      cloud(3000, [&](Random& random) { return ++next % 3 == 0 ? box({0.1, 0.2, 0.3}) : ball(random); });
  const VectorBuffer<Real> points = scattered_points<Real>(*program);
  std::vector<std::uint32_t> all(kMany - 10);
  std::iota(all.begin(), all.end(), 10U);
  for (const kernels::Isa& isa : kernels::available_isas()) {
    CAPTURE(isa.name);
    const kernels::KernelTable<Real>& kernels = isa.table<Real>();
    const Found<Real> expected = distances<Real>(*program, nullptr, isa);
    for (const bool is_full : {false, true}) {
      Octree<Real> octree(program->distance(), *program->focus(), is_full ? 0 : std::size_t{1} << 30);
      Runner<Real> runner(program->distance());
      CellChoice<Real> choice(octree, runner);
      ChainLanes<Real> lanes(choice);
      StageStats stage;
      bool is_cancelled = false;
      choice.begin(kStayOfPoint, is_cancelled, stage);
      std::vector<std::uint32_t> left;
      std::vector<Real> out(kMany, Real(-7));
      const auto run = [&] {
        run_points_alone(lanes, points.read(), all, is_cancelled, out.data(), left,
                         [&](const auto&... rest) { kernels.run_chain(rest..., stage.work); });
      };
      run();
      if (is_full) {
        CHECK(left == all);
      } else {
        std::size_t measured = 0;
        for (std::size_t i = 10; i < kMany; ++i) {
          if (out[i] == Real(-7)) continue;
          CHECK(out[i] == expected.values[i]);
          ++measured;
        }
        CHECK(measured + left.size() == all.size());
        CHECK(measured > all.size() / 2);
        is_cancelled = true;
        std::fill(out.begin(), out.end(), Real(-7));
        run();
        CHECK(std::ranges::count(out, Real(-7)) == static_cast<std::ptrdiff_t>(kMany));
      }
    }
  }
}

}  // namespace
}  // namespace octomarch
