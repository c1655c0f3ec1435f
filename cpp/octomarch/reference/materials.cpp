// Collects materials by a walk with an explicit stack; see materials.hpp.
#include "octomarch/reference/materials.hpp"

#include <array>
#include <map>
#include <set>
#include <span>
#include <utility>

#include "octomarch/graph/builder.hpp"

namespace octomarch::reference {
namespace {

/// Numbers materials by value, in order of first request.
class Numbering {
 public:
  explicit Numbering(std::vector<Material>& materials) : materials_(materials) {}

  int index_of(const Material& m) {
    const std::array key{m.color.x, m.color.y, m.color.z, m.roughness, m.specular, m.metallic};
    const auto [entry, added] = indices_.emplace(key, static_cast<int>(materials_.size()));
    if (added) materials_.push_back(m);
    return entry->second;
  }

 private:
  std::vector<Material>& materials_;
  std::map<std::array<double, 6>, int> indices_;
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
    if (node->children().empty()) {
      if (paint == nullptr) {
        table.index_of_unpainted = numbering.index_of(Material{});
      } else {
        table.index_of_paint.emplace(paint, numbering.index_of(material_of(*paint)));
      }
      continue;
    }
    const Node* const innermost = node->kind() == NodeKind::kPaint ? node : paint;
    const std::span<const NodePtr> children = node->children();
    for (auto child = children.rbegin(); child != children.rend(); ++child) work.emplace_back(child->get(), innermost);
  }
  return table;
}

}  // namespace octomarch::reference
