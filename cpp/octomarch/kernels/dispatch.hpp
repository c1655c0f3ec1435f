// Which kernels run: every ISA that was compiled in and that this machine has, best first. Chosen at run time, by name
// or by the environment variable OCTOMARCH_ISA.
#pragma once

#include <span>
#include <string_view>

#include "octomarch/kernels/api.hpp"

namespace octomarch::kernels {

struct Isa {
  std::string_view name;
  const KernelTable<float>* table32;
  const KernelTable<double>* table64;

  template <class Real>
  const KernelTable<Real>& table() const {
    if constexpr (sizeof(Real) == sizeof(float)) {
      return *table32;
    } else {
      return *table64;
    }
  }
};

/// What this machine can run, best first; the last is always "scalar".
std::span<const Isa> available_isas();

/// The ISA of that name; for "" the one that OCTOMARCH_ISA names, or the best. Throws ArgumentError naming "isa" (or
/// "OCTOMARCH_ISA"), the value and what there is.
const Isa& find_isa(std::string_view name);

}  // namespace octomarch::kernels
