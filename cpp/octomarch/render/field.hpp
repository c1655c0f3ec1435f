// A program's field as the stages of a picture or a query ask for it: at many points, and along many rays. By its tape, or
// where it is long, by an octree's parts of it. One for each worker, with the memory that it takes. Comes after loaded_tape.hpp
// and before every stage.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "octomarch/program/ball_tree.hpp"
#include "octomarch/render/cell_groups.hpp"
#include "octomarch/render/cell_march.hpp"
#include "octomarch/render/loaded_tape.hpp"
#include "octomarch/render/rays.hpp"
#include "octomarch/render/stages.hpp"

namespace octomarch {

/// What all workers of a picture or a query share of a program's field.
template <class Real>
struct SharedField {
  const Program* program;
  std::shared_ptr<Octree<Real>> octree;  ///< of program->distance(), or null
  const PlanesAndRest* split = nullptr;  ///< where rays meet its planes in closed form, and march the rest
  std::shared_ptr<Octree<Real>> rest_octree;
  bool clips_to_bounds = false;  ///< are rays only marched within them?
};

/// `many`: is there enough to do for an octree? It is made where it is worth its cost, and not for fixed steps, which take solids
/// without distances.
template <class Real>
SharedField<Real> share_field(const Program& program, const March& march, bool many);

template <class Real>
class Field {
 public:
  /// `size`: points or rays at the most in one call. `shared` must outlive this.
  Field(const SharedField<Real>& shared, const kernels::KernelTable<Real>& kernels, std::size_t size);

  Field(const Field&) = delete;

  const Program& program() const { return program_; }
  /// An octree of another tape of the program; null where the field has none.
  std::shared_ptr<Octree<Real>> octree_of(const Tape& tape, Octrees& octrees) const;

  /// Distances at points; NaN at NaN points. Counts all of `stage` but how many evaluations those were that matter.
  void distance(const kernels::Vectors<const Real>& points, std::size_t count, const bool& cancelled, Real* out,
                StageStats& stage);
  /// Exact gradients at points.
  void gradient(const kernels::Vectors<const Real>& points, std::size_t count, const bool& cancelled,
                const kernels::Vectors<Real>& out, StageStats& stage);
  /// Directions across the surface from the field around points; see the kernel.
  void sample_around(const kernels::Vectors<const Real>& points, std::size_t count,
                     const kernels::StencilView<Real>& stencil, const bool& cancelled,
                     const kernels::Vectors<Real>& out, StageStats& stage);

  /// Sets `start` of rays in whole blocks to where none of their neighbours has met anything yet, by marching cones about these,
  /// and `end` to where all of a block are past the solid's bounds, and each has met the first plane.
  void advance_together(const kernels::RayView<Real>& rays, const kernels::MarchParameters<Real>& parameters,
                        RayBatch<Real>& batch, StageStats& stage);
  /// Fills t and status of `batch`, and `steps` (exactly rays.count long) unless it is null. `advanced`: together, before.
  void march(const kernels::RayView<Real>& rays, const kernels::MarchParameters<Real>& parameters,
             RayBatch<Real>& batch, std::int32_t* steps, StageStats& stage, bool advanced = false);
  /// How much of each ray's far end is seen from its origin.
  void cast_shadows(const kernels::RayView<Real>& rays, const kernels::MarchParameters<Real>& parameters,
                    RayBatch<Real>& batch, Real* visibility, StageStats& stage);

 private:
  using Rays = kernels::RayView<Real>;
  using Parameters = kernels::MarchParameters<Real>;
  using State = kernels::MarchState<Real>;

