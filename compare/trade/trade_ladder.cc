// The rungs: what is built, judged and measured.
#include "compare/format/text.h"
#include "compare/report/model_table.h"
#include "compare/trade/linear_contact.h"
#include "compare/trade/trade.h"
#include "fast/run/ticks.h"
#include "fast/step/engine.h"
#include "reference/run/cost.h"
#include "reference/solver.h"
#include "scene/input/fields.h"

#ifdef TOUCHSTONE_BULLET
#include "compare/errors/compute_errors.h"
#include "fast/bench/bullet_peer.h"
#endif

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

namespace touchstone::compare {
namespace {

using Clock = std::chrono::steady_clock;
using scene::Scene;
using SolveLevels = std::function<reference::Result(const Scene&, const scene::Surface&, std::optional<int>)>;

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

std::string thousands(int count) { return count < 1000 ? std::to_string(count) : fmt::format("{:.0f}k", 1e-3 * count); }

scene::Surface surface_of(const Scene& scene) {
  return scene::tessellate(*scene::body_shape(scene.body), scene.fast.triangles);
}

/// Poses of the ticks in contact, there and back again without end, so that no step jumps.
class Poses {
 public:
  explicit Poses(const Scene& scene) {
    const auto body = scene::body_shape(scene.body);
    fast::Ticks ticks(scene);
    if (ticks.count() > ticks_max) {
      throw scene::InputError(fmt::format(
          "the track takes {} ticks at fast.rate_hz = {} Hz, and every model steps there and back: expected "
          "at most {}",
          ticks.count(), scene.fast.rate_hz, ticks_max));
    }
    while (const std::optional<fast::Tick> tick = ticks.next()) {
      const scene::Pose pose = scene::pose_at(scene.track, tick->time_s);
      if (scene::rest_depth_m(*body, scene.tool, pose) > grazing_depth_m) poses_.push_back(pose);
    }
    if (poses_.empty()) throw scene::InputError("the tool never touches the body on this track: nothing to trade");
  }
  [[nodiscard]] const scene::Pose& at(std::size_t step) const {
    const std::size_t n = poses_.size(), k = step % (2 * n);
    return poses_[k < n ? k : 2 * n - 1 - k];
  }
  [[nodiscard]] std::size_t round_trip() const { return 2 * poses_.size(); }

 private:
  static constexpr std::int64_t ticks_max = 1'000'000;
  std::vector<scene::Pose> poses_;
};

/// A model whose steps are measured.
struct Timed {
  std::size_t row = 0;
  std::function<void(const scene::Pose&)> step;
  std::size_t next = 0;  ///< pose
  std::size_t block = 32;
  std::vector<double> step_us{};
};

/// All models by turns, so that a machine that drifts does it to all, and each there and back at least once. Of every
/// turn the last steps are measured: the first ones bring back what the others drove out of the caches.
void measure(std::vector<Timed>& models, const Poses& poses, bool quick, std::vector<TradeRow>& rows) {
  constexpr std::size_t warming_steps = 2;
  constexpr double slow_us = 2000.0;
  const std::size_t rounds = quick ? 6 : 64;
  for (Timed& model : models) {
    const Clock::time_point begin = Clock::now();
    model.step(poses.at(model.next++));
    model.step(poses.at(model.next++));
    if (0.5e6 * seconds_since(begin) > slow_us) model.block = 2;
  }
  for (std::size_t round = 0; round < rounds; ++round) {
    for (Timed& model : models) {
      const std::size_t steps = std::max(warming_steps + model.block, poses.round_trip() / rounds + 1);
      for (std::size_t k = model.block; k < steps; ++k) model.step(poses.at(model.next++));
      for (std::size_t k = 0; k < model.block; ++k) {
        const scene::Pose& pose = poses.at(model.next++);
        const Clock::time_point begin = Clock::now();
        model.step(pose);
        model.step_us.push_back(1e6 * seconds_since(begin));
      }
    }
  }
  for (Timed& model : models) {
    TradeRow& row = rows[model.row];
    row.steps = static_cast<int>(model.step_us.size());
    const fast::Percentiles all = fast::percentiles(std::move(model.step_us));
    row.step_p50_us = all.p50_us;
    row.step_p999_us = all.p999_us;
  }
}

/// A run of another model than the fast one, in the fast one's records.
fast::Run empty_run(const scene::Surface& surface, const reference::Result& result) {
  fast::Run run;
  run.surface = surface;
  for (const scene::InstantRecord& instant : result.instants) {
    scene::InstantRecord record;
    record.time_s = instant.time_s;
    record.tool = instant.tool;
    record.depth_m = instant.depth_m;
    record.displacement_m = Eigen::Matrix3Xd::Zero(3, surface.points_m.cols());
    run.instants.push_back(std::move(record));
    run.normals.emplace_back(Eigen::Matrix3Xd::Zero(3, surface.points_m.cols()));
  }
  return run;
}

class Ladder {
 public:
  Ladder(const Scene& scene, const TradeOptions& options, const SolveLevels& solve,
         const std::function<void(const std::string&)>& say)
      : scene_(scene), options_(options), solve_(solve), say_(say), poses_(scene) {
    trade_.title = scene.title.empty() ? scene.name : scene.title;
    trade_.tick_us = 1e6 / scene.fast.rate_hz;
    if (options.held_out.empty()) {
      trade_.contacts = {{trade_.title, "", scene}};
    } else {
      trade_.contacts = load_tuning_study(options.held_out, reference::unsupported).held_out;
      trade_.held_out = true;
    }
    // Bad files are refused before any work.
    for (const auto& file : options.parameters) (void)with_parameters(scene, file);
  }

