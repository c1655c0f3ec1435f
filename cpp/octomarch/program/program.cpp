#include "octomarch/program/program.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "octomarch/base/parallel.hpp"
#include "octomarch/graph/analysis.hpp"
#include "octomarch/program/allocate.hpp"
#include "octomarch/program/ball_tree.hpp"
#include "octomarch/program/lower.hpp"
#include "octomarch/program/lower_expression.hpp"
#include "octomarch/program/octree.hpp"
#include "octomarch/program/rounding.hpp"

namespace octomarch {
namespace {

Expressions expressions_of(const DataFlow& flow, std::span<const ValueId> values) {
  Expressions expressions;
  std::vector<ValueId> varying;
  for (const ValueId value : values) {
    const std::optional<double> constant = flow.constant_of(value);
    expressions.slots.push_back({constant.has_value(), constant.value_or(0.0), varying.size()});
    if (!constant) varying.push_back(value);
  }
  expressions.tape = allocate(flow, varying);
  return expressions;
}

}  // namespace

Program::Program(NodePtr root, const std::optional<Vec3>& anchor)
    : root_(std::move(root)), balls_(std::make_unique<BallTrees>()), octrees_(std::make_unique<ProgramOctrees>()) {
  const FactTable facts = analyse(*root_);
  const FieldFacts& whole = facts.at(root_.get());
  lipschitz_ = whole.lipschitz;
  bounds_ = {whole.level.lo, whole.level.hi};
  if (whole.focus) focus_ = Aabb{whole.focus->lo, whole.focus->hi};
  // what is too large for a number is as good as unbounded
  if (focus_ && (is_empty(*focus_) || !is_finite(focus_->lo) || !is_finite(focus_->hi))) focus_.reset();
  site_ = site_of(focus_, bounds_);
  if (anchor) site_ = counted_from(*anchor, site_);
  const Lowered lowered = lower(*root_, facts, LoweringOf::kDistance, site_.anchor);
  distance_ = allocate(lowered.flow, {&lowered.distance, 1});
  is_solid_ = root_->has_solid();
  if (!(site_.anchor == Vec3{})) site_.inner_offset = lowered.flow.farthest_move();
}

Program::~Program() = default;

const Attributes& Program::attributes() const {
  std::call_once(attributes_once_, [this] {
    Lowered lowered = lower(*root_, analyse(*root_), LoweringOf::kAttributes, site_.anchor);
    attributes_.tape = allocate(lowered.flow, {&lowered.object, 1});
    attributes_.objects = std::move(lowered.objects);
    attributes_.materials = std::move(lowered.materials);
  });
  return attributes_;
}

const Expressions& Program::surface() const {
  std::call_once(surface_once_, [this] {
    const Lowered lowered = lower(*root_, analyse(*root_), LoweringOf::kSurface, site_.anchor);
    surface_ = expressions_of(lowered.flow, lowered.slots);
  });
  return surface_;
}

const PlanesAndRest* Program::planes_and_rest() const {
  std::call_once(planes_once_, [this] {
    Separated separated = separate_planes(root_, site_.anchor);
    if (separated.planes.empty()) return;
    planes_ = PlanesAndRest{std::move(separated.planes), nullptr};
    if (separated.rest) planes_->rest = std::make_unique<const Program>(separated.rest, site_.anchor);
  });
  return planes_ ? &*planes_ : nullptr;
}

template <class Real>
const BallTree<Real>* Program::balls(const bool& cancelled) const {
  auto& balls = balls_->of<Real>();
  const std::scoped_lock lock(balls.mutex);
  if (!balls.is_made) {
    if (lipschitz_ == 1.0) balls.tree = BallTree<Real>::of(distance_, cancelled);
    balls.is_made = !is_set(cancelled);
    if (!balls.is_made) balls.tree.reset();
  }
  return balls.tree ? &*balls.tree : nullptr;
}

template const BallTree<float>* Program::balls(const bool& cancelled) const;
template const BallTree<double>* Program::balls(const bool& cancelled) const;

template <class Real>
const Doubt& Program::doubt() const {
  std::call_once(doubt_once_, [this] {
    double size = site_.focus ? 0.0 : 1.0;
    for (const Vec3& corner : site_.focus ? std::array{site_.focus->lo, site_.focus->hi} : std::array<Vec3, 2>{}) {
      size = std::max({size, std::fabs(corner.x), std::fabs(corner.y), std::fabs(corner.z)});
    }
    if (size == 0.0) size = 1.0;
    // constants have been folded in double, with roundings of their own: each stands for four of the tape's
    doubt_f32_ = doubt_of(distance_, 0x1p-24, size, lipschitz_);
    doubt_f64_ = doubt_of(distance_, 0x1p-51, size, lipschitz_);
  });
  return sizeof(Real) == 4 ? doubt_f32_ : doubt_f64_;
}

template const Doubt& Program::doubt<float>() const;
template const Doubt& Program::doubt<double>() const;

Expressions compile_expressions(std::span<const NodePtr> expressions) {
  DataFlow flow;
  ExpressionLowering lowering;
  std::vector<ValueId> values;
  for (const NodePtr& expression : expressions) {
    values.push_back(lowering.lower(*expression, {0, 1, 2, kNoNormal, kNoNormal, kNoNormal}, flow));
  }
  return expressions_of(flow, values);
}

std::shared_ptr<const Program> compile(const NodePtr& root) { return std::make_shared<const Program>(root); }

}  // namespace octomarch
