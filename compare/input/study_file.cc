#include "compare/input/study_file.h"

#include "scene/base/text.h"
#include "scene/input/fields.h"
#include "scene/input/scene_io.h"
#include "scene/input/toml_reader.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

namespace touchstone::compare {

using namespace scene;  // the TOML reader and its types
namespace {

/// The value as it is shown in a table.
std::string label_text(const toml::node& node) {
  return node.is_string() ? node.value_or(std::string()) : value_text(node);
}

/// An axis: labels and settings of each of its values.
struct Axis {
  std::string name;
  std::vector<std::string> labels;
  std::vector<std::vector<Setting>> settings;
};

class StudyReader : TomlReader {
 public:
  using TomlReader::TomlReader;

  Study read() {
    Study study;
    study.name = file_.stem().string();
    known_keys(document_, "", {"kind", "title", "scene", "run", "set", "axis", "case"});
    word(document_, "kind", {"sweep"}, "sweep");
    study.title = text(document_, "title").value_or("");
    study.run = word(document_, "run", {"fast", "reference", "compare"});
    if (const auto scene = text(document_, "scene")) {
      study.scene_file = (file_.parent_path() / *scene).lexically_normal();
    } else if (document_.get("scene") == nullptr) {
      add(document_, "scene: missing; expected the path of a scene file, from the study file");
    }
    const std::vector<Setting> always = settings(document_, "set");
    std::vector<Axis> axes;
    for (const toml::table* table : rows("axis")) axes.push_back(axis(*table));
    if (faults_.empty()) cross(axes, always, study);
    for (const toml::table* table : rows("case")) study.cases.push_back(single_case(*table, always));
    if (faults_.empty() && study.cases.empty()) add(document_, "no case; expected [[axis]] or [[case]] rows");
    for (const Axis& each : axes) study.axes.push_back(each.name);
    unique_names(study);
    refuse_faults();
    return study;
  }

 private:
  Axis axis(const toml::table& table) {
    known_keys(table, "axis.", {"name", "key", "values", "range", "zip", "labels"});
    Axis axis;
    const std::optional<std::string> name = text(table, "name"), key = text(table, "key");
    axis.name = name.value_or(key.value_or(""));
    const toml::node *values = table.get("values"), *range = table.get("range"), *zip = table.get("zip");
    if (const int ways = (values != nullptr) + (range != nullptr) + (zip != nullptr); ways != 1) {
      add(table, ways == 0 ? "axis: no values; expected one of axis.values, axis.range and axis.zip"
                           : "axis: expected only one of axis.values, axis.range and axis.zip");
      return axis;
    }
    if (zip != nullptr && (!name || key)) {
      add(*zip, "axis.zip: expected axis.name, a name for its keys together, and no axis.key");
      return axis;
    }
    if (zip == nullptr && !key) {
      add(table, "axis.key: missing; expected a key as for --set, such as \"fast.C_n\"");
      return axis;
    }
    if (values != nullptr) {
      along(axis, *key, *values, "axis.values");
    } else if (range != nullptr) {
      along_range(axis, *key, *range);
    } else {
      along_zip(axis, *zip);
    }
    relabel(axis, table);
    return axis;
  }

  /// Adds a list of values of a key to the axis. @param where  its key in the study file
  void along(Axis& axis, const std::string& key, const toml::node& node, const std::string& where) {
    const toml::array* array = node.as_array();
    if (array == nullptr || array->empty()) {
      add(node, where + ": expected a list of values for " + key);
      return;
    }
    if (axis.settings.empty()) axis.settings.resize(array->size());
    if (axis.settings.size() != array->size()) {
      add(node, where + ": " + std::to_string(array->size()) + " values; expected " +
                    std::to_string(axis.settings.size()) + " like the other keys of its axis");
      return;
    }
    const bool first = axis.labels.empty();
    for (std::size_t i = 0; i < array->size(); ++i) {
      const toml::node& value = *array->get(i);
      axis.settings[i].push_back({key, value_text(value), place(value.source())});
      if (first) {
        axis.labels.push_back(label_text(value));
      } else {
        axis.labels[i] += ", " + label_text(value);
      }
    }
  }

  void along_range(Axis& axis, const std::string& key, const toml::node& node) {
    const toml::table* table = node.as_table();
    if (table == nullptr) {
      add(node, "axis.range: expected { from, to, count, spacing }");
      return;
    }
    known_keys(*table, "axis.range.", {"from", "to", "count", "spacing"});
    const bool log = word(*table, "spacing", {"linear", "log"}, "linear") == "log";
    const auto number = [&](const char* name) -> std::optional<double> {
      const toml::node* end = table->get(name);
      const double value = end != nullptr && end->is_number() ? *end->value<double>() : NAN;
      if (std::isfinite(value) && (!log || value > 0.0)) return value;
      add(end != nullptr ? *end : node, std::string("axis.range.") + name + ": expected a number" +
                                            (log ? " above 0, because the spacing is \"log\"" : ""));
      return std::nullopt;
    };
    const std::optional<double> from = number("from"), to = number("to");
    const toml::node* count_node = table->get("count");
    const auto count = count_node != nullptr && count_node->is_integer() ? *count_node->value<std::int64_t>() : 0;
    if (count < 2 || count > static_cast<std::int64_t>(study_cases_max)) {
      add(count_node != nullptr ? *count_node : node,
          "axis.range.count: expected a whole number in [2, " + std::to_string(study_cases_max) + "]");
    }
    if (!faults_.empty()) return;
    const bool whole = table->get("from")->is_integer() && table->get("to")->is_integer() && !log &&
                       static_cast<std::int64_t>(*to - *from) % (count - 1) == 0;
    for (std::int64_t i = 0; i < count; ++i) {
      // The ends of the range are exactly the given numbers.
      const double share = static_cast<double>(i) / static_cast<double>(count - 1);
      const double value = i == 0           ? *from
                           : i == count - 1 ? *to
                           : log            ? *from * std::pow(*to / *from, share)
                                            : *from + share * (*to - *from);
      const std::string text = whole ? std::to_string(std::llround(value)) : number_text(value);
      axis.settings.push_back({{key, text, place(node.source())}});
      axis.labels.push_back(text);
    }
  }