  Trade climb() {
    skeletons();
    meshes();
    absent("anchor sets", "anchors", TradeFamily::paper,
           "the anchor points follow from the body's shape by the paper's rule: no scene has a setting for them");
    compliances();
    peers();
    reference_levels();
    tell("steps of every model by turns");
    measure(timed_, poses_, options_.quick, trade_.rows);
    return std::move(trade_);
  }

 private:
  using Change = std::function<Scene(Scene)>;
  /// A model's answer at the instants of a contact that count.
  using Answer = std::function<fast::Run(const TuningData&)>;

  void tell(const std::string& line) const {
    if (say_) say_(line);
  }

  TradeRow& add(TradeRow row) { return trade_.rows.emplace_back(std::move(row)); }

  void absent(const std::string& name, const std::string& key, TradeFamily family, const std::string& why) {
    add({.name = name, .key = key, .label = name, .family = family, .absent = why});
  }

  /// The reference's answer on a surface of so many triangles, from the meshes that the contact's own surface asks for:
  /// on finer ones the shape is known less well, and a row more is not worth hours of another mesh.
  const TuningData& data_of(std::size_t contact, int triangles) {
    const int own = trade_.contacts[contact].scene.fast.triangles;
    std::optional<int> levels;
    if (triangles != own) levels = static_cast<int>(data_of(contact, own).result.levels.size());
    const auto [found, is_new] = data_.try_emplace({contact, triangles});
    if (is_new) {
      TuningContact one = trade_.contacts[contact];
      one.scene.fast.triangles = triangles;
      tell("reference of \"" + one.name + "\" on " + thousands(triangles) + " triangles");
      found->second = std::make_unique<TuningData>(tuning_data(
          one, [&](const Scene& scene, const scene::Surface& surface) { return solve_(scene, surface, levels); }));
    }
    return *found->second;
  }

  /// The row's errors: the worst of the contacts.
  void judge(TradeRow& row, std::optional<int> triangles, bool with_force, const Answer& answer) {
    for (std::size_t c = 0; c < trade_.contacts.size(); ++c) {
      const TuningData& data = data_of(c, triangles.value_or(trade_.contacts[c].scene.fast.triangles));
      const Errors errors = compute_errors(data.contact.scene, answer(data), data.result);
      const auto keep_worst = [&](const Measure& one, Measure& worst, std::string& where) {
        if (!one.value) return;
        if (worst.value && judged_error(worst).value_or(INFINITY) >= judged_error(one).value_or(INFINITY)) return;
        worst = one;
        where = data.contact.name;
      };
      if (with_force) keep_worst(errors.force_nrmse, row.force_nrmse, row.force_contact);
      keep_worst(errors.shape_rel_l2, row.shape_rel_l2, row.shape_contact);
    }
  }

