#include "octomarch/program/planes.hpp"

#include <utility>

#include "octomarch/graph/builder.hpp"
#include "octomarch/program/placement.hpp"

namespace octomarch {

namespace {

constexpr int kDeepest = 64;
/// Visits, after which all that is left stays as it is: what is shared again and again may have no end.
constexpr int kMost = 1 << 20;
/// Each costs every ray; an octree makes more of many.
constexpr std::size_t kMostPlanes = 16;

class Separation {
 public:
  explicit Separation(std::vector<Plane>& planes) : planes_(planes) {}

  /// What is left of a shape once its planes are out: the shape itself where it has none.
  NodePtr rest_of(const NodePtr& shape, const Placement& placement, int depth) {
    if (depth > kDeepest || ++visits_ > kMost) return shape;
    switch (shape->kind()) {
      case NodeKind::kPlane: planes_.push_back(placed_plane(*shape, placement)); return nullptr;
      case NodeKind::kUnion: return shape->parameter(0) == 0.0 ? rest_of_union(shape, placement, depth) : shape;
      case NodeKind::kPaint: {
        const NodePtr& painted = shape->children().front();
        NodePtr rest = rest_of(painted, placement, depth + 1);
        return rest == painted ? shape : rest;
      }
      case NodeKind::kTranslate:
      case NodeKind::kRotate:
      case NodeKind::kScale: {
        const NodePtr& moved = shape->children().front();
        const NodePtr rest = rest_of(moved, child_placement(placement, *shape), depth + 1);
        if (rest == moved) return shape;
        return rest ? intern(shape->kind(), {shape->parameters().begin(), shape->parameters().end()}, {rest}) : nullptr;
      }
      default: return shape;
    }
  }

 private:
  NodePtr rest_of_union(const NodePtr& shape, const Placement& placement, int depth) {
    std::vector<NodePtr> left;
    bool is_whole = true;
    for (const NodePtr& operand : shape->children()) {
      NodePtr rest = rest_of(operand, placement, depth + 1);
      is_whole = is_whole && rest == operand;
      if (rest) left.push_back(std::move(rest));
    }
    if (is_whole) return shape;
    if (left.empty()) return nullptr;
    return left.size() == 1 ? left.front() : combine(NodeKind::kUnion, std::move(left), 0.0);
  }

  std::vector<Plane>& planes_;
  int visits_ = 0;
};

}  // namespace

Separated separate_planes(const NodePtr& root, const Vec3& anchor) {
  Separated result;
  Placement world;
  world.offset = Vec3{} - anchor;
  result.rest = Separation(result.planes).rest_of(root, world, 0);
  if (result.planes.size() > kMostPlanes) return {{}, root};
  return result;
}

}  // namespace octomarch
