// A fast model that is looked at after every tick: whatever the scene and the pose, what it answers is finite and
// within the law's bound, the surface is whole and what the support holds is at rest.
#pragma once

#include "fast/contact/equivalent_point.h"
#include "fast/step/cell_rule.h"
#include "fast/step/stages.h"
#include "fast/step/step.h"
#include "support/press.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace touchstone::fast::extremes {

using scene::Formulation;
using scene::Vec3;

inline constexpr std::array both{Formulation::published, Formulation::corrected};

inline const char* name_of(Formulation formulation) {
  return formulation == Formulation::published ? "published" : "corrected";
}

/// A test runs its body under both, each named in what it reports.
#define IN_BOTH_FORMULATIONS(formulation)                                                                           \
  for (const ::touchstone::scene::Formulation formulation : ::touchstone::fast::extremes::both)                     \
    if (const ::testing::ScopedTrace trace(__FILE__, __LINE__, ::touchstone::fast::extremes::name_of(formulation)); \
        true)

/// A coarse surface and tool, since every vertex is looked at after every tick.
inline scene::Scene coarse(scene::Scene scene) {
  scene.fast.triangles = 300;
  scene.fast.tool_samples = 1000;
  return scene;
}
inline scene::Scene cube(Formulation formulation) { return coarse(test::ball_on_cube(formulation)); }
inline scene::Scene ball(Formulation formulation) { return coarse(test::ball_on_sphere(formulation)); }
inline scene::Scene ellipsoid(Formulation formulation, const Vec3& semi_axes_m, double support_height_m) {
  scene::Scene scene = cube(formulation);
  scene.body.shape = scene::BodyShape::ellipsoid;
  scene.body.semi_axes_m = semi_axes_m;
  scene.body.support_height_m = support_height_m;
  return scene;
}
/// The cube under a flat square punch: every sample of its foot is as deep as the others.
inline scene::Scene punch_on_cube(Formulation formulation, double side_m = 0.01) {
  scene::Scene scene = cube(formulation);
  scene.tool = {};
  scene.tool.shape = scene::ToolShape::box;
  scene.tool.size_m = Vec3(side_m, side_m, 0.02);
  scene.tool.mass_kg = 1.0;
  return scene;
}
/// The punch with its foot this deep.
inline scene::Pose punched(double depth_m, double x_m = 0.0) { return test::at(x_m, 0.0, 0.060 + 0.010 - depth_m); }

