#include "compare/model/response_model.h"

#include "compare/format/text.h"
#include "compare/model/engine_model.h"
#include "fast/command/stop_signals.h"
#include "reference/run/cost.h"
#include "reference/run/options.h"
#include "scene/base/error.h"
#include "scene/base/stopwatch.h"
#include "scene/model/solid_kinds.h"
#include "scene/response/response.h"

#include <fmt/format.h>

#include <optional>

namespace touchstone::compare {
namespace {

void prepare_missing_response(const scene::Scene& scene, const Say& say) {
  const reference::Prepared prepared = prepare(scene, scene.fast.store, [&](const std::string& line, bool marked) {
    if (say && marked) say(line);
  });
  if (prepared.computed && say) {
    say(fmt::format("the body's response: {} columns in {:.3g} s: {}", prepared.response.own_m_per_n.cols(),
                    prepared.seconds, prepared.file.string()));
  }
}

/// The falloff next to an inclusion, where a trial gives smaller errors.
void advise_falloff(Advice& advice) {
  const scene::Scene& scene = advice.scene();
  const Errors& errors = advice.errors();
  if (scene.body.inclusions.empty() || !errors.force_nrmse.value || !errors.shape_rel_l2.value) return;
  const auto sum = [](const Trial& trial) { return trial.force_nrmse + trial.shape_rel_l2; };
  const Trial before{*errors.force_nrmse.value, *errors.shape_rel_l2.value};
  Trial best = before;
  for (const double share : {16.0, 32.0, 8.0}) {  // of the body's size over the layer's thickness, about
    if (!advice.time_left()) break;
    scene::Scene changed = scene;
    changed.fast.body_falloff_per_m = share / scene::body_size_m(scene.body);
    if (const Trial trial = advice.tried(changed); sum(trial) < sum(best)) best = trial;
  }
  if (sum(best) > Advice::worth_it * sum(before)) return;
  advice.tune("meshes/studies/soft-ball.toml",
              fmt::format(" Tried with a guess: force error from {} to {}, shape error from {} to {}.",
                          percent_text(before.force_nrmse), percent_text(best.force_nrmse),
                          percent_text(before.shape_rel_l2), percent_text(best.shape_rel_l2)));
}

}  // namespace

reference::Prepared prepare(const scene::Scene& scene, const std::filesystem::path& store,
                            const std::function<void(const std::string&, bool)>& show) {
  using Next = reference::SmoothProgress::Next;
  // Before its first column a computation cannot be stopped and has nothing to keep.
  std::optional<fast::EndSignals> ends(
      "interrupted; no new column of the body's response was finished, so the next run begins where this one did");
  std::optional<fast::StopSignals> stops;
  const scene::Surface surface = scene::tessellate(*scene::body_shape(scene.body), scene.fast.triangles);
  scene::Stopwatch watch;
  Eigen::Index first = 0;  // column of this run
  const auto progress = [&](const reference::SmoothProgress& now) {
    const Eigen::Index done = now.first.done, all = now.first.response.own_m_per_n.cols();
    if (stops && fast::StopSignals::asked()) {
      throw reference::Interrupted(fmt::format(
          "interrupted; {} of {} columns of the body's response are kept, and the next run goes on from there", done,
          all));
    }
    if (now.next == Next::mesh) {
      show("the body's response, computed once: mesh", true);
    } else if (now.next == Next::matrix) {
      first = done + 1;
      const int unknowns = now.first.response.unknowns;
      const reference::Cost cost = reference::expected_cost({.unknowns = 1.0 * unknowns, .load_steps = 1}, 1);
      show(fmt::format("the body's response: factorisation of {} unknowns, about {} on an idle machine; then {}{} "
                       "columns",
                       unknowns, reference::duration_text(cost.seconds / cost.newton_iterations),
                       done > 0 ? fmt::format("{} of ", all - done) : "", all),
           true);
    } else if (done == first) {
      // Its time is also that of the factorisation.
      watch = {};
      ends.reset();
      stops.emplace(fast::StopSignals::Again::end_at_once);
    } else if (done < all) {
      const double left_s = watch.wall_s() * static_cast<double>(all - done) / static_cast<double>(done - first);
      show(fmt::format("the body's response: {} of {} columns, about {} left", done, all,
                       reference::duration_text(left_s)),
           done == first + 1);
    }
  };
  return reference::prepare_response(scene, surface, store, progress);
}

scene::Scene with_response(scene::Scene scene) {
  scene.fast.formulation = scene::Formulation::response;
  return scene;
}

ModelEntry response_model(const scene::Scene&, const Say& say) {
  return {.name = "response",
          .key = "response",
          .label = "response",
          .method = "half space, response",
          .family = ModelFamily::response,
          .prepare = prepare_missing_response,
          .set_up =
              [say](const scene::Scene& scene) {
                if (const std::string needs = scene::response_needs(scene); !needs.empty()) {
                  throw Unavailable("the response model needs that " + needs);
                }
                try {
                  prepare_missing_response(scene, say);
                } catch (const scene::InputError& error) {
                  throw Unavailable(error.what());
                }
                return engine_model(scene);
              },
          .replay =
              [](const scene::Scene& scene) {
                prepare_missing_response(scene, {});
                return engine_replay(scene);
              },
          .account = {.advise = advise_falloff}};
}

std::vector<ModelEntry> response_models(const ModelRequest& request) {
  ModelEntry entry = changed(response_model(request.scene, request.say), with_response);
  entry.name = "response, from the material and the body's linear response";
  return {entry};
}

}  // namespace touchstone::compare
