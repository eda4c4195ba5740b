#include "compare/report/headline.h"

#include "compare/errors/figures.h"
#include "compare/format/page.h"
#include "compare/format/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace touchstone::compare {
namespace {

struct Column {
  std::string_view key, title;
};
constexpr Column columns[] = {{"force.nrmse", "Force error, of the peak"},
                              {"force.peak_rel", "Error of the largest force"},
                              {"shape.rel_l2", "Shape error, of the displacement"},
                              {"contact.area_iou", "Contact area in common"},
                              {"force.peak_reference_n", "Largest force, reference"},
                              {"fast.step_us.p50", "Fast step, median"},
                              {"fast.step_us.p999", "99.9 % are shorter than"},
                              {"reference.wall_s", "Reference took"}};

std::string value_cell(const scene::Figures& figures, std::string_view key) {
  const scene::Figure* value = find_figure(figures, key);
  if (value == nullptr) return cell("–");
  if (!value->text.empty() || !std::isfinite(value->number)) return cell(figure_text(*value));
  std::string out = escape_xml(figure_text(*value));
  const scene::Figure* uncertainty = find_figure(figures, std::string(key) + std::string(uncertainty_suffix));
  if (uncertainty != nullptr) {
    const bool known = std::isfinite(uncertainty->number);
    out += tag("span", "± " + (known ? figure_text(*uncertainty) : "unknown"), "class=\"under\"");
    if (known && std::abs(value->number) <= uncertainty->number) {
      out += tag("span", "not distinguishable", "class=\"under\"");
    }
  }
  return "<td class=\"n\">" + out + "</td>";
}

}  // namespace

std::string headline_heads() {
  std::string out;
  for (const Column& column : columns) {
    out += tag("th", std::string(column.title), fmt::format("class=\"wrap\" title=\"{}\"", column.key));
  }
  return out;
}

std::string headline_cells(const scene::Figures& figures) {
  std::string out;
  for (const Column& column : columns) out += value_cell(figures, column.key);
  return out;
}

std::string headline_note() {
  return tag("p",
             "± is the reference's own uncertainty in the same norm. Not distinguishable: the error is no larger than "
             "that, so it may be none.",
             "class=\"dim\"") +
         "\n";
}

}  // namespace touchstone::compare
