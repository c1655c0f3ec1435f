#include "octomarch/render/sky_pass.hpp"

#include <vector>

namespace octomarch {

template <class Real>
SkyPass<Real>::SkyPass(const Expressions& sky, const kernels::KernelTable<Real>& kernels, std::size_t size)
    : color(size), kernels_(kernels), direction_(size), ray_(size) {
  const std::vector<Real*> rows{color.x.data(), color.y.data(), color.z.data()};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Expressions::Slot& slot = sky.slots[i];
    if (slot.is_constant) std::fill_n(rows[i], size, clamped<Real>(slot.value));
  }
  if (sky.is_constant()) {
    kernels_.clamp_colors(color.view(), size);
  } else {
    channels_.emplace(sky.tape, varying_rows(sky, rows), nullptr, kernels);
  }
}

template <class Real>
void SkyPass<Real>::add(std::size_t ray, Real dx, Real dy, Real dz) {
  const std::size_t i = ray_.size();
  ray_.push(ray);
  direction_.x[i] = dx;
  direction_.y[i] = dy;
  direction_.z[i] = dz;
}

template <class Real>
void SkyPass<Real>::run(const bool& cancelled, StageStats& stage) {
  if (!channels_ || count() == 0) return;
  channels_->run(direction_.read(), direction_.read(), count(), cancelled, stage);
  kernels_.clamp_colors(color.view(), count());
}

template class SkyPass<float>;
template class SkyPass<double>;

}  // namespace octomarch
