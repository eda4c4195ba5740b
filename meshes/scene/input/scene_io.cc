#include "scene/input/scene_io.h"

#include "scene/base/hash.h"
#include "scene/base/index.h"
#include "scene/base/input.h"
#include "scene/base/nearest_name.h"
#include "scene/base/text.h"
#include "scene/input/fields.h"
#include "scene/input/toml_reader.h"
#include "scene/input/track_csv.h"
#include "scene/mesh/mesh_file.h"
#include "scene/model/first_contact.h"
#include "scene/model/rules.h"
#include "scene/response/response.h"

#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <type_traits>

namespace touchstone::scene {
namespace {

constexpr std::string_view track_file_key = "file";
constexpr std::string_view inclusion_key = "body.inclusion";
constexpr std::string_view probe_key = "probe";
constexpr std::string_view override_mark = "--set ";

/// The value as written in the file, for an error message.
std::string written(const toml::node& node) {
  if (const auto* number = node.as_floating_point()) return number_text(number->get());
  if (const auto* array = node.as_array()) {
    std::string out;
    for (const toml::node& element : *array) out += (out.empty() ? "" : ", ") + written(element);
    return shortened("[" + out + "]");
  }
  if (node.is_table()) return "a table";
  std::ostringstream out;
  node.visit([&](const auto& n) {
    if constexpr (toml::is_string<decltype(n)>)
      out << toml_quoted(shortened(n.get()));
    else if constexpr (!toml::is_table<decltype(n)> && !toml::is_array<decltype(n)>)
      out << n;
  });
  return out.str();
}

/// Reads one file's document into a Scene and collects all faults with their places.
class Reader {
 public:
  Reader(const toml::table& document, std::filesystem::path file) : document_(document), file_(std::move(file)) {}

  Scene read() {
    Scene scene;
    scene.name = file_.stem().string();
    find_unknown(document_, "", known_scene_keys());
    for (const OptionalTable& table : optional_tables()) {
      if (document_.at_path(table.key).is_table()) table.give(scene);
    }
    // Before the keys that apply only with inclusions.
    scene.body.inclusions = read_rows(inclusion_fields(), document_.at_path(inclusion_key), inclusion_key);
    read_fields(scene_fields(), document_, "", scene);
    scene.probes = read_rows(probe_fields(), document_.at_path(probe_key), probe_key);
    read_mesh(scene);
    const std::vector<TrackRow> rows = read_track();
    check_rows(rows);
    if (faults_.empty()) {
      complete(scene.body);
      for (Inclusion& inclusion : scene.body.inclusions) complete(inclusion);
      report(broken_shapes(scene));
    }
    if (faults_.empty()) fill_in_defaults(scene);
    if (faults_.empty()) place_tool(rows, scene);
    if (faults_.empty()) report(broken_rules(scene));
    if (faults_.empty()) {
      if (const std::string needs = formulation_needs(scene); !needs.empty())
        add_fault("fast.formulation",
                  "the " + std::string(name_of(scene.fast.formulation)) + " model needs that " + needs);
    }
    if (!faults_.empty()) throw InputError(sorted(faults_));
    return scene;
  }

 private:
  static std::vector<Fault> sorted(std::vector<Fault> faults) {
    std::stable_sort(faults.begin(), faults.end(), [](const Fault& a, const Fault& b) {
      return std::tie(a.file, a.line, a.column) < std::tie(b.file, b.line, b.column);
    });
    return faults;
  }

  [[nodiscard]] Fault at(const toml::source_region& source, std::string message) const {
    const std::string file = source.path ? *source.path : file_.string();
    if (file.starts_with(override_mark)) return {file, 0, 0, std::move(message)};
    return {file, static_cast<int>(source.begin.line), static_cast<int>(source.begin.column), std::move(message)};
  }

  void report(const std::vector<Violation>& violations) {
    for (const Violation& v : violations) add_fault(v.key, v.message);
  }

