// A tape ready to run: as kernels see it, with the memory it runs in. One per worker and use, after compilation and before
// any kernel.
#pragma once

#include <cstdint>
#include <vector>

#include "octomarch/kernels/dispatch.hpp"
#include "octomarch/program/axis_steps.hpp"
#include "octomarch/program/octree.hpp"
#include "octomarch/render/buffer.hpp"

namespace octomarch {

/// What a loaded tape is run for, which decides how much memory it needs.
enum class TapeUse : std::uint8_t { kValues, kGradients, kMarches };

template <class Real>
class LoadedTape {
 public:
  /// `tape` must outlive this. Memory for marches serves for values too. `octree`: whose parts are to be run too, or null.
  LoadedTape(const Tape& tape, TapeUse use, const Octree<Real>* octree = nullptr)
      : tape_(tape),
        table_(octree == nullptr ? nullptr : octree->table()),
        memory_(rows(octree == nullptr ? tape.registers : octree->registers(), use) * kernels::kLanes) {
    if (use == TapeUse::kGradients) axes_ = axis_steps(tape.code, tape.registers, tape.result());
    for (const NodePtr& image : tape.images) {
      const auto size = [&image](std::size_t i) { return static_cast<std::uint32_t>(image->parameter(i)); };
      images_.push_back({image->texels().data(), size(0), size(1), image->kind() == NodeKind::kGrid ? size(2) : 1});
    }
  }

  kernels::TapeView<Real> view() const {
    return {tape_.code.data(),
            tape_.code.size(),
            constants_of<Real>(tape_),
            tape_.registers,
            tape_.result(),
            images_.data(),
            axes()};
  }
  /// A part of the tape. Looking for coordinates would take longer than what it saves at the few points of a cell.
  kernels::TapeView<Real> view(const TapePart& part) const {
    const Real* const constants = part.has_table() ? table_ : constants_of<Real>(tape_);
    return {part.code, part.length, constants, part.registers, part.result, images_.data(), nullptr};
  }
  Real* memory() { return memory_.data(); }

 private:
  const AxisStep* axes() const { return axes_.empty() ? nullptr : axes_.data(); }

  static std::size_t rows(std::size_t file, TapeUse use) {
    switch (use) {
      case TapeUse::kValues: return file;
      case TapeUse::kGradients: return 4 * file;
      case TapeUse::kMarches: return 2 * file + kernels::kMarchRows;
    }
    return 0;
  }

  const Tape& tape_;
  const Real* const table_;
  std::vector<kernels::ImageView> images_;
  std::vector<AxisStep> axes_;  ///< empty but for gradients
  Buffer<Real> memory_;
};

/// Runs parts of a loaded tape for those who prune it.
template <class Real>
class KernelSampler final : public Sampler<Real> {
 public:
  /// Both must outlive this.
  KernelSampler(LoadedTape<Real>& tape, const kernels::KernelTable<Real>& kernels) : tape_(tape), kernels_(kernels) {}

  void compare(const TapePart& part, const SamplePoints<Real>& points, const Margin* margins, TakenAt* taken) override {
    kernels_.compare(tape_.view(part), tape_.memory(), {points.x, points.y, points.z}, points.radius, part.origins,
                     margins, taken);
  }

 private:
  LoadedTape<Real>& tape_;
  const kernels::KernelTable<Real>& kernels_;
};

}  // namespace octomarch
