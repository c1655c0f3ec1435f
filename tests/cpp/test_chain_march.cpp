// render/chain_march.hpp: rays of which few share a cell end as those that run the whole program, bit for bit, whatever memory there
// is for cells, and whoever else makes them.
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "parts.hpp"
#include <doctest/doctest.h>

#include "octomarch/render/field.hpp"

namespace octomarch {
namespace {

constexpr std::size_t kRays = 512;

/// Balls all over a cube, one in each unit of volume.
std::shared_ptr<const Program> cloud(int count) {
  Random random(31);  // NOLINT(bugprone-random-generator-seed): the same numbers each time
  const double half = 0.5 * std::cbrt(count);
  std::vector<NodePtr> balls;
  for (int i = 0; i < count; ++i) {
    const double x = uniform(random, -half, half);
    const double y = uniform(random, -half, half);
    balls.push_back(translate(sphere(uniform(random, 0.1, 0.3)), {x, y, uniform(random, -half, half)}));
  }
  return compile(combine(NodeKind::kUnion, std::move(balls), 0.1));
}

template <class Real>
struct Ended {
  std::vector<Real> t;
  std::vector<std::uint8_t> status;
  std::vector<std::int32_t> steps;
  std::uint64_t evaluations = 0;
  std::size_t visits = 0;

  bool is_same(const Ended& other) const {
    return std::memcmp(t.data(), other.t.data(), t.size() * sizeof(Real)) == 0 && status == other.status &&
           steps == other.steps && evaluations == other.evaluations;
  }
};

/// Rays from all over a program's bounds, in all directions; some hold no number, or begin where no cell is.
template <class Real>
class Shooter {
 public:
  explicit Shooter(const Program& program, std::uint64_t seed = 32)
      : program_(program), batch_(kRays), epsilon_(kRays) {
    Random random(seed);  // NOLINT(bugprone-random-generator-seed): likewise
    const double reach = 0.8 * program.bounds().hi.x;
    for (std::size_t i = 0; i < kRays; ++i) {
      const auto place = [&] { return static_cast<Real>(uniform(random, -reach, reach)); };
      batch_.origin.x[i] = place();
      batch_.origin.y[i] = place();
      batch_.origin.z[i] = place();
      const Vec3 along = normalized({uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)});
      batch_.direction.x[i] = static_cast<Real>(along.x);
      batch_.direction.y[i] = static_cast<Real>(along.y);
      batch_.direction.z[i] = static_cast<Real>(along.z);
      epsilon_[i] = Real(1e-4);
    }
    batch_.origin.y[3] = std::numeric_limits<Real>::quiet_NaN();
    batch_.direction.z[4] = std::numeric_limits<Real>::quiet_NaN();
    batch_.origin.x[5] = Real(1e30);
    batch_.origin.z[6] = std::numeric_limits<Real>::max();
  }

  Ended<Real> shoot(std::shared_ptr<Octree<Real>> octree, const March& march, const bool& cancelled) {
    Ended<Real> ended{std::vector<Real>(kRays), std::vector<std::uint8_t>(kRays), std::vector<std::int32_t>(kRays)};
    const SharedField<Real> shared{&program_, std::move(octree), nullptr, nullptr, false};
    Field<Real> field(shared, kernels::find_isa("scalar").table<Real>(), kRays);
    StageStats stage;
    const RayColumns<Real> columns = own_columns(batch_.origin, batch_.direction, epsilon_);
    field.march(columns.view({nullptr, Real(0)}, {nullptr, Real(60)}, kRays),
                march_parameters<Real>(program_, march, Real(1e-3), cancelled), batch_, ended.steps.data(), stage);
    std::copy_n(batch_.t.data(), kRays, ended.t.begin());
    std::copy_n(batch_.status.data(), kRays, ended.status.begin());
    ended.evaluations = stage.work.evaluations;
    ended.visits = stage.cells_visited;
    return ended;
  }

 private:
  const Program& program_;
  RayBatch<Real> batch_;
  Buffer<Real> epsilon_;
};

const bool kNever = false;

TEST_CASE_TEMPLATE("rays alone end as by the whole program, whatever memory there is", Real, float, double) {
  const auto program = cloud(600);
  Shooter<Real> shooter(*program);
  for (const Method method : {Method::kEnhanced, Method::kPlain, Method::kRelaxed, Method::kCertified}) {
    for (const int max_steps : {256, 9}) {
      March march;
      march.method = method;
      march.max_steps = max_steps;
      const Ended<Real> expected = shooter.shoot(nullptr, march, kNever);
      CHECK(expected.visits == 0);
      for (const std::size_t most_bytes : {std::size_t{0}, std::size_t{150'000}, std::size_t{1} << 28}) {
        CAPTURE(most_bytes);
        const auto octree = std::make_shared<Octree<Real>>(program->distance(), *program->focus(), most_bytes);
        for (int round = 0; round < 2; ++round) {  // cells are made, then found
          const Ended<Real> found = shooter.shoot(octree, march, kNever);
          CHECK(found.is_same(expected));
          if (most_bytes > 150'000) CHECK(found.visits > kRays);  // few are together
        }
        CHECK((octree->cells() > Octree<Real>::kTops + 1) == (most_bytes > 0));
        CHECK(octree->is_full() == (most_bytes <= 150'000));
      }
    }
  }
}

TEST_CASE("rays that threads march at the same time through cells that they make") {
  const auto program = cloud(1500);
  const March march;
  const auto octree = std::make_shared<Octree<float>>(program->distance(), *program->focus());
  std::vector<std::optional<Ended<float>>> found(4);
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < found.size(); ++i) {
    threads.emplace_back([&, i] { found[i] = Shooter<float>(*program, 40 + i).shoot(octree, march, kNever); });
  }
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < found.size(); ++i) {
    CHECK(found[i]->is_same(Shooter<float>(*program, 40 + i).shoot(nullptr, march, kNever)));
  }
}

TEST_CASE("a march that is cancelled ends") {
  const auto program = cloud(1500);
  Shooter<float> shooter(*program);
  const bool cancelled = true;
  const auto octree = std::make_shared<Octree<float>>(program->distance(), *program->focus());
  CHECK(shooter.shoot(octree, March{}, cancelled).evaluations < kRays);
  const Ended<float> expected = shooter.shoot(nullptr, March{}, kNever);
  CHECK(shooter.shoot(octree, March{}, kNever).is_same(expected));
}

}  // namespace
}  // namespace octomarch
