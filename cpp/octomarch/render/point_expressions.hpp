// Several numbers at points, from a tape that is run once for each: ids, what surfaces are made of, the colour of a sky. Long
// tapes are run by an octree's parts. Comes after cell_groups.hpp; surface_pass.hpp, material_pass.hpp and sky_pass.hpp use it.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "octomarch/render/cell_groups.hpp"
#include "octomarch/render/loaded_tape.hpp"

namespace octomarch {

template <class Real>
class PointExpressions {
 public:
  /// `rows[i]` is where the tape's i-th result goes. `octree`: of the tape, or null. The tape and `kernels` must outlive this.
  PointExpressions(const Tape& tape, std::vector<Real*> rows, std::shared_ptr<Octree<Real>> octree,
                   const kernels::KernelTable<Real>& kernels);
  PointExpressions(const PointExpressions&) = delete;

  /// `normals` are read where the tape has them among its inputs. Counts all of `stage`.
  void run(const kernels::Vectors<const Real>& points, const kernels::Vectors<const Real>& normals, std::size_t count,
           const bool& cancelled, StageStats& stage);

 private:
  void run_by_cells(const kernels::Vectors<const Real>& points, const kernels::Vectors<const Real>& normals,
                    std::size_t count, const bool& cancelled, StageStats& stage);
  void sort(const kernels::Vectors<const Real>& points, const kernels::Vectors<const Real>& normals, std::size_t count,
            const bool& cancelled, StageStats& stage);

  const kernels::KernelTable<Real>& kernels_;
  const Tape& code_;
  std::shared_ptr<Octree<Real>> octree_;
  LoadedTape<Real> tape_;
  std::vector<Real*> rows_;
  KernelSampler<Real> sampler_;
  std::optional<CellChoice<Real>> choice_;
  std::optional<CellGroups<Real>> groups_;
  VectorBuffer<Real> points_, normals_;  ///< sorted by cells, like the values
  std::vector<Buffer<Real>> values_;
};

/// Rows of those slots that differ from point to point, in the order of the tape's results. `rows`: of all slots.
template <class Real>
std::vector<Real*> varying_rows(const Expressions& expressions, const std::vector<Real*>& rows) {
  std::vector<Real*> varying(expressions.tape.results.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Expressions::Slot& slot = expressions.slots[i];
    if (!slot.is_constant) varying[slot.result] = rows[i];
  }
  return varying;
}

}  // namespace octomarch
