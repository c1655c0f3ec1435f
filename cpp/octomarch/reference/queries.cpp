// Loops over points and rays; see queries.hpp.
#include "octomarch/reference/queries.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "octomarch/reference/march.hpp"

namespace octomarch::reference {
namespace {

Vec3 triple(std::span<const double> values, std::size_t i) {
  return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

}  // namespace

template <class T>
void distance(const NodePtr& root, const Vec3& anchor, std::span<const double> points, std::span<T> values,
              const Poll& poll) {
  Evaluator<T> field(root, poll, anchor);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = field.distance(vector<T>(triple(points, i) - anchor));
}

template <class T>
void gradient(const NodePtr& root, const Vec3& anchor, std::span<const double> points, std::span<T> gradients,
              const Poll& poll) {
  Evaluator<T> field(root, poll, anchor);
  for (std::size_t i = 0; i < gradients.size() / 3; ++i)
    store(gradients, i, field.gradient(vector<T>(triple(points, i) - anchor)));
}

template <class T>
void raycast(const NodePtr& root, std::span<const double> origins, std::span<const double> directions,
             const March& march, const Shading& shading, double t_max, const Compiled& compiled, const Hits<T>& hits,
             const Poll& poll) {
  const Site& site = compiled.site;
  Evaluator<T> field(root, poll, site.anchor);
  for (std::size_t i = 0; i < hits.t.size(); ++i) {
    const Vec3 direction = triple(directions, i);
    // a length beyond the numbers would make a miss NaN
    const double norm = std::min(length(direction), std::numeric_limits<double>::max());
    const bool valid = is_finite(direction) && norm > 0.0;
    const Vec3 unit = valid ? normalized(direction) : Vec3{};
    const Vec3 origin = triple(origins, i) - site.anchor;
    const double lead = lead_of(site, origin, march.min_distance);
    const Ray<T> ray{
        .origin = vector<T>(lead > 0.0 ? origin + unit * lead : origin), .direction = vector<T>(unit), .lead = lead};
    MarchLimits<T> limits(march, compiled, site);
    limits.move(march, site, lead, std::min(march.max_distance, t_max * norm));
    const Arrival<T> arrival = march_ray(field, ray, limits);
    const Surface<T> surface = surface_at(field, ray, arrival, NormalRule<T>(shading));
    hits.t[i] = valid ? T((lead + static_cast<double>(arrival.t)) / norm) : arrival.t;
    store(hits.position, i, has_surface(arrival.status) ? from_far(site.anchor, surface.position) : surface.position);
    store(hits.normal, i, surface.normal);
    hits.material_id[i] = surface.material;
    hits.steps[i] = arrival.steps;
    hits.status[i] = static_cast<std::uint8_t>(arrival.status);
  }
}

template void distance(const NodePtr&, const Vec3&, std::span<const double>, std::span<float>, const Poll&);
template void distance(const NodePtr&, const Vec3&, std::span<const double>, std::span<double>, const Poll&);
template void gradient(const NodePtr&, const Vec3&, std::span<const double>, std::span<float>, const Poll&);
template void gradient(const NodePtr&, const Vec3&, std::span<const double>, std::span<double>, const Poll&);
template void raycast(const NodePtr&, std::span<const double>, std::span<const double>, const March&, const Shading&,
                      double, const Compiled&, const Hits<float>&, const Poll&);
template void raycast(const NodePtr&, std::span<const double>, std::span<const double>, const March&, const Shading&,
                      double, const Compiled&, const Hits<double>&, const Poll&);

}  // namespace octomarch::reference
