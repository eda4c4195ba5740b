// Groups contact points into regions, and matches these with the regions of the last instant.
#pragma once

#include "scene/base/frames.h"

#include <utility>
#include <vector>

namespace touchstone::reference {

/// One contact region of a solved state, of the whole body.
struct ContactRegion {
  scene::Vec3 force_n = scene::Vec3::Zero();              ///< on the tool, sum of pressures and friction
  scene::Vec3 torque_nm = scene::Vec3::Zero();            ///< on the tool, about its mass centre
  scene::Vec3 center_m = scene::Vec3::Zero();             ///< centre of pressure: mean of the contact points by force
  double area_m2 = 0.0;                                   ///< on the deformed surface
  Eigen::Vector2d half_axes_m = Eigen::Vector2d::Zero();  ///< long and short, see ReferenceInstant::contact_half_axes_m
  scene::Vec3 friction_n = scene::Vec3::Zero();           ///< part of force_n along the surface, summed over the nodes
  double stuck_share = 1.0;                               ///< of the normal force, carried by nodes that stick
};

/// Numbers the regions of points: two points are in one region exactly if a chain of points leads from one to the other
/// by links or by steps of at most gap_m.
/// @param links  pairs of points
/// @returns per point its region, numbered in the order of their first points
[[nodiscard]] std::vector<int> region_of_points(const Eigen::Matrix3Xd& points_m,
                                                const std::vector<std::pair<int, int>>& links, double gap_m);

/// Keeps the numbers of regions from instant to instant: the nearest pairs of old and new centres are matched, if
/// they are nearer than a reach; the other old ones end, and the other new ones take the smallest numbers free.
class RegionIds {
 public:
  struct Place {
    int id = 0;
    int region = 0;  ///< place in the list given
  };
  /// @returns the regions in the order of their creation, those of one instant by falling force
  std::vector<Place> follow(const std::vector<ContactRegion>& regions, double reach_m);

 private:
  struct Living {
    int id;
    scene::Vec3 center_m;
  };
  std::vector<Living> living_;  // in the order of creation
};

}  // namespace touchstone::reference