  /// Adds a fault at a key's place; for an absent key, at the nearest table above it.
  void add_fault(const std::string& key, const std::string& message) {
    const auto place = places_.find(key);
    if (place != places_.end()) {
      Fault fault = place->second;
      fault.message = key + ": " + message;
      faults_.push_back(std::move(fault));
      return;
    }
    if (!csv_lines_.empty() && key.starts_with("track[")) {
      const auto row = static_cast<std::size_t>(std::stoul(key.substr(6)));
      faults_.push_back({places_.at("track").file, csv_lines_[row], 1, key + ": " + message});
      return;
    }
    const toml::node* above = nullptr;
    for (std::size_t dot = key.rfind('.'); above == nullptr && dot != std::string::npos;
         dot = key.rfind('.', dot - 1)) {
      above = document_.at_path(key.substr(0, dot)).node();
    }
    faults_.push_back(above != nullptr ? at(above->source(), key + ": " + message)
                                       : Fault{file_.string(), 0, 0, key + ": " + message});
  }

  template <class T>
  static std::vector<std::string> keys_of(const std::vector<Field<T>>& fields) {
    std::vector<std::string> keys;
    for (const auto& field : fields) keys.emplace_back(field.key);
    return keys;
  }

  static std::vector<std::string> known_scene_keys() {
    std::vector<std::string> keys = keys_of(scene_fields());
    keys.emplace_back("track");
    keys.emplace_back(inclusion_key);
    keys.emplace_back(probe_key);
    return keys;
  }

  /// @param path of the table within its row or document; @param known keys of that row or document
  void find_unknown(const toml::table& table, const std::string& path, const std::vector<std::string>& known,
                    const std::string& row = "") {
    for (const auto& [key, node] : table) {
      const std::string here = path + std::string(key.str());
      if (here == "track" || here == inclusion_key || here == probe_key) continue;
      const std::string above = here + ".";
      const bool is_section =
          std::any_of(known.begin(), known.end(), [&](const std::string& k) { return k.starts_with(above); });
      if (is_section && node.is_table()) {
        find_unknown(*node.as_table(), above, known, row);
      } else if (is_section) {
        faults_.push_back(at(node.source(), row + here + ": expected a table, [" + row + here + "]"));
      } else if (std::find(known.begin(), known.end(), here) == known.end()) {
        faults_.push_back(at(key.source(), unknown_key_message(here, known, row)));
      }
    }
  }

  [[nodiscard]] std::string unknown_key_message(const std::string& path, const std::vector<std::string>& known,
                                                const std::string& row) const {
    if (std::string former = row.empty() ? former_name_message(path) : ""; !former.empty()) return former;
    if (faults_.size() >= faults_shown_max) return unknown_key(row + path, path, known, faults_.size());
    // Table names are keys too: [boddy] should suggest [body], not a long key inside it.
    std::set<std::string> names(known.begin(), known.end());
    for (const std::string& key : known) {
      for (std::size_t dot = key.find('.'); dot != std::string::npos; dot = key.find('.', dot + 1))
        names.insert(key.substr(0, dot));
    }
    return unknown_key(row + path, path, {names.begin(), names.end()}, faults_.size());
  }

  /// Reads all fields of a document or row. @param row its name with a dot, for messages; empty for the document
  template <class T>
  void read_fields(const std::vector<Field<T>>& fields, const toml::table& table, const std::string& row, T& object) {
    // Keys that conditions of others depend on come first: choices, then lists, then the rest.
    const auto rank = [](const Field<T>& field) {
      if (std::holds_alternative<Choice<T>>(field.access)) return 0;
      return std::holds_alternative<std::vector<Eigen::Vector2d>& (*)(T&)>(field.access) ? 1 : 2;
    };
    for (const int turn : {0, 1, 2}) {
      for (const auto& field : fields) {
        if (rank(field) == turn) read_field(field, table, row, object);
      }
    }
  }

