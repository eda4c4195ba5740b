#include "scene/shape/revolution.h"
#include "scene/shape/surface_builder.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchstone::scene {
namespace {

/// Width and height of the triangles. A disc of n rings with 1, 2, ... n segments to the quadrant has triangles that
/// are pi / 2 as wide as high; the bands take the same measure, so that all areas are alike.
struct Pattern {
  double width_m, height_m;

  [[nodiscard]] int segments(double r_m) const {
    return r_m == 0.0 ? 0 : std::max(1, static_cast<int>(std::lround(0.5 * std::numbers::pi * r_m / width_m)));
  }
  [[nodiscard]] int rows(double length_m) const {
    return std::max(1, static_cast<int>(std::lround(length_m / height_m)));
  }
};

/// A ring of the piece; place s along it, segments per quadrant.
struct Ring {
  double s;
  int segments;
};

/// The piece's rings from its start up.
std::vector<Ring> rings_of(const Revolution& shape, int index, const Pattern& pattern) {
  const RevolutionPiece& piece = shape.piece(index);
  const bool disc = piece.whole && piece.straight() && piece.start_m.y() == piece.end_m.y();
  const double rim_m = std::max(piece.start_m.x(), piece.end_m.x());
  const int rows = disc ? pattern.segments(rim_m) : pattern.rows(piece.length_m);
  std::vector<Ring> rings;
  for (int k = 0; k <= rows; ++k) {
    const double s = static_cast<double>(k) / rows;
    const int segments = disc ? (index == 0 ? k : rows - k) : pattern.segments(shape.meridian(index, s).rz_m.x());
    rings.push_back({s, segments});
  }
  return rings;
}

void add_quadrant(const Revolution& shape, int index, int quadrant, const std::vector<Ring>& rings,
                  SurfaceBuilder& builder) {
  builder.begin_patch();
  const int patch = shape.piece(index).first_patch + quadrant;
  std::vector<int> begin;
  for (const Ring& ring : rings) {
    for (int i = 0; i <= ring.segments; ++i) {
      const double u = ring.segments > 0 ? static_cast<double>(i) / ring.segments : 0.5;
      const SurfacePoint p = shape.at(patch, u, ring.s);
      const int vertex = builder.add_vertex(p.point_m, p.normal);
      if (i == 0) begin.push_back(vertex);
    }
  }
  for (std::size_t k = 0; k + 1 < rings.size(); ++k) {
    join_rows(
        rings[k].segments, rings[k + 1].segments, static_cast<int>(k), [&](int i) { return begin[k] + i; },
        [&](int j) { return begin[k + 1] + j; }, [&](int a, int b, int c) { builder.add_triangle(a, b, c); });
  }
}

/// Vertices from the axis out, ring by ring.
void add_cap(const Revolution& shape, int index, std::vector<Ring> rings, SurfaceBuilder& builder) {
  builder.begin_patch();
  const bool top = index > 0;
  const int patch = shape.piece(index).first_patch;
  if (top) std::reverse(rings.begin(), rings.end());
  std::vector<int> begin;
  for (const Ring& ring : rings) {
    const int around = std::max(1, 4 * ring.segments);
    for (int i = 0; i < around; ++i) {
      // Each quadrant counts its own segments, as the neighbouring patches do.
      const int quadrant = ring.segments > 0 ? i / ring.segments : 0;
      const double u = ring.segments > 0 ? static_cast<double>(i % ring.segments) / ring.segments : 0.0;
      const SurfacePoint p = shape.at_quadrant(patch, quadrant, u, ring.s);
      const int vertex = builder.add_vertex(p.point_m, p.normal);
      if (i == 0) begin.push_back(vertex);
    }
  }
  for (std::size_t k = 0; k + 1 < rings.size(); ++k) {
    for (int quadrant = 0; quadrant < 4; ++quadrant) {
      const auto vertex = [&](std::size_t ring, int i) {
        const int n = rings[ring].segments;
        return begin[ring] + (n > 0 ? (quadrant * n + i) % (4 * n) : 0);
      };
      const auto inner = [&](int i) { return vertex(k, i); };
      const auto outer = [&](int i) { return vertex(k + 1, i); };
      join_rows(rings[k].segments, rings[k + 1].segments, static_cast<int>(k), inner, outer, [&](int a, int b, int c) {
        // Seen from above, the way out from the axis is the way down.
        top ? builder.add_triangle(a, c, b) : builder.add_triangle(a, b, c);
      });
    }
  }
}

}  // namespace

Surface Revolution::tessellated(int triangles) const {
  const double triangle_m2 = area_m2() / triangles;
  const double width_m = std::sqrt(std::numbers::pi * triangle_m2);
  const Pattern pattern{width_m, 2.0 * triangle_m2 / width_m};
  SurfaceBuilder builder;
  for (int index = 0; index < piece_count(); ++index) {
    const std::vector<Ring> rings = rings_of(*this, index, pattern);
    if (piece(index).whole) {
      add_cap(*this, index, rings, builder);
    } else {
      for (int quadrant = 0; quadrant < 4; ++quadrant) add_quadrant(*this, index, quadrant, rings, builder);
    }
  }
  return builder.finish();
}

}  // namespace touchstone::scene
