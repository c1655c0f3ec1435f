// Collects materials by a walk with an explicit stack; see materials.hpp.
#include "octomarch/reference/materials.hpp"

#include <array>
#include <map>
#include <set>
#include <span>
#include <utility>

#include "octomarch/graph/builder.hpp"
#include "octomarch/reference/operands.hpp"

namespace octomarch::reference {
namespace {

/// Numbers materials by content, in order of first request.
class Numbering {
 public:
  explicit Numbering(std::vector<Material>& materials) : materials_(materials) {}

  int index_of(const Material& material) {
    const auto [entry, added] = indices_.emplace(material.slots, static_cast<int>(materials_.size()));
    if (added) materials_.push_back(material);
    return entry->second;
  }

 private:
  std::vector<Material>& materials_;
  std::map<std::array<NodePtr, Material::kSlots>, int> indices_;
};

}  // namespace

MaterialTable collect_materials(const Node& root) {
  using Visit = std::pair<const Node*, const Node*>;  // a node, and the innermost paint above it or null
  MaterialTable table;
  Numbering numbering(table.materials);
  std::set<Visit> seen;
  std::vector<Visit> work{{&root, nullptr}};
  while (!work.empty()) {
    const auto [node, paint] = work.back();
    work.pop_back();
    if (!seen.emplace(node, paint).second) continue;
    const std::span<const NodePtr> shapes = operand_shapes(*node);
    if (shapes.empty()) {
      if (paint == nullptr) {
        table.index_of_unpainted = numbering.index_of(default_material());
      } else {
        table.index_of_paint.emplace(paint, numbering.index_of(material_of(*paint)));
      }
      continue;
    }
    const Node* const innermost = node->kind() == NodeKind::kPaint ? node : paint;
    for (auto shape = shapes.rbegin(); shape != shapes.rend(); ++shape) work.emplace_back(shape->get(), innermost);
  }
  return table;
}

}  // namespace octomarch::reference