  void add_skeleton(TradeRow row, const Change& change, std::optional<int> triangles) {
    tell(row.name);
    Scene scene = change(scene_);
    if (triangles) scene.fast.triangles = *triangles;
    const Clock::time_point begin = Clock::now();
    const auto engine = std::make_shared<fast::Engine>(scene);
    row.setup_s = seconds_since(begin);
    row.memory_bytes = static_cast<double>(engine->memory_bytes());
    row.size = engine->model().surface.triangle_count();
    std::uint32_t status = 0;
    judge(row, triangles, true, [&](const TuningData& data) {
      fast::Run run = fast::run(change(data.contact.scene));
      status |= run.status;
      keep_instants(run, data.instants);
      return run;
    });
    if (status != 0) row.note = "status of its steps: " + fast::status_text(status);
    add(std::move(row));
    timed_.push_back({trade_.rows.size() - 1, [engine](const scene::Pose& pose) { engine->step(pose); }});
  }

  void skeletons() {
    const bool duffing = scene_.contact.law == scene::ContactLaw::duffing;
    for (const auto formulation : {scene::Formulation::published, scene::Formulation::corrected}) {
      const std::string name = formulation == scene::Formulation::published ? "published" : "corrected";
      if (duffing) {
        add_skeleton({.name = name + " skeleton, Duffing law of the scene", .key = name + "-duffing", .label = name},
                     [=](Scene scene) {
                       scene.fast.formulation = formulation;
                       return scene;
                     },
                     {});
      } else {
        absent(name + " skeleton, Duffing law", name + "-duffing", TradeFamily::paper,
               "the scene's law is the area-aware one");
      }
      // Without a constant of the scene's own, the material's, which nothing has to be tuned for.
      const std::string from = duffing ? "k1 and s_c of material and size" : "of the scene";
      add_skeleton({.name = name + " skeleton, area-aware law, " + from,
                    .key = name + "-area-aware",
                    .label = name + ", area-aware",
                    .family = TradeFamily::area_aware},
                   [=](Scene scene) {
                     scene.fast.formulation = formulation;
                     return duffing ? with_untuned_area_law(std::move(scene)) : scene;
                   },
                   {});
    }
    for (const std::filesystem::path& file : options_.parameters) {
      const Scene tuned = with_parameters(scene_, file);
      const bool area_aware = tuned.contact.law == scene::ContactLaw::area_aware;
      const std::string formulation =
          tuned.fast.formulation == scene::Formulation::published ? "published" : "corrected";
      add_skeleton({.name = fmt::format("{} skeleton, {} law, tuned ({})", formulation,
                                        area_aware ? "area-aware" : "Duffing", file.filename().string()),
                    .key = "tuned-" + file.stem().string(),
                    .label = formulation + (area_aware ? ", area-aware" : "") + ", tuned",
                    .family = area_aware ? TradeFamily::area_aware : TradeFamily::paper},
                   [file](const Scene& scene) { return with_parameters(scene, file); }, {});
    }
  }

  /// Meshes of the corrected skeleton, tuned where there is a parameter file.
  void meshes() {
    const std::vector<int> sizes = options_.quick ? std::vector{400, 1000} : std::vector{1000, 3952, 16000, 100000};
    for (const int triangles : sizes) {
      if (triangles == scene_.fast.triangles) continue;  // is there already
      const bool tuned = !options_.parameters.empty();
      const Change change = [this, tuned, triangles](Scene scene) {
        if (tuned) scene = with_parameters(std::move(scene), options_.parameters.front());
        scene.fast.formulation = scene::Formulation::corrected;
        scene.fast.triangles = triangles;
        return scene;
      };
      const bool area_aware = change(scene_).contact.law == scene::ContactLaw::area_aware;
      add_skeleton(
          {.name = fmt::format("corrected skeleton{}, {} triangles", tuned ? ", tuned" : "", thousands(triangles)),
           .key = "corrected-" + thousands(triangles),
           .label = thousands(triangles),
           .family = area_aware ? TradeFamily::area_aware : TradeFamily::paper},
          change, triangles);
    }
  }