  // of a field without planes, between the ends of rays that have been limited:
  void march_limited(const Rays& rays, const Parameters& parameters, RayBatch<Real>& batch, std::int32_t* steps,
                     StageStats& stage);
  void cast_limited_shadows(const Rays& rays, const Parameters& parameters, RayBatch<Real>& batch, Real* visibility,
                            StageStats& stage);
  void march_nothing(Rays rays, const Parameters& parameters, RayBatch<Real>& batch, std::int32_t* steps);
  void meet_planes(const Rays& rays, const Parameters& parameters, RayBatch<Real>& batch);
  static Rays ending_at(const Buffer<Real>& end, Rays rays);
  Rays clipped(Rays rays, Real widening, const Parameters& parameters, RayBatch<Real>& batch) const;
  Aabb bounds_on_grid() const;
  bool has_bounds() const {
    return clips_to_bounds_ && is_bounded(program_.site().bounds) && !is_empty(program_.site().bounds);
  }
  kernels::PlanesView<Real> planes() const { return {planes_.data(), planes_.size() / 4}; }
  /// Marches until all rays have ended, by the kernels run(tape, memory, rays, parameters, region, state) and
  /// step(chain, block, live, parameters).
  template <class Run, class Step>
  void march_all(const Rays& rays, const Parameters& parameters, const State& state, StageStats& stage, Run&& run,
                 Step&& step);
  /// By the kernels for what is no shadow ray.
  void march_states(const Rays& rays, const Parameters& parameters, const State& state, StageStats& stage);
  /// Runs f(tape, group) for the cell of each group of points, whose coordinates are in sorted_points_.
  template <class Function>
  void for_each_group(const kernels::Vectors<const Real>& points, std::size_t count, Few few, const bool& cancelled,
                      LoadedTape<Real>& tape, StageStats& stage, Function&& f);
  void distance_by_groups(const kernels::Vectors<const Real>& points, std::size_t count, Few few, const bool& cancelled,
                          Real* out, StageStats& stage);
  void distance_alone(const kernels::Vectors<const Real>& points, const bool& cancelled, Real* out, StageStats& stage);
  void follow_secants(const kernels::RayView<Real>& rays, const kernels::MarchParameters<Real>& parameters,
                      const kernels::MarchState<Real>& state, const std::uint8_t* status, StageStats& stage);

  /// Cones about neighbouring rays, with what their march works on.
  struct Cones {
    explicit Cones(std::size_t size);
    kernels::ConeView<Real> view() {
      return {origin.view(), direction.view(), width.data(), spread.data(), epsilon.data(), t_max.data()};
    }
    /// The i-th is in the one around, and goes on from its end.
    void begin_within(const Cones& around, std::size_t one, std::size_t i) {
      t[i] = around.t[one];
      t_max[i] = std::min(t_max[i], around.t_max[one]);
    }
    /// As ConeSteps reads it: carried is the width, stride the spread.
    State state() {
      return {t.data(), radius.data(), width.data(), spread.data(), boldness.data(), pause.data(), nullptr};
    }

    VectorBuffer<Real> origin, direction;
    Buffer<Real> width, spread, epsilon, t_max, t;
    Buffer<Real> radius, boldness;
    Buffer<std::uint8_t> pause;
  };
  /// About so many rays at the most. `tape`: of the field.
  struct ConesOfTile {
    ConesOfTile(std::size_t rays, const Tape& tape);

    Cones of_blocks;
    std::optional<Cones> small, smallest;  ///< where the tape is long
  };
  void enter_balls(const BallTree<Real>& balls, const Rays& rays, std::size_t blocks, const Parameters& parameters,
                   RayBatch<Real>& batch);
  void enter_bounds(Cones& cones, std::size_t count, const Parameters& parameters) const;
  void march_small_cones(const Rays& rays, std::size_t blocks, const Parameters& parameters, StageStats& stage);
  void march_cones(const Rays& rays, Cones& cones, std::size_t count, Parameters parameters, StageStats& stage);

  const Program& program_;
  const Octree<Real>* octree_;
  const bool clips_to_bounds_;
  const kernels::KernelTable<Real>& kernels_;
  LoadedTape<Real> tape_;
  std::optional<LoadedTape<Real>> gradient_;
  VectorBuffer<Real> points_;
  Buffer<Real> values_, ends_;
  std::optional<ConesOfTile> cones_;  ///< once they are asked for
  KernelSampler<Real> sampler_;
  std::optional<CellChoice<Real>> choice_;
  std::optional<CellGroups<Real>> groups_;
  std::optional<CellMarch<Real>> cell_march_;
  VectorBuffer<Real> sorted_points_, sorted_values_;  ///< by cells
  std::vector<std::uint32_t> left_;                   ///< points that cannot be run alone after all
  std::vector<Real> planes_;                          ///< apart from the rest
  Buffer<Real> met_;                                  ///< where rays meet the first of them
  std::unique_ptr<Field> rest_;                       ///< what is marched beside planes; null where that is nothing
};

}  // namespace octomarch
