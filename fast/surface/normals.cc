#include "fast/surface/normals.h"

#include "fast/surface/patch_kernels.h"
#include "scene/base/index.h"

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
    nth(rings, a).insert({b, c});
    nth(rings, b).insert({c, a});
    nth(rings, c).insert({a, b});
  }
  return rings;
}

/// Area below which a vertex's neighbourhood counts as degenerate, crushed to a line [m^2].
constexpr float crushed_m2 = 1e-16f;
/// The same for the vertices of a run, relative to their area at rest.
constexpr float crushed_rel = 1e-9f;

/// Shorter runs are computed vertex by vertex.
constexpr std::int32_t shortest_run = 4;
/// Single vertices that are computed in one loop.
constexpr std::size_t singles_at_once = 32;
/// Vertices in a vector register: the length of a run is rounded up to a multiple.
constexpr std::int32_t wide = 8;
/// A run continues over at most this many vertices with other neighbours.
constexpr std::int32_t longest_gap = 2;

/// The neighbour closest to a direction by its cosine, in steps so that a regular mesh gives the same result at every
/// vertex; `self` if none is close. Of equal neighbours the first in the given order: the two sides of a vertex, asked
/// in opposite orders, then give opposite neighbours.
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

/// One chord per axis of a run's vertices: from a column or, for a flat run, the first value.
template <bool flat>
class Chord {
 public:
  Chord(const Columns3& t_m, std::size_t axis, std::int32_t begin) noexcept
      : all_(t_m[axis].data() + begin), first_(*all_) {}
  [[nodiscard]] TOUCHSTONE_INLINE float operator[](std::int32_t v) const noexcept { return flat ? first_ : all_[v]; }

 private:
  const float* all_;
  float first_;
};

template <bool flat>
TOUCHSTONE_INLINE void update_run(const NormalStencils::Run& run, const NormalStencils& stencils,
                                  SurfaceField& field) noexcept {
  const Columns3& u = field.displacement_m;
  const float *xa = u[0].data() + run.begin + run.offset[0], *xb = u[0].data() + run.begin + run.offset[1];
  const float *xc = u[0].data() + run.begin + run.offset[2], *xd = u[0].data() + run.begin + run.offset[3];
  const float *ya = u[1].data() + run.begin + run.offset[0], *yb = u[1].data() + run.begin + run.offset[1];
  const float *yc = u[1].data() + run.begin + run.offset[2], *yd = u[1].data() + run.begin + run.offset[3];
  const float *za = u[2].data() + run.begin + run.offset[0], *zb = u[2].data() + run.begin + run.offset[1];
  const float *zc = u[2].data() + run.begin + run.offset[2], *zd = u[2].data() + run.begin + run.offset[3];
  const Chord<flat> t1x(stencils.t1_m, 0, run.begin), t1y(stencils.t1_m, 1, run.begin),
      t1z(stencils.t1_m, 2, run.begin);
  const Chord<flat> t2x(stencils.t2_m, 0, run.begin), t2y(stencils.t2_m, 1, run.begin),
      t2z(stencils.t2_m, 2, run.begin);
  float* nx = field.normal[0].data() + run.begin;
  float* ny = field.normal[1].data() + run.begin;
  float* nz = field.normal[2].data() + run.begin;
  const std::int32_t count = run.lanes;
  // Columns never overlap.
#pragma GCC ivdep
  for (std::int32_t v = 0; v < count; ++v) {
    const float px = t1x[v] + (xa[v] - xb[v]), py = t1y[v] + (ya[v] - yb[v]), pz = t1z[v] + (za[v] - zb[v]);
    const float qx = t2x[v] + (xc[v] - xd[v]), qy = t2y[v] + (yc[v] - yd[v]), qz = t2z[v] + (zc[v] - zd[v]);
    // The contribution of the rest normal is far below rounding unless the area vanishes.
    const float cx = (py * qz - pz * qy) + crushed_rel * (t1y[v] * t2z[v] - t1z[v] * t2y[v]);
    const float cy = (pz * qx - px * qz) + crushed_rel * (t1z[v] * t2x[v] - t1x[v] * t2z[v]);
    const float cz = (px * qy - py * qx) + crushed_rel * (t1x[v] * t2y[v] - t1y[v] * t2x[v]);
    const float to_unit = 1.0f / std::sqrt(cx * cx + cy * cy + cz * cz);
    nx[v] = cx * to_unit;
    ny[v] = cy * to_unit;
    nz[v] = cz * to_unit;
  }
}

