#include "compare/input/tuning_study.h"

#include "scene/base/nearest_name.h"
#include "scene/base/text.h"
#include "scene/input/fields.h"
#include "scene/input/toml_reader.h"
#include "scene/response/response.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace touchstone::compare {

using namespace scene;  // the TOML reader and its types
namespace {

/// Keys that may be fitted and, with `models`, keys that choose a model; with all their names.
std::vector<std::string> tunable_names(bool models) {
  std::vector<std::string> names;
  for (const auto& field : scene_fields()) {
    if (!field.tunable || (field.tunable->stage == TuningStage::model && !models)) continue;
    names.emplace_back(field.key);
    if (field.tunable->per_mass) names.emplace_back(field.tunable->per_mass->key);
  }
  return names;
}

/// The allowed words of a key that chooses a model.
std::vector<std::string> words_of(const Field<Scene>& field) {
  const auto& names = std::get<Choice<Scene>>(field.access).names;
  return {names.begin(), names.end()};
}

/// Constants that scene `now` requires and scene `before` did not.
std::vector<const Field<Scene>*> newly_required(const Scene& before, const Scene& now) {
  std::vector<const Field<Scene>*> list;
  for (const auto& field : scene_fields()) {
    if (field.tunable && must_be_given(field) && !scene::applies(field, before) && scene::applies(field, now))
      list.push_back(&field);
  }
  return list;
}

Scene with_law(Scene scene, ContactLaw law) {
  scene.contact.law = law;
  return scene;
}

class TuningReader : TomlReader {
 public:
  TuningReader(const toml::table& document, const std::filesystem::path& file,
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
    study.formulations = choices<Formulation>("formulation", words_of(*tunable_field("fast.formulation")));
    study.laws = choices<ContactLaw>("law", words_of(*tunable_field("contact.law")));
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

  /// Two numbers, the first smaller than the second.
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

  /// A word or a list of words, as values of an enumeration in the order of `words`.
  template <class Enum>
  std::vector<Enum> choices(const std::string& key, const std::vector<std::string>& words) {
    std::vector<Enum> list;
    const toml::node* node = document_.get(key);
    if (node == nullptr) return list;
    const auto take = [&](const toml::node& one) {
      const auto found = std::find(words.begin(), words.end(), one.value_or(std::string()));
      if (found == words.end()) {
        std::string expected;
        for (const std::string& word : words) expected += (expected.empty() ? "\"" : " or \"") + word + "\"";
        add(one, key + " = " + shortened(value_text(one)) + "; expected " + expected);
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
    const std::string key = text(table, "key").value_or("");
    const Field<Scene>* field = tunable_field(key);
    if (field == nullptr || field->tunable->stage == TuningStage::model) {
      const toml::node* node = table.get("key");
      const std::string former = former_name_message(key);
      add(node != nullptr ? *node : table,
          "parameter.key = \"" + key + "\" cannot be tuned; " +
              (former.empty() ? "did you mean \"" + nearest_name(key, tunable_names(false)) + "\"?" : former));
      return;
    }
    TuningParameter out;
    out.key = key;
    out.unit = key == field->key ? field->unit : field->tunable->per_mass->unit;
    out.stage = field->tunable->stage;
    const toml::node* bounds = table.get("bounds");
    if (bounds == nullptr) {
      add(table, "parameter.bounds: missing for " + key + "; expected [low, high]");
      return;
    }
    const auto ends = interval(*bounds, "parameter.bounds", field->range, out.unit);
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
    out.profile = profile != nullptr ? profile->value_or(false) : field->tunable->rough;
    if (profile != nullptr && !profile->is_boolean()) add(*profile, "parameter.profile: expected true or false");
    for (const TuningParameter& other : study.parameters) {
      if (tunable_field(other.key) == field) {
        add(table, "parameter.key = \"" + key + "\": \"" + other.key + "\" stands for the same constant");
      }
    }
    study.parameters.push_back(std::move(out));
    places_.push_back(&table);
  }

  /// Checks and defaults that depend on the contacts: laws and formulations, and parameters that no contact uses.
  void complete(TuningStudy& study) {
    const Scene& first = study.training.front().scene;
    if (study.formulations.empty()) study.formulations = {first.fast.formulation};
    if (study.laws.empty()) study.laws = {first.contact.law};
    for (const Formulation formulation : study.formulations) {
      for (const auto* list : {&study.training, &study.held_out}) {
        for (const TuningContact& one : *list) {
          Scene scene = one.scene;
          scene.fast.formulation = formulation;
          if (const std::string needs = formulation_needs(scene); !needs.empty()) {
            add(document_, "formulation: the " + std::string(name_of(formulation)) + " model needs that " + needs +
                               "; contact \"" + one.name + "\"");
          }
        }
      }
    }
    for (const ContactLaw law : study.laws) {
      const auto tuned = [&](const Field<Scene>* field) {
        return std::ranges::any_of(study.parameters,
                                   [&](const TuningParameter& one) { return tunable_field(one.key) == field; });
      };
      const bool complete = std::ranges::all_of(study.training, [&](const TuningContact& contact) {
        return std::ranges::all_of(newly_required(contact.scene, with_law(contact.scene, law)), tuned);
      });
      if (!complete) {
        const toml::node* node = document_.get("law");
        add(node != nullptr ? *node : document_, std::string("law: the scenes have no linear constant for \"") +
                                                     std::string(name_of(law).word) +
                                                     "\"; expected a [[parameter]] with it");
      }
    }
    for (std::size_t k = 0; k < study.parameters.size(); ++k) {
      const TuningParameter& one = study.parameters[k];
      const auto meant = [&](Formulation formulation) {
        return std::any_of(study.laws.begin(), study.laws.end(),
                           [&](ContactLaw law) { return applies(one, formulation, law); });
      };
      const Field<Scene>& field = *tunable_field(one.key);
      const auto has = [&](const TuningContact& contact) {
        return std::ranges::any_of(study.laws,
                                   [&](ContactLaw law) { return scene::applies(field, with_law(contact.scene, law)); });
      };
      if (std::none_of(study.formulations.begin(), study.formulations.end(), meant)) {
        add(*places_[k], "parameter.key = \"" + one.key + "\" has no meaning under the models of this study");
      } else if (std::ranges::none_of(study.training, has)) {
        add(*places_[k], "parameter.key = \"" + one.key + "\" only applies with " + std::string(field.only_when->text) +
                             "; expected a training contact with it");
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
    const Scene before = scene;
    // Which constants apply depends on the model, so its choices are read first.
    for (const bool models : {true, false}) take(document_, "", models, scene);
    for (const Field<Scene>* field : newly_required(before, scene)) {
      if (given_.contains(field)) continue;
      add(document_, std::string(field->only_when->key) +
                         " is not the scene's, and its constant is missing; expected " + std::string(field->key));
    }
    refuse_faults();
    return scene;
  }

 private:
  /// @param models  read the choices of the model, else the constants
  void take(const toml::table& table, const std::string& above, bool models, Scene& scene) {
    for (const auto& [name, node] : table) {
      const std::string key = above + std::string(name.str());
      const Field<Scene>* field = tunable_field(key);
      if (const toml::table* below = node.as_table()) {
        take(*below, key + ".", models, scene);
      } else if (field == nullptr) {
        if (models) refuse(key, name.source());
      } else if (models != (field->tunable->stage == TuningStage::model)) {
        continue;
      } else if (models) {
        const std::vector<std::string> words = words_of(*field);
        const auto found = std::ranges::find(words, word(table, std::string(name.str()), words));
        if (found != words.end())
          std::get<Choice<Scene>>(field->access).set(scene, static_cast<int>(found - words.begin()));
      } else {
        given_.insert(field);
        const double value = node.is_number() ? *node.value<double>() : NAN;
        if (field->range.contains(value)) {
          set_parameter(scene, key, value);
        } else {
          add(node, key + " = " + shortened(value_text(node)) + "; expected a number in " + field->range.text());
        }
      }
    }
  }

  void refuse(const std::string& key, const toml::source_region& source) {
    const std::string former = former_name_message(key);
    add(source, former.empty() ? "\"" + key + "\" is no parameter of the fast model; did you mean \"" +
                                     nearest_name(key, tunable_names(true)) + "\"?"
                               : former + ": set it in the scene");
  }

  std::set<const Field<Scene>*> given_;
};

}  // namespace

bool applies(const TuningParameter& parameter, Formulation formulation, ContactLaw law) {
  const Field<Scene>* field = tunable_field(parameter.key);
  if (field == nullptr || !tunable_in(*field, formulation)) return false;
  Scene full = with_law({}, law);
  full.body.inclusions.emplace_back();
  for (const OptionalTable& table : optional_tables()) table.give(full);
  return scene::applies(*field, full);
}

void set_parameter(Scene& scene, const std::string& key, double value) {
  const Field<Scene>& field = *tunable_field(key);
  if (!scene::applies(field, scene)) return;
  const double factor = key == field.key ? 1.0 : field.tunable->per_mass->factor * scene.tool.mass_kg;
  std::get<double& (*)(Scene&)>(field.access)(scene) = factor * value;
}

Scene with_parameters(Scene scene, const std::filesystem::path& file) {
  const toml::table document = read_document(file, "the parameters");
  return ParameterReader(document, file).over(std::move(scene));
}

TuningStudy load_tuning_study(const std::filesystem::path& file,
                              const std::function<std::vector<Fault>(const Scene&)>& check) {
  const toml::table document = read_document(file, "the study");
  require_kind(document, file, FileKind::tuning);
  return TuningReader(document, file, check).read();
}

}  // namespace touchstone::compare
