#include "fast/run/recording.h"

#include "fast/run/ticks.h"
#include "fast/step/stages.h"
#include "fast/step/step.h"
#include "scene/base/index.h"

#include <algorithm>
#include <array>

namespace touchstone::fast {
namespace {

using scene::Vec3;

/// A factor above the rounding error of a law and its inverse.
constexpr double rounding = 1.0 + 1e-6;

/// Columns of RecordedTick::numbers, in that order.
std::array<double**, 7> columns_of(RegionPoints& p) noexcept {
  return {&p.x_T_m, &p.y_T_m, &p.z_T_m, &p.depth_m, &p.rise1_m, &p.rise2_m, &p.share};
}

RecordedTick record(const FastState& state, int instant) {
  RecordedTick tick;
  tick.instant = instant;
  tick.in_region = state.region_count > 0;
  if (!tick.in_region) return tick;
  const ContactRegion& region = state.regions[0];
  tick.created = region.created;
  tick.motion = state.motion;
  tick.d = region.d;
  tick.extent = region.extent;
  tick.origin = region.origin;
  tick.points = region.points.count;
  tick.spread = region.points.spread;
  RegionPoints points = region.points;
  for (double** column : columns_of(points)) tick.numbers.insert(tick.numbers.end(), *column, *column + tick.points);
  return tick;
}

/// Whether a tool that may have several regions has only one, for any value of the constants.
class OneRegion {
 public:
  explicit OneRegion(const FastModel& model)
      : model_(model),
        cells_(model.cell_scratch()),
        scratch_(*model.clusters, model.max_points()),
        was_(samples(), 0) {}

  /// For a tick whose points, if any, are in the state's region, before their depths are measured.
  [[nodiscard]] bool holds(FastState& state) {
    RegionPoints reach = state.probe.window();
    find_points(model_, state.motion.at, bulge_m_, reach, cells_);
    if (state.region_count == 0) {
      last_.clear();
      return reach.count == 0;
    }
    std::vector<std::int32_t> inside, outside;
    for (int i = 0; i < reach.count; ++i) (reach.depth_m[i] > 0.0 ? inside : outside).push_back(reach.sample[i]);
    for (const std::int32_t far : outside) {
      if (std::none_of(inside.begin(), inside.end(), [&](std::int32_t near) { return joined(far, near); }))
        return false;
    }
    const bool kept = last_.empty() || std::any_of(inside.begin(), inside.end(),
                                                   [&](std::int32_t sample) { return nth(was_, sample) != 0; });
    for (const std::int32_t sample : last_) nth(was_, sample) = 0;
    for (const std::int32_t sample : inside) nth(was_, sample) = 1;
    last_ = std::move(inside);
    // A single cluster keeps the order of its points.
    std::array<Cluster, 2> found;
    return kept && cluster(*model_.clusters, state.regions[0].points, scratch_, found).count == 1;
  }

  /// Stores how far the surface may extend outside the rest shape after the tick.
  void remember(const FastState& state) noexcept {
    bulge_m_ = 0.0;
    if (state.region_count == 0) return;
    const RegionPoints& points = state.regions[0].points;
    for (int i = 0; i < points.count; ++i) bulge_m_ = std::max(bulge_m_, rounding * points.depth_m[i]);
  }

 private:
  [[nodiscard]] std::size_t samples() const noexcept { return static_cast<std::size_t>(model_.tool.count()); }
  [[nodiscard]] bool joined(std::int32_t a, std::int32_t b) const noexcept {
    const auto at = [&](std::int32_t sample) {
      const auto i = static_cast<std::size_t>(sample);
      return Vec3(model_.tool.x_T_m[i], model_.tool.y_T_m[i], model_.tool.z_T_m[i]);
    };
    return rounding * (at(a) - at(b)).norm() < model_.clusters->r_th_m;
  }

  const FastModel& model_;
  CellScratch cells_;
  ClusterScratch scratch_;
  std::vector<char> was_;           ///< per sample: inside in the last tick
  std::vector<std::int32_t> last_;  ///< the samples inside in the last tick
  double bulge_m_ = 0.0;
};

}  // namespace

std::optional<std::vector<RecordedTick>> record_one_region(const FastModel& model, const scene::Scene& scene,
                                                           std::size_t bytes_max) {
  const bool friction = model.formulas.resolve_friction != nullptr;
  std::optional<OneRegion> one;
  if (model.max_regions > 1) {
    if (friction) return std::nullopt;
    one.emplace(model);
  }
  FastState state(model, 1);
  std::vector<RecordedTick> recorded;
  std::size_t bytes = 0;
  Ticks ticks(scene);
  while (const std::optional<Tick> tick = ticks.next()) {
    const scene::Pose pose = scene::pose_at(scene.track, tick->time_s);
    step(model, pose, state, Parts::find);
    if (one && !one->holds(state)) return std::nullopt;
    step(model, pose, state, Parts::measure);
    if (one) one->remember(state);
    if (!friction && tick->instant < 0) continue;
    recorded.push_back(record(state, tick->instant));
    bytes += sizeof(RecordedTick) + recorded.back().numbers.size() * sizeof(double);
    if (bytes > bytes_max) return std::nullopt;
  }
  return recorded;
}

void recall(const RecordedTick& tick, FastState& state) noexcept {
  ContactRegion& region = state.regions[0];
  state.region_count = tick.in_region ? 1 : 0;
  if (!tick.in_region) {
    if (region.active) region.clear();
    return;
  }
  state.motion = tick.motion;
  region.active = true;
  region.created = tick.created;
  region.d = tick.d;
  region.extent = tick.extent;
  region.origin = tick.origin;
  region.points = {};
  region.points.count = tick.points;
  region.points.spread = tick.spread;
  // The points are only read from here on.
  auto* numbers = const_cast<double*>(tick.numbers.data());
  for (double** column : columns_of(region.points)) {
    *column = numbers;
    numbers += tick.points;
  }
}

}  // namespace touchstone::fast
