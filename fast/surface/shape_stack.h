// The deformed shape of several contact regions as terms, section VI-B: what the passes and the queries of points add
// up.
#pragma once

#include "fast/surface/contact_hats.h"
#include "fast/surface/local_factor.h"
#include "fast/surface/local_factor_kernel.h"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace touchstone::fast {

/// One region's part in the deformed shape.
struct RegionShape {
  /// U_i, displacements of the anchor points by the region's skeleton, world. Borrowed until the next
  /// ShapeStack::clear().
  std::span<const scene::Vec3> anchor_displacement_m;
  ContactPoint contact;                      ///< with D_i, which comes on top of Shape_{i-1}
  scene::Vec3 p0_W_m = scene::Vec3::Zero();  ///< on the rest surface
  RegionSize size;
};

/// Work space of the passes over a block of vertices; nothing in it lasts.
struct PassScratch {
  PassScratch(const SurfacePatches& rest, std::size_t max_regions);
  [[nodiscard]] std::size_t memory_bytes() const noexcept;

  /// Numbers of one block of vertices.
  using Lane = std::array<float, block_vertices>;
  std::array<Lane, patch_corners_max> corner_weight{};
  std::vector<Lane> height;       ///< of the hats, one per region
  std::vector<std::size_t> near;  ///< regions whose R reaches the present patch
  SurfacePatches points;          ///< the body's patches, with one block of vertices: the points asked for
};

/// Shape_i, i = 0 to count(): the regions in order of creation, each with the terms of its increment u_i = Shape_i -
/// Shape_{i-1}.
///
/// A quantity q of u_i is the sum of its anchor points' q by weight and, on top, the hats of the contact points k <= i
/// by coefficient c_ik (contact_hats.h), so that it has its value at p0_i and that of no displacement at every earlier
/// p0_k, which the tool holds. Storage is fixed at construction.
struct ShapeStack {
  ShapeStack(const SurfacePatches& rest, const AnchorPoints& anchors, int max_regions);
  /// Shape_0: the body at rest.
  void clear() noexcept;
  /// Regions so far.
  [[nodiscard]] std::size_t count() const noexcept { return hats.count(); }
  [[nodiscard]] std::size_t memory_bytes() const noexcept;

  /// A region's local factor.
  struct Reach {
    FactorTerms terms;
    Eigen::Vector3f p0_W_m;
  };
  /// Lengths and angles of one region's displacements at the corners of one patch, as printed.
  struct Printed {
    std::array<double, patch_corners_max> length_m{}, angle_rad{};
    scene::Vec3 toward = scene::Vec3::Zero();  ///< unit mean of the displacements, in place of the azimuth (E15)
  };

  ContactHats hats;
  std::vector<RegionShape> region;
  std::vector<Reach> reach;                 ///< where there is a local factor
  std::vector<scene::Vec3> anchor_total_m;  ///< sum of U_i

  /// Of the corrected form, also in single precision.
  std::vector<scene::Vec3> vector_c_m, vector_total_m;  ///< c_ik, rows of the capacity; sum over i of c_ik
  std::vector<Eigen::Vector3f> vector_c_short_m, vector_total_short_m;
  /// Of the printed form.
  std::vector<double> length_c_m, angle_c_rad;  ///< c_ik, rows of the capacity
  std::vector<Printed> printed;                 ///< rows of one per patch

  PassScratch scratch;
};

/// Takes the next region in. At most `max_regions` times between clears. @param local null where there is no local
/// factor
using AddRegion = void (*)(const SurfacePatches&, const LocalConstants* local, const RegionShape&,
                           ShapeStack&) noexcept;
void add_region_published(const SurfacePatches&, const LocalConstants*, const RegionShape&, ShapeStack&) noexcept;
void add_region_corrected(const SurfacePatches&, const LocalConstants*, const RegionShape&, ShapeStack&) noexcept;

}  // namespace touchstone::fast
