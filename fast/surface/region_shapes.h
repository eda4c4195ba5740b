// The deformed shape of several contact regions, section VI-B, and its displacement at any one point, which
// contact of a later region needs.
#pragma once

#include "fast/contact/pull_back.h"
#include "fast/surface/hat.h"
#include "fast/surface/interpolation.h"
#include "fast/surface/local_factor.h"
#include "scene/shape/shape.h"

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

/// Shape_i, i = 0 to count: the regions in order of creation, each with the terms of its increment u_i = Shape_i -
/// Shape_{i-1}.
///
/// A quantity q of u_i is the sum of its anchor points' q by weight and, on top, the hats (hat.h) over the contact
/// points p0_k of the regions k <= i by coefficient c_ik, so that it has its value at p0_i and that of no displacement
/// at every earlier p0_k, which the tool holds. The coefficients solve, for j <= i, sum_k h_k(p0_j) c_ik = target_j -
/// W(p0_j) q: one triangular factorisation that grows by a row and a column per region, since u_i's matrix is a corner
/// of the next one's. Its pivots are bounded away from zero: where a contact point is within a hundredth of its patch
/// of an earlier one, its own value is not met in full, and the coefficients stay bounded. A contact point that does
/// not move the surface (held, or without force) takes no part. Storage is fixed at construction.
struct ShapeStack {
  ShapeStack(const SurfacePatches& rest, const AnchorPoints& anchors, int max_regions);
  /// Shape_0: the body at rest.
  void clear() noexcept;

  /// Lengths and angles of one region's displacements at the corners of one patch, as printed.
  struct Printed {
    std::array<double, patch_corners_max> length_m{}, angle_rad{};
    scene::Vec3 toward = scene::Vec3::Zero();  ///< unit mean of the displacements, in place of the azimuth (E15)
  };

  std::size_t count = 0;  ///< regions so far
  std::size_t capacity = 0;
  std::size_t patches = 0;
  std::vector<RegionShape> region;
  std::vector<char> takes_part;                       ///< has a hat
  std::vector<HatPart> hat;                           ///< rows of one per patch
  std::vector<double> factor;                         ///< L below and U above the diagonal, rows of `capacity`
  std::vector<double> right;                          ///< work space, `capacity`
  std::vector<scene::Vec3> vector_c_m;                ///< c_ik of the corrected form, rows of `capacity`
  std::vector<Eigen::Vector3f> vector_c_short_m;      ///< the same in single precision
  std::vector<scene::Vec3> vector_total_m;            ///< sum over i of c_ik
  std::vector<Eigen::Vector3f> vector_total_short_m;  ///< the same in single precision
  std::vector<scene::Vec3> anchor_total_m;            ///< sum of U_i
  std::vector<double> length_c_m, angle_c_rad;        ///< c_ik of the printed form, rows of `capacity`
  std::vector<Printed> printed;                       ///< rows of one per patch

  /// Work space of the passes: numbers of one block of vertices.
  using Lane = std::array<float, block_vertices>;
  /// A region's local factor.
  struct Reach {
    FactorTerms terms;
    Eigen::Vector3f p0_W_m;
  };
  std::array<Lane, patch_corners_max> corner_weight{};
  std::vector<Lane> height;       ///< of the hats, one per region
  std::vector<Reach> reach;       ///< of the regions so far, where there is a local factor
  std::vector<std::size_t> near;  ///< regions whose R reaches the patch at hand
  SurfacePatches points;          ///< the body's patches, with one block of vertices: the points asked for

  [[nodiscard]] std::size_t memory_bytes() const noexcept;
};

/// Takes the next region in. At most `max_regions` times between clears. @param local null where there is no local
/// factor
using AddRegion = void (*)(const SurfacePatches&, const LocalConstants* local, const RegionShape&,
                           ShapeStack&) noexcept;
/// Fills field.displacement_m with the global deformation of all regions.
using InterpolateSeveral = void (*)(const SurfacePatches&, ShapeStack&, SurfaceField&) noexcept;
/// Adds (w_i - 1) u_i inside every region's R_i to it. A point in contact with region i or an earlier one keeps u_i: it
/// is no noncontact point. At an earlier p0_k there is no u_i to begin with, and a later region's point moves as the
/// rest of Shape_i does, on which that region is built.
using ApplyLocalFactors = void (*)(const SurfacePatches&, const LocalConstants&, ShapeStack&, SurfaceField&) noexcept;
/// Displacement of a rest surface point [m], world: what the two passes above give a vertex there, without the pass.
/// Only the regions in the stack count, so with regions 1 to i - 1 in it this is Shape_{i-1}.
/// @param local null where there is no local factor; @param at the point, its normal and its patch
using DisplacementAt = scene::Vec3 (*)(const SurfacePatches&, const AnchorPoints&, const ShapeStack&,
                                       const LocalConstants* local, const scene::SurfaceQuery& at) noexcept;

/// The same of a block of points of one patch, in single precision.
using DisplacementsAt = void (*)(const AnchorPoints&, const LocalConstants* local, int patch, ShapeStack&,
                                 PointLanes&) noexcept;

/// One formulation of the above. With a single region both passes equal interpolate_* and apply_local_factor_*.
struct SeveralRegions {
  AddRegion add = nullptr;
  InterpolateSeveral interpolate = nullptr;
  ApplyLocalFactors apply_local_factors = nullptr;
  DisplacementAt displacement_at = nullptr;
  DisplacementsAt displacements_at = nullptr;
};

/// As printed: lengths and angles, region upon region at every vertex, an earlier contact point entering with length
/// zero and, having no direction, the angle of the mean displacement (errata E15). Normals and distances are those of
/// the rest shape, where section VI would take those of Shape_{i-1}.
extern const SeveralRegions several_regions_published;

/// Errata E15: vectors. Being linear, the anchor points' parts and the coefficients of all regions are summed first:
/// one pass over the surface, then one hat per region.
extern const SeveralRegions several_regions_corrected;

}  // namespace touchstone::fast
