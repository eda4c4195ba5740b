#include "fast/run/run.h"

#include "fast/run/duration_histogram.h"
#include "fast/contact/separation.h"
#include "fast/step/several_regions.h"
#include "fast/step/step.h"
#include "fast/run/ticks.h"
#include "scene/model/rest_depth.h"

#include <xxhash.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

namespace touchstone::fast {
namespace {

using Clock = std::chrono::steady_clock;

std::int64_t nanoseconds(Clock::duration duration) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(duration).count();
}

/// Hash over every tick's force and the shape after the last.
class StateHash {
 public:
  StateHash() { XXH3_64bits_reset(state_.get()); }
  void add_force(const scene::Vec3& force_n) { XXH3_64bits_update(state_.get(), force_n.data(), sizeof(double) * 3); }
  [[nodiscard]] std::uint64_t finish(const SurfaceField& field) {
    for (const Columns3* columns : {&field.displacement_m, &field.normal}) {
      for (const auto& column : *columns)
        XXH3_64bits_update(state_.get(), column.data(), column.size() * sizeof(float));
    }
    return XXH3_64bits_digest(state_.get());
  }

 private:
  struct Free {
    void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
  };
  std::unique_ptr<XXH3_state_t, Free> state_{XXH3_createState()};
};

scene::InstantRecord record_of(const scene::RestDepth& depth, const FastModel& model, const FastState& state,
                               double time_s, const scene::Pose& pose) {
  scene::InstantRecord record;
  record.time_s = time_s;
  record.tool = pose;
  record.depth_m = depth.depth_m(pose);
  record.displacement_m = matrix_of(state.field.displacement_m);
  record.support_force_n = support_force_n(state);
  for (int i = 0; i < state.region_count; ++i) {
    const ContactRegion& region = state.regions[static_cast<std::size_t>(i)];
    if (!region.pressing()) continue;
    scene::RegionRecord out;
    out.id = region.id;
    out.depth_m = model.max_regions == 1 ? record.depth_m : region.extent.deepest_m;
    out.force_n = region.force.force_n;
    out.torque_nm = region.force.torque_nm;
    out.area_m2 = region.extent.area_m2;
    out.friction_n = region.force.tangential_n;
    out.sliding = region.friction.sliding;
    record.regions.push_back(out);
  }
  return record;
}

void add_beams(const FastModel& model, const FastState& state, double time_s, std::vector<BeamRecord>& beams) {
  std::vector<BeamStress> stress(model.skeleton.anchor_m.size());
  for (std::size_t k = 0; k < static_cast<std::size_t>(state.region_count); ++k) {
    const ContactRegion& region = state.regions[k];
    if (!region.pressing()) continue;
    // The first region meets the body at rest; only what later ones do to the others is kept.
    if (state.several == nullptr || state.several->order[0] == static_cast<int>(k)) {
      beam_stresses(model.skeleton, region.ends, stress);
    } else {
      stress = state.several->stress_pa[k];
    }
    for (std::size_t i = 0; i < stress.size(); ++i) {
      beams.push_back({time_s, region.id, static_cast<int>(i), model.skeleton.anchor_m[i],
                       region.ends.displacement_m[i], region.ends.force_n[i], stress[i]});
    }
  }
}

/// A depth that counts as contact, of the body's size: the depth is known better than that.
constexpr double missed_depth_rel = 1e-6;

}  // namespace

Run run(const scene::Scene& scene, const std::function<void(double)>& progress) {
  const Clock::time_point start = Clock::now();
  const FastModel model(scene);
  FastState state(model);
  Run run;
  run.setup_s = std::chrono::duration<double>(Clock::now() - start).count();
  run.surface = model.surface;
  run.memory_bytes = model.memory_bytes() + state.memory_bytes();

  const Separation separation(*model.body, run.surface, scene::tool_surface(scene.tool, scene.fast.tool_samples));
  run.first_contact_s = separation.first_contact_s(scene.track);
  const scene::RestDepth depth(*model.body, scene.tool);
  const double missed_depth_m = missed_depth_rel * scene::body_size_m(scene.body);
  Ticks ticks(scene);
  DurationHistogram step, force;
  StateHash hash;
  const std::int64_t report_every = std::max<std::int64_t>(1, ticks.count() / 100);
  for (std::optional<Tick> tick; (tick = ticks.next()); ++run.ticks) {
    const scene::Pose pose = scene::pose_at(scene.track, tick->time_s);
    const Clock::time_point begin = Clock::now();
    StepStatus status = step_force(model, pose, state);
    const Clock::time_point published = Clock::now();
    if (status != StepStatus::not_finite) status |= step_shape(model, state);
    const Clock::time_point end = Clock::now();

    step.add(nanoseconds(end - begin));
    if (state.in_contact()) {
      force.add(nanoseconds(published - begin));
      run.regions_max = std::max(run.regions_max, state.region_count);
    }
    run.status |= static_cast<std::uint32_t>(status);
    hash.add_force(total_force_n(state));
    if (tick->instant >= 0) {
      if (state.region_count > 1) {
        const OrderSpread spread = order_spread(model, state);
        run.order_spread_rel = std::max(run.order_spread_rel.value_or(0.0), spread.spread_rel);
        run.equilibrium_rel = std::max(run.equilibrium_rel.value_or(0.0), spread.equilibrium_rel);
      }
      run.instants.push_back(record_of(depth, model, state, tick->time_s, pose));
      if (run.instants.back().depth_m > missed_depth_m && !state.in_contact())
        run.status |= static_cast<std::uint32_t>(StepStatus::contact_missed);
      if (!state.in_contact()) run.instants.back().separation_m = separation.distance_m(pose);
      run.instants.back().normal = matrix_of(state.field.normal);
      add_beams(model, state, tick->time_s, run.beams);
    }
    if (progress && run.ticks % report_every == 0) {
      progress(std::min(1.0, static_cast<double>(run.ticks + 1) / static_cast<double>(ticks.count())));
    }
  }
  if (progress) progress(1.0);
  run.step = step.percentiles();
  run.force = force.percentiles();
  run.state_hash = hash.finish(state.field);
  return run;
}

}  // namespace touchstone::fast
