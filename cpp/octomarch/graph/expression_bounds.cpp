// Bounds of an expression over a box: its nodes in order, evaluated over pieces of the box, the steepest cut first.
#include "octomarch/graph/expression_bounds.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <queue>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

#include "octomarch/graph/slopes.hpp"

namespace octomarch {
namespace {

constexpr std::size_t kMostPieces = 512;
constexpr std::size_t kMostEvaluations = 100'000;  ///< of nodes: what takes some milliseconds
constexpr double kEnough = 0.99;                   ///< twice as many pieces must tighten the bound to less than this

/// What texels of one channel say of bilinear lookups: their range, and the steepest rise between neighbours.
struct TexelFacts {
  Interval value;
  Interval across;  ///< derivative by u
  Interval down;    ///< derivative by v
};

/// c·(operand)², or c alone.
struct SquareTerm {
  std::optional<std::size_t> operand;
  double factor;
};

struct Step {
  const Node* node;
  std::vector<std::size_t> operands;  ///< steps before this one
  std::vector<SquareTerm> squares;    ///< that a product is, or of whose sum a square root is taken
  TexelFacts texel;
};

using Steps = std::vector<Step>;
using Values = std::vector<Slopes>;
using Piece = std::array<Interval, 3>;

TexelFacts texel_facts(const Node& texel) {
  const Node& image = texel.child(0);
  const auto channel = static_cast<std::size_t>(texel.parameter(0));
  const bool repeats_u = texel.parameter(1) != 0.0;
  const bool repeats_v = texel.parameter(1) == 1.0;
  const auto width = static_cast<std::size_t>(image.parameter(0));
  const auto height = static_cast<std::size_t>(image.parameter(1));
  const auto at = [&](std::size_t column, std::size_t row) {
    return static_cast<double>(image.texels()[3 * (row % height * width + column % width) + channel]);
  };
  Interval value = at(0, 0);
  double across = 0.0;
  double down = 0.0;
  for (std::size_t row = 0; row < height; ++row) {
    for (std::size_t column = 0; column < width; ++column) {
      const double here = at(column, row);
      value = hull(value, here);
      if (repeats_u || column + 1 < width)
        across = std::max(across, (Interval(at(column + 1, row)) - here).magnitude());
      if (repeats_v || row + 1 < height) down = std::max(down, (Interval(at(column, row + 1)) - here).magnitude());
    }
  }
  return {value, Interval{-across, across} * static_cast<double>(width),
          Interval{-down, down} * static_cast<double>(height)};
}

bool is_constant(const Step& step) { return step.node->kind() == NodeKind::kConstant; }

/// The product a·b as c·b², if it is one: of b·b, (−b)·b or (c·b)·b, as -x * x and c * x * x are read.
std::optional<SquareTerm> square_term(const Steps& steps, std::size_t a, std::size_t b) {
  if (a == b) return SquareTerm{b, 1.0};
  const Step& first = steps[a];
  if (first.node->kind() == NodeKind::kNegate && first.operands[0] == b) return SquareTerm{b, -1.0};
  if (first.node->kind() != NodeKind::kMultiply || first.operands[1] != b) return std::nullopt;
  const Step& factor = steps[first.operands[0]];
  if (!is_constant(factor)) return std::nullopt;
  return SquareTerm{b, factor.node->parameter(0)};
}

/// The terms of a sum of squares; none where the step is no such sum, or one of too many terms to be a length.
std::vector<SquareTerm> squares_in(const Steps& steps, std::size_t sum) {
  constexpr std::size_t kMostTerms = 16;
  std::vector<SquareTerm> terms;
  std::vector<std::size_t> work{sum};
  while (!work.empty()) {
    const std::size_t i = work.back();
    work.pop_back();
    const Step& step = steps[i];
    if (step.node->kind() == NodeKind::kAdd) {
      work.insert(work.end(), step.operands.begin(), step.operands.end());
    } else if (is_constant(step)) {
      terms.push_back({std::nullopt, step.node->parameter(0)});
    } else if (step.node->kind() == NodeKind::kMultiply && !step.squares.empty()) {
      terms.push_back(step.squares.front());
    } else {
      return {};
    }
    if (!terms.empty() && terms.back().factor < 0.0) return {};
    if (terms.size() + work.size() > kMostTerms) return {};
  }
  return terms;
}

/// Nodes of expressions, each once, operands before what is made of them.
class StepList {
 public:
  /// Adds what is not there yet of the expression.
  void add(const Node& root) {
    std::vector<std::pair<const Node*, bool>> stack{{&root, false}};
    while (!stack.empty()) {
      const auto [node, operands_done] = stack.back();
      stack.pop_back();
      if (known_.contains(node)) continue;
      if (operands_done) {
        add_one(*node);
        continue;
      }
      stack.emplace_back(node, true);
      for (const NodePtr& child : node->children()) {
        if (is_expression(child->kind())) stack.emplace_back(child.get(), false);
      }
    }
  }

