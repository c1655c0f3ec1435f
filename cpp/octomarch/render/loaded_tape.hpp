// A tape ready to run: as kernels see it, with the memory it runs in. One per worker and use, after compilation and before
// any kernel.
#pragma once

#include <cstdint>
#include <type_traits>
#include <vector>

#include "octomarch/kernels/dispatch.hpp"
#include "octomarch/program/prune.hpp"
#include "octomarch/render/buffer.hpp"

namespace octomarch {

/// What a loaded tape is run for, which decides how much memory it needs.
enum class TapeUse : std::uint8_t { kValues, kGradients, kMarches };

template <class Real>
class LoadedTape {
 public:
  /// `tape` must outlive this. Memory for marches serves for values too.
  LoadedTape(const Tape& tape, TapeUse use) : tape_(tape), memory_(rows(tape, use) * kernels::kLanes) {
    for (const NodePtr& image : tape.images) {
      images_.push_back({image->texels().data(), static_cast<std::uint32_t>(image->parameter(0)),
                         static_cast<std::uint32_t>(image->parameter(1))});
    }
  }

  kernels::TapeView<Real> view() const {
    return {tape_.code.data(), tape_.code.size(), constants(), tape_.registers, tape_.result(), images_.data()};
  }
  /// A part of the tape, which needs no more memory than the whole.
  kernels::TapeView<Real> view(const TapePart& part) const {
    return {part.code.data(), part.code.size(), constants(), part.registers, part.results.front(), images_.data()};
  }
  Real* memory() { return memory_.data(); }

 private:
  const Real* constants() const {
    if constexpr (std::is_same_v<Real, float>) {
      return tape_.constants_f32.data();
    } else {
      return tape_.constants.data();
    }
  }

  static std::size_t rows(const Tape& tape, TapeUse use) {
    const std::size_t file = tape.registers;
    switch (use) {
      case TapeUse::kValues: return file;
      case TapeUse::kGradients: return 4 * file;
      case TapeUse::kMarches: return 2 * file + kernels::kMarchRows;
    }
    return 0;
  }

  const Tape& tape_;
  std::vector<kernels::ImageView> images_;
  Buffer<Real> memory_;
};

/// The results of compiled expressions that differ from point to point, as the `expressions` kernel takes them: which
/// register goes to which row.
template <class Real>
class LoadedExpressions {
 public:
  /// `rows[i]` is where slot i goes. Rows of constant slots are left alone. `expressions` must outlive this.
  LoadedExpressions(const Expressions& expressions, const std::vector<Real*>& rows)
      : uses_normal_(expressions.uses_normal()), tape_(expressions.tape, TapeUse::kValues) {
    for (std::size_t i = 0; i < expressions.slots.size(); ++i) {
      const Expressions::Slot& slot = expressions.slots[i];
      if (slot.is_constant) continue;
      results_.push_back(expressions.tape.results[slot.result]);
      rows_.push_back(rows[i]);
    }
  }

  bool uses_normal() const { return uses_normal_; }

  void run(const kernels::KernelTable<Real>& kernels, const kernels::Vectors<const Real>& points,
           const kernels::Vectors<const Real>& normals, std::size_t count, const bool& cancelled) {
    kernels.expressions(tape_.view(), tape_.memory(), points, uses_normal_ ? &normals : nullptr, count, &cancelled,
                        results_.data(), results_.size(), rows_.data());
  }

 private:
  bool uses_normal_;
  LoadedTape<Real> tape_;
  std::vector<std::uint16_t> results_;
  std::vector<Real*> rows_;
};

}  // namespace octomarch
