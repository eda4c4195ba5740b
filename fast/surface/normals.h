// Normals of the deformed surface, the last step of section V-E.
#pragma once

#include "fast/surface/surface_patches.h"
#include "scene/shape/surface.h"

#include <array>
#include <cstdint>
#include <vector>

namespace touchstone::fast {

/// How each vertex takes its normal from the displacements around it:
/// n = (t1 + u_a - u_b) x (t2 + u_c - u_d), t1 and t2 the chords between its neighbours a, b and c, d in two crossing
/// mesh directions, laid into the rest shape's tangent plane. The undeformed surface thus has the shape's own normals,
/// where averaged triangles would have theirs. Neighbours are taken within the patch, so a sharp edge keeps one normal
/// per side; on the border of a patch the vertex itself replaces the missing neighbour.
///
/// Most vertices have their neighbours at the same offsets as the vertex before and are worked off in runs. A run goes
/// on over a vertex or two with other neighbours, as from one row of a mesh to the next; what it writes there is
/// overwritten by the pass over the single vertices. So is what it writes past its end, or by the runs that follow.
struct NormalStencils {
  /// Consecutive vertices whose neighbours lie at the same offsets in the vertex order.
  struct Run {
    std::int32_t begin, end;
    std::int32_t lanes;                  ///< vertices worked off: some behind the end, too
    std::array<std::int32_t, 4> offset;  ///< of a, b, c, d
    bool flat;                           ///< the chords are those of the first vertex all along
  };
  /// A vertex with neighbours of its own.
  struct Single {
    std::int32_t vertex;
    std::array<std::int32_t, 4> neighbour;  ///< a, b, c, d
  };
  std::vector<Run> runs;
  std::vector<Single> singles;
  Columns3 t1_m, t2_m;
  Columns3 single_t1_m, single_t2_m, single_normal;  ///< of the singles side by side; with the normal at rest

  [[nodiscard]] std::size_t memory_bytes() const noexcept {
    return runs.size() * sizeof(Run) + singles.size() * sizeof(Single) +
           (6 * t1_m[0].size() + 9 * single_t1_m[0].size()) * sizeof(float);
  }
};
[[nodiscard]] NormalStencils normal_stencils(const scene::Surface& surface);

/// Fills field.normal from field.displacement_m; where the surface is crushed to a line, the rest normal stays.
void update_normals(const NormalStencils&, SurfaceField& field) noexcept;

}  // namespace touchstone::fast