  template <class T>
  void read_field(const Field<T>& field, const toml::table& table, const std::string& row, T& object) {
    const std::string key = row + std::string(field.key);
    const toml::node* node = table.at_path(field.key).node();
    if (field.only_when && failed_.contains(row + std::string(field.only_when->key))) return;
    if (!applies(field, object)) {
      if (node != nullptr) {
        faults_.push_back(at(node->source(), key + ": only applies with " + std::string(field.only_when->text)));
      }
      return;
    }
    if (node != nullptr) {
      places_[key] = at(node->source(), "");
      read_value(field, *node, key, object);
    } else if (!read_default(field, object) && must_be_given(field)) {
      if (row.empty()) {
        add_fault(key, "missing; expected " + expected_text(field));
      } else {
        faults_.push_back(at(table.source(), key + ": missing; expected " + expected_text(field)));
      }
      failed_.insert(key);
    }
  }

  /// Fills in defaults that follow from other values, which are all valid by now.
  void fill_in_defaults(Scene& scene) {
    for (const auto& field : scene_fields()) {
      if (!field.default_of || places_.contains(std::string(field.key)) || !applies(field, scene)) continue;
      std::get<double& (*)(Scene&)>(field.access)(scene) = field.default_of(scene);
    }
  }

  /// Reads an array of tables. @param node the array, or null
  template <class T>
  std::vector<T> read_rows(const std::vector<Field<T>>& fields, toml::node_view<const toml::node> node,
                           std::string_view name) {
    std::vector<T> rows;
    if (!node) return rows;
    const toml::array* array = node.as_array();
    if (array == nullptr || !array->is_array_of_tables()) {
      faults_.push_back(at(node.node()->source(), std::string(name) + ": expected [[" + std::string(name) + "]] rows"));
      return rows;
    }
    for (std::size_t i = 0; i < array->size(); ++i) {
      const toml::table& table = *(*array)[i].as_table();
      const std::string row = std::string(name) + "[" + std::to_string(i) + "].";
      places_[row.substr(0, row.size() - 1)] = at(table.source(), "");
      find_unknown(table, "", keys_of(fields), row);
      rows.emplace_back();
      read_fields(fields, table, row, rows.back());
    }
    return rows;
  }

  /// Reads a file that the scene names. @param key  the key that names it, at which a fault is reported
  std::optional<std::string> read_named(const std::filesystem::path& file, const InputKind& kind,
                                        const std::string& key) {
    Input input = read_input(file, kind);
    if (input.fault.empty()) return std::move(input.bytes);
    add_fault(key, "cannot read " + file.string() + ": " + input.fault);
    return std::nullopt;
  }

  void read_mesh(Scene& scene) {
    if (scene.tool.shape != ToolShape::mesh) return;
    if (failed_.contains("tool.file") || failed_.contains("tool.unit")) return;
    constexpr double units_m[] = {1.0, 1e-2, 1e-3, 0.0254};
    const std::filesystem::path file = file_.parent_path() / scene.tool.file;
    std::optional<std::string> content = read_named(file, mesh_input, "tool.file");
    if (!content) return;
    scene.tool.mesh = mesh_of_file(*std::move(content), file, nth(units_m, scene.tool.unit), faults_);
  }

  template <class T>
  bool read_default(const Field<T>& field, T& object) {
    if (!field.default_value) return false;
    const toml::table parsed = toml::parse("value = " + std::string(*field.default_value));
    read_value(field, *parsed.get("value"), std::string(field.key), object);
    return true;
  }

  /// @param key  full path, for the message
  template <class T>
  void read_value(const Field<T>& field, const toml::node& node, const std::string& key, T& object) {
    const bool good = std::visit([&](const auto& access) { return assign(field, access, node, object); }, field.access);
    if (good) return;
    faults_.push_back(at(
        node.source(), key + " = " + written(node) + "; expected " + expected_text(field) + meant_choice(field, node)));
    failed_.insert(key);
  }

