// Computes the rows of a trade: every model set up, judged and timed.
#include "compare/format/text.h"
#include "compare/model/judge.h"
#include "compare/trade/step_times.h"
#include "compare/trade/trade.h"
#include "fast/run/percentiles.h"
#include "reference/solver.h"
#include "scene/base/stopwatch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <utility>

namespace touchstone::compare {
namespace {

using scene::Scene;
using SolveLevels = std::function<reference::Result(const Scene&, const scene::Surface&, std::optional<int>)>;

class RowMaker {
 public:
  RowMaker(const Scene& scene, const TradeOptions& options, const SolveLevels& solve,
           const std::function<void(const std::string&)>& say)
      : scene_(scene), options_(options), solve_(solve), say_(say), poses_(scene) {
    trade_.title = scene.title.empty() ? scene.name : scene.title;
    trade_.tick_us = 1e6 / scene.fast.rate_hz;
    if (options.held_out.empty()) {
      trade_.contacts = {{trade_.title, "", scene}};
    } else {
      trade_.contacts = load_tuning_study(options.held_out, reference::unsupported).held_out;
      trade_.held_out = true;
      for (TuningContact& contact : trade_.contacts) contact.scene.fast.store = scene.fast.store;
    }
    // Faulty files are reported before any solve.
    for (const auto& file : options.parameters) (void)with_parameters(scene, file);
  }

  Trade rows_of(const std::vector<ModelList>& models) {
    ModelRequest request{scene_,
                         {},
                         options_.parameters,
                         options_.quick,
                         [this] { return reference_levels(); },
                         [this](const Scene& scene, const scene::Surface& surface, int levels) {
                           return reference_on(scene, surface, levels);
                         },
                         say_};
    for (const TuningContact& contact : trade_.contacts) request.contacts.push_back(contact.scene);
    for (const ModelEntry& entry : list_models(request, models)) add(entry);
    tell("steps of all models in turn");
    measure_by_turns(timed_, poses_, options_.quick ? 6 : 64);
    for (Timed& one : timed_) {
      TradeRow& row = trade_.rows[one.row];
      row.steps = static_cast<int>(one.step_us.size());
      const fast::Percentiles all = fast::percentiles(std::move(one.step_us));
      row.step_p50_us = all.p50_us;
      row.step_p999_us = all.p999_us;
    }
    return std::move(trade_);
  }

 private:
  void tell(const std::string& line) const {
    if (say_) say_(line);
  }

  /// The reference's result on a surface with this number of triangles, on the meshes chosen for the contact's own.
  /// Finer surfaces would ask for finer meshes, which take hours and are not worth a row.
  const TuningData& data_of(std::size_t contact, int triangles) {
    const int own = trade_.contacts[contact].scene.fast.triangles;
    std::optional<int> levels;
    if (triangles != own) levels = static_cast<int>(data_of(contact, own).result.levels.size());
    const auto [found, is_new] = data_.try_emplace({contact, triangles});
    if (is_new) {
      TuningContact one = trade_.contacts[contact];
      one.scene.fast.triangles = triangles;
      tell("reference of \"" + one.name + "\" on " + thousands_text(triangles) + " triangles");
      found->second = std::make_unique<TuningData>(tuning_data(
          one, [&](const Scene& scene, const scene::Surface& surface) { return solve_(scene, surface, levels); }));
    }
    return *found->second;
  }

  /// Number of meshes that every contact's reference has.
  int reference_levels() {
    int levels = std::numeric_limits<int>::max();
    for (std::size_t c = 0; c < trade_.contacts.size(); ++c) {
      const int solved = static_cast<int>(data_of(c, trade_.contacts[c].scene.fast.triangles).result.levels.size());
      levels = std::min(levels, solved);
    }
    return levels;
  }

  /// The result that the models are judged by, if it has this number of levels.
  reference::Result reference_on(const Scene& scene, const scene::Surface& surface, int levels) {
    for (const auto& [key, data] : data_) {
      const bool same = reference::content_key(data->contact.scene) == reference::content_key(scene);
      if (same && data->surface.points_m == surface.points_m &&
          static_cast<int>(data->result.levels.size()) == levels) {
        return data->result;
      }
    }
    return solve_(scene, surface, levels);
  }

