// Where on the body a tool will touch, and how finely that has to be resolved.
#pragma once

#include "reference/tool/tool_gap.h"
#include "scene/model/scene.h"

#include <vector>

namespace touchstone::reference {

/// A contact as expected from the shapes at rest.
struct ContactPatch {
  /// A piece of the rest surface.
  struct Disc {
    scene::Vec3 center_m;
    double radius_m;
  };
  /// A place where the tool bends more tightly than the patch is wide: the fillet of a punch.
  struct Rim {
    scene::Vec3 place_m;  ///< on the rest surface
    double bend_radius_m;
  };
  scene::Vec3 center_m, normal;  ///< on the rest surface
  double depth_m = 0.0;
  double half_width_m = 0.0;  ///< the smaller one: a circle's radius, a line contact's half width
  std::vector<Disc> discs;    ///< together they cover the patch
  std::vector<Rim> rims;
};

/// Points all over a tool's surface with the local bend, in the tool frame.
struct ToolPoints {
  Eigen::Matrix3Xd points_m;
  std::vector<double> bend_radius_m;  ///< 1 / the largest principal curvature
  double spacing_m = 0.0;
};
[[nodiscard]] ToolPoints tool_points(const scene::Tool& tool, const ToolDistance& distance);

/// The part of the tool that is deeper in the body at rest than half the depth there: for smooth surfaces exactly
/// Hertz's contact, sqrt(R d), and for a flat face all of it. Points nearer than gap_m are of one patch.
[[nodiscard]] std::vector<ContactPatch> contact_patches(const scene::Shape& body, const ToolPoints& tool,
                                                        const scene::Pose& pose, double gap_m);

}  // namespace touchstone::reference
