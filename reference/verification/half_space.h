// A rigid tool of revolution pressed upright into a half space: a cylinder so large that its end hardly shows, on the
// meshes that the solver takes for a scene.
#pragma once

#include "reference/run/contact_patch.h"
#include "reference/tool/tool_gap.h"
#include "scene/model/scene.h"

#include <Eigen/Core>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace touchstone::verification {

/// A tool, and where it will touch: the part of it deeper than half the depth, which for a ball is Hertz's radius.
struct Punch {
  /// A circle about the axis where the tool bends tightly.
  struct Rim {
    double radius_m;
    double bend_radius_m;  ///< 0: sharp
  };
  std::shared_ptr<const reference::ToolDistance> tool;
  double tip_m = 0.0;  ///< of the lowest point below the mass centre
  double patch_radius_m = 0.0;
  std::vector<Rim> rims = {};
};
[[nodiscard]] Punch ball_punch(double radius_m, double depth_m);
/// A flat end of a cylinder with a sharp rim.
[[nodiscard]] Punch flat_punch(double radius_m);
/// A cylinder's end with a fillet.
[[nodiscard]] Punch rounded_punch(double radius_m, double edge_radius_m, double depth_m);
/// A cone on its tip. @param half_angle from the axis [rad]
/// @param tip_radius_m of a ball in the tip, tangent to the flank; 0: sharp
[[nodiscard]] Punch cone_punch(double half_angle, double tip_radius_m, double depth_m);

struct HalfSpaceProblem {
  scene::Material material;
  Punch punch;
  double depth_m = 0.0;
  scene::Kinematics kinematics = scene::Kinematics::small;
  int level = 3;  ///< mesh of level_mesh(): 4, 8, 16, 32, ... cells to the patch's radius
  /// Cylinder's radius and height over the patch's radius. The far end adds about 1.13 / this to the force.
  double domain_over_patch = 3000.0;
  Eigen::VectorXd radii_m = {};         ///< where on the surface displacement and pressure are wanted
  Eigen::VectorXd below_m = {};         ///< how far below the surface, on the axis, stress is wanted
  std::optional<double> friction = {};  ///< Coulomb's coefficient
  int steps = 1;  ///< with friction the answer depends on them; a ball's contact grows by equal parts in each
};

struct HalfSpaceAnswer {
  double force_n = 0.0;
  double contact_radius_m = 0.0;
  double stick_radius_m = 0.0;    ///< halfway between the last sticking node and the next; 0 without friction
  double peak_pressure_pa = 0.0;  ///< on the axis
  double equilibrium_rel = 0.0;
  double node_penetration_m = 0.0;
  Eigen::VectorXd settlement_m;  ///< downwards, at radii_m
  Eigen::VectorXd pressure_pa;   ///< at radii_m
  Eigen::VectorXd shear_pa;      ///< outwards on the body, at radii_m
  Eigen::VectorXd stress_zz_pa;  ///< along the axis, at below_m
  Eigen::VectorXd stress_rr_pa;  ///< across it
  int unknowns = 0;
  int newton_iterations = 0;
};

/// @throws reference::NotConverged
[[nodiscard]] HalfSpaceAnswer indent_half_space(const HalfSpaceProblem& problem);

}  // namespace touchstone::verification