  void compliances() {
    const int levels = options_.quick ? 1 : 2;
    for (int level = 0; level < levels; ++level) {
      TradeRow row{.name = fmt::format("linear compliance, mesh {}", level + 1),
                   .key = fmt::format("compliance-{}", level + 1),
                   .label = fmt::format("compliance {}", level + 1),
                   .family = TradeFamily::compliance};
      tell(row.name);
      try {
        const Clock::time_point begin = Clock::now();
        const reference::LinearResponse response =
            reference::linear_response(scene_, surface_of(scene_).points_m, {.level = level});
        const auto model = std::make_shared<LinearContact>(response, scene_.tool);
        row.setup_s = seconds_since(begin);
        row.memory_bytes = static_cast<double>(model->memory_bytes());
        row.size = response.unknowns;
        row.note =
            fmt::format("{}, {} nodes may be touched; displacements only, no normals", response.model, model->nodes());
        if (response.model.starts_with("axisymmetric")) {
          row.note += "; a tool that leaves the axis would need the whole body";
        }
        bool solved = true;
        judge(row, {}, true, [&](const TuningData& data) {
          std::unique_ptr<LinearContact> own;
          if (trade_.held_out) {
            own = std::make_unique<LinearContact>(
                reference::linear_response(data.contact.scene, data.surface.points_m, {.level = level}),
                data.contact.scene.tool);
          }
          LinearContact& contact = own ? *own : *model;
          fast::Run run = empty_run(data.surface, data.result);
          for (scene::InstantRecord& record : run.instants) {
            contact.step(record.tool);
            solved = solved && contact.solved();
            record.displacement_m = contact.displacement_m();
            if (contact.touching() == 0) continue;
            record.regions.push_back({.depth_m = record.depth_m, .force_n = contact.force_n()});
          }
          return run;
        });
        if (!solved) row.note += "; some contact was not found";
        add(std::move(row));
        timed_.push_back({trade_.rows.size() - 1, [model](const scene::Pose& pose) { model->step(pose); }});
      } catch (const scene::InputError& error) {
        absent(row.name, row.key, row.family, error.what());
      } catch (const reference::Interrupted&) {
        throw;
      } catch (const std::runtime_error& error) {
        absent(row.name, row.key, row.family, error.what());
      }
    }
  }

#ifdef TOUCHSTONE_BULLET
  /// Why Bullet's block cannot stand for a scene's body; empty when it can.
  static std::string unlike_bullet(const Scene& scene) {
    const scene::Body& body = scene.body;
    if (body.shape != scene::BodyShape::box || (body.size_m.array() != body.size_m.x()).any())
      return "its body is a cube";
    if (scene.tool.shape != scene::ToolShape::sphere) return "its tool is a ball";
    if (!body.inclusions.empty()) return "its body is of one material";
    if (scene.contact.friction) return "it runs without friction";
    if (scene.track.back().time_s - scene.track.front().time_s > 5.0) return "the track is longer than 5 s";
    return "";
  }

  static bench::BulletScene bullet_scene(const Scene& scene, int cells) {
    bench::BulletScene out;
    out.cells = cells;
    out.edge_m = scene.body.size_m.x();
    out.ball_radius_m = scene.tool.radius_m;
    out.youngs_modulus_pa = scene.body.material.youngs_modulus_pa;
    out.poissons_ratio = std::min(scene.body.material.poissons_ratio, 0.45);
    return out;
  }