  template <class T>
  static std::string meant_choice(const Field<T>& field, const toml::node& node) {
    const auto* choice = std::get_if<Choice<T>>(&field.access);
    if (choice == nullptr || !node.is_string()) return "";
    return did_you_mean(node.value_or(std::string()), {choice->names.begin(), choice->names.end()});
  }

  /// Numbers of an array, or nothing if it does not consist of `count` numbers in range.
  static std::optional<std::vector<double>> numbers(const Range& range, const toml::node& node,
                                                    std::optional<std::size_t> count = std::nullopt) {
    const toml::array* array = node.as_array();
    if (array == nullptr || (count && array->size() != *count)) return std::nullopt;
    std::vector<double> values;
    for (const toml::node& element : *array) {
      const auto value = element.is_number() ? element.value<double>() : std::nullopt;
      if (!value || !range.contains(*value)) return std::nullopt;
      values.push_back(*value);
    }
    return values;
  }
  /// Sets the value from the node. @returns false if the node is not one of its kind and in range
  static bool set(double& to, const Range& range, const toml::node& node) {
    const auto value = node.is_number() ? node.value<double>() : std::nullopt;
    if (!value || !range.contains(*value)) return false;
    to = *value;
    return true;
  }
  static bool set(int& to, const Range& range, const toml::node& node) {
    const auto value = node.is_integer() ? node.value<std::int64_t>() : std::nullopt;
    if (!value || !range.contains(static_cast<double>(*value))) return false;
    to = static_cast<int>(*value);
    return true;
  }
  static bool set(std::string& to, const Range&, const toml::node& node) {
    const auto value = node.is_string() ? node.value<std::string>() : std::nullopt;
    if (!value || !is_plain_text(*value)) return false;
    to = *value;
    return true;
  }
  static bool set(Vec3& to, const Range& range, const toml::node& node) {
    const auto v = numbers(range, node, 3);
    if (v) to = Vec3((*v)[0], (*v)[1], (*v)[2]);
    return v.has_value();
  }
  static bool set(OpenPosition& to, const Range& range, const toml::node& node) {
    const auto v = numbers(range, node);
    if (!v || (v->size() != 2 && v->size() != 3)) return false;
    to = {Vec3((*v)[0], (*v)[1], v->size() == 3 ? (*v)[2] : 0.0), v->size() == 2};
    return true;
  }
  static bool set(std::vector<double>& to, const Range& range, const toml::node& node) {
    auto values = numbers(range, node);
    if (values) to = std::move(*values);
    return values.has_value();
  }
  static bool set(std::vector<Eigen::Vector2d>& to, const Range& range, const toml::node& node) {
    const toml::array* array = node.as_array();
    if (array == nullptr) return false;
    to.clear();
    for (const toml::node& element : *array) {
      const auto pair = numbers(range, element, 2);
      if (!pair) return false;
      to.emplace_back((*pair)[0], (*pair)[1]);
    }
    return true;
  }
  static bool set(Eigen::Quaterniond& to, const Range& range, const toml::node& node) {
    const auto v = numbers(range, node, 4);
    const auto orientation = v ? orientation_of({(*v)[0], (*v)[1], (*v)[2], (*v)[3]}) : std::nullopt;
    if (orientation) to = *orientation;
    return orientation.has_value();
  }
  template <class Value>
  static bool set(std::optional<Value>& to, const Range& range, const toml::node& node) {
    Value value{};
    if (!set(value, range, node)) return false;
    to = value;
    return true;
  }

  template <class T, class Value>
  static bool assign(const Field<T>& field, Value& (*const& member)(T&), const toml::node& node, T& object) {
    if constexpr (std::is_same_v<Value, std::string>) {
      if (!field.default_value && node.value_or(std::string()).empty()) return false;
    }
    return set(member(object), field.range, node);
  }
  template <class T>
  static bool assign(const Field<T>&, const Choice<T>& access, const toml::node& node, T& object) {
    const auto value = node.is_string() ? node.value<std::string>() : std::nullopt;
    const auto found = std::find(access.names.begin(), access.names.end(), value.value_or(""));
    if (!value || found == access.names.end()) return false;
    access.set(object, static_cast<int>(found - access.names.begin()));
    return true;
  }

