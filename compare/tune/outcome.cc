#include "compare/tune/outcome.h"

#include "compare/model/judge.h"
#include "compare/model/replay.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchstone::compare {
namespace {

using scene::Vec3;

/// Points of the rest surface under the reference's regions.
std::vector<Vec3> contact_points_m(const TuningData& data, std::size_t t) {
  const auto body = scene::body_shape(data.contact.scene.body);
  std::vector<Vec3> points_m = data.result.instants[t].region_middles_m;
  if (points_m.empty()) points_m.push_back(data.result.instants[t].tool.position_m);
  for (Vec3& p_m : points_m) p_m = body->query(p_m).point_m;
  return points_m;
}

double contact_area_m2(const scene::InstantRecord& record) {
  double area_m2 = 0.0;
  for (const scene::RegionRecord& region : record.regions) area_m2 += region.area_m2;
  return area_m2;
}

std::vector<RegimePoint> regime_of(const Tuning& tuning, const TuningData& data, const Errors& errors) {
  std::vector<Vec3> trained_m;
  for (const TuningData& other : tuning.data) {
    if (other.held_out()) continue;
    for (std::size_t t = 0; t < other.result.instants.size(); ++t) {
      if (other.result.instants[t].depth_m <= grazing_depth_m) continue;
      for (const Vec3& p_m : contact_points_m(other, t)) trained_m.push_back(p_m);
    }
  }
  const scene::Tool& tool = data.contact.scene.tool;
  std::vector<RegimePoint> regime;
  for (std::size_t t = 0; t < errors.instants.size(); ++t) {
    const InstantErrors& e = errors.instants[t];
    if (!e.deep || !e.force_error_rel) continue;
    RegimePoint point;
    point.depth_m = e.depth_m;
    point.area_m2 = contact_area_m2(data.result.instants[t]);
    const double radius_m = tool.radius_m > 0.0 ? tool.radius_m : std::sqrt(point.area_m2 / std::numbers::pi);
    point.depth_over_radius = e.depth_m / radius_m;
    point.force_error_rel = *e.force_error_rel;
    point.place_m = INFINITY;
    for (const Vec3& p_m : contact_points_m(data, t)) {
      for (const Vec3& q_m : trained_m) point.place_m = std::min(point.place_m, (p_m - q_m).norm());
    }
    regime.push_back(point);
  }
  return regime;
}

/// shape.rel_l2 over the instants that are fitted.
double shape_error_rel(const TuningData& data, const scene::Scene& scene, ModelReplay& replay) {
  double error2 = 0.0, scale2 = 0.0;
  (void)replay.forces_n(scene);
  replay.displacements(scene, data.instants, [&](std::size_t t, const auto& fast_m) {
    const Eigen::Matrix3Xd& reference_m = data.result.instants[t].displacement_m;
    const auto area_m2 = Eigen::Map<const Eigen::VectorXd>(data.surface.vertex_area_m2.data(), reference_m.cols());
    error2 += area_m2.dot((fast_m - reference_m).colwise().squaredNorm().transpose());
    scale2 += area_m2.dot(reference_m.colwise().squaredNorm().transpose());
  });
  return std::sqrt(error2 / scale2);
}

}  // namespace

TuningOutcome outcome_of(const Tuning& tuning, const TunedModel& model, std::size_t at) {
  const TuningData& data = tuning.data[at];
  const scene::Scene scene = tuned_scene(data.contact.scene, model);
  TuningOutcome out{at, judge(model.entry, *model.entry.set_up(scene), scene, data.surface, data.result.instants), {}};
  out.regime = regime_of(tuning, data, out.errors);
  return out;
}

std::vector<double> shape_parts_of(const TuningData& data, const TunedModel& model) {
  const scene::Scene whole = tuned_scene(data.contact.scene, model);
  std::vector<double> errors;
  if (model.entry.account.parts.empty()) return errors;
  const std::unique_ptr<ModelReplay> replay = replay_of(model.entry, whole);
  for (const ModelParts& parts : model.entry.account.parts)
    errors.push_back(shape_error_rel(data, parts.change(whole), *replay));
  return errors;
}

}  // namespace touchstone::compare
