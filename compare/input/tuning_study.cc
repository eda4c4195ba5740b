#include "compare/input/tuning_study.h"

#include "scene/base/nearest_name.h"
#include "scene/base/text.h"
#include "scene/input/fields.h"
#include "scene/input/toml_reader.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace touchstone::compare {

using namespace scene;  // the reader of TOML and its words
namespace {

constexpr const char* omega_key = "contact.omega0_squared_per_s2";
constexpr const char* epsilon_key = "contact.epsilon_beta0_squared_per_m2_s2";

/// What may be tuned. A key of our own stands for one of the scene's.
struct Tunable {
  const char* key;
  const char* scene_key;  ///< whose range and meaning count
  const char* unit;       ///< of a key of our own
  TuningStage stage;
  bool rough;                                   ///< the fit may have corners or steps in it
  std::optional<ContactLaw> law;                ///< absent: any
  std::optional<Formulation> formulation = {};  ///< absent: any
};
constexpr Tunable tunables[] = {
    {"contact.k1_n_per_m", "contact.k1_n_per_m", nullptr, TuningStage::force, false, ContactLaw::duffing},
    {omega_key, "contact.k1_n_per_m", "1/s^2", TuningStage::force, false, ContactLaw::duffing},
    {"contact.k1_per_radius_n_per_m2", "contact.k1_per_radius_n_per_m2", nullptr, TuningStage::force, false,
     ContactLaw::area_aware},
    {"contact.k3_n_per_m3", "contact.k3_n_per_m3", nullptr, TuningStage::force, false, {}},
    {epsilon_key, "contact.k3_n_per_m3", "1/(m^2 s^2)", TuningStage::force, false, {}},
    {"contact.friction.K", "contact.friction.K", nullptr, TuningStage::force, false, {}},
    {"contact.friction.beta", "contact.friction.beta", nullptr, TuningStage::force, false, {}},
    {"contact.friction.mu_D", "contact.friction.mu_D", nullptr, TuningStage::force, false, {}},
    {"contact.friction.stiffness_ratio",
     "contact.friction.stiffness_ratio",
     nullptr,
     TuningStage::force,
     false,
     {},
     Formulation::corrected},
    {"fast.r_th_m", "fast.r_th_m", nullptr, TuningStage::force, true, {}},
    {"fast.s_c_m2", "fast.s_c_m2", nullptr, TuningStage::shape, false, {}},
    {"fast.C_n", "fast.C_n", nullptr, TuningStage::shape, false, {}},
    {"fast.C_r_m", "fast.C_r_m", nullptr, TuningStage::shape, true, {}},
    {"fast.r_R_m", "fast.r_R_m", nullptr, TuningStage::shape, true, {}},
};

const Tunable* tunable(const std::string& key) {
  const auto found =
      std::find_if(std::begin(tunables), std::end(tunables), [&](const Tunable& t) { return key == t.key; });
  return found == std::end(tunables) ? nullptr : found;
}

const Field<Scene>& scene_field(const std::string& key) {
  const auto& fields = scene_fields();
  return *std::find_if(fields.begin(), fields.end(), [&](const Field<Scene>& field) { return field.key == key; });
}

class Reader : TomlReader {
 public:
  Reader(const toml::table& document, const std::filesystem::path& file,
         const std::function<std::vector<Fault>(const Scene&)>& check)
      : TomlReader(document, file), check_(check) {}

