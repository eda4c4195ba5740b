#include "fast/normals.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace touchstone::fast {
namespace {

using scene::Vec3;
using Ring = std::set<std::int32_t>;

std::vector<Ring> rings_of(const scene::Surface& surface) {
  std::vector<Ring> rings(static_cast<std::size_t>(surface.vertex_count()));
  for (const auto& [a, b, c] : surface.triangles) {
    rings[static_cast<std::size_t>(a)].insert({b, c});
    rings[static_cast<std::size_t>(b)].insert({c, a});
    rings[static_cast<std::size_t>(c)].insert({a, b});
  }
  return rings;
}

/// Area below which a vertex's surroundings count as crushed to a line [m^2].
constexpr float crushed_m2 = 1e-16f;

/// The neighbour that points most nearly along a direction, by its cosine in steps so that a regular mesh answers alike
/// at every vertex; `self` where none comes near. Of equals the first in the order given, so that the two sides of a
/// vertex, asked in opposite orders, give opposite neighbours.
template <class Iterator>
std::int32_t neighbour_along(const scene::Surface& surface, Iterator begin, Iterator end, std::int32_t self,
                             const Vec3& direction) {
  std::int32_t best = self;
  double best_cos = 0.3;
  for (Iterator it = begin; it != end; ++it) {
    const std::int32_t other = *it;
    const double cosine = (surface.points_m.col(other) - surface.points_m.col(self)).normalized().dot(direction);
    const double step = cosine > 0.95 ? 1.0 : std::min(cosine, 0.5);
    if (step > best_cos) {
      best_cos = step;
      best = other;
    }
  }
  return best;
}

void update_run(const NormalStencils::Run& run, const NormalStencils& stencils, const SurfacePatches& rest,
                SurfaceField& field) noexcept {
  const auto from = [&](const Columns3& columns, std::size_t axis, std::size_t neighbour) {
    return columns[axis].data() + run.begin + run.offset[neighbour];
  };
  const auto here = [&](const Columns3& columns, std::size_t axis) { return columns[axis].data() + run.begin; };
  const Columns3& u = field.displacement_m;
  const float *xa = from(u, 0, 0), *ya = from(u, 1, 0), *za = from(u, 2, 0);
  const float *xb = from(u, 0, 1), *yb = from(u, 1, 1), *zb = from(u, 2, 1);
  const float *xc = from(u, 0, 2), *yc = from(u, 1, 2), *zc = from(u, 2, 2);
  const float *xd = from(u, 0, 3), *yd = from(u, 1, 3), *zd = from(u, 2, 3);
  const float *t1x = here(stencils.t1_m, 0), *t1y = here(stencils.t1_m, 1), *t1z = here(stencils.t1_m, 2);
  const float *t2x = here(stencils.t2_m, 0), *t2y = here(stencils.t2_m, 1), *t2z = here(stencils.t2_m, 2);
  const float *rx = here(rest.normal, 0), *ry = here(rest.normal, 1), *rz = here(rest.normal, 2);
  float* nx = field.normal[0].data() + run.begin;
  float* ny = field.normal[1].data() + run.begin;
  float* nz = field.normal[2].data() + run.begin;
  // Columns never overlap.
#pragma GCC ivdep
  for (std::int32_t v = 0; v < run.end - run.begin; ++v) {
    const float px = t1x[v] + (xa[v] - xb[v]), py = t1y[v] + (ya[v] - yb[v]), pz = t1z[v] + (za[v] - zb[v]);
    const float qx = t2x[v] + (xc[v] - xd[v]), qy = t2y[v] + (yc[v] - yd[v]), qz = t2z[v] + (zc[v] - zd[v]);
    // The rest normal's part is far below rounding, unless there is nothing else.
    const float cx = py * qz - pz * qy + crushed_m2 * rx[v];
    const float cy = pz * qx - px * qz + crushed_m2 * ry[v];
    const float cz = px * qy - py * qx + crushed_m2 * rz[v];
    const float to_unit = 1.0f / std::sqrt(cx * cx + cy * cy + cz * cz);
    nx[v] = cx * to_unit;
    ny[v] = cy * to_unit;
    nz[v] = cz * to_unit;
  }
}

}  // namespace

NormalStencils normal_stencils(const scene::Surface& surface) {
  const std::vector<Ring> rings = rings_of(surface);
  NormalStencils stencils;
  for (std::int32_t v = 0; v < surface.vertex_count(); ++v) {
    const Ring& ring = rings[static_cast<std::size_t>(v)];
    const Vec3 n = surface.normals.col(v);
    // The first direction is the vertex order's own, so that neighbours lie side by side in memory.
    const std::int32_t a = ring.count(v + 1) ? v + 1 : v;
    std::int32_t b = ring.count(v - 1) ? v - 1 : v;
    if (a == b) b = *ring.begin();
    const auto chord = [&](std::int32_t to, std::int32_t from) {
      const Vec3 straight_m = surface.points_m.col(to) - surface.points_m.col(from);
      return Vec3(straight_m - straight_m.dot(n) * n);
    };
    const Vec3 t1_m = chord(a, b), crossing = n.cross(t1_m).normalized();
    const std::int32_t c = neighbour_along(surface, ring.begin(), ring.end(), v, crossing);
    const std::int32_t d = neighbour_along(surface, ring.rbegin(), ring.rend(), v, Vec3(-crossing));
    const Vec3 t2_m = chord(c, d);
    for (int axis = 0; axis < 3; ++axis) {
      stencils.t1_m[static_cast<std::size_t>(axis)].push_back(static_cast<float>(t1_m[axis]));
      stencils.t2_m[static_cast<std::size_t>(axis)].push_back(static_cast<float>(t2_m[axis]));
    }
    const std::array<std::int32_t, 4> offset{a - v, b - v, c - v, d - v};
    if (stencils.runs.empty() || stencils.runs.back().offset != offset) stencils.runs.push_back({v, v, offset});
    stencils.runs.back().end = v + 1;
  }
  return stencils;
}

void update_normals(const NormalStencils& stencils, const SurfacePatches& rest, SurfaceField& field) noexcept {
  for (const NormalStencils::Run& run : stencils.runs) update_run(run, stencils, rest, field);
}

}  // namespace touchstone::fast
