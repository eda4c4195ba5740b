#include "compare/model/judge.h"

#include "compare/errors/compute_errors.h"
#include "compare/model/usual_models.h"
#include "fast/run/duration_histogram.h"
#include "fast/run/ticks.h"
#include "scene/model/rest_depth.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace touchstone::compare {
namespace {

scene::Answer at_rest(const scene::Surface& surface) { return {surface, {}}; }

void add_instant(scene::Answer& answer, double time_s, const scene::Pose& tool, double depth_m) {
  scene::InstantRecord& record = answer.instants.emplace_back();
  record.time_s = time_s;
  record.tool = tool;
  record.depth_m = depth_m;
  record.displacement_m.setZero(3, answer.surface.points_m.cols());
}

/// The model's own figure, else the median over the track's first ticks.
double step_p50_us(ContactModel& model, const scene::Scene& scene) {
  if (const std::optional<double> known_us = model.step_p50_us()) return *known_us;
  if (const std::optional<KnownSteps> known = model.known_steps()) return 1e6 * known->total_s / known->count;
  using Clock = std::chrono::steady_clock;
  constexpr std::uint64_t ticks_max = 10'000;
  fast::DurationHistogram steps;
  fast::Ticks ticks(scene);
  for (std::optional<fast::Tick> tick; steps.count() < ticks_max && (tick = ticks.next());) {
    const scene::Pose pose = scene::pose_at(scene.track, tick->time_s);
    const Clock::time_point begin = Clock::now();
    model.step(pose);
    steps.add(std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - begin).count());
  }
  return steps.percentiles().p50_us;
}

JudgedModel judged(const ModelEntry& entry, const scene::Scene& scene, const scene::Surface& surface,
                   const std::vector<scene::ReferenceInstant>& reference) {
  if (!entry.absent.empty()) return {.absent = entry.absent};
  try {
    const std::unique_ptr<ContactModel> model = entry.set_up(scene);
    const Errors errors = judge(entry, *model, scene, surface, reference);
    return {.force_nrmse = errors.force_nrmse,
            .shape_rel_l2 = errors.shape_rel_l2,
            .step_p50_us = step_p50_us(*model, scene),
            .pressure_rel_l2 = errors.contact_pressure_rel_l2,
            .pressure_peak_rel = errors.contact_pressure_peak_rel,
            .trouble = model->trouble()};
  } catch (const Unavailable& why) {
    return {.absent = why.what()};
  }
}

}  // namespace

scene::Answer unanswered(const scene::Surface& surface, const scene::Instants& instants) {
  scene::Answer answer = at_rest(surface);
  for (const scene::InstantRecord& instant : instants) {
    add_instant(answer, instant.time_s, instant.tool, instant.depth_m);
  }
  return answer;
}

scene::Answer unanswered(const scene::Scene& scene) {
  const auto body = scene::body_shape(scene.body);
  const scene::RestDepth depth(*body, scene.tool);
  scene::Answer answer = at_rest(scene::tessellate(*body, scene.fast.triangles));
  for (const double time_s : scene::instants_s(scene)) {
    const scene::Pose tool = scene::pose_at(scene.track, time_s);
    add_instant(answer, time_s, tool, depth.depth_m(tool));
  }
  return answer;
}

Errors errors_of(const ModelEntry& entry, const scene::Scene& scene, const scene::Answer& answer,
                 const std::vector<scene::ReferenceInstant>& reference) {
  Errors errors = compute_errors(scene, answer, reference);
  if (entry.gives_force) return errors;
  for (Measure* force : {&errors.force_nrmse, &errors.force_peak_rel, &errors.force_rel_deep,
                         &errors.force_friction_nrmse, &errors.force_friction_work_rel, &errors.force_torque_nrmse}) {
    *force = {};
  }
  errors.regions.clear();
  return errors;
}

Errors judge(const ModelEntry& entry, ContactModel& model, const scene::Scene& scene, const scene::Surface& surface,
             const std::vector<scene::ReferenceInstant>& reference) {
  scene::Answer answer = unanswered(surface, reference);
  model.answer(answer);
  return errors_of(entry, scene, answer, reference);
}

Contenders contenders(const scene::Scene& scene, const std::vector<std::filesystem::path>& parameters,
                      const std::vector<std::string>& keys, const std::function<void(const std::string&)>& say) {
  const ModelRequest request{.scene = scene, .parameters = parameters, .say = say};
  Contenders out{scene, usual_models(request)};
  for (const std::string& key : keys) {
    const auto same = [&](const ModelEntry& entry) { return entry.key == key; };
    if (std::ranges::any_of(out.models, same)) continue;
    ModelEntry& entry = out.models.emplace_back(find_model(request, key));
    entry.name = entry.label;  // a short name for the table
  }
  return out;
}

std::vector<JudgedModel> judge_models(const Contenders& contenders, const scene::Surface& surface,
                                      const std::vector<scene::ReferenceInstant>& reference, const JudgedModel& own) {
  std::vector<JudgedModel> models;
  for (const ModelEntry& entry : contenders.models) {
    JudgedModel& model = models.emplace_back(entry.own ? own : judged(entry, contenders.scene, surface, reference));
    model.key = entry.key;
    model.name = entry.name;
    model.method = entry.method;
  }
  return models;
}

}  // namespace touchstone::compare