  TuningStudy read() {
    TuningStudy study;
    study.name = file_.stem().string();
    known_keys(document_, "",
               {"kind", "title", "formulation", "law", "starts", "force_floor", "shape_floor", "set", "training",
                "held_out", "parameter"});
    word(document_, "kind", {"tuning"});
    study.title = text(document_, "title").value_or("");
    study.formulations = choices<Formulation>("formulation", {"published", "corrected"});
    study.laws = choices<ContactLaw>("law", {"duffing", "area_aware"});
    study.starts = static_cast<int>(number(document_, "starts", {1.0, 100.0}, 16.0));
    study.force_floor = number(document_, "force_floor", {1e-6, 1.0}, 0.01);
    study.shape_floor = number(document_, "shape_floor", {1e-6, 1.0}, 0.01);
    const std::vector<Setting> always = settings(document_, "set");
    for (const toml::table* table : rows("training")) study.training.push_back(contact(*table, "training", always));
    for (const toml::table* table : rows("held_out")) study.held_out.push_back(contact(*table, "held_out", always));
    if (study.training.empty()) add(document_, "training: missing; expected at least one [[training]] row");
    if (study.held_out.empty()) add(document_, "held_out: missing; expected at least one [[held_out]] row");
    for (const toml::table* table : rows("parameter")) parameter(*table, study);
    if (study.parameters.empty() && faults_.empty()) {
      add(document_, "parameter: missing; expected at least one [[parameter]] row");
    }
    refuse_faults();
    complete(study);
    refuse_faults();
    return study;
  }

 private:
  double number(const toml::table& table, const std::string& key, const Range& range, double otherwise) {
    const toml::node* node = table.get(key);
    if (node == nullptr) return otherwise;
    const double value = node->is_number() ? *node->value<double>() : NAN;
    if (range.contains(value)) return value;
    add(*node, key + " = " + shortened(value_text(*node)) + "; expected a number in " + range.text());
    return otherwise;
  }

  /// Two numbers, the first below the second.
  std::optional<std::array<double, 2>> interval(const toml::node& node, const std::string& where, const Range& range,
                                                const std::string& unit) {
    const toml::array* array = node.as_array();
    if (array != nullptr && array->size() == 2 && (*array)[0].is_number() && (*array)[1].is_number()) {
      const std::array<double, 2> ends = {*(*array)[0].value<double>(), *(*array)[1].value<double>()};
      if (ends[0] < ends[1] && range.contains(ends[0]) && range.contains(ends[1])) return ends;
    }
    add(node, where + " = " + shortened(value_text(node)) + "; expected [low, high], low below high, each in " +
                  range.text() + (unit.empty() ? "" : " " + unit));
    return std::nullopt;
  }

  /// A word or a list of them, as values of an enumeration in the order of `words`.
  template <class Enum>
  std::vector<Enum> choices(const std::string& key, const std::vector<std::string>& words) {
    std::vector<Enum> list;
    const toml::node* node = document_.get(key);
    if (node == nullptr) return list;
    const auto take = [&](const toml::node& one) {
      const auto found = std::find(words.begin(), words.end(), one.value_or(std::string()));
      if (found == words.end()) {
        add(one, key + " = " + shortened(value_text(one)) + "; expected \"" + words[0] + "\" or \"" + words[1] + "\"");
        return;
      }
      const auto value = static_cast<Enum>(found - words.begin());
      if (std::find(list.begin(), list.end(), value) == list.end()) list.push_back(value);
    };
    if (const toml::array* array = node->as_array(); array != nullptr && !array->empty()) {
      for (const toml::node& one : *array) take(one);
    } else {
      take(*node);
    }
    return list;
  }

  TuningContact contact(const toml::table& table, const std::string& row, const std::vector<Setting>& always) {
    TuningContact out;
    std::vector<std::string> known = {"name", "scene", "set", "depth_m"};
    if (row == "held_out") {
      known.emplace_back("differs");
      out.differs = word(table, "differs", {"place", "tool", "depth", "track", "body"});
    }
    known_keys(table, row + ".", known);
    out.name = text(table, "name").value_or("");
    if (out.name.empty()) add(table, row + ".name: missing; expected a name");
    if (!names_.insert(out.name).second) add(table, row + ".name: two contacts are called \"" + out.name + "\"");
    if (const toml::node* node = table.get("depth_m")) {
      out.depth_m = interval(*node, row + ".depth_m", {0.0, 10.0}, "m").value_or(out.depth_m);
    }
    const std::optional<std::string> scene = text(table, "scene");
    if (!scene) {
      if (table.get("scene") == nullptr) {
        add(table, row + ".scene: missing; expected the path of a scene file, from the study file");
      }
      return out;
    }
    StudyCase one{out.name, {}, always};
    for (Setting& setting : settings(table, "set")) one.settings.push_back(std::move(setting));
    Study single;
    single.scene_file = (file_.parent_path() / *scene).lexically_normal();
    single.cases.push_back(std::move(one));
    try {
      out.scene = load_cases(single, check_).front();
    } catch (const InputError& error) {
      faults_.insert(faults_.end(), error.faults().begin(), error.faults().end());
    }
    return out;
  }

