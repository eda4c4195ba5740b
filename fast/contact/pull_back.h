// Contact with the already deformed body (section VI): a later region sees Shape_{i-1}, the body under the regions
// before it. Instead of a distance to that shape, which changes every tick, its points are taken back to the body at
// rest.
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

/// What pull_back() writes on its way; its content does not outlast a call. Storage is fixed at construction.
struct PullBackScratch {
  /// @param points at most
  explicit PullBackScratch(int points);
  [[nodiscard]] std::size_t memory_bytes() const noexcept;

  /// Where the displaced surface is closest to a point p.
  struct Foot {
    scene::SurfaceQuery rest;   ///< c
    scene::Vec3 off_m;          ///< p - c - u(c), of the best c so far
    scene::Vec3 from_m, way_m;  ///< the last step, to c
    scene::Vec3 normal;         ///< of the displaced surface where it began
    double distance_m;          ///< signed, of p; 0 where it is not inside for sure
    bool overshot;              ///< the last step led further off
    bool settled;               ///< the last step was short
  };
  std::vector<Foot> foot;             ///< per point
  std::vector<double> height_m;       ///< per point, over the displaced surface at least
  std::vector<std::int32_t> seeking;  ///< points whose foot is not yet the closest one
  std::vector<std::int32_t> near;     ///< of them those that may be inside
  PointLanes lanes, beside, across;
  QuadraticFit fit;
};

/// Takes every point back beside the rest point c whose displaced place c + u(c) is closest to it, as far from the body
/// at rest as it was from the deformed one, and drops those that are not inside. What is then found out about the
/// points and the rest shape (Summarise, MeasureDepths) is true of the given points and the deformed one. World
/// coordinates and depth_m change; tool coordinates stay, for forces act where the tool is.
///
/// The foot of a point is first guessed from the displacement across the region, taken as quadratic, and then followed
/// down the slope of the displaced surface by Newton's method.
/// @param points with depth_m to the rest surface
template <class Body>
InsideSummary pull_back(const scene::Shape& shape, const DisplacedSurface& surface, RegionPoints& points,
                        PullBackScratch& scratch) noexcept;

}  // namespace touchstone::fast