  std::vector<TrackRow> read_track() {
    const toml::node* track = document_.get("track");
    if (track == nullptr) {
      add_fault("track", "missing; expected [[track]] rows with time_s and position_m, or [track] file = \"...csv\"");
      return {};
    }
    places_["track"] = at(track->source(), "");
    if (const toml::table* table = track->as_table()) return read_track_file(*table);
    if (const toml::array* rows = track->as_array(); rows != nullptr && rows->is_array_of_tables())
      return read_rows(track_fields(), toml::node_view<const toml::node>(track), "track");
    add_fault("track", "expected [[track]] rows, or [track] file = \"...csv\"");
    return {};
  }

  /// A row must give its height either by z or by the depth.
  void check_rows(const std::vector<TrackRow>& rows) {
    if (!csv_lines_.empty()) return;  // a CSV table's header decides this for all rows
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const TrackRow& row = rows[i];
      const std::string name = "track[" + std::to_string(i) + "].";
      if (failed_.contains(name + "position_m") || failed_.contains(name + "depth_m") ||
          failed_.contains(name + "direction"))
        continue;
      const Vec3& p_m = row.position.position_m;
      const std::string flat = "[" + number_text(p_m.x()) + ", " + number_text(p_m.y()) + "]";
      if (row.direction && !row.depth_m) {
        add_fault(name + "direction", "only applies with depth_m, how far along it beyond first contact");
      } else if (row.direction && row.direction->stableNorm() == 0.0) {
        add_fault(name + "direction", "is zero; expected a non-zero length");
      } else if (row.direction && row.position.height_open && row.direction->head<2>().norm() > 0.0) {
        add_fault(name + "position_m",
                  "a direction that is not vertical needs a point of its line; expected three numbers");
      } else if (row.depth_m && !row.direction && !row.position.height_open) {
        add_fault(name + "depth_m",
                  "the height is given twice, by depth_m and by the third number of position_m; "
                  "expected position_m = " +
                      flat + " with depth_m, or position_m alone");
      } else if (!row.depth_m && row.position.height_open) {
        add_fault(name + "position_m", "the height is missing; expected a third number, or depth_m beside " + flat);
      }
    }
  }

  /// The track's poses. Those given by depth are computed here, so that a resolved scene has positions alone.
  void place_tool(const std::vector<TrackRow>& rows, Scene& scene) {
    const auto body = body_shape(scene.body);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const TrackRow& row = rows[i];
      Pose pose{row.position.position_m, row.orientation};
      if (row.depth_m) {
        const Vec3 direction = row.direction.value_or(-Vec3::UnitZ()).stableNormalized();
        const std::optional<double> touch_m = first_contact_m(*body, scene.tool, pose, direction);
        if (!touch_m) {
          add_fault("track[" + std::to_string(i) + "].depth_m",
                    row.direction
                        ? "the tool never touches the body along this direction; expected a line through "
                          "position_m on which it does"
                        : "moved straight down the tool never touches the body; expected x and y above the body");
          continue;
        }
        // Rounded to a picometre: the same text on every machine, and a round height stays round.
        for (int axis = 0; axis < 3; ++axis) {
          if (direction[axis] == 0.0) continue;
          const double moved_m = pose.position_m[axis] + (*touch_m + *row.depth_m) * direction[axis];
          pose.position_m[axis] = std::round(moved_m * 1e12) / 1e12;
        }
        const Range& range = track_field("position_m").range;
        if (!range.contains(pose.position_m.minCoeff()) || !range.contains(pose.position_m.maxCoeff())) {
          add_fault("track[" + std::to_string(i) + "].depth_m",
                    "leads to a position outside the range of position_m; expected each coordinate in " + range.text() +
                        " m");
          continue;
        }
      }
      scene.track.push_back({row.time_s, pose});
    }
  }

