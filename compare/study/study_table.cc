#include "compare/study/study_table.h"

#include "compare/errors/figures.h"
#include "compare/format/text.h"
#include "compare/report/headline.h"
#include "compare/report/result_folder.h"
#include "compare/study/study_page.h"
#include "compare/study/study_parameters.h"
#include "scene/base/files.h"
#include "scene/base/json_text.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>

namespace touchstone::compare {
namespace {

using Json = nlohmann::ordered_json;

/// Columns of the short table, as far as the figures exist.
constexpr std::array short_figures = {"force.nrmse",
                                      "force.peak_rel",
                                      "shape.rel_l2",
                                      "contact.area_iou",
                                      "reference.force_uncertainty_rel",
                                      "reference.shape_uncertainty_rel",
                                      "reference.wall_s",
                                      "fast.step_us.p50"};

bool is_number(const scene::Figure& figure) { return figure.text.empty() || !std::isfinite(figure.number); }

std::string plain_text(const scene::Figure& figure) {
  if (!is_number(figure)) return figure.text;
  return std::isfinite(figure.number) ? fmt::format("{}", figure.number) : "nan";
}

Json json_of(const scene::Figure& figure) {
  if (!is_number(figure)) return figure.text;
  return std::isfinite(figure.number) ? Json(figure.number) : Json(nullptr);
}

std::string markdown_cell(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '|' ? "\\|" : c == '\n' ? " " : std::string(1, c);
  return out;
}

std::string label_at(const ManifestCase& one, const std::string& axis) {
  for (const auto& [name, label] : one.along) {
    if (name == axis) return label;
  }
  return "";
}

/// Parameters set by cases that are not on the axes.
std::vector<StudyParameter> keys_beside(const StudyManifest& manifest) {
  std::vector<StudyParameter> parameters = study_parameters(manifest);
  std::erase_if(parameters, [&](const StudyParameter& parameter) {
    return std::find(manifest.axes.begin(), manifest.axes.end(), parameter.name) != manifest.axes.end();
  });
  return parameters;
}

std::string csv(const StudyManifest& manifest, const std::vector<StudyRow>& rows,
                const std::vector<StudyParameter>& beside, const std::vector<std::string>& keys) {
  std::string text = "index,id,name,state,why,version,wall_s";
  for (const std::string& axis : manifest.axes) text += "," + csv_cell(axis);
  for (const StudyParameter& parameter : beside) text += "," + csv_cell(parameter.name);
  for (const std::string& key : keys) text += "," + csv_cell(key);
  text += '\n';
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const StudyRow& row = rows[k];
    const bool done = row.status.state == CaseState::done;
    text += fmt::format("{},{},{},{},{},{},{}", row.one->index, csv_cell(row.one->id), csv_cell(row.one->name),
                        state_name(row.status.state), csv_cell(row.status.why), csv_cell(row.status.version),
                        done ? fmt::format("{}", row.status.wall_s) : "");
    for (const std::string& axis : manifest.axes) text += "," + csv_cell(label_at(*row.one, axis));
    for (const StudyParameter& parameter : beside) text += "," + csv_cell(parameter.written[k]);
    for (const std::string& key : keys) {
      const scene::Figure* figure = find_figure(row.figures, key);
      text += "," + (figure != nullptr ? csv_cell(plain_text(*figure)) : "");
    }
    text += '\n';
  }
  return text;
}

Json json(const StudyManifest& manifest, const std::vector<StudyRow>& rows, const Json& units) {
  Json out = {{"name", manifest.name}, {"title", manifest.title}, {"run", manifest.run}, {"axes", manifest.axes}};
  out["cases"] = Json::array();
  for (const StudyRow& row : rows) {
    Json one = {{"index", row.one->index}, {"id", row.one->id}, {"name", row.one->name}};
    one["along"] = Json::object();
    for (const auto& [axis, label] : row.one->along) one["along"][axis] = label;
    one["set"] = Json::object();
    for (const auto& [key, value] : row.one->settings) one["set"][key] = value;
    one["state"] = state_name(row.status.state);
    if (!row.status.why.empty()) one["why"] = row.status.why;
    if (row.status.state == CaseState::done) {
      one["version"] = row.status.version;
      one["wall_s"] = row.status.wall_s;
      one["figures"] = Json::object();
      for (const scene::Figure& figure : row.figures) one["figures"][figure.key] = json_of(figure);
    }
    out["cases"].push_back(std::move(one));
  }
  out["units"] = units;
  return out;
}

std::string markdown(const StudyManifest& manifest, const std::vector<StudyRow>& rows,
                     const std::vector<StudyParameter>& beside_axes, const std::string& missing) {
  std::vector<std::string> keys;
  for (const char* key : short_figures) {
    if (std::any_of(rows.begin(), rows.end(),
                    [&](const StudyRow& row) { return find_figure(row.figures, key) != nullptr; })) {
      keys.emplace_back(key);
    }
  }
  const bool beside = std::any_of(rows.begin(), rows.end(), [](const StudyRow& row) { return row.one->along.empty(); });
  std::string head = "| case |", rule = "|---|";
  const auto column = [&](const std::string& name, bool number) {
    head += " " + markdown_cell(name) + " |";
    rule += number ? "---:|" : "---|";
  };
  for (const std::string& axis : manifest.axes) column(axis, false);
  for (const StudyParameter& parameter : beside_axes) column(parameter.label(), parameter.numeric());
  if (beside) column("name", false);
  column("state", false);
  for (const std::string& key : keys) column(key, true);
  std::string text =
      "# " + (manifest.title.empty() ? manifest.name : manifest.title) + "\n\n" + head + "\n" + rule + "\n";
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const StudyRow& row = rows[k];
    text += fmt::format("| {} |", row.one->index);
    for (const std::string& axis : manifest.axes) text += " " + markdown_cell(label_at(*row.one, axis)) + " |";
    for (const StudyParameter& parameter : beside_axes) text += " " + markdown_cell(parameter.values[k]) + " |";
    if (beside) text += " " + (row.one->along.empty() ? markdown_cell(row.one->name) : "") + " |";
    text += fmt::format(" {} |", state_name(row.status.state));
    for (const std::string& key : keys) {
      const scene::Figure* figure = find_figure(row.figures, key);
      text += " " + (figure != nullptr ? markdown_cell(figure_text(*figure)) : "") + " |";
    }
    text += '\n';
  }
  return text + (missing.empty() ? "" : "\n```\n" + missing + "```\n");
}

}  // namespace