/// Single vertices: their neighbourhoods are gathered in batches.
TOUCHSTONE_INLINE void update_singles(const NormalStencils& stencils, SurfaceField& field) noexcept {
  constexpr std::size_t batch = singles_at_once;
  float p[3][batch] = {}, q[3][batch] = {}, n[3][batch];
  const float *ux = field.displacement_m[0].data(), *uy = field.displacement_m[1].data(),
              *uz = field.displacement_m[2].data();
  const std::size_t all = stencils.singles.size();
  for (std::size_t begin = 0; begin < all; begin += batch) {
    const NormalStencils::Single* single = stencils.singles.data() + begin;
    const std::size_t count = std::min(batch, all - begin);
    for (std::size_t i = 0; i < count; ++i) {
      const std::int32_t a = single[i].neighbour[0], b = single[i].neighbour[1], c = single[i].neighbour[2],
                         d = single[i].neighbour[3];
      p[0][i] = ux[a] - ux[b];
      p[1][i] = uy[a] - uy[b];
      p[2][i] = uz[a] - uz[b];
      q[0][i] = ux[c] - ux[d];
      q[1][i] = uy[c] - uy[d];
      q[2][i] = uz[c] - uz[d];
    }
    const auto& t1 = stencils.single_t1_m;
    const auto& t2 = stencils.single_t2_m;
    const auto& r = stencils.single_normal;
    const float *t1x = t1[0].data() + begin, *t1y = t1[1].data() + begin, *t1z = t1[2].data() + begin;
    const float *t2x = t2[0].data() + begin, *t2y = t2[1].data() + begin, *t2z = t2[2].data() + begin;
    const float *rx = r[0].data() + begin, *ry = r[1].data() + begin, *rz = r[2].data() + begin;
    // The columns of the single vertices are padded to a full batch.
    for (std::size_t i = 0; i < batch; ++i) {
      const float px = t1x[i] + p[0][i], py = t1y[i] + p[1][i], pz = t1z[i] + p[2][i];
      const float qx = t2x[i] + q[0][i], qy = t2y[i] + q[1][i], qz = t2z[i] + q[2][i];
      const float cx = py * qz - pz * qy + crushed_m2 * rx[i];
      const float cy = pz * qx - px * qz + crushed_m2 * ry[i];
      const float cz = px * qy - py * qx + crushed_m2 * rz[i];
      const float to_unit = 1.0f / std::sqrt(cx * cx + cy * cy + cz * cz);
      n[0][i] = cx * to_unit;
      n[1][i] = cy * to_unit;
      n[2][i] = cz * to_unit;
    }
    float *nx = field.normal[0].data(), *ny = field.normal[1].data(), *nz = field.normal[2].data();
    for (std::size_t i = 0; i < count; ++i) {
      nx[single[i].vertex] = n[0][i];
      ny[single[i].vertex] = n[1][i];
      nz[single[i].vertex] = n[2][i];
    }
  }
}

