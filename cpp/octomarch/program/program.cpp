#include "octomarch/program/program.hpp"

#include "octomarch/program/allocate.hpp"
#include "octomarch/program/analysis.hpp"
#include "octomarch/program/lower.hpp"

namespace octomarch {

Program::Program(NodePtr root) : root_(std::move(root)) {
  const FactTable facts = analyse(*root_);
  const Lowered lowered = lower(*root_, facts, LoweringOf::kDistance);
  distance_ = allocate(lowered.flow, lowered.distance);
  const FieldFacts& whole = facts.at(root_.get());
  lipschitz_ = whole.lipschitz;
  bounds_ = {whole.level.lo, whole.level.hi};
  if (whole.focus) focus_ = Aabb{whole.focus->lo, whole.focus->hi};
  if (focus_ && is_empty(*focus_)) focus_.reset();
}

const Attributes& Program::attributes() const {
  std::call_once(attributes_once_, [this] {
    Lowered lowered = lower(*root_, analyse(*root_), LoweringOf::kAttributes);
    attributes_.tape = allocate(lowered.flow, lowered.object);
    attributes_.objects = std::move(lowered.objects);
    attributes_.materials = std::move(lowered.materials);
  });
  return attributes_;
}

std::shared_ptr<const Program> compile(const NodePtr& root) { return std::make_shared<const Program>(root); }

}  // namespace octomarch
