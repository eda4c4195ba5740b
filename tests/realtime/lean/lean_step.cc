// A scene with one region, without friction, inclusion and local factor, stepped in three ways whose instructions are
// counted from outside: by the step; by only the stages that such a scene needs, called in sequence; and by the latter
// with an additional stage now and then, which the count must show.
#include "fast/step/step.h"

#include "support/press.h"

#include <cstdio>
#include <string_view>

namespace touchstone {
namespace {

using fast::ContactRegion;
using fast::FastModel;
using fast::FastState;

constexpr int ticks = 200;

scene::Pose pose_of(int tick) { return test::pressed(-0.0005 + 2e-5 * tick, 1e-5 * tick, 0.0); }

/// Only the stages that the scene needs.
void bare_tick(const FastModel& model, const scene::Pose& pose, FastState& state) {
  const fast::Placement at{pose.orientation.toRotationMatrix(), pose.position_m};
  ContactRegion& region = state.regions[0];
  fast::RegionPoints points = state.store.window();
  const fast::InsideSummary inside =
      model.detection.find_cells(*model.body, model.tool, at, model.cells->rule, 0.0, points, state.cells);
  if (points.count == 0) return;
  region.d = region.active ? fast::follow_direction(region.d, inside) : fast::direction_from(inside, region.d);
  region.active = true;
  region.points = points;
  region.extent = model.detection.measure_depths(*model.body, at.R_WT, region.d, region.points);
  region.origin = fast::deformation_origin(*model.body, model.detection.exit_distance_m, region.d, region.extent);
  fast::limit_depths(fast::depth_limit_rel * region.extent.thickness_m, region.points);
  model.formulas.distribute_mass(at.R_WT.transpose() * region.d, model.tool.groups, state.integrals, region.points);
  const fast::DuffingLaw law = model.law.at(fast::contact_radius_m(region.extent.area_m2));
  region.force = fast::region_force(law, at.R_WT, region.d, region.points);
  region.displacement_m = law.depth_m(region.force.magnitude_n) * region.d;
  model.formulas.split_force(model.skeleton, region.origin.p0_W_m, -region.force.force_n, region.displacement_m,
                             region.ends);
  fast::ContactPoint contact{region.displacement_m, region.origin.normal, region.origin.patch,
                             model.anchors->at(region.origin.patch, region.origin.p0_W_m)};
  model.formulas.interpolate(model.rest, region.ends.displacement_m, contact, state.field);
  fast::update_normals(model.normals, state.field);
}

void run(std::string_view how) {
  scene::Scene scene = test::ball_on_cube();
  scene.fast.C_n = 0.0;
  const FastModel model(scene);
  FastState state(model);
  for (int tick = 0; tick < ticks; ++tick) {
    const scene::Pose pose = pose_of(tick);
    if (how == "step") {
      fast::step(model, pose, state);
    } else {
      bare_tick(model, pose, state);
      if (how == "padded" && tick % 4 == 0 && state.regions[0].active) fast::update_normals(model.normals, state.field);
    }
  }
  std::printf("%.17g\n", fast::total_force_n(state).z() + state.regions[0].force.force_n.z());
}

}  // namespace
}  // namespace touchstone

/// @param argv[1] set_up | step | bare | padded
int main(int argc, char** argv) {
  const std::string_view how = argc > 1 ? argv[1] : "step";
  if (how == "set_up") {
    touchstone::scene::Scene scene = touchstone::test::ball_on_cube();
    scene.fast.C_n = 0.0;
    const touchstone::fast::FastModel model(scene);
    touchstone::fast::FastState state(model);
    std::printf("%.17g\n", 0.0);
    return 0;
  }
  touchstone::run(how);
}
