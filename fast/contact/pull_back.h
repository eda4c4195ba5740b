// Contact with the already deformed body (section VI): a later region is in contact with Shape_{i-1}, the body deformed
// by the earlier regions. That shape changes every tick, so no distance to it is computed. Instead a rest-point search
// takes the region's points to the body at rest.
#pragma once

#include "fast/contact/region_points.h"
#include "scene/shape/shape.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace touchstone::fast {

/// A block of points of one patch of the rest surface, by component, and how far they move.
struct PointLanes {
  static constexpr std::size_t size = 32;
  using Lane = std::array<double, size>;
  using Lane3 = std::array<Lane, 3>;
  Lane3 point_m, normal;  ///< of the rest surface, world
  Lane3 displacement_m;
};

/// The displaced rest surface.
class DisplacedSurface {
 public:
  virtual ~DisplacedSurface() = default;
  /// Fills displacement_m. @param lanes points on that patch, or as far as 1e-4 of the body's size beyond its border
  virtual void displace(int patch, PointLanes& lanes) const noexcept = 0;
};

/// Places in the square of half side 1 and the least-squares fit of a quadratic to what is found there.
struct QuadraticFit {
  QuadraticFit();
  std::array<Eigen::Vector2d, PointLanes::size> place;
  Eigen::Matrix<double, PointLanes::size, 6> terms;  ///< 1, a, b, a^2, a b, b^2 at each place
  Eigen::Matrix<double, 6, PointLanes::size> solve;  ///< its pseudo-inverse
};

/// Scratch memory of pull_back(), valid during a call only. Storage is fixed at construction.
struct PullBackScratch {
  /// @param points at most
  explicit PullBackScratch(int points);
  [[nodiscard]] std::size_t memory_bytes() const noexcept;

  /// Where the displaced surface is closest to a point p.
  struct Foot {
    scene::SurfaceQuery rest;   ///< c
    scene::Vec3 off_m;          ///< p - c - u(c), of the best c so far
    scene::Vec3 from_m, way_m;  ///< start and displacement of the last step, to c
    scene::Vec3 normal;         ///< of the displaced surface at the start of the last step
    double distance_m;          ///< signed, of p; 0 where it is certainly not inside
    bool overshot;              ///< the last step increased the distance
    bool settled;               ///< the last step was short
  };
  std::vector<Foot> foot;             ///< per point
  std::vector<double> height_m;       ///< per point, a lower bound over the displaced surface
  std::vector<std::int32_t> seeking;  ///< points whose foot is not yet the closest one
  std::vector<std::int32_t> near;     ///< of them those that may be inside
  PointLanes lanes, beside, across;
  QuadraticFit fit;
};

/// Rest-point search. For every point finds the rest point c whose displaced position c + u(c) is closest to it, and
/// moves the point next to c, at the same distance from the body at rest as it had from the deformed one. Drops points
/// that are not inside. Results for the moved points and the rest shape (Summarise, MeasureDepths) then hold for the
/// given points and the deformed shape. World coordinates and depth_m change; tool coordinates stay, since forces act
/// on the tool where it is.
///
/// The initial guess of c comes from a quadratic fit of the displacement across the region; Newton's method on the
/// displaced surface then improves it.
/// @param points with depth_m to the rest surface
using PullBack = InsideSummary (*)(const scene::Shape&, const DisplacedSurface&, RegionPoints&,
                                   PullBackScratch&) noexcept;
[[nodiscard]] PullBack pull_back_for(const scene::Shape&) noexcept;

}  // namespace touchstone::fast