std::string ranges_text(const std::vector<int>& ascending) {
  std::string text;
  for (std::size_t i = 0; i < ascending.size();) {
    std::size_t end = i;
    while (end + 1 < ascending.size() && ascending[end + 1] == ascending[end] + 1) ++end;
    text += (text.empty() ? "" : ",") + std::to_string(ascending[i]);
    if (end > i) text += "-" + std::to_string(ascending[end]);
    i = end + 1;
  }
  return text;
}

StudyTable collect(const StudyManifest& manifest) {
  std::vector<StudyRow> rows;
  std::vector<std::string> keys;
  std::set<std::string> known, versions;
  Json units = Json::object();
  StudyTable table{static_cast<int>(manifest.cases.size()), 0, ""};
  std::vector<int> again;
  for (const ManifestCase& one : manifest.cases) {
    StudyRow row{&one, case_status(manifest, one), {}};
    if (row.status.state == CaseState::done) {
      ++table.done;
      versions.insert(row.status.version);
      row.figures = read_figures(manifest.result_folder(one) / "summary.json");
      for (const scene::Figure& figure : row.figures) {
        units[figure.key] = figure.unit;
        if (known.insert(figure.key).second) keys.push_back(figure.key);
      }
    } else {
      table.text += fmt::format("case {} ({}): {}{}\n", one.index, one.name, state_name(row.status.state),
                                row.status.why.empty() ? "" : ": " + row.status.why);
      if (row.status.state != CaseState::running) again.push_back(one.index);
    }
    rows.push_back(std::move(row));
  }
  if (!again.empty()) table.text += "To run again: " + ranges_text(again) + '\n';
  if (versions.size() > 1) {
    table.text += "The cases are of different versions of the program:";
    for (const std::string& version : versions) table.text += " " + version + ";";
    table.text.back() = '\n';
  }
  const std::vector<StudyParameter> beside = keys_beside(manifest);
  scene::write_file(manifest.folder / "summary.csv", csv(manifest, rows, beside, keys));
  scene::write_file(manifest.folder / "summary.json", scene::json_text(json(manifest, rows, units)));
  scene::write_file(manifest.folder / "summary.md", markdown(manifest, rows, beside, table.text));
  scene::write_file(manifest.folder / "report.html", study_page_html(manifest, rows));
  return table;
}

}  // namespace touchstone::compare