  void peers() {
    const std::string name = "deformable body of " + bench::bullet_version();
    for (const TuningContactRef& contact : scenes()) {
      if (const std::string why = unlike_bullet(contact.get()); !why.empty()) {
        absent(name, "bullet", TradeFamily::peer, "not this scene: " + why);
        return;
      }
    }
    const std::vector<int> sizes = options_.quick ? std::vector{4} : std::vector{6, 9};
    for (const int cells : sizes) {
      TradeRow row{.name = fmt::format("{}, {} triangles", name, 12 * cells * cells),
                   .key = fmt::format("bullet-{}", 12 * cells * cells),
                   .label = fmt::format("Bullet {}", thousands(12 * cells * cells)),
                   .family = TradeFamily::peer};
      tell(row.name);
      const Clock::time_point begin = Clock::now();
      const auto model = std::make_shared<bench::BulletPeer>(bullet_scene(scene_, cells));
      row.setup_s = seconds_since(begin);
      row.size = model->surface_triangles();
      row.note = fmt::format(
          "implicit steps of 1 ms with Poisson's ratio {}; it tells neither the force on the tool nor its memory",
          number_text(std::min(scene_.body.material.poissons_ratio, 0.45)));
      bool sound = true;
      judge(row, {}, false, [&](const TuningData& data) {
        const Scene& scene = data.contact.scene;
        bench::BulletPeer peer(bullet_scene(scene, cells));
        fast::Run run = empty_run(data.surface, data.result);
        double time_s = scene.track.front().time_s;
        for (scene::InstantRecord& record : run.instants) {
          for (; time_s < record.time_s + 0.5e-3; time_s += 1e-3) {
            peer.step(scene::pose_at(scene.track, time_s).position_m);
          }
          record.displacement_m = peer.displacement_m(data.surface.points_m);
          sound = sound && peer.sound();
        }
        return run;
      });
      if (!sound) {
        absent(row.name, row.key, row.family, "its body flew apart");
        continue;
      }
      add(std::move(row));
      timed_.push_back({trade_.rows.size() - 1, [model](const scene::Pose& pose) { model->step(pose.position_m); }});
    }
  }

  using TuningContactRef = std::reference_wrapper<const Scene>;
  [[nodiscard]] std::vector<TuningContactRef> scenes() const {
    std::vector<TuningContactRef> out{scene_};
    for (const TuningContact& contact : trade_.contacts) out.emplace_back(contact.scene);
    return out;
  }
#else
  void peers() { absent("Bullet's deformable body", "bullet", TradeFamily::peer, "built without Bullet"); }
#endif

  void reference_levels() {
    int levels = 0;
    for (std::size_t c = 0; c < trade_.contacts.size(); ++c) {
      const auto solved = static_cast<int>(data_of(c, trade_.contacts[c].scene.fast.triangles).result.levels.size());
      levels = c == 0 ? solved : std::min(levels, solved);
    }
    for (int level = 1; level <= levels; ++level) {
      const bool finest = level == levels;
      TradeRow row{.name = fmt::format("reference, {} mesh{}", level, level == 1 ? "" : "es"),
                   .key = fmt::format("reference-{}", level),
                   .label = fmt::format("reference {}", level),
                   .family = TradeFamily::reference};
      double wall_s = 0.0;
      int touching = 0, dim = 3;
      judge(row, {}, true, [&](const TuningData& data) {
        fast::Run run = empty_run(data.surface, data.result);
        reference::Result coarse;
        if (!finest) {
          coarse = solve_(data.contact.scene, data.surface, level);
          std::vector<scene::InstantRecord> counted;
          for (const std::size_t t : data.instants) counted.push_back(std::move(coarse.instants[t]));
          run.instants = std::move(counted);
        } else {
          run.instants = data.result.instants;
        }
        for (int k = 0; k < level; ++k) wall_s += data.result.levels[static_cast<std::size_t>(k)].wall_s;
        const auto touches = [](const scene::InstantRecord& r) { return r.depth_m > grazing_depth_m; };
        touching += static_cast<int>(std::count_if(run.instants.begin(), run.instants.end(), touches));
        row.size = data.result.levels[static_cast<std::size_t>(level - 1)].unknowns;
        dim = data.result.model.starts_with("axisymmetric") ? 2 : 3;
        return run;
      });
      row.step_p50_us = 1e6 * wall_s / touching;
      row.steps = touching;
      row.memory_bytes = reference::expected_memory_bytes(dim, row.size);
      row.note =
          "mean wall time of an instant, the coarser meshes it starts from included, when it was solved; memory "
          "as predicted";
      if (finest && !row.force_nrmse.uncertainty) {
        row.force_nrmse = row.shape_rel_l2 = {};
        row.note = "the yardstick, which does not know its own uncertainty with fewer than three meshes; " + row.note;
      } else if (finest) {
        row.note = "the yardstick: its error is its uncertainty; " + row.note;
      }
      add(std::move(row));
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
            const std::function<void(const std::string&)>& say) {
  return Ladder(scene, options, solve, say).climb();
}

}  // namespace touchstone::compare
