#include "octomarch/render/query.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "octomarch/render/material_pass.hpp"

namespace octomarch {

namespace {

/// How the points or rays of a query are divided among its tasks.
struct Chunks {
  std::size_t count;  ///< of all
  std::size_t size;   ///< of a task's, but for the last

  std::size_t tasks() const { return (count + size - 1) / size; }
  /// What a worker's memory has to hold.
  std::size_t scratch() const { return kernels::padded_lanes(std::min(size, count)); }
};

/// Enough to keep blocks full, few enough that a cancelled query ends soon. By cells, which look whether it has been, as many
/// as leave several chunks to each thread: the more there are, the more are in a cell together.
template <class Real>
Chunks chunks_of(const SharedField<Real>& shared, std::size_t count, unsigned threads) {
  constexpr std::size_t kUsual = 4096;
  constexpr std::size_t kOfLong = 512;
  constexpr std::size_t kByCells = 32768;
  constexpr std::size_t kChunksOfThread = 4;
  static_assert(kByCells <= Way::kMost);
  if (shared.octree != nullptr || shared.rest_octree != nullptr) {
    const std::size_t share = kernels::padded_lanes(count / (kChunksOfThread * thread_count(threads)));
    return {count, std::clamp(share, kUsual, kByCells)};
  }
  return {count, shared.program->distance().code.size() < 1000 ? kUsual : kOfLong};
}

/// Runs body(first, count, worker, cancelled) for each chunk. One of little work stays on the calling thread, where starting another
/// would cost more; `evaluations`: of each item, at the most.
template <class Body>
void for_each_chunk(const Program& program, const Chunks& chunks, std::size_t evaluations, const Execution& how,
                    Body&& body) {
  constexpr double kLittle = 5e8;  // instructions of a lane: under a tenth of a second
  const std::size_t count = chunks.count;
  const std::size_t tasks = chunks.tasks();
  if (tasks == 0) return;
  const double work = static_cast<double>(count) * static_cast<double>(evaluations) *
                      static_cast<double>(program.distance().code.size());
  if (tasks == 1 && work < kLittle) {
    const bool never = false;
    body(std::size_t{0}, count, std::size_t{0}, never);
    return;
  }
  parallel_for(
      tasks, thread_count(how.threads),
      [&](std::size_t task, std::size_t worker, const bool& cancelled) {
        const std::size_t first = task * chunks.size;
        body(first, std::min(chunks.size, count - first), worker, cancelled);
      },
      how.listener);
}

/// Of points, which need no more than the whole field.
March no_march() {
  March march;
  march.method = Method::kPlain;
  return march;
}

/// The field at so many points, or along rays from them. Few are not worth an octree.
template <class Real>
SharedField<Real> field_of(const Program& program, std::size_t count, const March& march = no_march()) {
  constexpr std::size_t kMany = 4096;
  return share_field<Real>(program, march, count >= kMany && program.distance().code.size() <= 64 * count);
}

Vec3 triple(const double* values, std::size_t i) { return {values[3 * i], values[3 * i + 1], values[3 * i + 2]}; }

template <class Real>
void set(VectorBuffer<Real>& rows, std::size_t i, const Vec3& v) {
  rows.x[i] = static_cast<Real>(v.x);
  rows.y[i] = static_cast<Real>(v.y);
  rows.z[i] = static_cast<Real>(v.z);
}

/// Points of one chunk as rows of Real, counted from the anchor.
template <class Real>
void split(const double* points, std::size_t count, const Vec3& anchor, VectorBuffer<Real>& rows) {
  for (std::size_t i = 0; i < count; ++i) set(rows, i, triple(points, i) - anchor);
}

/// Scratch of one worker, made when it takes its first task.
template <class Scratch, class... Arguments>
Scratch& scratch_of(std::vector<std::optional<Scratch>>& all, std::size_t worker, Arguments&&... arguments) {
  if (!all[worker]) all[worker].emplace(arguments...);
  return *all[worker];
}

template <class Real>
struct PointScratch {
  PointScratch(const SharedField<Real>& shared, const kernels::KernelTable<Real>& kernels, std::size_t size)
      : field(shared, kernels, size), points(size), out(size) {}

  Field<Real> field;
  VectorBuffer<Real> points;
  VectorBuffer<Real> out;
  StageStats stats;
};

template <class Real>
struct MaterialScratch {
  MaterialScratch(const SharedField<Real>& shared, const kernels::KernelTable<Real>& kernels, std::size_t size)
      : field(shared, kernels, size), points(size), normals(size), material(*shared.program, kernels, size) {}

  Field<Real> field;
  VectorBuffer<Real> points, normals;
  MaterialPass<Real> material;
  StageStats stats;
};

template <class Real>
struct RayScratch {
  RayScratch(const SharedField<Real>& shared, const kernels::KernelTable<Real>& kernels, std::size_t size)
      : batch(size),
        length(size),
        lead(size),
        t_max(size),
        epsilon(size),
        field(shared, kernels, size),
        surface(field, kernels, size) {}

