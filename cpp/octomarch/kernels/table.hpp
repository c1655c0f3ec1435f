// The kernel table of one ISA: what an isa_*.cpp hands to the dispatcher. Included once, last, by each of them.
#pragma once

#include "octomarch/kernels/balls.hpp"
#include "octomarch/kernels/camera.hpp"
#include "octomarch/kernels/chains.hpp"
#include "octomarch/kernels/compare.hpp"
#include "octomarch/kernels/cones.hpp"
#include "octomarch/kernels/finish.hpp"
#include "octomarch/kernels/limits.hpp"
#include "octomarch/kernels/march.hpp"
#include "octomarch/kernels/shade.hpp"
#include "octomarch/kernels/surface.hpp"

namespace octomarch::kernels::OCTOMARCH_ISA {

template <class Real>
constexpr KernelTable<Real> make_table() {
  return {
      .camera_rays = &camera_rays<Real>,
      .fit_cones = &fit_cones<Real>,
      .fit_small_cones = &fit_small_cones<Real>,
      .enter_balls = &enter_balls<Real>,
      .meet_planes = &meet_planes<Real>,
      .take_planes = &take_planes<Real>,
      .dim_by_planes = &dim_by_planes<Real>,
      .clip_rays = &clip_rays<Real>,
      .begin_march = &begin_march<Real>,
      .march = &march<Real>,
      .march_shadow = &march_shadow<Real>,
      .run_chain = &run_chain<Real>,
      .step_chain = &step_chain<Real>,
      .step_chain_shadow = &step_chain_shadow<Real>,
      .visibility = &visibility<Real>,
      .conclude = &conclude<Real>,
      .secants = &secants<Real>,
      .follow_secants = &follow_secants<Real>,
      .bisect = &bisect<Real>,
      .distance = &distance<Real>,
      .compare = &compare<Real>,
      .expressions = &expressions<Real>,
      .gradient = &gradient<Real>,
      .sample_around = &sample_around<Real>,
      .surface_points = &surface_points<Real>,
      .normalize = &normalize<Real>,
      .face_rays = &face_rays<Real>,
      .occlusion_points = &occlusion_points<Real>,
      .add_occlusion = &add_occlusion<Real>,
      .ambient_visibility = &ambient_visibility<Real>,
      .clamp_materials = &clamp_materials<Real>,
      .clamp_colors = &clamp_colors<Real>,
      .mirror_rays = &mirror_rays<Real>,
      .light_samples = &light_samples<Real>,
      .add_light = &add_light<Real>,
  };
}

extern const KernelTable<float> kTable32;
extern const KernelTable<double> kTable64;
const KernelTable<float> kTable32 = make_table<float>();
const KernelTable<double> kTable64 = make_table<double>();

}  // namespace octomarch::kernels::OCTOMARCH_ISA
