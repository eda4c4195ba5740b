#include "fast/run/run.h"

#include "fast/contact/separation.h"
#include "fast/run/duration_histogram.h"
#include "fast/run/make_engine.h"
#include "fast/run/ticks.h"
#include "fast/step/order_spread.h"
#include "fast/step/skeleton_engine.h"
#include "scene/base/stopwatch.h"
#include "scene/model/rest_depth.h"

#include <algorithm>
#include <memory>

namespace touchstone::fast {
namespace {

/// What only the beam skeleton can tell of an instant.
void add_skeleton(SkeletonEngine& engine, double time_s, Run& run) {
  const FastModel& model = engine.model();
  FastState& state = engine.state();
  if (state.region_count > 1) {
    const OrderSpread spread = order_spread(model, state);
    run.order_spread_rel = std::max(run.order_spread_rel.value_or(0.0), spread.spread_rel);
    run.equilibrium_rel = std::max(run.equilibrium_rel.value_or(0.0), spread.equilibrium_rel);
  }
  std::vector<BeamStress> stress(model.skeleton.anchor_m.size());
  for (std::size_t k = 0; k < static_cast<std::size_t>(state.region_count); ++k) {
    const ContactRegion& region = state.regions[k];
    if (!region.pressing()) continue;
    // The first region is evaluated on the body at rest; only the stress by later regions is recorded.
    if (state.several == nullptr || state.several->order[0] == static_cast<int>(k)) {
      beam_stresses(model.skeleton, region.ends, stress);
    } else {
      stress = state.several->stress_pa[k];
    }
    for (std::size_t i = 0; i < stress.size(); ++i) {
      run.beams.push_back({time_s, region.id, static_cast<int>(i), model.skeleton.anchor_m[i],
                           region.ends.displacement_m[i], region.ends.force_n[i], stress[i]});
    }
  }
}

/// Depth relative to the body's size that counts as contact; larger than the error of the depth.
constexpr double missed_depth_rel = 1e-6;

}  // namespace

Run run(const scene::Scene& scene, const std::function<void(double)>& progress) {
  const scene::Stopwatch watch;
  const std::unique_ptr<Engine> owned = make_engine(scene);
  Engine& engine = *owned;
  auto* const skeleton = dynamic_cast<SkeletonEngine*>(owned.get());
  Run run;
  run.setup_s = watch.wall_s();
  run.surface = engine.surface();
  run.memory_bytes = engine.memory_bytes();

  const Separation separation(engine.body(), run.surface, scene::tool_surface(scene.tool, scene.fast.tool_samples));
  run.first_contact_s = separation.first_contact_s(scene.track);
  const scene::RestDepth depth(engine.body(), scene.tool);
  const double missed_depth_m = missed_depth_rel * scene::body_size_m(scene.body);
  Ticks ticks(scene);
  DurationHistogram step, force;
  const std::int64_t report_every = std::max<std::int64_t>(1, ticks.count() / 100);
  for (std::optional<Tick> tick; (tick = ticks.next()); ++run.ticks) {
    const scene::Pose pose = scene::pose_at(scene.track, tick->time_s);
    const TimedStep timed = engine.step_timed(pose);
    step.add(timed.step_ns);
    if (engine.in_contact()) {
      force.add(timed.force_ns);
      run.regions_max = std::max(run.regions_max, engine.region_count());
    }
    run.status |= static_cast<std::uint32_t>(timed.status);
    if (tick->instant >= 0) {
      scene::InstantRecord& record = run.instants.emplace_back(engine.record(tick->time_s, pose, depth.depth_m(pose)));
      if (!engine.in_contact()) {
        record.separation_m = separation.distance_m(pose);
        if (record.depth_m > missed_depth_m) run.status |= static_cast<std::uint32_t>(StepStatus::contact_missed);
      }
      record.normal = matrix_of(engine.field().normal);
      if (skeleton != nullptr) add_skeleton(*skeleton, tick->time_s, run);
    }
    if (progress && run.ticks % report_every == 0) {
      progress(std::min(1.0, static_cast<double>(run.ticks + 1) / static_cast<double>(ticks.count())));
    }
  }
  if (progress) progress(1.0);
  run.step = step.percentiles();
  run.force = force.percentiles();
  run.state_hash = engine.answer_hash();
  return run;
}

}  // namespace touchstone::fast