  const Steps& steps() const { return steps_; }
  std::size_t place_of(const Node& expression) const { return known_.at(&expression); }

 private:
  /// Contract: the node's operands are there.
  void add_one(const Node& node) {
    Step step{&node, {}, {}, {}};
    for (const NodePtr& child : node.children()) {
      if (is_expression(child->kind())) step.operands.push_back(known_.at(child.get()));
    }
    if (node.kind() == NodeKind::kSquareRoot) step.squares = squares_in(steps_, step.operands[0]);
    if (node.kind() == NodeKind::kMultiply) {
      if (const auto term = square_term(steps_, step.operands[0], step.operands[1])) step.squares = {*term};
    }
    if (node.kind() == NodeKind::kTexel) step.texel = texels_of(node);
    known_.emplace(&node, steps_.size());
    steps_.push_back(std::move(step));
  }

  /// An image is large, and many lookups share it.
  const TexelFacts& texels_of(const Node& texel) {
    const std::tuple key{&texel.child(0), texel.parameter(0), texel.parameter(1)};
    const auto entry = texels_.find(key);
    return entry != texels_.end() ? entry->second : texels_.emplace(key, texel_facts(texel)).first->second;
  }

  Steps steps_;
  std::unordered_map<const Node*, std::size_t> known_;
  std::map<std::tuple<const Node*, double, double>, TexelFacts> texels_;
};

Slopes coordinate_over(const Node& node, const Piece& piece) {
  const auto index = static_cast<std::size_t>(node.parameter(0));
  if (index > 2) return jumping({-1.0, 1.0});  // of the normal nothing else is known
  Slopes result{piece[index], {}, 1.0};
  result.partial[index] = 1.0;
  return result;
}

Slopes square_over(const SquareTerm& term, const Values& values) {
  const Slopes& a = values[*term.operand];
  const Interval factor = term.factor;
  return chained(factor * square(a.value), Interval(2.0) * factor * a.value, a);
}

/// A length: whatever the direction, its slope by its components is 1, at 0 too.
Slopes length_over(const Step& step, const Values& values, const Interval& value) {
  std::vector<Slopes> scaled;
  for (const SquareTerm& term : step.squares) {
    if (!term.operand) continue;
    const Interval root = sqrt(Interval(term.factor));
    const Slopes& a = values[*term.operand];
    scaled.push_back(chained(root * a.value, root, a));
  }
  std::vector<Weighted> operands;
  for (const Slopes& a : scaled) operands.push_back({&a, overlap(a.value / value, {-1.0, 1.0})});
  return chained(value, 1.0, operands);
}

Slopes comparison(bool holds, bool fails) { return holds || fails ? level(holds ? 1.0 : 0.0) : jumping({0.0, 1.0}); }

Slopes where_over(const Slopes& condition, const Slopes& a, const Slopes& b) {
  if (!condition.value.contains(0.0)) return a;
  if (condition.value == Interval(0.0)) return b;
  const Interval value = hull(a.value, b.value);
  return value.is_point() ? level(value) : jumping(value);
}

Slopes noise_over(const Slopes& x, const Slopes& y, const Slopes& z) {
  const Interval slope{-kNoiseSlope, kNoiseSlope};
  const std::array<Weighted, 3> operands{{{&x, slope}, {&y, slope}, {&z, slope}}};
  return chained({-kNoiseValue, kNoiseValue}, kNoiseSlope, operands);
}

Slopes texel_over(const TexelFacts& texel, const Slopes& u, const Slopes& v) {
  const std::array<Weighted, 2> operands{{{&u, texel.across}, {&v, texel.down}}};
  return chained(texel.value, kInfinity, operands);
}

/// Is the function no number for some x in the interval?
bool may_be_undefined(NodeKind kind, const Interval& x) {
  if (kind == NodeKind::kSquareRoot || kind == NodeKind::kLogarithm) return x.lo() < 0.0;
  if (kind == NodeKind::kArcSine || kind == NodeKind::kArcCosine) return x.lo() < -1.0 || x.hi() > 1.0;
  return false;
}

/// Functions of one number.
Slopes function_over(NodeKind kind, const Slopes& a) {
  const Interval& x = a.value;
  if (may_be_undefined(kind, x)) return undefined();
  switch (kind) {
    case NodeKind::kNegate: return chained(-x, -1.0, a);
    case NodeKind::kAbsolute:
      return chained(abs(x), x.lo() >= 0.0 ? 1.0 : x.hi() <= 0.0 ? -1.0 : Interval{-1.0, 1.0}, a);
    case NodeKind::kSquareRoot: return chained(sqrt(x), Interval(0.5) / sqrt(x), a);
    case NodeKind::kFloor: return floor(x).is_point() ? level(floor(x)) : jumping(floor(x));
    case NodeKind::kExponential: return chained(exp(x), exp(x), a);
    case NodeKind::kLogarithm: return chained(log(x), Interval(1.0) / x, a);
    case NodeKind::kSine: return chained(sin(x), cos(x), a);
    case NodeKind::kCosine: return chained(cos(x), -sin(x), a);
    case NodeKind::kTangent: return chained(tan(x), Interval(1.0) + square(tan(x)), a);
    case NodeKind::kArcSine: return chained(asin(x), Interval(1.0) / sqrt(Interval(1.0) - square(x)), a);
    case NodeKind::kArcCosine: return chained(acos(x), Interval(-1.0) / sqrt(Interval(1.0) - square(x)), a);
    default: return chained(atan(x), Interval(1.0) / (Interval(1.0) + square(x)), a);
  }
}

/// Functions of two numbers.
Slopes function_over(NodeKind kind, const Slopes& a, const Slopes& b) {
  switch (kind) {
    case NodeKind::kAdd: return a + b;
    case NodeKind::kSubtract: return a - b;
    case NodeKind::kMultiply: return a * b;
    case NodeKind::kDivide: return a / b;
    case NodeKind::kMinimum:
      if (a.value.hi() <= b.value.lo()) return a;
      if (b.value.hi() <= a.value.lo()) return b;
      return either(min(a.value, b.value), a, b);
    case NodeKind::kMaximum:
      if (a.value.lo() >= b.value.hi()) return a;
      if (b.value.lo() >= a.value.hi()) return b;
      return either(max(a.value, b.value), a, b);
    case NodeKind::kModulo: return mod(a, b);
    case NodeKind::kPower: return pow(a, b);
    case NodeKind::kArcTangent2: return atan2(a, b);
    case NodeKind::kLess: return comparison(a.value.hi() < b.value.lo(), a.value.lo() >= b.value.hi());
    default: return comparison(a.value.hi() <= b.value.lo(), a.value.lo() > b.value.hi());
  }
}

Slopes step_over(const Step& step, const Values& values, const Piece& piece) {
  const NodeKind kind = step.node->kind();
  if (kind == NodeKind::kCoordinate) return coordinate_over(*step.node, piece);
  if (kind == NodeKind::kConstant) return level(step.node->parameter(0));
  const auto operand = [&](std::size_t i) -> const Slopes& { return values[step.operands[i]]; };
  if (kind == NodeKind::kWhere) return where_over(operand(0), operand(1), operand(2));
  if (kind == NodeKind::kNoise) return noise_over(operand(0), operand(1), operand(2));
  if (kind == NodeKind::kTexel) return texel_over(step.texel, operand(0), operand(1));
  if (kind == NodeKind::kMultiply && !step.squares.empty()) return square_over(step.squares.front(), values);
  if (step.operands.size() == 2) return function_over(kind, operand(0), operand(1));
  if (!step.squares.empty()) return length_over(step, values, sqrt(operand(0).value));
  return function_over(kind, operand(0));
}

/// Evaluates the steps from `first` on; those before it have their values.
void evaluate(const Steps& steps, const Piece& piece, Values& values, std::size_t first = 0) {
  values.resize(steps.size());
  for (std::size_t i = first; i < steps.size(); ++i) {
    values[i] = step_over(steps[i], values, piece);
    const bool constant =
        std::ranges::all_of(steps[i].operands, [&](std::size_t j) { return values[j].is_constant(); });
    if (constant && !steps[i].operands.empty())
      values[i] = level(values[i].value);  // whatever the function does elsewhere
  }
}

/// A part of the box, and the expression over it.
struct Bounded {
  Piece piece;
  Slopes result;
  double slope;