  void parameter(const toml::table& table, TuningStudy& study) {
    known_keys(table, "parameter.", {"key", "bounds", "start", "scale", "profile"});
    std::vector<std::string> names;
    for (const Tunable& each : tunables) names.emplace_back(each.key);
    const std::string key = text(table, "key").value_or("");
    const Tunable* what = tunable(key);
    if (what == nullptr) {
      const toml::node* node = table.get("key");
      add(node != nullptr ? *node : table,
          "parameter.key = \"" + key + "\" cannot be tuned; did you mean \"" + nearest_name(key, names) + "\"?");
      return;
    }
    const Field<Scene>& field = scene_field(what->scene_key);
    TuningParameter out;
    out.key = key;
    out.unit = what->unit != nullptr ? what->unit : field.unit;
    out.stage = what->stage;
    const toml::node* bounds = table.get("bounds");
    if (bounds == nullptr) {
      add(table, "parameter.bounds: missing for " + key + "; expected [low, high]");
      return;
    }
    const auto ends = interval(*bounds, "parameter.bounds", field.range, out.unit);
    if (!ends) return;
    std::tie(out.low, out.high) = std::pair((*ends)[0], (*ends)[1]);
    out.log = word(table, "scale", {"log", "linear"}, out.low > 0.0 ? "log" : "linear") == "log";
    if (out.log && out.low <= 0.0) {
      add(*table.get("scale"), "parameter.scale = \"log\"; expected bounds above 0 for it");
      return;
    }
    const double middle = out.log ? std::sqrt(out.low * out.high) : 0.5 * (out.low + out.high);
    out.start = number(table, "start", {out.low, out.high}, middle);
    const toml::node* profile = table.get("profile");
    out.profile = profile != nullptr ? profile->value_or(false) : what->rough;
    if (profile != nullptr && !profile->is_boolean()) add(*profile, "parameter.profile: expected true or false");
    for (const TuningParameter& other : study.parameters) {
      if (std::string_view(tunable(other.key)->scene_key) == what->scene_key) {
        add(table, "parameter.key = \"" + key + "\": \"" + other.key + "\" is the same constant already");
      }
    }
    study.parameters.push_back(std::move(out));
    places_.push_back(&table);
  }

  /// What needs the contacts: laws and formulations of their own, and parameters that none of them has.
  void complete(TuningStudy& study) {
    const Scene& first = study.training.front().scene;
    if (study.formulations.empty()) study.formulations = {first.fast.formulation};
    if (study.laws.empty()) study.laws = {first.contact.law};
    for (const ContactLaw law : study.laws) {
      const bool own = std::all_of(study.training.begin(), study.training.end(),
                                   [&](const TuningContact& contact) { return contact.scene.contact.law == law; });
      const bool tuned = std::any_of(study.parameters.begin(), study.parameters.end(),
                                     [&](const TuningParameter& one) { return tunable(one.key)->law == law; });
      if (!own && !tuned) {
        const toml::node* node = document_.get("law");
        add(node != nullptr ? *node : document_, std::string("law: the scenes have no linear constant for \"") +
                                                     (law == ContactLaw::duffing ? "duffing" : "area_aware") +
                                                     "\"; expected a [[parameter]] with it");
      }
    }
    const auto has_friction = [](const TuningContact& contact) { return contact.scene.contact.friction.has_value(); };
    for (std::size_t k = 0; k < study.parameters.size(); ++k) {
      const TuningParameter& one = study.parameters[k];
      const auto meant = [&](Formulation formulation) {
        return std::any_of(study.laws.begin(), study.laws.end(),
                           [&](ContactLaw law) { return applies(one, formulation, law); });
      };
      if (std::none_of(study.formulations.begin(), study.formulations.end(), meant)) {
        add(*places_[k], "parameter.key = \"" + one.key + "\" has no meaning under the models of this study");
      }
      if (one.key.starts_with("contact.friction.") &&
          std::none_of(study.training.begin(), study.training.end(), has_friction)) {
        add(*places_[k], "parameter.key = \"" + one.key + "\": no training contact has friction");
      }
    }
  }

