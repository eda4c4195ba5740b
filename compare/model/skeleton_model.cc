#include "compare/model/skeleton_model.h"

#include "compare/format/text.h"
#include "compare/input/tuning_study.h"
#include "compare/model/engine_model.h"
#include "compare/model/response_model.h"
#include "fast/run/replay.h"
#include "scene/model/area_law.h"

#include <fmt/format.h>

#include <utility>

namespace touchstone::compare {
namespace {

using scene::Scene;

class FastReplay final : public ModelReplay {
 public:
  explicit FastReplay(const Scene& scene) : replay_(scene) {}

  std::vector<scene::Vec3> forces_n(const Scene& scene) override { return replay_.forces_n(scene); }
  void displacements(const Scene& scene, std::span<const std::size_t> instants, const Visit& visit) override {
    replay_.displacements(scene, instants, [&](std::size_t k, const fast::Columns3& displacement_m) {
      visit(k, fast::matrix_of(displacement_m));
    });
  }

 private:
  fast::Replay replay_;
};

ModelFamily family_of(const Scene& scene) {
  return scene.contact.law == scene::ContactLaw::duffing ? ModelFamily::paper : ModelFamily::area_aware;
}

}  // namespace

Scene as_printed(Scene scene) {
  scene.fast.formulation = scene::Formulation::published;
  return scene;
}

Scene corrected(Scene scene) {
  scene.fast.formulation = scene::Formulation::corrected;
  return scene;
}

Scene with_untuned_area_law(Scene scene) {
  scene.contact.law = scene::ContactLaw::area_aware;
  scene.contact.k1_per_radius_n_per_m2 =
      scene::area_law_constant_n_per_m2(scene.body.material, scene.tool, scene.fast.formulation);
  scene.contact.k1_n_per_m = scene.contact.k3_n_per_m3 = 0.0;
  scene.fast.s_c_m2 = scene::stiff_beam_area_m2(scene.body);
  return scene;
}

ModelEntry skeleton_model(ModelEntry entry, const SceneChange& change) {
  entry.set_up = [change](const Scene& scene) { return engine_model(change(scene)); };
  return entry;
}

ModelEntry skeleton_model(const std::string& key, const Scene& given, const SceneChange& change) {
  const Scene scene = change(given);
  return skeleton_model({.name = "",
                         .key = key,
                         .method = std::string(scene::name_of(scene.contact.law).title) + ", " +
                                   std::string(scene::name_of(scene.fast.formulation)),
                         .family = family_of(scene)},
                        change);
}

ModelEntry fast_model() {
  ModelEntry entry = skeleton_model({.name = "fast model", .key = "fast", .family = ModelFamily::paper, .own = true},
                                    [](Scene scene) { return scene; });
  entry.replay = [](const Scene& scene) {
    prepare_missing(scene, {});
    return std::make_unique<FastReplay>(scene);
  };
  return entry;
}

std::vector<ModelEntry> skeleton_models(const ModelRequest& request) {
  std::vector<ModelEntry> models;
  const scene::ContactLaw law = request.scene.contact.law;
  const std::string own_word(scene::name_of(law).word), own_title(scene::name_of(law).title);
  const bool own_area_law = law == scene::ContactLaw::area_aware;
  using Form = std::pair<const char*, Scene (*)(Scene)>;
  for (const auto& [name, change] : {Form{"published", as_printed}, Form{"corrected", corrected}}) {
    const std::string form = name;
    if (law == scene::ContactLaw::duffing) {
      models.push_back(skeleton_model({.name = form + " skeleton, Duffing law of the scene",
                                       .key = form + "-duffing",
                                       .label = form,
                                       .family = ModelFamily::paper},
                                      change));
    } else {
      models.push_back({.name = form + " skeleton, Duffing law",
                        .key = form + "-duffing",
                        .family = ModelFamily::paper,
                        .absent = "the scene's law is the " + own_title + " one"});
      if (!own_area_law) {
        models.push_back(skeleton_model({.name = form + " skeleton, " + own_title + " law of the scene",
                                         .key = form + "-" + own_word,
                                         .label = form + ", " + own_title,
                                         .family = ModelFamily::area_aware},
                                        change));
      }
    }
    const std::string from = own_area_law ? "of the scene" : "k1 and s_c of material and size";
    models.push_back(skeleton_model({.name = form + " skeleton, area-aware law, " + from,
                                     .key = form + "-area-aware",
                                     .label = form + ", area-aware",
                                     .family = ModelFamily::area_aware},
                                    [change = change, own_area_law](Scene scene) {
                                      scene = change(std::move(scene));
                                      return own_area_law ? scene : with_untuned_area_law(std::move(scene));
                                    }));
  }
  for (const std::filesystem::path& file : request.parameters) {
    const Scene tuned = with_parameters(request.scene, file);
    const bool duffing = tuned.contact.law == scene::ContactLaw::duffing;
    const std::string title(scene::name_of(tuned.contact.law).title);
    const std::string form(scene::name_of(tuned.fast.formulation));
    if (tuned.fast.formulation == scene::Formulation::response) {
      models.push_back(response_model(
          {.name = fmt::format("response, tuned ({})", file.filename().string()),
           .key = "tuned-" + file.stem().string(),
           .label = "response, tuned"},
          [file](Scene scene) { return with_parameters(std::move(scene), file); }, request));
      continue;
    }
    models.push_back(
        skeleton_model({.name = fmt::format("{} skeleton, {} law, tuned ({})", form, title, file.filename().string()),
                        .key = "tuned-" + file.stem().string(),
                        .label = form + (duffing ? "" : ", " + title) + ", tuned",
                        .family = family_of(tuned)},
                       [file](Scene scene) { return with_parameters(std::move(scene), file); }));
  }
  return models;
}

std::vector<ModelEntry> skeleton_meshes(const ModelRequest& request) {
  std::vector<ModelEntry> models;
  const std::vector<int> sizes = request.quick ? std::vector{400, 1000} : std::vector{1000, 3952, 16000, 100000};
  const bool tuned = !request.parameters.empty();
  for (const int triangles : sizes) {
    if (triangles == request.scene.fast.triangles) continue;  // already in the list
    const SceneChange change = [triangles, tuned, file = tuned ? request.parameters.front() : ""](Scene scene) {
      if (tuned) scene = with_parameters(std::move(scene), file);
      scene.fast.triangles = triangles;
      return corrected(std::move(scene));
    };
    models.push_back(skeleton_model(
        {.name = fmt::format("corrected skeleton{}, {} triangles", tuned ? ", tuned" : "", thousands_text(triangles)),
         .key = "corrected-" + thousands_text(triangles),
         .label = thousands_text(triangles),
         .family = family_of(change(request.scene)),
         .triangles = triangles},
        change));
  }
  return models;
}

std::vector<ModelEntry> skeleton_anchor_sets(const ModelRequest&) {
  return {{.name = "anchor sets",
           .key = "anchors",
           .family = ModelFamily::paper,
           .absent = "the anchor points follow from the body's shape by the paper's rule: no scene has a setting for "
                     "them"}};
}

}  // namespace touchstone::compare
