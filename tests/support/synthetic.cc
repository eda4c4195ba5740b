#include "support/synthetic.h"

#include "compare/errors/compute_errors.h"
#include "compare/errors/figures.h"
#include "compare/model/registry.h"
#include "compare/report/report.h"
#include "fast/command/results.h"
#include "scene/input/scene_io.h"
#include "support/source_folder.h"

#include <algorithm>
#include <cmath>

namespace touchstone::compare::testing {

using scene::Vec3;

scene::Scene ball_on_cube(int instants, int triangles) {
  scene::Scene scene;
  scene.name = "ball-on-cube-press";
  scene.title = "A ball pressed on a rubber cube (paper, Fig. 13)";
  scene.body.size_m = Vec3(0.06, 0.06, 0.06);
  scene.body.material = {3.0e6, 0.5};
  scene.tool.radius_m = 0.010;
  scene.tool.mass_kg = 1.0;
  scene.track = {{0.0, {Vec3(0.0, 0.0, 0.0705)}}, {1.1, {Vec3(0.0, 0.0, 0.0650)}}};
  scene.contact = {scene::ContactLaw::duffing, 40.0, 3.0e8};
  scene.fast.triangles = triangles;
  scene.fast.tool_samples = 500;
  scene.fast.rate_hz = 1000.0;
  scene.contact.r_th_m = 0.004;
  scene.fast.r_R_m = 0.015;
  scene.fast.C_n = 0.2;
  scene.fast.C_r_m = 0.002;
  scene.fast.s_c_m2 = 1.0e-3;
  scene.reference.levels = 3;
  scene.compare.instants = instants;
  return scene;
}

void set_force(scene::InstantRecord& record, const Vec3& force_n) {
  record.regions.resize(1);
  record.regions[0].depth_m = record.depth_m;
  record.regions[0].force_n = force_n;
}

Sides pressed(int instants, int triangles) {
  Sides sides;
  sides.scene = ball_on_cube(instants, triangles);
  const auto body = scene::body_shape(sides.scene.body);
  const scene::Surface surface = scene::tessellate(*body, triangles);
  const double radius_m = sides.scene.tool.radius_m;
  sides.run.surface = surface;
  const Eigen::Index points = surface.points_m.cols();
  // On the ball inside the contact, 1/r outside, zero at the support; the sides bulge.
  const auto reference_m = [&](const Vec3& p, double d) {
    const double height = p.z() / 0.06, r = std::hypot(p.x(), p.y());
    const double far = Vec3(p.x(), p.y(), p.z() - 0.06).norm(), a = std::sqrt(radius_m * d);
    const double under_m = far < 1e-9 || (p.z() > 0.0599 && r < 0.71 * a)
                               ? d - (radius_m - std::sqrt(radius_m * radius_m - r * r))
                               : 0.62 * d * 0.71 * a / std::max(far, 0.71 * a);
    return Vec3(0.05 * d * p.x() / 0.03 * height * (1 - height) * 4,
                0.05 * d * p.y() / 0.03 * height * (1 - height) * 4, -under_m * std::min(1.0, 1.4 * height));
  };
  const std::vector<double> level_factor = {0.982, 1.006, 1.0};
  for (std::size_t level = 0; level < 3; ++level) {
    sides.result.levels.push_back({2.0e-3 / static_cast<double>(1 << level),
                                   4300 << (3 * static_cast<int>(level)),
                                   96,
                                   static_cast<int>(level),
                                   2.4 * std::pow(11.0, static_cast<double>(level)),
                                   4.1 * std::pow(11.0, static_cast<double>(level)),
                                   {},
                                   {}});
  }
  for (const double time_s : scene::instants_s(sides.scene)) {
    scene::InstantRecord fast;
    scene::ReferenceInstant reference;
    fast.time_s = time_s;
    fast.tool = scene::pose_at(sides.scene.track, time_s);
    fast.depth_m = scene::rest_depth_m(*body, sides.scene.tool, fast.tool);
    fast.displacement_m = Eigen::Matrix3Xd::Zero(3, points);
    static_cast<scene::InstantRecord&>(reference) = fast;
    reference.displacement_uncertainty_m.setZero(points);
    const double d = fast.depth_m;
    if (d > 0.0) {
      const double fast_n = 40.0 * d + 3.0e8 * d * d * d;
      const double reference_n = 170.0 * std::pow(d / 0.005, 1.47);
      set_force(fast, Vec3(0.0, 0.0, fast_n));
      set_force(reference, Vec3(0.0, 0.0, reference_n));
      reference.support_force_n = Vec3(0.0, 0.0, reference_n);
      for (Eigen::Index i = 0; i < points; ++i) {
        const Vec3 p = surface.points_m.col(i);
        const double height = p.z() / 0.06, r = std::hypot(p.x(), p.y());
        reference.displacement_m.col(i) = reference_m(p, d);
        fast.displacement_m.col(i) =
            Vec3(0.0, 0.0, -(p.z() > 0.0599 ? d * std::max(0.0, 1.0 - r / 0.015) : 0.0) - 0.02 * d * height);
      }
      reference.force_uncertainty_n = 0.02 * reference_n;
      for (Eigen::Index i = 0; i < points; ++i) {
        reference.displacement_uncertainty_m[i] = 0.01 * reference.displacement_m.col(i).norm() + 1e-7;
      }
      reference.contact_half_axes_m.setConstant(std::sqrt(sides.scene.tool.radius_m * d));
      reference.contact_half_axes_uncertainty_m = 0.02 * reference.contact_half_axes_m;
      reference.residual_penetration_m = 2e-5 * d;
      reference.between_nodes_penetration_m = 4e-3 * d;
      reference.equilibrium_rel = 3e-11;
      reference.volume_change_rel = -1.4e-6 * d / 0.005;
    }
    for (std::size_t level = 0; level < 3; ++level) {
      sides.result.levels[level].force_n.push_back(level_factor[level] * reference.force_n().norm());
    }
    fast.normal = surface.normals;
    sides.run.instants.push_back(std::move(fast));
    sides.result.instants.push_back(std::move(reference));
  }
  reference::BoundarySurface& own = sides.result.deepest_surface;
  own.rest = scene::tessellate(*body, 19'200);
  own.displacement_m.resize(3, own.rest.points_m.cols());
  own.is_node.assign(static_cast<std::size_t>(own.rest.points_m.cols()), true);
  for (Eigen::Index i = 0; i < own.rest.points_m.cols(); ++i) {
    own.displacement_m.col(i) = reference_m(own.rest.points_m.col(i), sides.result.instants.back().depth_m);
  }
  // Like Hertz's, over 7 mm.
  own.traction_pa.setZero(3, own.rest.points_m.cols());
  for (Eigen::Index i = 0; i < own.rest.points_m.cols(); ++i) {
    const Vec3 p = own.rest.points_m.col(i);
    if (p.z() > 0.0599)
      own.traction_pa(2, i) = -2e6 * std::sqrt(std::max(0.0, 1.0 - p.head<2>().squaredNorm() / 4.9e-5));
  }
  sides.result.instants.back().pressure_peak_pa = 2e6;
  sides.result.instants.back().pressure_peak_uncertainty_pa = 3e4;
  sides.run.step = {11.2, 14.9, 21.7, 63.0};
  sides.run.force = {6.1, 8.4, 12.0, 30.0};
  sides.run.setup_s = 0.042;
  sides.run.memory_bytes = 3'400'000;
  sides.run.ticks = 1100;
  sides.run.regions_max = 1;
  sides.result.shape_uncertainty_rel = reference::shape_uncertainty_rel(sides.result.instants, surface.vertex_area_m2);
  sides.result.model = "quarter 3D u-p finite strain";
  sides.result.linear_solver = "CHOLMOD with OpenBLAS";
  sides.plans.fast = {{"contact law", true, "contact.law = \"duffing\"", "under 1 us"},
                      {"beam skeleton", true, "8 anchor points, the corners of the box", "about 3 us"},
                      {"friction", false, "the scene has none", ""}};
  sides.plans.reference = {{"quarter symmetry", true, "tool and track lie on both symmetry planes", "a quarter"},
                           {"pressure unknowns", true, "poissons_ratio = 0.5", "about 30,000 unknowns"},
                           {"friction", false, "the scene has none", ""}};
  sides.manifest = {"touchstone compare ball-on-cube-press.toml",
                    "4f1c09a7d2be55aa4f1c09a7d2be55aa",
                    sides.scene.title,
                    "title = \"A ball pressed on a rubber cube (paper, Fig. 13)\"\n\n[body]\nshape = \"box\"\n",
                    {{"version", "0.1.0"}, {"compiler", "GNU 12.2.0"}, {"date", "2026-01-01T00:00:00Z"}},
                    {{"fast", 1.2, 1.1}, {"reference", 317.0, 560.0}}};
  sides.call = {"meshes/scenes/ball-on-cube-press.toml", {}, {.levels = 3}, {}, "out/ball-on-cube-press-compare"};
  return sides;
}

Sides pressed_by_mallet(const std::filesystem::path& folder, int instants) {
  const std::filesystem::path source = source_folder() + "/meshes";
  std::filesystem::create_directories(folder / "scenes");
  std::filesystem::create_directories(folder / "tools");
  std::filesystem::copy(source / "tools/mallet.stl", folder / "tools");
  std::filesystem::copy(source / "scenes/mallet-head-on-cube.toml", folder / "scenes");
  Sides sides = pressed(instants, 200);
  const scene::Scene ball = sides.scene;
  sides.scene = scene::load_scene(folder / "scenes/mallet-head-on-cube.toml");
  sides.scene.track = ball.track;
  sides.scene.compare.instants = ball.compare.instants;
  sides.scene.fast.triangles = ball.fast.triangles;
  sides.scene.fast.rate_hz = 50.0;
  // The ball's centre is 10 mm above its lowest point, the mallet's 23.566 mm.
  constexpr double higher_m = 0.013566;
  for (scene::Waypoint& waypoint : sides.scene.track) waypoint.pose.position_m.z() += higher_m;
  for (std::size_t t = 0; t < sides.run.instants.size(); ++t) {
    sides.run.instants[t].tool.position_m.z() += higher_m;
    sides.result.instants[t].tool.position_m.z() += higher_m;
  }
  sides.manifest = scene::make_manifest(sides.scene, "touchstone compare");
  return sides;
}

std::string report_of(const Sides& sides) {
  const Errors errors = compute_errors(sides.scene, sides.run, sides.result.instants);
  const scene::Figures figures = make_figures(errors, sides.result, fast::figures(sides.run));
  const Verdict told = verdict(sides.scene, sides.run, sides.result, errors, sides.call, fast_model(sides.scene));
  const ComparisonDrawings drawings = comparison_drawings(sides.scene, sides.run, sides.result, errors);
  return report_html(
      {sides.scene, sides.run, sides.result, errors, figures, told, drawings, sides.plans, sides.manifest});
}

Sides small() {
  Sides sides;
  sides.scene = ball_on_cube(2, 8);
  sides.run.surface.points_m.resize(3, 4);
  sides.run.surface.points_m.col(0) = Vec3(0.0, 0.0, 0.06);
  sides.run.surface.points_m.col(1) = Vec3(0.03, 0.0, 0.0);
  sides.run.surface.points_m.col(2) = Vec3(-0.03, 0.03, 0.0);
  sides.run.surface.points_m.col(3) = Vec3(-0.03, -0.03, 0.0);
  sides.run.surface.normals = sides.run.surface.points_m.colwise().normalized();
  sides.run.surface.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
  sides.run.surface.patch_begin = {0, 4};
  sides.run.surface.vertex_area_m2 = {1.0, 2.0, 3.0, 4.0};
  for (std::size_t t = 0; t < 2; ++t) {
    scene::ReferenceInstant record;
    record.time_s = static_cast<double>(t);
    record.depth_m = t == 0 ? 0.001 : 0.010;
    record.tool.position_m = Vec3(0.0, 0.0, 0.07 - record.depth_m);
    record.displacement_m = Eigen::Matrix3Xd::Zero(3, 4);
    record.displacement_uncertainty_m.setZero(4);
    sides.result.instants.push_back(record);
    sides.run.instants.push_back(record);
    sides.run.instants.back().normal = sides.run.surface.normals;
  }
  return sides;
}

}  // namespace touchstone::compare::testing