  RayBatch<Real> batch;
  std::vector<double> length, lead;  ///< of the directions; by which rays are moved along at once
  Buffer<Real> t_max;
  Buffer<Real> epsilon;
  Field<Real> field;
  SurfacePass<Real> surface;
  StageStats stats;
};

/// Fills origins, unit directions, starts, t_max and epsilon of one chunk; directions that have no length become NaN, which the
/// march reports as invalid.
template <class Real>
void set_rays(RayScratch<Real>& s, const Site& site, const double* origins, const double* directions, std::size_t count,
              const March& march, double t_max) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 d = triple(directions, i);
    Vec3 o = triple(origins, i) - site.anchor;
    const bool usable = is_finite(d) && !(d == Vec3{});
    const Vec3 unit = usable ? normalized(d) : Vec3{kNan, kNan, kNan};
    // a length beyond the numbers would make a miss NaN
    s.length[i] = usable ? std::min(length(d), std::numeric_limits<double>::max()) : 1.0;
    s.lead[i] = lead_of(site, o, march.min_distance);
    if (s.lead[i] > 0.0) o = o + unit * s.lead[i];
    s.batch.start[i] = clamped<Real>(s.lead[i] > 0.0 ? march.min_distance + site.radius : march.min_distance);
    set(s.batch.origin, i, o);
    set(s.batch.direction, i, unit);
    s.t_max[i] = clamped<Real>(std::min(march.max_distance, t_max * s.length[i]) - s.lead[i]);
    const double farthest = std::max({std::fabs(o.x), std::fabs(o.y), std::fabs(o.z), site.inner_offset});
    s.epsilon[i] = clamped<Real>(std::max(march.least_epsilon(), static_cast<double>(kUlpFloor<Real>) * farthest));
  }
}

/// Writes the surface quantities of one chunk over the values that rays without a surface have.
template <class Real>
void write_surfaces(RayScratch<Real>& s, const Program& program, std::size_t first, std::size_t count,
                    const RayColumns<Real>& columns, const Shading& shading, const Hits<Real>& out,
                    const bool& cancelled) {
  if (out.position) std::fill_n(out.position + 3 * first, 3 * count, Real(0));
  if (out.normal) std::fill_n(out.normal + 3 * first, 3 * count, Real(0));
  if (out.object_id) std::fill_n(out.object_id + first, count, -1);
  if (out.material_id) std::fill_n(out.material_id + first, count, -1);
  SurfacePass<Real>& surface = s.surface;
  surface.gather(s.batch, columns, count);
  if (out.normal) surface.find_normals(shading, cancelled, s.stats);
  if (out.object_id || out.material_id) surface.find_objects(cancelled, s.stats);
  for (std::size_t i = 0; i < surface.count(); ++i) {
    const std::size_t ray = first + surface.ray(i);
    const auto write = [&](Real* plane, const VectorBuffer<Real>& rows, const Vec3& origin) {
      if (plane == nullptr) return;
      plane[3 * ray] = from_far(origin.x, rows.x[i]);
      plane[3 * ray + 1] = from_far(origin.y, rows.y[i]);
      plane[3 * ray + 2] = from_far(origin.z, rows.z[i]);
    };
    write(out.position, surface.position, program.site().anchor);
    write(out.normal, surface.normal, {});
    if (out.object_id) out.object_id[ray] = surface.object(i);
    if (out.material_id) {
      out.material_id[ray] = program.attributes().objects[static_cast<std::size_t>(surface.object(i))].material;
    }
  }
}

}  // namespace

template <class Real>
void query_distance(const Program& program, const double* points, std::size_t count, Real* out, const Execution& how) {
  const SharedField<Real> shared = field_of<Real>(program, count);
  const Chunks chunks = chunks_of(shared, count, how.threads);
  std::vector<std::optional<PointScratch<Real>>> scratch(thread_count(how.threads));
  for_each_chunk(program, chunks, 1, how,
                 [&](std::size_t first, std::size_t n, std::size_t worker, const bool& cancelled) {
                   auto& s = scratch_of(scratch, worker, shared, how.isa->table<Real>(), chunks.scratch());
                   split(points + 3 * first, n, program.site().anchor, s.points);
                   s.field.distance(s.points.read(), n, cancelled, s.out.x.data(), s.stats);
                   std::copy_n(s.out.x.data(), n, out + first);
                 });
}