  const std::function<std::vector<Fault>(const Scene&)>& check_;
  std::set<std::string> names_;
  std::vector<const toml::table*> places_;  ///< of the parameters
};

class ParameterReader : TomlReader {
 public:
  using TomlReader::TomlReader;

  Scene over(Scene scene) {
    const ContactLaw before = scene.contact.law;
    known_keys(document_, "", {"contact", "fast"});
    take(document_, "", scene);
    if (scene.contact.law != before && !linear_constant_) {
      add(document_,
          "contact.law is not the scene's, and its linear constant is missing; expected contact." +
              std::string(scene.contact.law == ContactLaw::duffing ? "k1_n_per_m" : "k1_per_radius_n_per_m2"));
    }
    refuse_faults();
    return scene;
  }

 private:
  void take(const toml::table& table, const std::string& above, Scene& scene) {
    for (const auto& [name, node] : table) {
      const std::string key = above + std::string(name.str());
      if (node.is_table()) {
        take(*node.as_table(), key + ".", scene);
      } else if (key == "contact.law") {
        const std::string law = word(table, "law", {"duffing", "area_aware"});
        scene.contact.law = law == "area_aware" ? ContactLaw::area_aware : ContactLaw::duffing;
      } else if (key == "fast.formulation") {
        const std::string formulation = word(table, "formulation", {"published", "corrected"});
        scene.fast.formulation = formulation == "published" ? Formulation::published : Formulation::corrected;
      } else {
        take_number(key, node, name.source(), scene);
      }
    }
  }

  void take_number(const std::string& key, const toml::node& node, const toml::source_region& source, Scene& scene) {
    const Tunable* what = tunable(key);
    if (what == nullptr) {
      std::vector<std::string> names = {"contact.law", "fast.formulation"};
      for (const Tunable& each : tunables) names.emplace_back(each.key);
      add(source,
          "\"" + key + "\" is no parameter of the fast model; did you mean \"" + nearest_name(key, names) + "\"?");
      return;
    }
    const Range& range = scene_field(what->scene_key).range;
    const double value = node.is_number() ? *node.value<double>() : NAN;
    if (!range.contains(value)) {
      add(node, key + " = " + shortened(value_text(node)) + "; expected a number in " + range.text());
      return;
    }
    linear_constant_ = linear_constant_ || what->law.has_value();
    if (!key.starts_with("contact.friction.") || scene.contact.friction) set_parameter(scene, key, value);
  }

  bool linear_constant_ = false;
};

}  // namespace

bool applies(const TuningParameter& parameter, Formulation formulation, ContactLaw law) {
  const Tunable* what = tunable(parameter.key);
  return what != nullptr && what->law.value_or(law) == law && what->formulation.value_or(formulation) == formulation;
}

void set_parameter(Scene& scene, const std::string& key, double value) {
  if (key == omega_key) {
    scene.contact.k1_n_per_m = scene.tool.mass_kg * value;
  } else if (key == epsilon_key) {
    scene.contact.k3_n_per_m3 = 0.75 * scene.tool.mass_kg * value;
  } else {
    std::get<double& (*)(Scene&)>(scene_field(key).access)(scene) = value;
  }
}

Scene with_parameters(Scene scene, const std::filesystem::path& file) {
  const toml::table document = read_document(file, "the parameters");
  return ParameterReader(document, file).over(std::move(scene));
}

TuningStudy load_tuning_study(const std::filesystem::path& file,
                              const std::function<std::vector<Fault>(const Scene&)>& check) {
  const toml::table document = read_document(file, "the study");
  require_kind(document, file, FileKind::tuning);
  return Reader(document, file, check).read();
}

}  // namespace touchstone::compare
