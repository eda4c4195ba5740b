// Gathers vertices and triangles patch by patch into a Surface, and joins rings of vertices by triangles.
#pragma once

#include "scene/shape/surface.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace touchstone::scene {

class SurfaceBuilder {
 public:
  void begin_patch() { surface_.patch_begin.push_back(static_cast<std::int32_t>(points_.size())); }
  /// @returns the vertex's index
  int add_vertex(const Vec3& point_m, const Vec3& normal) {
    points_.push_back(point_m);
    normals_.push_back(normal);
    return static_cast<int>(points_.size()) - 1;
  }
  void add_triangle(int a, int b, int c) { surface_.triangles.push_back({a, b, c}); }
  /// The surface with its vertex areas; the builder is empty afterwards.
  Surface finish();

 private:
  Surface surface_;
  std::vector<Vec3> points_, normals_;
};

/// Triangles between two rows of vertices that run side by side, `below` and `above` segments long (0: a single
/// vertex). Counter-clockwise where the rows run to the right. Of two equally good diagonals, `turn` decides in turns,
/// so that the pattern has no preferred direction.
/// @param low, high give the vertex at a place along the row; @param add takes the three vertices of a triangle
template <class Low, class High, class Add>
void join_rows(int below, int above, int turn, const Low& low, const High& high, const Add& add) {
  int i = 0, j = 0;
  while (i < below || j < above) {
    const std::int64_t next_low = static_cast<std::int64_t>(i + 1) * above;
    const std::int64_t next_high = static_cast<std::int64_t>(j + 1) * below;
    const bool tie = next_low == next_high && (i + turn) % 2 != 0;
    if (j == above || (i < below && (next_low < next_high || tie))) {
      add(low(i), low(i + 1), high(j));
      ++i;
    } else {
      add(low(i), high(j + 1), high(j));
      ++j;
    }
  }
}

}  // namespace touchstone::scene
