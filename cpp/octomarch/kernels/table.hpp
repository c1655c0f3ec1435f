// The kernel table of one ISA: what an isa_*.cpp hands to the dispatcher. Included once, last, by each of them.
#pragma once

#include "octomarch/kernels/march.hpp"
#include "octomarch/kernels/shade.hpp"
#include "octomarch/kernels/surface.hpp"

namespace octomarch::kernels::OCTOMARCH_ISA {

template <class Real>
constexpr KernelTable<Real> make_table() {
  return {&camera_rays<Real>, &march<Real>,  &shadow<Real>,    &distance<Real>,      &gradient<Real>,
          &central_difference<Real>, &orient<Real>, &occlusion<Real>, &light_samples<Real>, &add_light<Real>};
}

extern const KernelTable<float> kTable32;
extern const KernelTable<double> kTable64;
const KernelTable<float> kTable32 = make_table<float>();
const KernelTable<double> kTable64 = make_table<double>();

}  // namespace octomarch::kernels::OCTOMARCH_ISA
