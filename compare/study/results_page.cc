#include "compare/study/results_page.h"

#include "compare/errors/errors.h"
#include "compare/format/page.h"
#include "compare/format/svg_plot.h"
#include "compare/format/text.h"
#include "compare/report/headline.h"
#include "compare/study/study.h"
#include "scene/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

namespace touchstone::compare {
namespace {

/// A result and its name on the page.
struct Entry {
  const ResultFolder& result;
  std::string name, title, link;
};

/// Link from a page in the folder `place` to a file, percent-encoded.
std::string relative_link(const std::filesystem::path& file, const std::filesystem::path& place) {
  const std::string path =
      std::filesystem::proximate(std::filesystem::weakly_canonical(file), std::filesystem::weakly_canonical(place))
          .generic_string();
  std::string out;
  for (const char c : path) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       std::string_view("-._~/").find(c) != std::string_view::npos;
    out += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return out;
}

/// A result and its place in the study that contains it, if any.
struct Placed {
  ResultFolder result;
  std::optional<StudyPlace> place;
};

/// Results of one study are listed in the study's order, at the place of the first of them.
std::vector<Placed> in_order(const std::vector<ResultFolder>& results) {
  std::vector<Placed> out;
  for (const ResultFolder& result : results) {
    std::optional<StudyPlace> place = place_in_study(result.folder);
    const auto same = [&](const Placed& other) { return place && other.place && other.place->study == place->study; };
    auto at = out.end();
    if (const auto first = std::find_if(out.begin(), out.end(), same); first != out.end()) {
      at = std::find_if(first, out.end(),
                        [&](const Placed& other) { return !same(other) || other.place->index > place->index; });
    }
    out.insert(at, {result, std::move(place)});
  }
  return out;
}

/// The case's name in its study, with the study's name if several studies have such a case; else the folder's name,
/// with as many parent folders as needed to be unique.
std::string short_name(const std::vector<Placed>& results, std::size_t at) {
  if (const auto& place = results[at].place) {
    const bool shared = std::any_of(results.begin(), results.end(), [&](const Placed& other) {
      return other.place && other.place->study != place->study && other.place->name == place->name;
    });
    return shared ? place->study.filename().string() + ": " + place->name : place->name;
  }
  const auto tail = [](const std::filesystem::path& folder, int parts) {
    std::filesystem::path rest = std::filesystem::weakly_canonical(folder), out;
    for (int i = 0; i < parts && rest.has_relative_path(); ++i) {
      out = out.empty() ? rest.filename() : rest.filename() / out;
      rest = rest.parent_path();
    }
    return out.generic_string();
  };
  for (int parts = 1; parts < 16; ++parts) {
    std::string name = tail(results[at].result.folder, parts);
    const auto alike = std::count_if(results.begin(), results.end(),
                                     [&](const Placed& r) { return tail(r.result.folder, parts) == name; });
    if (alike == 1) return name;
  }
  return results[at].result.folder.generic_string();
}

std::string headline_table(const std::vector<Entry>& entries) {
  std::string out = "<div class=\"scroll\"><table>\n<tr><th>Result</th>" + headline_heads() + "</tr>\n";
  for (const Entry& entry : entries) {
    out += "<tr><td>" + tag("a", entry.title, fmt::format("href=\"{}\"", entry.link)) +
           tag("span", entry.name, "class=\"under\"") + "</td>" + headline_cells(entry.result.figures) + "</tr>\n";
  }
  return out + "</table></div>\n" + headline_note();
}

/// A curve of one result, drawn as the reference or as the fast model.
Curve result_curve(const Entry& entry, std::size_t at, Look look, std::vector<double> x, std::vector<double> y) {
  Curve curve{look == Look::reference ? entry.name : "", look, std::move(x), std::move(y)};
  curve.own_colour = palette[at % palette.size()];
  curve.markers = false;
  return curve;
}

/// Curves of both sides of one result over the same x.
void add_curves(Plot& plot, const Entry& entry, std::size_t at, const std::vector<double>& x,
                std::vector<double> reference, std::vector<double> fast) {
  plot.curves.push_back(result_curve(entry, at, Look::reference, x, std::move(reference)));
  plot.curves.push_back(result_curve(entry, at, Look::fast, x, std::move(fast)));
}

double largest(const std::vector<double>& values) {
  double found = 0.0;
  for (const double v : values) found = std::max(found, std::isfinite(v) ? v : 0.0);
  return found;
}

std::vector<double> scaled(std::vector<double> values, double offset, double factor) {
  for (double& v : values) v = (v - offset) * factor;
  return values;
}

/// Forces of both sides over the fraction of the track's time, relative to the reference's peak.
Plot share_plot(const std::vector<Entry>& entries) {
  Plot plot;
  plot.title = "Force over the track, relative";
  plot.x_label = "fraction of the track's time [%]";
  plot.y_label = "force / reference's largest [%]";
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const ResultFolder& result = entries[i].result;
    const std::vector<double>& time_s = result.required_column("time_s");
    const std::vector<double>& reference_n = result.required_column("reference_force_n");
    const double peak_n = largest(reference_n);
    const double length_s = time_s.back() - time_s.front();
    if (peak_n == 0.0 || length_s == 0.0) continue;
    add_curves(plot, entries[i], i, scaled(time_s, time_s.front(), 100.0 / length_s),
               scaled(reference_n, 0.0, 100.0 / peak_n),
               scaled(result.required_column("fast_force_n"), 0.0, 100.0 / peak_n));
  }
  return plot;
}

/// Forces of both sides over depth in SI-based units, without grazing instants, whose round-off would take most
/// decades.
Plot depth_plot(const std::vector<Entry>& entries) {
  Plot plot;
  plot.title = "Force over depth, both axes logarithmic";
  plot.x_label = "depth [mm]";
  plot.y_label = "force on the tool [N]";
  plot.x_log = plot.y_log = true;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const ResultFolder& result = entries[i].result;
    std::vector<double> depth_mm = scaled(result.required_column("depth_m"), 0.0, 1e3);
    for (double& depth : depth_mm) depth = depth > 1e3 * grazing_depth_m ? depth : no_value;
    add_curves(plot, entries[i], i, depth_mm, result.required_column("reference_force_n"),
               result.required_column("fast_force_n"));
  }
  return plot;
}

