#include "compare/report/result_folder.h"

#include "scene/base/csv.h"
#include "scene/base/error.h"
#include "scene/base/text.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <limits>

namespace touchstone::compare {
namespace {

using Json = nlohmann::ordered_json;

int line_of(std::string_view text, std::size_t byte) {
  return 1 + static_cast<int>(std::count(
                 text.begin(), text.begin() + static_cast<std::ptrdiff_t>(std::min(byte, text.size())), '\n'));
}

std::string read_required(const std::filesystem::path& file) {
  const std::optional<std::string> text = scene::read_file(file);
  if (!text) {
    throw scene::InputError(
        {{file.string(), 0, 0, "cannot be read; expected a folder that touchstone fast, reference or compare wrote"}});
  }
  return *text;
}

Json read_object(const std::filesystem::path& file) {
  const std::string text = read_required(file);
  try {
    Json json = Json::parse(text);
    if (json.is_object()) return json;
  } catch (const Json::parse_error& error) {
    throw scene::InputError({{file.string(), line_of(text, error.byte), 0, "is not JSON; was it cut off or edited?"}});
  } catch (const Json::out_of_range&) {
    throw scene::InputError({{file.string(), 0, 0, "holds a number that is too large; was it edited?"}});
  }
  throw scene::InputError({{file.string(), 1, 0, "expected one JSON object"}});
}

std::string text_or_nothing(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : "";
}

scene::Figures figures_of(const Json& summary) {
  const Json units = summary.value("units", Json::object()), reasons = summary.value("reasons", Json::object());
  scene::Figures figures;
  for (const auto& [key, value] : summary.items()) {
    if (value.is_object()) continue;
    scene::Figure figure{key, std::numeric_limits<double>::quiet_NaN(), "", text_or_nothing(units, key.c_str())};
    if (value.is_number()) figure.number = value.get<double>();
    if (value.is_string()) figure = {key, 0.0, value.get<std::string>(), figure.unit};
    if (value.is_null()) figure.text = text_or_nothing(reasons, key.c_str());
    figures.push_back(std::move(figure));
  }
  return figures;
}

}  // namespace

const scene::Figure* ResultFolder::figure(std::string_view key) const { return find_figure(figures, key); }

const std::vector<double>* ResultFolder::column(std::string_view name) const {
  const auto found = std::find_if(curve.begin(), curve.end(), [&](const auto& c) { return c.name == name; });
  return found == curve.end() ? nullptr : &found->values;
}

const std::vector<double>& ResultFolder::required_column(std::string_view name) const {
  if (const std::vector<double>* values = column(name)) return *values;
  throw scene::InputError({{(folder / "curve.csv").string(), 1, 0, fmt::format("has no column {}", name)}});
}

scene::Figures read_figures(const std::filesystem::path& file) { return figures_of(read_object(file)); }

std::vector<scene::Column> parse_csv(std::string_view text, const std::filesystem::path& file) {
  std::vector<scene::Column> columns;
  scene::CsvRows rows(text);
  if (rows.next()) {
    for (const std::string_view name : rows.cells()) columns.push_back({std::string(name), {}});
  }
  while (rows.next()) {
    const auto refuse = [&](const std::string& message) {
      throw scene::InputError(std::vector<scene::Fault>{{file.string(), rows.line(), 0, message}});
    };
    const std::vector<std::string_view>& cells = rows.cells();
    if (cells.size() != columns.size()) {
      refuse(fmt::format("has {} values, expected {} as in the first line", cells.size(), columns.size()));
    }
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::optional<double> value = scene::parsed<double>(cells[i]);
      if (!value) refuse(fmt::format("\"{}\" in column {} is no number", cells[i], columns[i].name));
      columns[i].values.push_back(*value);
    }
  }
  return columns;
}

ResultFolder read_result_folder(const std::filesystem::path& folder) {
  if (!std::filesystem::exists(folder / "manifest.json")) {
    throw scene::InputError({{folder.string(), 0, 0,
                              "holds no manifest.json; expected a folder that touchstone fast, reference or compare "
                              "wrote"}});
  }
  ResultFolder out;
  out.folder = folder;
  std::vector<scene::Fault> faults;
  const auto attempt = [&faults](const auto& read) {
    try {
      read();
    } catch (const scene::InputError& error) {
      faults.insert(faults.end(), error.faults().begin(), error.faults().end());
    }
  };
  attempt([&] {
    const Json manifest = read_object(folder / "manifest.json");
    out.command = text_or_nothing(manifest, "command");
    out.scene_hash = text_or_nothing(manifest, "scene_hash");
    out.title = text_or_nothing(manifest, "title");
    out.resolved_scene = text_or_nothing(manifest, "resolved_scene");
    out.version = text_or_nothing(manifest, "version") + " " + text_or_nothing(manifest, "commit");
    out.date = text_or_nothing(manifest, "date");
  });
  attempt([&] { out.figures = read_figures(folder / "summary.json"); });
  attempt([&] { out.curve = parse_csv(read_required(folder / "curve.csv"), folder / "curve.csv"); });
  if (!faults.empty()) throw scene::InputError(std::move(faults));
  return out;
}

}  // namespace touchstone::compare