  void along_zip(Axis& axis, const toml::node& node) {
    const toml::table* table = node.as_table();
    if (table == nullptr || table->empty()) {
      add(node, "axis.zip: expected a table of keys, each with its list of values");
      return;
    }
    zip_tables(axis, *table, "");
  }
  void zip_tables(Axis& axis, const toml::table& table, const std::string& above) {
    for (const auto& [key, node] : table) {
      const std::string name = above + std::string(key.str());
      if (node.is_table()) {
        zip_tables(axis, *node.as_table(), name + ".");
      } else {
        along(axis, name, node, "axis.zip." + name);
      }
    }
  }

  void relabel(Axis& axis, const toml::table& table) {
    const toml::node* node = table.get("labels");
    if (node == nullptr) return;
    const toml::array* array = node->as_array();
    if (array == nullptr || array->size() != axis.settings.size() || !array->is_homogeneous<std::string>()) {
      add(*node, "axis.labels: expected " + std::to_string(axis.settings.size()) + " texts, one for every value");
      return;
    }
    for (std::size_t i = 0; i < array->size(); ++i) {
      axis.labels[i] = array->get(i)->value_or(std::string());
      if (!is_plain_text(axis.labels[i])) add(*array->get(i), "axis.labels: expected texts without control characters");
    }
  }

  /// All combinations of the axes' values.
  void cross(const std::vector<Axis>& axes, const std::vector<Setting>& always, Study& study) {
    if (axes.empty()) return;
    std::set<std::string> names;
    std::size_t count = 1;
    for (const Axis& axis : axes) {
      if (!names.insert(axis.name).second) {
        add(document_, "axis.name: two axes are called \"" + axis.name + "\"; expected different names");
        return;
      }
      if ((count *= axis.settings.size()) > study_cases_max) {
        add(document_, "axis: more than " + std::to_string(study_cases_max) + " cases; expected fewer values");
        return;
      }
    }
    for (std::size_t k = 0; k < count; ++k) {
      StudyCase one{"", {}, always};
      std::size_t stride = count, rest = k;
      for (const Axis& axis : axes) {
        stride /= axis.settings.size();
        const std::size_t at = rest / stride;
        rest %= stride;
        one.settings.insert(one.settings.end(), axis.settings[at].begin(), axis.settings[at].end());
        one.along.emplace_back(axis.name, axis.labels[at]);
        one.name += (one.name.empty() ? "" : ", ") + axis.name + " = " + axis.labels[at];
      }
      study.cases.push_back(std::move(one));
    }
  }

  StudyCase single_case(const toml::table& table, const std::vector<Setting>& always) {
    known_keys(table, "case.", {"name", "set"});
    StudyCase one{text(table, "name").value_or(""), {}, always};
    if (one.name.empty()) add(table, "case.name: missing; expected a name");
    for (Setting& setting : settings(table, "set")) one.settings.push_back(std::move(setting));
    return one;
  }

  void unique_names(const Study& study) {
    std::set<std::string> names;
    for (const StudyCase& one : study.cases) {
      if (!names.insert(one.name).second) {
        add(document_, "two cases are called \"" + one.name + "\"; expected different names or axis.labels");
        return;
      }
    }
  }
};

/// A fault of a case, reported at the place in the study that gives the value.
Fault in_study(const Fault& fault, const StudyCase& one) {
  for (const Setting& setting : one.settings) {
    if (fault.file != "--set " + setting.key + "=" + setting.value) continue;
    Fault moved = setting.place;
    moved.message = fault.message;
    return moved;
  }
  return fault;
}

}  // namespace

Study load_study(const std::filesystem::path& file) {
  const toml::table document = read_document(file, "the study");
  require_kind(document, file, FileKind::sweep);
  return StudyReader(document, file).read();
}

std::optional<std::string> value_in(std::string_view text, const std::filesystem::path& file, const std::string& key) {
  const toml::table document = parse_document(text, file.string());
  const auto node = document.at_path(key);
  return node ? std::optional(value_text(*node.node())) : std::nullopt;
}

std::vector<Scene> load_cases(const Study& study, const std::function<std::vector<Fault>(const Scene&)>& check) {
  std::vector<Scene> scenes;
  std::vector<Fault> faults;
  std::set<std::string> told;
  for (const StudyCase& one : study.cases) {
    std::vector<Fault> found;
    try {
      std::vector<std::string> overrides;
      for (const Setting& setting : one.settings) overrides.push_back(setting.key + "=" + setting.value);
      scenes.push_back(load_scene(study.scene_file, overrides));
      if (check) found = check(scenes.back());
    } catch (const InputError& error) {
      found = error.faults();
    }
    for (const Fault& fault : found) {
      Fault moved = in_study(fault, one);
      if (!told.insert(moved.text()).second) continue;
      moved.message += " (case \"" + one.name + "\")";
      faults.push_back(std::move(moved));
    }
  }
  if (!faults.empty()) throw InputError(std::move(faults));
  return scenes;
}

}  // namespace touchstone::compare
