// render/chain_march.hpp: rays of which few share a cell end as those that run the whole program, bit for bit, whatever memory there
// is for cells, and whoever else makes them.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "clouds.hpp"
#include "parts.hpp"
#include <doctest/doctest.h>

#include "octomarch/render/field.hpp"

namespace octomarch {
namespace {

constexpr std::size_t kRays = 512;

template <class Real>
struct Ended {
  std::vector<Real> t;
  std::vector<std::uint8_t> status;
  std::vector<std::int32_t> steps;
  std::vector<Real> visibility;
  std::uint64_t evaluations = 0;
  std::uint64_t visits = 0;
  std::uint64_t packets = 0;

  /// A group of rays is a packet at the least for each visit.
  bool some_went_alone() const { return visits > packets; }
  bool is_same(const Ended& other) const {
    return std::memcmp(t.data(), other.t.data(), t.size() * sizeof(Real)) == 0 && status == other.status &&
           std::memcmp(visibility.data(), other.visibility.data(), visibility.size() * sizeof(Real)) == 0 &&
           steps == other.steps && evaluations == other.evaluations;
  }
};

/// Rays from all over a program's bounds, in all directions; some hold no number, or begin where no cell is.
template <class Real>
class Shooter {
 public:
  explicit Shooter(const Program& program, std::uint64_t seed = 32, std::size_t count = kRays)
      : program_(program), count_(count), batch_(kRays), epsilon_(kRays) {
    Random random(seed);  // NOLINT(bugprone-random-generator-seed): likewise
    const double reach = 0.8 * program.bounds().hi.x;
    for (std::size_t i = 0; i < count_; ++i) {
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

  /// What becomes of them, and of as many shadow rays.
  Ended<Real> shoot(std::shared_ptr<Octree<Real>> octree, const March& march, const bool& cancelled,
                    const kernels::Isa& isa = kernels::find_isa("scalar")) {
    Ended<Real> ended{std::vector<Real>(count_), std::vector<std::uint8_t>(count_), std::vector<std::int32_t>(count_),
                      std::vector<Real>(count_)};
    const SharedField<Real> shared{&program_, std::move(octree), nullptr, nullptr, false};
    Field<Real> field(shared, isa.table<Real>(), kRays);
    StageStats stage;
    const kernels::RayView<Real> rays = view();
    field.march(rays, march_parameters<Real>(program_, march, Real(1e-3), cancelled), batch_, ended.steps.data(),
                stage);
    std::copy_n(batch_.t.data(), count_, ended.t.begin());
    std::copy_n(batch_.status.data(), count_, ended.status.begin());
    Buffer<Real> visibility(kRays);
    field.cast_shadows(rays, shadow_parameters<Real>(program_, march, Real(8), Real(1e-3), cancelled), batch_,
                       visibility.data(), stage);
    std::copy_n(visibility.data(), count_, ended.visibility.begin());
    ended.evaluations = stage.work.evaluations;
    ended.visits = stage.cells_visited;
    ended.packets = stage.work.packets;
    return ended;
  }

  kernels::RayView<Real> view() const {
    return own_columns(batch_.origin, batch_.direction, epsilon_).view({nullptr, Real(0)}, {nullptr, Real(60)}, count_);
  }
  RayBatch<Real>& batch() { return batch_; }

 private:
  const Program& program_;
  std::size_t count_;
  RayBatch<Real> batch_;
  Buffer<Real> epsilon_;
};

const bool kNever = false;

TEST_CASE_TEMPLATE("rays alone end as by the whole program", Real, float, double) {
  const auto program = cloud(600);
  Shooter<Real> shooter(*program);
  for (const Method method : {Method::kEnhanced, Method::kPlain, Method::kRelaxed, Method::kCertified}) {
    for (const int max_steps : {256, 9, 1}) {
      March march;
      march.method = method;
      march.max_steps = max_steps;
      const Ended<Real> expected = shooter.shoot(nullptr, march, kNever);
      CHECK(expected.visits == 0);
      const auto octree = std::make_shared<Octree<Real>>(program->distance(), *program->focus());
      for (int round = 0; round < 2; ++round) {  // cells are made, then found
        const Ended<Real> found = shooter.shoot(octree, march, kNever);
        CHECK(found.is_same(expected));
        CHECK((found.some_went_alone() || max_steps == 1));
      }
    }
  }
}

TEST_CASE_TEMPLATE("rays that would go alone end alike where memory ends", Real, float, double) {
  const auto program = cloud(300);
  Shooter<Real> shooter(*program, 33, 100);
  const Ended<Real> expected = shooter.shoot(nullptr, March{}, kNever);
  for (const std::size_t most_bytes : {std::size_t{0}, std::size_t{40'000}}) {
    CAPTURE(most_bytes);
    const auto octree = std::make_shared<Octree<Real>>(program->distance(), *program->focus(), most_bytes);
    for (int round = 0; round < 2; ++round) CHECK(shooter.shoot(octree, March{}, kNever).is_same(expected));
    CHECK((octree->cells() > Octree<Real>::kTops + 1) == (most_bytes > 0));
    CHECK(octree->is_full());
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

TEST_CASE_TEMPLATE("rays alone end alike by every instruction set", Real, float, double) {
  const auto program = cloud(1000);
  Shooter<Real> shooter(*program);
  const Ended<Real> expected = shooter.shoot(nullptr, March{}, kNever);
  for (const kernels::Isa& isa : kernels::available_isas()) {
    CAPTURE(isa.name);
    const auto octree = std::make_shared<Octree<Real>>(program->distance(), *program->focus());
    for (int round = 0; round < 2; ++round) {
      const Ended<Real> found = shooter.shoot(octree, March{}, kNever, isa);
      CHECK(found.is_same(expected));
      CHECK(found.some_went_alone());
    }
  }
}

NodePtr turned(NodePtr shape, Random& random) {
  return rotate(std::move(shape), uniform(random, 10.0, 80.0), {1.0, uniform(random, 1.0, 2.0), 0.5});
}

using Make = std::function<NodePtr(Random&)>;

/// All opcodes that lanes run, in bodies of all lengths.
std::vector<std::vector<Make>> makes() {
  const auto pair = [](NodeKind kind, double smooth) {
    return [kind, smooth](Random& r) {
      return turned(combine(kind, {box({0.3, 0.3, 0.4}), translate(ball(r), {0.1, 0.1, 0.1})}, smooth), r);
    };
  };
  const Make block = [](Random& r) { return box({uniform(r, 0.1, 0.3), 0.2, 0.4}); };
  return {
      {block, ball},
      {[](Random& r) { return turned(box({0.1, 0.2, 0.3}, NodeKind::kBoxMaximum), r); },
       [](Random& r) { return turned(round(box({0.1, 0.2, 0.3}, NodeKind::kBoxExterior), 0.05), r); }, ball},
      {[](Random& r) {
         return turned(combine(NodeKind::kIntersection, {cylinder(0.2, {}, {0, 1, 0}), ball(r)}, 0.0), r);
       },
       [](Random& r) { return combine(NodeKind::kIntersection, {cylinder(0.2, {}, {0, 0, 1}), ball(r)}, 0.0); }},
      {[](Random& r) { return cylinder(uniform(r, 0.1, 0.2), 0.5, {0, 1, 0}); },
       [](Random& r) { return torus(uniform(r, 0.1, 0.2), 0.05, {0, 1, 0}); },
       [](Random& r) { return capsule({0, 0, 0}, {uniform(r, 0.1, 0.2), 0.2, 0.1}, 0.1); }},
      {[](Random& r) {
         return combine(NodeKind::kDifference, {ball(r), plane({1, uniform(r, -1, 1), 1}, {0, 0, 0})}, 0.0);
       },
       [](Random& r) {
         return combine(NodeKind::kDifference, {ball(r), plane({0, 1, 0}, {0, uniform(r, -0.1, 0.1), 0})}, 0.0);
       }},
      {[](Random& r) { return extrude(rectangle({uniform(r, 0.1, 0.3), 0.2}), 0.2); }, ball, block},
      {[](Random& r) { return turned(capped_cone(uniform(r, 0.1, 0.2), 0.05, 0.4, {0, 1, 0}), r); },
       [](Random& r) { return turned(octahedron(uniform(r, 0.1, 0.3)), r); },
       [](Random& r) { return turned(pyramid(uniform(r, 0.1, 0.3), 0.3), r); }},
      {pair(NodeKind::kUnion, 0.0), pair(NodeKind::kUnion, 0.1), pair(NodeKind::kIntersection, 0.1)},
      {pair(NodeKind::kDifference, 0.1), pair(NodeKind::kMetaballs, 0.001), ball},
      {[](Random& r) { return elongate(sphere(uniform(r, 0.05, 0.1)), {0.1, 0.2, 0.0}); },
       [](Random& r) { return shell(ball(r), 0.05); },
       [](Random& r) { return combine(NodeKind::kIntersection, {ball(r), round(complement(ball(r)), 0.05)}, 0.1); },
       [](Random& r) { return stretch(mirror(translate(ball(r), {0.1, 0, 0}), 0), {1.0, 1.5, 2.0}); }},
  };
}

/// What a kernel leaves of rays that are not to be concluded.
template <class Real>
struct Marched {
  std::vector<Real> numbers;
  std::vector<std::int32_t> steps;
  std::vector<std::uint8_t> pause;

  friend bool operator==(const Marched&, const Marched&) = default;
};

/// Marches the rays behind the first ten, which are no numbers or far away.
template <class Real, class MarchThem>
Marched<Real> marched(Shooter<Real>& shooter, const kernels::KernelTable<Real>& kernels,
                      const kernels::MarchParameters<Real>& parameters, MarchThem&& march_them) {
  const kernels::RayView<Real> rays = shooter.view();
  Marched<Real> result{{}, std::vector<std::int32_t>(rays.count), {}};
  const kernels::MarchState<Real> state = shooter.batch().state(result.steps.data());
  kernels.begin_march(rays, parameters, kernels::kNothingBefore<Real>, state);
  std::fill_n(result.steps.begin(), rays.count, 0);
  march_them(rays, state);
  for (std::size_t i = 10; i < rays.count; ++i) {
    result.numbers.insert(result.numbers.end(), {state.t[i], state.before[i]});
  }
  result.pause.assign(state.pause + 10, state.pause + rays.count);
  std::fill_n(result.steps.begin(), 10, 0);
  return result;
}

TEST_CASE_TEMPLATE("rays alone among shapes of several kinds are marched as by the whole program", Real, float,
                   double) {
  std::array<bool, kOpcodeCount> is_met{};
  for (std::size_t all = makes().size(); all-- > 0;) {
    CAPTURE(all);
    const std::vector<Make> kinds = makes()[all];
    std::size_t next = 0;
    const std::size_t count = kinds.size() * (Chain::kManyThatChoose + 10);
    const auto program =
        cloud(static_cast<int>(count), [&](Random& random) { return kinds[next++ % kinds.size()](random); });
    Shooter<Real> shooter(*program, 34, 100);
    const auto parameters = march_parameters<Real>(*program, March{}, Real(1e-3), kNever);
    StageStats stage;
    LoadedTape<Real> tape(program->distance(), TapeUse::kMarches);
    const kernels::KernelTable<Real>& widest = kernels::available_isas().front().table<Real>();
    const Marched<Real> expected = marched(shooter, widest, parameters, [&](const auto& rays, const auto& state) {
      widest.march(tape.view(), tape.memory(), rays, parameters, nullptr, state, stage.work);
    });
    Octree<Real> octree(program->distance(), *program->focus());
    for (const kernels::Isa& isa : kernels::available_isas()) {
      CAPTURE(isa.name);
      REQUIRE(octree.chain() != nullptr);
      CHECK(octree.chain()->kinds().size() == kinds.size());
      Runner<Real> runner(program->distance());
      CellChoice<Real> choice(octree, runner);
      ChainMarch<Real> alone(choice);
      choice.begin(kStayOfRay, kNever, stage);
      std::vector<Way> ways;
      for (std::size_t i = 10; i < shooter.view().count; ++i) ways.emplace_back(0, i);
      const kernels::KernelTable<Real>& kernels = isa.table<Real>();
      const Marched<Real> found = marched(shooter, kernels, parameters, [&](const auto& rays, const auto& state) {
        alone.march(rays, ways, parameters, state, state.steps,
                    [&](const auto&... rest) { return kernels.step_chain(rest..., stage.work); });
      });
      CHECK(found == expected);
      for (const Chain::Kind& kind : octree.chain()->kinds()) {
        for (const Instruction& instruction : kind.body()) is_met[static_cast<std::size_t>(instruction.op)] = true;
      }
    }
  }
  for (std::size_t op = 0; op < kOpcodeCount; ++op) {
    CAPTURE(std::string(kOpcodes[op].mnemonic));
    CHECK(is_met[op] >= runs_by_lanes(Opcode(op)));
  }
}

TEST_CASE("rays among shapes of which lanes have room for few end as by the whole program") {
  const auto cones = [](Random& random) {  // 120 constants
    std::vector<NodePtr> shapes;
    for (int i = 0; i < 4; ++i) shapes.push_back(capped_cone(0.1 + 0.05 * i, 0.2 - 0.05 * i, 0.3, {0, 1, 0}));
    return turned(combine(NodeKind::kUnion, std::move(shapes), 0.0), random);
  };
  int next = 0;
  const auto program = cloud(6000, [&](Random& random) { return next++ % 5 == 0 ? cones(random) : ball(random); }, 0.0);
  Shooter<float> shooter(*program, 35);
  const auto octree = std::make_shared<Octree<float>>(program->distance(), *program->focus());
  REQUIRE(octree->chain() != nullptr);
  CHECK(octree->chain()->kinds().size() == 2);
  CHECK(octree->chain()->columns() > 100);
  const kernels::Isa& widest = kernels::available_isas().front();
  const Ended<float> expected = shooter.shoot(nullptr, March{}, kNever, widest);
  for (int round = 0; round < 4; ++round) CHECK(shooter.shoot(octree, March{}, kNever, widest).is_same(expected));
}

TEST_CASE("a march of rays alone that is cancelled stops, and leaves nothing for the next") {
  int next = 0;
  const auto program =
      cloud(600, [&](Random& random) { return ++next % 3 == 0 ? box({0.1, 0.2, 0.3}) : ball(random); });
  Shooter<float> shooter(*program);
  const kernels::KernelTable<float>& kernels = kernels::find_isa("scalar").table<float>();
  Octree<float> octree(program->distance(), *program->focus());
  Runner<float> runner(program->distance());
  CellChoice<float> choice(octree, runner);
  ChainMarch<float> alone(choice);
  bool is_cancelled = false;
  const kernels::MarchParameters<float> parameters = march_parameters<float>(*program, March{}, 1e-3F, is_cancelled);
  std::vector<Way> ways;
  for (std::size_t i = 10; i < kRays; ++i) ways.emplace_back(0, i);  // those before are no numbers, or far away
  StageStats stage;
  choice.begin(kStayOfRay, is_cancelled, stage);
  const auto march = [&](int cancelled_at) {
    std::vector<std::int32_t> taken(kRays);
    const kernels::MarchState<float> state = shooter.batch().state(taken.data());
    kernels.begin_march(shooter.view(), parameters, kernels::kNothingBefore<float>, state);
    is_cancelled = false;
    int steps = 0;
    alone.march(shooter.view(), ways, parameters, state, taken.data(), [&](const auto&... all) {
      is_cancelled = ++steps == cancelled_at;
      return kernels.step_chain(all..., stage.work);
    });
    CHECK((cancelled_at == 0 || steps == cancelled_at));
    return taken;
  };
  const std::vector<std::int32_t> expected = march(0);
  CHECK(*std::ranges::max_element(expected) > 10);
  for (const int step : {1, 2, 17}) {
    march(step);
    CHECK(march(0) == expected);
  }
}

}  // namespace
}  // namespace octomarch