  friend bool operator<(const Bounded& a, const Bounded& b) { return a.slope < b.slope; }
};

/// The box on the axes that the expression looks at, one point on the others.
Piece piece_of(const Steps& steps, const Aabb& box) {
  Piece piece;
  for (const Step& step : steps) {
    if (step.node->kind() != NodeKind::kCoordinate) continue;
    if (step.node->parameter(0) == 0.0) piece[0] = {box.lo.x, box.hi.x};
    if (step.node->parameter(0) == 1.0) piece[1] = {box.lo.y, box.hi.y};
    if (step.node->parameter(0) == 2.0) piece[2] = {box.lo.z, box.hi.z};
  }
  return piece;
}

std::pair<Piece, Piece> halves(const Piece& piece) {
  const auto width = [](const Interval& a) { return a.hi() - a.lo(); };
  const auto widest = std::ranges::max_element(piece, {}, width);
  const double middle = 0.5 * widest->lo() + 0.5 * widest->hi();
  std::pair<Piece, Piece> result{piece, piece};
  const auto axis = static_cast<std::size_t>(widest - piece.begin());
  result.first[axis] = {widest->lo(), middle};
  result.second[axis] = {middle, widest->hi()};
  return result;
}

}  // namespace

ExpressionBounds expression_bounds(const Node& expression, const Aabb& box) {
  StepList list;
  list.add(expression);
  const Steps& steps = list.steps();
  Values values;
  const auto bounded = [&](const Piece& piece) {
    evaluate(steps, piece, values);
    return Bounded{piece, values.back(), steepness(values.back())};
  };
  const Piece whole = piece_of(steps, box);
  std::priority_queue<Bounded> pieces;
  pieces.push(bounded(whole));
  Interval value = pieces.top().result.value;
  const bool is_bounded = std::ranges::all_of(whole, [](const Interval& a) { return std::isfinite(a.hi() - a.lo()); });
  const std::size_t most = is_bounded ? std::min(kMostPieces, kMostEvaluations / (2 * steps.size())) : 1;
  double before = kInfinity;
  for (std::size_t next = 16; pieces.size() < most; next *= 2) {
    while (pieces.size() < std::min(next, most)) {
      const auto [first, second] = halves(pieces.top().piece);
      pieces.pop();
      pieces.push(bounded(first));
      pieces.push(bounded(second));
    }
    if (pieces.top().slope > kEnough * before) break;
    before = pieces.top().slope;
  }
  const double slope = pieces.top().slope;
  value = pieces.top().result.value;
  for (; !pieces.empty(); pieces.pop()) value = hull(value, pieces.top().result.value);
  return {value.lo(), value.hi(), slope};
}

struct Amplitudes::State {
  StepList list;
  Values values;
};

Amplitudes::Amplitudes() : state_(std::make_unique<State>()) {}
Amplitudes::~Amplitudes() = default;

double Amplitudes::of(const Node& expression) {
  const std::size_t first = state_->list.steps().size();
  state_->list.add(expression);
  evaluate(state_->list.steps(), {Interval::whole(), Interval::whole(), Interval::whole()}, state_->values, first);
  return state_->values[state_->list.place_of(expression)].value.magnitude();
}

}  // namespace octomarch
