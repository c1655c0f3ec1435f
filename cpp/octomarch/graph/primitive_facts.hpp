// What is known of primitives' fields: where the analysis begins.
#pragma once

#include "octomarch/graph/analysis.hpp"

namespace octomarch {

/// Contract: a shape node without shapes as children.
FieldFacts primitive_facts(const Node& node);

}  // namespace octomarch
