#include "compare/report/model_table.h"

#include "compare/format/page.h"
#include "compare/format/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace touchstone::compare {
namespace {

constexpr std::string_view reading_note =
    "Force error: root mean square over the track, relative to the largest force. Shape error: relative to the "
    "displacement; a body that never moves would have 100 %. <: below the reference's uncertainty.";

constexpr std::string_view pressure_note =
    " Pressure error: of the tractions on the surface, relative to them; not every model gives them.";

std::string reading_text(bool pressure) {
  return std::string(reading_note) + std::string(pressure ? pressure_note : "");
}

/// An error below the reference's uncertainty is only known to be below it.
std::string error_text(const Measure& error) {
  if (!error.value) return "–";
  return error.distinguishable() ? percent_text(*error.value) : "< " + percent_text(*error.uncertainty);
}

/// Whether a model gives tractions, and the table has a column for them.
bool has_pressure(const std::vector<JudgedModel>& models) {
  return std::any_of(models.begin(), models.end(),
                     [](const JudgedModel& model) { return model.pressure_rel_l2.value.has_value(); });
}

std::string step_text(const JudgedModel& model) {
  return model.absent.empty() ? quantity_text(model.step_p50_us, "us") : "–";
}

/// Length in characters of a UTF-8 text.
std::size_t characters(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

std::string padded(std::string_view text, std::size_t width, bool right) {
  const std::string space(width - std::min(width, characters(text)), ' ');
  return right ? space + std::string(text) : std::string(text) + space;
}

}  // namespace

std::string model_table_text(const std::vector<JudgedModel>& models) {
  const bool pressure = has_pressure(models);
  std::vector<std::vector<std::string>> rows{{"model", "law, skeleton", "force", "shape", "step"}};
  if (pressure) rows.front().insert(rows.front().end() - 1, "pressure");
  std::string absent;
  for (const JudgedModel& model : models) {
    rows.push_back(
        {model.name, model.method, error_text(model.force_nrmse), error_text(model.shape_rel_l2), step_text(model)});
    if (pressure) rows.back().insert(rows.back().end() - 1, error_text(model.pressure_rel_l2));
    if (!model.absent.empty()) absent += wrapped(model.name + " is absent: " + model.absent, 80) + "\n";
  }
  std::vector<std::size_t> widths(rows.front().size(), 0);
  for (const auto& row : rows) {
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], characters(row[c]));
  }
  std::string text;
  for (const auto& row : rows) {
    for (std::size_t c = 0; c < row.size(); ++c) text += "  " + padded(row[c], widths[c], c >= 2);
    text += '\n';
  }
  return "Models on this contact, and their errors:\n" + text + absent + wrapped(reading_text(pressure), 80) + "\n";
}

std::string model_table_html(const std::vector<JudgedModel>& models) {
  const bool pressure = has_pressure(models);
  std::string out =
      "<div class=\"scroll\"><table>\n<tr><th>Model</th><th>Law, skeleton</th><th class=\"n\">Force error</th>"
      "<th class=\"n\">Shape error</th>";
  if (pressure) out += "<th class=\"n\">Pressure error</th>";
  out += "<th class=\"n\">Step, median</th></tr>\n";
  for (const JudgedModel& model : models) {
    const std::string remark = model.absent.empty() ? model.trouble : "absent: " + model.absent;
    out += "<tr>" + cell(model.name + (remark.empty() ? "" : " (" + remark + ")")) + cell(model.method) +
           number_cell(error_text(model.force_nrmse)) + number_cell(error_text(model.shape_rel_l2)) +
           (pressure ? number_cell(error_text(model.pressure_rel_l2)) : "") + number_cell(step_text(model)) + "</tr>\n";
  }
  return out + "</table></div>\n" + tag("p", reading_text(pressure), "class=\"dim\"") + "\n";
}

scene::Figures model_figures(const std::vector<JudgedModel>& models) {
  scene::Figures out;
  for (const JudgedModel& model : models) {
    const auto add = [&](const char* key, const std::optional<double>& value, const std::string& why_not) {
      const double number = value.value_or(std::numeric_limits<double>::quiet_NaN());
      out.push_back({"model." + model.key + "." + key, number, value ? "" : why_not, ""});
    };
    const std::string none =
        model.absent.empty() ? "undefined: the reference is never in contact" : "absent: " + model.absent;
    add("force.nrmse", model.force_nrmse.value,
        model.shape_rel_l2.value ? "undefined: the model gives no force" : none);
    add("force.nrmse_uncertainty", model.force_nrmse.uncertainty, "unknown");
    add("shape.rel_l2", model.shape_rel_l2.value, none);
    add("shape.rel_l2_uncertainty", model.shape_rel_l2.uncertainty, "unknown");
    if (model.pressure_rel_l2.value) {
      add("contact.pressure_rel_l2", model.pressure_rel_l2.value, "");
      add("contact.pressure_rel_l2_uncertainty", model.pressure_rel_l2.uncertainty, "unknown");
      add("contact.pressure_peak_rel", model.pressure_peak_rel.value, none);
      add("contact.pressure_peak_rel_uncertainty", model.pressure_peak_rel.uncertainty, "unknown");
    }
    out.push_back({"model." + model.key + ".step_us.p50", model.step_p50_us, model.absent.empty() ? "" : none, "us"});
  }
  return out;
}

}  // namespace touchstone::compare
