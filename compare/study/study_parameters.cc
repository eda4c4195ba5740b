#include "compare/study/study_parameters.h"

#include "compare/format/text.h"
#include "scene/base/error.h"
#include "scene/base/files.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string_view>

namespace touchstone::compare {
namespace {

constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

/// "3.5 mm" as 3.5 and "mm"; nothing if the text does not begin with a number.
struct NumberWithUnit {
  double number = 0.0;
  std::string unit;
};
std::optional<NumberWithUnit> quantity_of(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  NumberWithUnit out;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out.number);
  if (error != std::errc()) return std::nullopt;
  out.unit = std::string(end, text.data() + text.size());
  if (out.unit.starts_with(' ')) out.unit.erase(0, 1);
  const bool word = out.unit.find_first_of(" =,;0123456789") == std::string::npos;
  return word ? std::optional(out) : std::nullopt;
}

/// The numbers and their unit, if all values are numbers of the same unit.
void read_numbers(StudyParameter& parameter) {
  std::optional<std::string> unit;
  std::vector<double> numbers;
  for (const std::string& value : parameter.values) {
    const std::optional<NumberWithUnit> one =
        value.empty() ? NumberWithUnit{no_number, unit.value_or("")} : quantity_of(value);
    if (!one || (!value.empty() && unit && *unit != one->unit)) return;
    if (!value.empty()) unit = one->unit;
    numbers.push_back(one->number);
  }
  parameter.numbers = std::move(numbers);
  parameter.unit = unit.value_or("");
  std::vector<std::string> rounded;
  for (const double number : parameter.numbers) rounded.push_back(std::isnan(number) ? "" : number_text(number, 4));
  // Rounded only if different values remain different.
  if (std::set(rounded.begin(), rounded.end()).size() ==
      std::set(parameter.values.begin(), parameter.values.end()).size()) {
    parameter.values = std::move(rounded);
  }
}

/// A TOML value without the quotes of a string.
std::string words_of(const std::string& toml) {
  const bool quoted = toml.size() >= 2 && (toml.front() == '"' || toml.front() == '\'') && toml.back() == toml.front();
  return quoted ? toml.substr(1, toml.size() - 2) : toml;
}

std::string label_on(const ManifestCase& one, const std::string& axis) {
  for (const auto& [name, label] : one.along) {
    if (name == axis) return label;
  }
  return "";
}

/// The last value that the case sets for a key; else the scene's.
std::string value_of(const StudyManifest& manifest, const ManifestCase& one, const std::string& key) {
  for (auto setting = one.settings.rbegin(); setting != one.settings.rend(); ++setting) {
    if (setting->first == key) return words_of(setting->second);
  }
  const std::filesystem::path file = manifest.scene_file(one);
  const std::optional<std::string> text = scene::read_file(file);
  if (!text) throw scene::InputError({{file.string(), 0, 0, "cannot be read; expected the scene of " + one.name}});
  return words_of(value_in(*text, file, key).value_or(""));
}

/// Finds the position on this axis of the cases that are not on it, if this key alone varies along the axis: the label
/// of the cases with the same value. @returns whether it was found
bool place_beside(const StudyManifest& manifest, const std::vector<std::string>& values, StudyParameter& axis) {
  std::map<std::string, std::string> label_of_value, value_of_label;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (manifest.cases[k].along.empty()) continue;
    const std::string& label = axis.values[k];
    if (label_of_value.emplace(values[k], label).first->second != label) return false;
    if (value_of_label.emplace(label, values[k]).first->second != values[k]) return false;
  }
  if (label_of_value.size() < 2) return false;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const auto known = label_of_value.find(values[k]);
    if (manifest.cases[k].along.empty() && known != label_of_value.end()) axis.values[k] = known->second;
  }
  return true;
}

}  // namespace

std::vector<std::string> StudyParameter::distinct() const {
  std::vector<std::string> out;
  for (const std::string& value : values) {
    if (!value.empty() && std::find(out.begin(), out.end(), value) == out.end()) out.push_back(value);
  }
  return out;
}

std::vector<StudyParameter> study_parameters(const StudyManifest& manifest) {
  std::vector<StudyParameter> found;
  for (const std::string& axis : manifest.axes) {
    const bool is_key = axis.find('.') != std::string::npos;
    StudyParameter parameter;
    parameter.name = axis;
    parameter.axis = true;
    for (const ManifestCase& one : manifest.cases) {
      parameter.values.push_back(!one.along.empty() ? label_on(one, axis)
                                 : is_key           ? value_of(manifest, one, axis)
                                                    : "");
    }
    found.push_back(std::move(parameter));
  }
  std::vector<std::string> keys;  // keys set by cases that are not on the axes
  for (const ManifestCase& one : manifest.cases) {
    for (const auto& [key, value] : one.settings) {
      if (one.along.empty() && std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
    }
  }
  for (const std::string& key : keys) {
    StudyParameter parameter;
    parameter.name = key;
    for (const ManifestCase& one : manifest.cases) parameter.values.push_back(value_of(manifest, one, key));
    const bool known = std::any_of(found.begin(), found.end(), [&](StudyParameter& other) {
      return other.name == key || (other.axis && place_beside(manifest, parameter.values, other));
    });
    if (!known) found.push_back(std::move(parameter));
  }
  std::erase_if(found, [](const StudyParameter& one) {
    return std::all_of(one.values.begin(), one.values.end(), [&](const auto& v) { return v == one.values.front(); });
  });
  const auto last_part = [](const std::string& key) { return key.substr(key.rfind('.') + 1); };
  for (StudyParameter& parameter : found) {
    const auto alike = std::count_if(found.begin(), found.end(), [&](const StudyParameter& other) {
      return last_part(other.name) == last_part(parameter.name);
    });
    parameter.shown = alike == 1 ? last_part(parameter.name) : parameter.name;
    parameter.written = parameter.values;
    read_numbers(parameter);
  }
  return found;
}

}  // namespace touchstone::compare