template <class Real>
void query_gradient(const Program& program, const double* points, std::size_t count, Real* out, const Execution& how) {
  const SharedField<Real> shared = field_of<Real>(program, count);
  const Chunks chunks = chunks_of(shared, count, how.threads);
  std::vector<std::optional<PointScratch<Real>>> scratch(thread_count(how.threads));
  for_each_chunk(
      program, chunks, 1, how, [&](std::size_t first, std::size_t n, std::size_t worker, const bool& cancelled) {
        auto& s = scratch_of(scratch, worker, shared, how.isa->table<Real>(), chunks.scratch());
        split(points + 3 * first, n, program.site().anchor, s.points);
        s.field.gradient(s.points.read(), n, cancelled, s.out.view(), s.stats);
        for (std::size_t i = 0; i < n; ++i) {
          const bool is_nan = std::isnan(s.points.x[i]) || std::isnan(s.points.y[i]) || std::isnan(s.points.z[i]);
          const Real nan = std::numeric_limits<Real>::quiet_NaN();
          out[3 * (first + i)] = is_nan ? nan : s.out.x[i];
          out[3 * (first + i) + 1] = is_nan ? nan : s.out.y[i];
          out[3 * (first + i) + 2] = is_nan ? nan : s.out.z[i];
        }
      });
}

template <class Real>
void query_material(const Program& program, const double* points, const double* normals, std::size_t count, Real* out,
                    const Execution& how) {
  const SharedField<Real> shared = field_of<Real>(program, count);
  const Chunks chunks = chunks_of(shared, count, how.threads);
  std::vector<std::optional<MaterialScratch<Real>>> scratch(thread_count(how.threads));
  for_each_chunk(
      program, chunks, 1, how, [&](std::size_t first, std::size_t n, std::size_t worker, const bool& cancelled) {
        auto& s = scratch_of(scratch, worker, shared, how.isa->table<Real>(), chunks.scratch());
        split(points + 3 * first, n, program.site().anchor, s.points);
        split(normals + 3 * first, n, {}, s.normals);
        s.material.run(s.field, s.points.read(), s.normals.read(), n, cancelled, s.stats);
        const kernels::MaterialView<Real> found = s.material.view();
        const Real* const rows[Material::kSlots] = {found.albedo.x, found.albedo.y, found.albedo.z,    found.roughness,
                                                    found.specular, found.metallic, found.reflectivity};
        for (std::size_t i = 0; i < n; ++i) {
          for (std::size_t slot = 0; slot < Material::kSlots; ++slot) {
            out[Material::kSlots * (first + i) + slot] = rows[slot][i];
          }
        }
      });
}

template <class Real>
void query_rays(const Program& program, const double* origins, const double* directions, std::size_t count,
                const March& march, const Shading& shading, double t_max, const Hits<Real>& out, const Execution& how) {
  const kernels::KernelTable<Real>& kernels = how.isa->table<Real>();
  const SharedField<Real> shared = field_of<Real>(program, count, march);
  const Chunks chunks = chunks_of(shared, count, how.threads);
  std::vector<std::optional<RayScratch<Real>>> scratch(thread_count(how.threads));
  for_each_chunk(program, chunks, static_cast<std::size_t>(march.max_steps), how,
                 [&](std::size_t first, std::size_t n, std::size_t worker, const bool& cancelled) {
                   auto& s = scratch_of(scratch, worker, shared, kernels, chunks.scratch());
                   set_rays(s, program.site(), origins + 3 * first, directions + 3 * first, n, march, t_max);
                   const RayColumns<Real> columns = own_columns(s.batch.origin, s.batch.direction, s.epsilon);
                   const kernels::RayView<Real> rays = columns.view({s.batch.start.data(), 0}, {s.t_max.data(), 0}, n);
                   const kernels::MarchParameters<Real> parameters =
                       march_parameters(program, march, columns.epsilon_slope, cancelled);
                   s.surface.field().march(rays, parameters, s.batch, out.steps ? out.steps + first : nullptr, s.stats);
                   for (std::size_t i = 0; i < n; ++i) {
                     out.t[first + i] =
                         static_cast<Real>((s.lead[i] + static_cast<double>(s.batch.t[i])) / s.length[i]);
                   }
                   if (out.status) std::copy_n(s.batch.status.data(), n, out.status + first);
                   if (out.position || out.normal || out.object_id || out.material_id) {
                     write_surfaces(s, program, first, n, columns, shading, out, cancelled);
                   }
                 });
}

template void query_distance(const Program&, const double*, std::size_t, float*, const Execution&);
template void query_distance(const Program&, const double*, std::size_t, double*, const Execution&);
template void query_gradient(const Program&, const double*, std::size_t, float*, const Execution&);
template void query_gradient(const Program&, const double*, std::size_t, double*, const Execution&);
template void query_material(const Program&, const double*, const double*, std::size_t, float*, const Execution&);
template void query_material(const Program&, const double*, const double*, std::size_t, double*, const Execution&);
template void query_rays(const Program&, const double*, const double*, std::size_t, const March&, const Shading&,
                         double, const Hits<float>&, const Execution&);
template void query_rays(const Program&, const double*, const double*, std::size_t, const March&, const Shading&,
                         double, const Hits<double>&, const Execution&);

}  // namespace octomarch