  void add(const ModelEntry& entry) {
    TradeRow row{
        .name = entry.name, .key = entry.key, .label = entry.label, .family = entry.family, .absent = entry.absent};
    std::shared_ptr<ContactModel> model;
    if (row.absent.empty()) {
      tell(row.name);
      try {
        const scene::Stopwatch watch;
        model = entry.set_up(scene_);
        row.setup_s = watch.wall_s();
        row.size = model->size();
        row.memory_bytes = model->memory_bytes().value_or(row.memory_bytes);
        row.note = model->note();
        judge(entry, *model, row);
      } catch (const Unavailable& why) {
        row = {.name = entry.name, .key = entry.key, .family = entry.family, .absent = why.what()};
      }
    }
    if (!row.absent.empty()) row.label = row.name;
    const bool timed = row.absent.empty() && row.steps == 0;
    trade_.rows.push_back(std::move(row));
    if (timed) {
      timed_.push_back({trade_.rows.size() - 1, model});
    }
  }

  /// Errors of the row: the largest over the contacts. The model is set up anew for each contact's scene.
  void judge(const ModelEntry& entry, ContactModel& of_scene, TradeRow& row) {
    std::vector<std::string> troubles;
    KnownSteps known;
    for (std::size_t c = 0; c < trade_.contacts.size(); ++c) {
      const TuningData& data = data_of(c, entry.triangles.value_or(trade_.contacts[c].scene.fast.triangles));
      const std::unique_ptr<ContactModel> own = trade_.held_out ? entry.set_up(data.contact.scene) : nullptr;
      ContactModel& model = own ? *own : of_scene;
      const Errors errors = compare::judge(entry, model, data.contact.scene, data.surface, data.result.instants);
      const std::string trouble = model.trouble();
      if (!trouble.empty() && std::find(troubles.begin(), troubles.end(), trouble) == troubles.end())
        troubles.push_back(trouble);
      if (const std::optional<KnownSteps> steps = model.known_steps()) {
        known.total_s += steps->total_s;
        known.count += steps->count;
      }
      const auto keep_worst = [&](const Measure& one, Measure& worst, std::string& where) {
        if (!one.value) return;
        if (worst.value && judged_error(worst).value_or(INFINITY) >= judged_error(one).value_or(INFINITY)) return;
        worst = one;
        where = data.contact.name;
      };
      keep_worst(errors.force_nrmse, row.force_nrmse, row.force_contact);
      keep_worst(errors.shape_rel_l2, row.shape_rel_l2, row.shape_contact);
    }
    for (const std::string& trouble : troubles) row.note += (row.note.empty() ? "" : "; ") + trouble;
    if (known.count > 0) {
      row.step_p50_us = 1e6 * known.total_s / known.count;
      row.steps = known.count;
      row.setup_s = std::numeric_limits<double>::quiet_NaN();
    }
    if (entry.finest_reference && !row.force_nrmse.uncertainty) {
      row.force_nrmse = row.shape_rel_l2 = {};
      row.note =
          "the reference that the others are judged by; its uncertainty is unknown with fewer than three meshes; " +
          row.note;
    } else if (entry.finest_reference) {
      row.note = "the reference that the others are judged by: its error is its uncertainty; " + row.note;
    }
  }

  const Scene& scene_;
  const TradeOptions& options_;
  const SolveLevels& solve_;
  const std::function<void(const std::string&)>& say_;
  Poses poses_;
  Trade trade_;
  std::map<std::pair<std::size_t, int>, std::unique_ptr<TuningData>> data_;
  std::vector<Timed> timed_;
};

}  // namespace

Trade trade(const Scene& scene, const TradeOptions& options, const SolveLevels& solve,
            const std::function<void(const std::string&)>& say, const std::vector<ModelList>& models) {
  return RowMaker(scene, options, solve, say).rows_of(models);
}

}  // namespace touchstone::compare