  std::vector<TrackRow> read_track_file(const toml::table& table) {
    for (const auto& [key, node] : table) {
      if (key.str() != track_file_key) {
        faults_.push_back(at(key.source(), "unknown key \"track." + shortened(key.str()) +
                                               "\"; did you mean \"track.file\", or [[track]] rows?"));
      }
    }
    const auto name = table[track_file_key].value<std::string>();
    if (!name) {
      faults_.push_back(at(table.source(), "track.file: expected the name of a CSV file"));
      return {};
    }
    const std::filesystem::path csv = file_.parent_path() / *name;
    places_["track.file"] = at(table.get(track_file_key)->source(), "");
    const std::optional<std::string> text = read_named(csv, table_input, "track.file");
    if (!text) return {};
    places_["track"] = {csv.string(), 0, 0, ""};
    return read_track_csv(*text, csv.string(), faults_, csv_lines_);
  }

  const toml::table& document_;
  std::filesystem::path file_;
  std::vector<Fault> faults_;
  std::map<std::string, Fault> places_;  ///< the place of every key; message empty
  std::vector<int> csv_lines_;           ///< of the track's rows, if it is a CSV table
  std::set<std::string> failed_;         ///< keys whose value is not valid
};

/// Moves the values, which keep the place they were read from.
void merge(toml::table&& from, toml::table& into) {
  for (auto& [key, node] : from) {
    toml::table* old = into[key.str()].as_table();
    if (toml::table* table = node.as_table(); table != nullptr && old != nullptr) {
      merge(std::move(*table), *old);
    } else {
      node.visit([&, &key = key](auto& n) { into.insert_or_assign(key, std::move(n)); });
    }
  }
}

/// Merges the included file, if any, below the document. It lies beside it and may not include another file.
void take_in_included(const std::filesystem::path& file, toml::table& document) {
  const toml::node* node = document.get("include");
  if (node == nullptr) return;
  const auto refuse = [&](const std::string& message) {
    const toml::source_position where = node->source().begin;
    throw InputError({{file.string(), static_cast<int>(where.line), static_cast<int>(where.column), message}});
  };
  if (node->value_or(std::string()).empty())
    refuse("include = " + written(*node) + "; expected the path of a TOML file, from this one");
  const std::filesystem::path included = file.parent_path() / node->value_or(std::string());
  const Input input = read_input(included, toml_input);
  if (!input.fault.empty()) refuse("include: cannot read " + included.string() + ": " + input.fault);
  toml::table all = parse_document(input.bytes, included.string());
  if (all.contains("include"))
    refuse("include: " + included.string() + " includes another file; expected a file without include");
  document.erase("include");
  merge(std::move(document), all);
  document = std::move(all);
}

/// @param before  the text before the value: its key and " = "
toml::table parse_value(const std::string& value, const std::string& before, const std::string& place) {
  try {
    return parse_document(before + value, place);
  } catch (const InputError&) {
    // So that a shell user need not quote a word twice.
    return parse_document(before + "'" + value + "'", place);
  }
}

/// Sets the value at a path with indices, such as track[1].position_m[2]. Rows and elements are counted from zero and
/// must exist.
void set_element(const std::string& path, toml::table&& parsed, const std::string& place, toml::table& document) {
  toml::node& value = *parsed.get("value");
  const std::size_t end = path.find_last_of(".[");
  toml::node* above = document.at_path(path.substr(0, end)).node();
  if (path[end] == '.' && above != nullptr && above->is_table()) {
    value.visit([&](auto& v) { above->as_table()->insert_or_assign(path.substr(end + 1), std::move(v)); });
    return;
  }
  toml::array* array = above != nullptr ? above->as_array() : nullptr;
  const toml::node* old = document.at_path(path).node();
  if (array == nullptr || old == nullptr) {
    throw InputError({{place, 0, 0,
                       path + " is not in the scene; expected an existing index, counted from 0, such as "
                              "track[1].position_m[2] of a track in rows"}});
  }
  const auto at = std::find_if(array->cbegin(), array->cend(), [&](const toml::node& node) { return &node == old; });
  value.visit([&](auto& v) { array->replace(at, std::move(v)); });
}