inline void add_box(const Vec3& lower_m, const Vec3& upper_m, scene::TriangleMesh& mesh) {
  const auto first = static_cast<std::int32_t>(mesh.points_m.cols());
  mesh.points_m.conservativeResize(3, first + 8);
  for (int i = 0; i < 8; ++i) {
    mesh.points_m.col(first + i) =
        Vec3((i & 1) != 0 ? upper_m.x() : lower_m.x(), (i & 2) != 0 ? upper_m.y() : lower_m.y(),
             (i & 4) != 0 ? upper_m.z() : lower_m.z());
  }
  constexpr std::array<std::array<int, 4>, 6> faces{
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  for (const auto& f : faces) {
    mesh.triangles.push_back({first + f[0], first + f[1], first + f[2]});
    mesh.triangles.push_back({first + f[0], first + f[2], first + f[3]});
  }
}
inline void use_mesh(scene::TriangleMesh mesh, scene::Scene& scene) {
  scene.tool = {};
  scene.tool.shape = scene::ToolShape::mesh;
  scene.tool.mass_kg = 1.0;
  scene.tool.mass_center_m = Vec3::Zero();
  scene.tool.mesh = std::make_shared<const scene::TriangleMesh>(std::move(mesh));
}
/// The cube under square pins whose feet stand around these places, z up from the tool's origin.
inline scene::Scene pins_on_cube(Formulation formulation, const std::vector<Vec3>& feet_m, double side_m = 0.003) {
  scene::Scene scene = cube(formulation);
  scene::TriangleMesh mesh;
  mesh.points_m.resize(3, 0);
  for (const Vec3& foot_m : feet_m) {
    add_box(foot_m - Vec3(0.5 * side_m, 0.5 * side_m, 0.0), foot_m + Vec3(0.5 * side_m, 0.5 * side_m, 0.02), mesh);
  }
  use_mesh(std::move(mesh), scene);
  scene.fast.max_regions = 10;
  scene.fast.s_c_m2 = 0.03;
  return scene;
}
/// Feet at z = 0 of the tool this deep.
inline scene::Pose sunk(double depth_m, double x_m = 0.0) { return test::at(x_m, 0.0, 0.060 - depth_m); }

/// The tool of one of these scenes with its lowest point this deep under the top of the cube.
inline scene::Pose in(const scene::Scene& scene, double depth_m, double x_m = 0.0) {
  switch (scene.tool.shape) {
    case scene::ToolShape::mesh:
      return sunk(depth_m, x_m);
    case scene::ToolShape::box:
      return punched(depth_m, x_m);
    default:
      return test::pressed(depth_m, x_m);
  }
}

[[nodiscard]] inline bool has(StepStatus status, StepStatus bit) { return (status | bit) == status; }

class Rig {
 public:
  explicit Rig(const scene::Scene& scene)
      : model(model_of(scene)), state(model), support_height_m_(static_cast<float>(scene.body.support_height_m)) {}

  StepStatus to(const scene::Pose& pose) {
    const StepStatus status = step(model, pose, state);
    if (broken_) return status;
    const std::string fault = fault_of(status);
    broken_ = !fault.empty();
    if (broken_) ADD_FAILURE() << fault << "\n  at " << pose.position_m.transpose();
    return status;
  }
  [[nodiscard]] bool broken() const { return broken_; }
  [[nodiscard]] const ContactRegion& region(std::size_t i = 0) const { return state.regions[i]; }
  [[nodiscard]] Vec3 force_n() const { return total_force_n(state); }
  /// The law at the region's size.
  [[nodiscard]] DuffingLaw law(std::size_t i = 0) const {
    return model.law.at(contact_radius_m(state.regions[i].extent.area_m2));
  }
  [[nodiscard]] Vec3 displacement_m(std::size_t vertex) const {
    const auto& u = state.field.displacement_m;
    return {u[0][vertex], u[1][vertex], u[2][vertex]};
  }
  [[nodiscard]] double largest_displacement_m() const {
    double largest_m = 0.0;
    for (std::size_t v = 0; v < model.rest.vertex_count(); ++v)
      largest_m = std::max(largest_m, displacement_m(v).norm());
    return largest_m;
  }
  /// The largest displacement of an anchor point.
  [[nodiscard]] double largest_end_m(std::size_t i = 0) const {
    double largest_m = 0.0;
    for (const Vec3& u_m : region(i).ends.displacement_m) largest_m = std::max(largest_m, u_m.norm());
    return largest_m;
  }
  /// What the beams of a region leave of its force on the body, over that force.
  [[nodiscard]] double imbalance(std::size_t i = 0) const {
    Vec3 sum_n = region(i).force.force_n;
    for (const Vec3& F_i : region(i).ends.force_n) sum_n += F_i;
    return sum_n.norm() / region(i).force.magnitude_n;
  }
  /// Of all that the next tick or the user may see.
  [[nodiscard]] std::uint64_t hash() const {
    std::uint64_t sum = 0;
    const auto mix = [&](const void* data, std::size_t bytes) {
      sum = 31 * sum + std::hash<std::string_view>{}({static_cast<const char*>(data), bytes});
    };
    mix(state.motion.pose.position_m.data(), 3 * sizeof(double));
    mix(state.motion.pose.orientation.coeffs().data(), 4 * sizeof(double));
    mix(&state.region_count, sizeof state.region_count);
    for (int i = 0; i < state.region_count; ++i) {
      const ContactRegion& r = region(static_cast<std::size_t>(i));
      mix(&r.id, sizeof r.id);
      mix(&r.depth_rel, sizeof r.depth_rel);
      mix(&r.friction.sliding, sizeof r.friction.sliding);
      for (const Vec3* v : {&r.d, &r.force.force_n, &r.force.torque_nm, &r.friction.stretch_m, &r.friction.motion,
                            &r.friction.d, &r.displacement_m, &r.origin.p0_W_m})
        mix(v->data(), 3 * sizeof(double));
    }
    if (state.several) mix(&state.several->bulge_m, sizeof state.several->bulge_m);
    for (const auto& column : state.field.displacement_m) mix(column.data(), column.size() * sizeof column[0]);
    for (const auto& column : state.field.normal) mix(column.data(), column.size() * sizeof column[0]);
    return sum;
  }

  FastModel model;
  FastState state;
  StepStatus may = StepStatus::ok;  ///< bits a tick may answer with
  double largest_factor = 1.0;      ///< of the local factor: beyond 1 only for a C_n past its limit
  double later_forces = 10.0;       ///< most that later regions' stresses may add, over the regions' own forces
  /// Hats of regions that come close are kept apart by their least pivot, which is 1 / 32.
  double hat_growth = 32.0;

 private:
  [[nodiscard]] std::string fault_of(StepStatus status) const {
    std::ostringstream out;
    if ((status | may) != may && status != StepStatus::not_finite)
      out << "status " << static_cast<int>(status) << " with bits beyond " << static_cast<int>(may);
    const double widest_m = (model.body->bounds().upper_m - model.body->bounds().lower_m).norm();
    double own_n = 0.0, moved_m = 0.0;
    for (int i = 0; i < state.region_count; ++i) {
      const ContactRegion& r = region(static_cast<std::size_t>(i));
      const DuffingLaw law_here = law(static_cast<std::size_t>(i));
      const double limit_m =
          depth_limit_rel * std::min(widest_m, r.extent.thickness_m > 0.0 ? r.extent.thickness_m : widest_m);
      if (!r.force.force_n.allFinite() || !r.force.torque_nm.allFinite() || !std::isfinite(r.force.magnitude_n))
        out << "a force or torque that is not finite";
      if (!r.force.load_center_m.allFinite() || !r.force.tangential_n.allFinite()) out << "a load that is not finite";
      if (!r.origin.p0_W_m.allFinite() || !r.displacement_m.allFinite()) out << "a contact point that is not finite";
      if (!(r.force.normal_n >= 0.0)) out << "a body that pulls";
      if (!(std::abs(r.d.norm() - 1.0) <= 1e-9)) out << "d of length " << r.d.norm();
      if (!model.friction) {
        const double most_n = law_here.force_n(limit_m);
        if (!(r.force.normal_n <= most_n * (1.0 + 1e-9))) out << "force " << r.force.normal_n << " N above " << most_n;
        if (!(r.displacement_m.norm() <= limit_m * (1.0 + 1e-9))) out << "D " << r.displacement_m.norm();
      } else {
        const double F_n = r.force.normal_n, F_t = r.force.tangential_n.norm();
        if (!(std::abs(r.force.tangential_n.dot(r.d)) <= 1e-9 * (F_t + F_n))) out << "friction along d";
        if (model.formulas.resolve_friction == resolve_friction_corrected) {
          // One potential in |D|^2 = D_n^2 + kappa D_t^2, and never more than the limit of the law, stuck or sliding.
          const double root = model.friction->stiffness_root();
          const double D_n = r.displacement_m.dot(r.d), D_t = (r.displacement_m - D_n * r.d).norm();
          const double F = law_here.secant_n_per_m(std::hypot(D_n, root * D_t)) * std::hypot(D_n, root * root * D_t);
          if (r.force.magnitude_n > 0.0 && state.several == nullptr &&
              !(std::abs(r.force.magnitude_n / F - 1.0) <= 1e-9))
            out << "force " << r.force.magnitude_n << " N, the law says " << F;
          if (!(F_t <= model.friction->limit_n(F_n) * (1.0 + 1e-9))) out << "friction beyond f_max: " << F_t << " N";
        }
      }
      own_n += std::hypot(r.force.normal_n, r.force.tangential_n.norm());
      moved_m += r.displacement_m.norm();
      for (const Vec3& F_i : r.ends.force_n)
        if (!F_i.allFinite()) out << "a beam's force that is not finite";
      for (const Vec3& u_i : r.ends.displacement_m)
        if (!(u_i.norm() <= r.displacement_m.norm() * (1.0 + 1e-9))) out << "an anchor point beyond the contact";
    }
    if (!(total_force_n(state).norm() <= (1.0 + (state.several ? later_forces : 1e-9)) * own_n)) out << "a total force";
    const double most_m =
        largest_factor * (state.several ? hat_growth : 2.0) * moved_m + 1e-6 * widest_m * (moved_m > 0.0);
    for (std::size_t v = 0; v < model.rest.vertex_count(); ++v) {
      const Vec3 u_m = displacement_m(v);
      const auto& n = state.field.normal;
      const Vec3 normal(n[0][v], n[1][v], n[2][v]);
      if (!(u_m.norm() <= most_m)) out << "vertex " << v << " moved by " << u_m.norm() << " of " << most_m << " m";
      if (!(std::abs(normal.norm() - 1.0) <= 1e-5)) out << "normal " << v << " of length " << normal.norm();
      if (model.rest.rest_W_m[2][v] <= support_height_m_ && !u_m.isZero(0.0))
        out << "vertex " << v << " left the support";
      if (out.tellp() > 400) break;
    }
    return out.str();
  }

  bool broken_ = false;
  float support_height_m_;
};

/// Largest change of the total force from tick to tick along a path, over slope times way, where the slope is the law's
/// at the deepest point: 1 for a straight press, somewhat more where the depth grows faster than the tool travels.
template <class PoseAt>
double steepest(Rig& rig, int ticks, const PoseAt& pose_at) {
  double steepest = 0.0;
  scene::Pose before = pose_at(0);
  rig.to(before);
  Vec3 force_n = rig.force_n();
  for (int i = 1; i <= ticks && !rig.broken(); ++i) {
    const scene::Pose now = pose_at(i);
    double slope = rig.law().slope_n_per_m(rig.region().extent.deepest_m);
    rig.to(now);
    slope = std::max(slope, rig.law().slope_n_per_m(rig.region().extent.deepest_m));
    const double explained_n = slope * (now.position_m - before.position_m).norm();
    steepest = std::max(steepest, (rig.force_n() - force_n).norm() / explained_n);
    force_n = rig.force_n();
    before = now;
  }
  return steepest;
}

}  // namespace touchstone::fast::extremes
