// What the reference takes from the compiler, since all marchers have to agree on it. Queries and pictures come after it.
#pragma once

#include "octomarch/graph/scene.hpp"
#include "octomarch/graph/site.hpp"

namespace octomarch::reference {

struct Compiled {
  double lipschitz;
  Site site;
  Doubt doubt;  ///< for the precision that is asked for
};

}  // namespace octomarch::reference