/// Each pair of plots has as many results as there are colours.
std::string force_section(const std::vector<Entry>& entries) {
  std::string out = tag("h2", "Force") + "\n<div class=\"plots\">\n";
  for (std::size_t begin = 0; begin < entries.size(); begin += palette.size()) {
    const std::vector<Entry> some(
        entries.begin() + static_cast<std::ptrdiff_t>(begin),
        entries.begin() + static_cast<std::ptrdiff_t>(std::min(begin + palette.size(), entries.size())));
    out += figure(to_svg(share_plot(some), 560, 420), "Solid: reference. Dashed, same colour: fast model.");
    out += figure(to_svg(depth_plot(some), 560, 420), "The same results in newtons and millimetres.");
  }
  return out + "</div>\n";
}

std::string pictures_section(const std::vector<Entry>& entries, const std::filesystem::path& place) {
  std::string pictures;
  for (const Entry& entry : entries) {
    const std::filesystem::path picture = entry.result.folder / "shape.svg";
    if (!std::filesystem::exists(picture)) continue;
    pictures += fmt::format("<figure><a href=\"{}\"><img src=\"{}\" alt=\"{}\" loading=\"lazy\"/></a>{}</figure>\n",
                            entry.link, relative_link(picture, place),
                            escape_xml("Deformed bodies and error: " + entry.title), tag("figcaption", entry.title));
  }
  if (pictures.empty()) return "";
  return tag("h2", "Shape at the deepest instant") + "\n" +
         tag("p", "Reference, fast model, and the error between them; each opens its report.", "class=\"dim\"") +
         "\n<div class=\"plots\">\n" + pictures + "</div>\n";
}

std::string origin_section(const std::vector<Entry>& entries) {
  std::string out = tag("h2", "How these were made") +
                    "\n<div class=\"scroll\"><table>\n<tr><th>Result</th><th>Scene hash</th><th>Version</th><th>Date"
                    "</th><th>Folder</th></tr>\n";
  std::set<std::string> versions;
  for (const Entry& entry : entries) {
    const ResultFolder& result = entry.result;
    versions.insert(result.version);
    out += "<tr>" + cell(entry.name) + "<td>" + tag("code", result.scene_hash) + "</td>" + cell(result.version) +
           cell(result.date) + "<td>" + tag("code", result.folder.string()) + "</td></tr>\n";
  }
  out += "</table></div>\n";
  if (versions.size() > 1) out += tag("p", "The results are of different versions of the program.") + "\n";
  return out;
}

}  // namespace

std::string results_page_html(const std::vector<ResultFolder>& results, const std::filesystem::path& place) {
  std::vector<scene::Fault> faults;
  for (const ResultFolder& result : results) {
    if (result.command == "touchstone compare") continue;
    faults.push_back({(result.folder / "manifest.json").string(), 0, 0,
                      fmt::format("was made by \"{}\", expected a result of \"touchstone compare\"", result.command)});
  }
  if (!faults.empty()) throw scene::InputError(std::move(faults));
  const std::vector<Placed> placed = in_order(results);
  std::vector<Entry> entries;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const ResultFolder& result = placed[i].result;
    const std::string name = short_name(placed, i);
    entries.push_back({result, name, result.title.empty() ? name : result.title,
                       relative_link(result.folder / "report.html", place)});
  }
  const std::string title = fmt::format("{} result{}", entries.size(), entries.size() == 1 ? "" : "s");
  return page(title,
              tag("h1", title) + "\n" +
                  tag("p", "How far the fast contact model is from the finite-element reference, scene by scene.",
                      "class=\"dim\"") +
                  "\n" + headline_table(entries) + force_section(entries) + pictures_section(entries, place) +
                  origin_section(entries));
}

}  // namespace touchstone::compare