/// Sorts the vertices into runs and singles. @param neighbour of every vertex
void find_runs(const scene::Surface& surface, const std::vector<std::array<std::int32_t, 4>>& neighbour,
               NormalStencils& stencils) {
  const auto chord = [&](const Columns3& t_m, std::int32_t v) {
    const auto k = static_cast<std::size_t>(v);
    return Vec3(t_m[0][k], t_m[1][k], t_m[2][k]);
  };
  const auto t1_m = [&](std::int32_t v) { return chord(stencils.t1_m, v); };
  const auto t2_m = [&](std::int32_t v) { return chord(stencils.t2_m, v); };
  const auto offset = [&](std::int32_t v) {
    std::array<std::int32_t, 4> out = nth(neighbour, v);
    for (std::int32_t& to : out) to -= v;
    return out;
  };
  // Neighbours on one line do not determine the normal; only a single vertex keeps the rest shape's normal.
  const auto spans = [&](std::int32_t v) {
    return t1_m(v).cross(t2_m(v)).norm() > 0.01 * (t1_m(v).squaredNorm() + t2_m(v).squaredNorm());
  };
  const auto add_single = [&](std::int32_t v) { stencils.singles.push_back({v, nth(neighbour, v)}); };
  for (std::size_t patch = 0; patch + 1 < surface.patch_begin.size(); ++patch) {
    const std::int32_t end = surface.patch_begin[patch + 1];
    for (std::int32_t v = surface.patch_begin[patch]; v < end;) {
      NormalStencils::Run run{v, v + 1, 0, offset(v), true};
      const auto [lowest, highest] = std::minmax_element(run.offset.begin(), run.offset.end());
      std::vector<std::int32_t> passed_over;
      std::int32_t members = spans(v) ? 1 : 0;
      for (std::int32_t next = v + 1; members > 0 && next < end && next - run.end <= longest_gap; ++next) {
        if (next + *lowest < surface.patch_begin[patch] || next + *highest >= end) break;
        if (offset(next) != run.offset || !spans(next)) continue;
        for (std::int32_t between = run.end; between < next; ++between) passed_over.push_back(between);
        run.end = next + 1;
        ++members;
        const double alike_m = 1e-6 * (t1_m(v).norm() + t2_m(v).norm());
        run.flat = run.flat && (t1_m(next) - t1_m(v)).norm() < alike_m && (t2_m(next) - t2_m(v)).norm() < alike_m;
      }
      if (members < shortest_run) {
        add_single(v++);
        continue;
      }
      for (const std::int32_t single : passed_over) add_single(single);
      // Values written past a run's end are overwritten by later runs or by the single vertices.
      const std::int32_t lanes = (run.end - run.begin + wide - 1) / wide * wide;
      const bool in_memory = run.begin + lanes + std::max(*highest, 0) <= surface.vertex_count();
      run.lanes = in_memory ? lanes : run.end - run.begin;
      stencils.runs.push_back(run);
      v = run.end;
    }
  }
}

}  // namespace

NormalStencils normal_stencils(const scene::Surface& surface) {
  const std::vector<Ring> rings = rings_of(surface);
  NormalStencils stencils;
  std::vector<std::array<std::int32_t, 4>> neighbour;
  for (std::int32_t v = 0; v < surface.vertex_count(); ++v) {
    const Ring& ring = nth(rings, v);
    const Vec3 n = surface.normals.col(v);
    // The first direction follows the vertex order, so that neighbours are adjacent in memory.
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
      nth(stencils.t1_m, axis).push_back(static_cast<float>(t1_m[axis]));
      nth(stencils.t2_m, axis).push_back(static_cast<float>(t2_m[axis]));
    }
    neighbour.push_back({a, b, c, d});
  }
  find_runs(surface, neighbour, stencils);
  for (const NormalStencils::Single& single : stencils.singles) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<std::size_t>(axis), v = static_cast<std::size_t>(single.vertex);
      stencils.single_t1_m[k].push_back(stencils.t1_m[k][v]);
      stencils.single_t2_m[k].push_back(stencils.t2_m[k][v]);
      stencils.single_normal[k].push_back(static_cast<float>(surface.normals(axis, single.vertex)));
    }
  }
  const std::size_t batches = (stencils.singles.size() + singles_at_once - 1) / singles_at_once;
  for (Columns3* columns : {&stencils.single_t1_m, &stencils.single_t2_m, &stencils.single_normal}) {
    for (auto& column : *columns) column.resize(batches * singles_at_once);
  }
  return stencils;
}

TOUCHSTONE_WIDE_LOOPS
void update_normals(const NormalStencils& stencils, SurfaceField& field) noexcept {
  for (const NormalStencils::Run& run : stencils.runs) {
    run.flat ? update_run<true>(run, stencils, field) : update_run<false>(run, stencils, field);
  }
  update_singles(stencils, field);
}

}  // namespace touchstone::fast
