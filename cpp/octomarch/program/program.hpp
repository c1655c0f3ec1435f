// The compiled form of a shape: flat tapes with constants folded, and what is known of the field as a whole. Made by
// compile() from the node graph; executed by kernels/, listed by listing.cpp. Lowering comes before, marching after.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "octomarch/base/types.hpp"
#include "octomarch/graph/node.hpp"
#include "octomarch/graph/scene.hpp"
#include "octomarch/graph/site.hpp"
#include "octomarch/program/instruction.hpp"
#include "octomarch/program/planes.hpp"

namespace octomarch {

/// Straight-line code over registers. Registers 0, 1, 2 hold x, y, z at the start; where there are six inputs, 3, 4, 5
/// hold the normal.
struct Tape {
  std::vector<Instruction> code;
  std::vector<double> constants;
  std::vector<float> constants_f32;  ///< the same, rounded once
  std::vector<NodePtr> images;       ///< images and grids that instructions look into, by number
  std::uint32_t inputs = 3;
  std::uint32_t registers = 3;
  std::vector<std::uint16_t> results;  ///< registers
  std::uint16_t result() const { return results.front(); }
};

/// A tape's constants, in Real.
template <class Real>
const Real* constants_of(const Tape& tape) {
  if constexpr (std::is_same_v<Real, float>) {
    return tape.constants_f32.data();
  } else {
    return tape.constants.data();
  }
}

/// What the hit record's object_id stands for.
struct Object {
  NodeKind kind;
  std::int32_t material;  ///< index into Attributes::materials
};

/// The second program, run once per hit: its result is the object id.
struct Attributes {
  Tape tape;
  std::vector<Object> objects;      ///< distinct placed primitives, in order of first appearance, depth first
  std::vector<Material> materials;  ///< distinct materials, in order of first appearance over the primitives
};

/// Several numbers at a point: of a surface, what it is made of; of a sky, its colour. What is the same everywhere is no
/// instruction and no result.
struct Expressions {
  struct Slot {
    bool is_constant = true;
    double value = 0.0;      ///< of a constant slot
    std::size_t result = 0;  ///< index into tape.results of the others
  };
  Tape tape;
  std::vector<Slot> slots;
  bool uses_normal() const { return tape.inputs == 6; }
  bool is_constant() const { return tape.results.empty(); }
};

struct ProgramOctrees;
template <class Real>
class BallTree;
struct BallTrees;
class Program;

/// A shape's planes, and the program of all the rest, which has the same anchor; null where nothing is left.
struct PlanesAndRest {
  std::vector<Plane> planes;
  std::unique_ptr<const Program> rest;
};

/// Immutable and safe to share between threads; the attributes are compiled when first asked for.
class Program {
 public:
  /// Where `anchor` is given, tapes count their coordinates from there, else from what site_of() says.
  explicit Program(NodePtr root, const std::optional<Vec3>& anchor = std::nullopt);
  ~Program();

  const NodePtr& root() const { return root_; }

  const Tape& distance() const { return distance_; }
  const Attributes& attributes() const;
  /// What the surface is made of at a point: Material's slots, blended across smooth operators by the weights with which
  /// their operands' slopes count. A third program, run once per hit.
  const Expressions& surface() const;
  /// Has the field no distances in some part (om.solid)? Then only marches of fixed steps find its surface.
  bool is_solid() const { return is_solid_; }
  /// |f(p) − f(q)| ≤ lipschitz·‖p − q‖: marchers divide by it.
  double lipschitz() const { return lipschitz_; }
  /// What certified marches in Real allow for; its offset is infinite where the program has operators of which no bound of
  /// the roundings is known.
  template <class Real>
  const Doubt& doubt() const;
  /// Where the shape is. Tapes see points from its anchor.
  const Site& site() const { return site_; }
  /// Holds every point of the solid; infinite where the solid may be. In the world, like the focus.
  const Aabb& bounds() const { return bounds_; }
  /// The bounded part of the shape (a floor leaves it alone); nothing when no part is bounded.
  const std::optional<Aabb>& focus() const { return focus_; }
  /// The field as planes and a rest, of which it is the least; null where it has no planes. Compiled when first
  /// asked for.
  const PlanesAndRest* planes_and_rest() const;
  /// Where a field that is nothing but balls may have a surface; null where it is anything else. Made when first asked for,
  /// unless that is cancelled.
  template <class Real>
  const BallTree<Real>* balls(const bool& cancelled) const;
  /// Octrees of the tapes, which stay as long as the program.
  ProgramOctrees& octrees() const { return *octrees_; }

 private:
  NodePtr root_;
  Tape distance_;
  double lipschitz_;
  Aabb bounds_;
  std::optional<Aabb> focus_;
  Site site_;
  bool is_solid_;
  mutable std::once_flag attributes_once_;
  mutable Attributes attributes_;
  mutable std::once_flag surface_once_;
  mutable Expressions surface_;
  mutable std::once_flag doubt_once_;
  mutable Doubt doubt_f32_, doubt_f64_;
  mutable std::once_flag planes_once_;
  mutable std::optional<PlanesAndRest> planes_;
  std::unique_ptr<BallTrees> balls_;
  std::unique_ptr<ProgramOctrees> octrees_;
};

/// Compiles expressions of a point (and no normal), such as a sky's.
Expressions compile_expressions(std::span<const NodePtr> expressions);

/// Compiles a shape. O(n log n) in its distinct placed nodes, constant stack. Throws SceneError when it would need
/// more than 65,535 registers.
std::shared_ptr<const Program> compile(const NodePtr& root);

/// The program as text: one line an instruction, then bounds and Lipschitz bound.
std::string listing(const Program& program);

}  // namespace octomarch