void apply_override(const std::string& setting, toml::table& document) {
  const std::string place = std::string(override_mark) + setting;
  const std::size_t equals = setting.find('=');
  if (equals == std::string::npos || equals == 0)
    throw InputError(place + ": expected key=value, such as fast.C_n=0.1");
  const std::string key = setting.substr(0, equals), value = setting.substr(equals + 1);
  if (key.find('[') != std::string::npos) {
    set_element(key, parse_value(value, "value = ", place), place, document);
  } else {
    merge(parse_value(value, key + " = ", place), document);
  }
}

/// @param keep  which keys; @param meaning  add every key's documentation after it
template <class Keep>
std::string toml_text(const Scene& scene, Keep keep, bool meaning = false) {
  std::ostringstream out;
  const auto line = [&](std::string_view key, const auto& field, const std::string& value) {
    const std::string text = std::string(key) + " = " + value;
    out << text;
    if (meaning) out << std::string(text.size() < 36 ? 36 - text.size() : 1, ' ') << "# " << field.doc;
    out << '\n';
  };
  std::string section;
  for (const auto& field : scene_fields()) {
    if (!applies(field, scene) || !keep(field)) continue;
    const std::string value = value_text(field, scene);
    if (value.empty()) continue;
    const std::string key(field.key);
    const std::size_t dot = key.rfind('.');
    const std::string table = dot == std::string::npos ? "" : key.substr(0, dot);
    if (table != section) out << "\n[" << (section = table) << "]\n";
    line(dot == std::string::npos ? key : key.substr(dot + 1), field, value);
  }
  const auto row = [&](std::string_view name, const auto& fields, const auto& object) {
    out << "\n[[" << name << "]]\n";
    for (const auto& field : fields) {
      if (const std::string value = value_text(field, object); applies(field, object) && !value.empty())
        line(field.key, field, value);
    }
  };
  for (const Inclusion& inclusion : scene.body.inclusions) row(inclusion_key, inclusion_fields(), inclusion);
  for (const Probe& probe : scene.probes) row(probe_key, probe_fields(), probe);
  for (const Waypoint& w : scene.track) {
    row("track", track_fields(),
        TrackRow{w.time_s, {w.pose.position_m, false}, std::nullopt, std::nullopt, w.pose.orientation});
  }
  return out.str();
}

/// The mesh's numbers, as bytes.
std::string mesh_text(const TriangleMesh& mesh) {
  const auto bytes = [](const auto* data, std::size_t count) {
    return std::string(reinterpret_cast<const char*>(data), count * sizeof *data);
  };
  return bytes(mesh.points_m.data(), static_cast<std::size_t>(mesh.points_m.size())) +
         bytes(mesh.triangles.data(), mesh.triangles.size());
}

}  // namespace

Scene parse_scene(const std::string& text, const std::filesystem::path& file,
                  const std::vector<std::string>& overrides) {
  toml::table document = parse_document(text, file.string());
  require_kind(document, file, FileKind::scene);
  take_in_included(file, document);
  for (const std::string& setting : overrides) apply_override(setting, document);
  return Reader(document, file).read();
}

Scene load_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
  return parse_scene(require_input(file, toml_input, "the scene"), file, overrides);
}

std::string resolved_toml(const Scene& scene) {
  return toml_text(scene, [](const auto&) { return true; });
}

std::string explained_toml(const Scene& scene) {
  return toml_text(
      scene, [](const auto&) { return true; }, true);
}

std::string scene_hash(const Scene& scene) {
  // A mesh is identified by its content, not by its file name.
  std::string text =
      toml_text(scene, [](const auto& field) { return field.side != Side::none && field.key != "tool.file"; });
  if (scene.tool.mesh) text += mesh_text(*scene.tool.mesh);
  return hash_text(text);
}

}  // namespace touchstone::scene
