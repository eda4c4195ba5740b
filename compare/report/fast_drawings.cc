#include "compare/report/fast_drawings.h"

#include "compare/format/text.h"
#include "compare/report/picture.h"
#include "compare/report/section.h"
#include "scene/base/index.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

namespace touchstone::compare {
namespace {

using scene::InstantRecord;
using scene::RegionRecord;
using scene::Vec3;

/// A curve with more points has no markers.
constexpr std::size_t most_markers = 32;

/// Largest number of sections drawn.
constexpr std::size_t most_sections = 6;

/// A component below this fraction of the largest is not visible in a plot.
constexpr double visible_share = 5e-3;

using Number = std::function<double(const InstantRecord&)>;

std::vector<double> series(const fast::Run& run, const Number& get) {
  std::vector<double> out;
  for (const InstantRecord& record : run.instants) out.push_back(get(record));
  return out;
}

/// Newton, or millinewton where all forces are small.
struct ForceUnit {
  double per_n;
  std::string name;
};

ForceUnit force_unit(const fast::Run& run) {
  double largest_n = 0.0;
  for (const InstantRecord& record : run.instants) largest_n = std::max(largest_n, record.force_n().norm());
  return largest_n < 0.01 ? ForceUnit{1e3, "mN"} : ForceUnit{1.0, "N"};
}

std::string force_label(const fast::Run& run, const std::string& what) {
  return fmt::format("{} [{}]", what, force_unit(run).name);
}

double time_s(const InstantRecord& record) { return record.time_s; }

Vec3 normal_n(const InstantRecord& record) { return record.force_n() - record.friction_n(); }

bool slides(const InstantRecord& record) {
  return std::any_of(record.regions.begin(), record.regions.end(), [](const RegionRecord& r) { return r.sliding; });
}

/// Null if there is no region of this id.
const RegionRecord* find_region(const InstantRecord& record, int id) {
  const auto found =
      std::find_if(record.regions.begin(), record.regions.end(), [id](const RegionRecord& r) { return r.id == id; });
  return found == record.regions.end() ? nullptr : &*found;
}

std::size_t most_regions(const fast::Run& run) {
  std::size_t most = 0;
  for (const InstantRecord& record : run.instants) most = std::max(most, record.regions.size());
  return most;
}

/// Largest region id plus one.
int region_ids(const fast::Run& run) {
  int ids = 0;
  for (const InstantRecord& record : run.instants) {
    for (const RegionRecord& region : record.regions) ids = std::max(ids, region.id + 1);
  }
  return ids;
}

/// The last of the instants [from, to) at which a quantity has its maximum.
std::size_t last_largest(const fast::Run& run, std::size_t from, std::size_t to, const Number& get) {
  std::size_t found = from;
  for (std::size_t t = from; t < to; ++t) {
    if (get(run.instants[t]) >= get(run.instants[found]) * (1.0 - 1e-9)) found = t;
  }
  return found;
}

std::size_t deepest_of(const fast::Run& run) {
  return last_largest(run, 0, run.instants.size(), [](const InstantRecord& r) { return r.depth_m; });
}

double shallowest_region_m(const InstantRecord& record) {
  double depth_m = record.depth_m;
  for (const RegionRecord& region : record.regions) depth_m = std::min(depth_m, region.depth_m);
  return depth_m;
}

/// Consecutive instants [from, to) with the same number of regions.
struct Stage {
  std::size_t from, to;
};

std::vector<Stage> stages_of(const fast::Run& run) {
  std::vector<Stage> stages;
  const std::size_t count = run.instants.size();
  for (std::size_t from = 0, to = 0; from < count; from = to) {
    while (to < count && run.instants[to].regions.size() == run.instants[from].regions.size()) ++to;
    if (!run.instants[from].regions.empty()) stages.push_back({from, to});
  }
  return stages;
}

/// Instants in contact after the tool has reached 90 % of its largest depth.
std::vector<std::size_t> pressed_instants(const fast::Run& run) {
  const double least_m = 0.9 * run.instants[deepest_of(run)].depth_m;
  std::vector<std::size_t> pressed;
  for (std::size_t t = 0; t < run.instants.size(); ++t) {
    if (!run.instants[t].regions.empty() && run.instants[t].depth_m >= least_m) pressed.push_back(t);
  }
  return pressed;
}

double size_m(const scene::Surface& surface) {
  return (surface.points_m.rowwise().maxCoeff() - surface.points_m.rowwise().minCoeff()).maxCoeff();
}

/// Displacement of the tool along the world axis of its longest motion while in contact.
struct Travel {
  int axis;  ///< 0: x, 1: y
  double from_m, to_m;
};

std::optional<Travel> sideways(const fast::Run& run) {
  Vec3 low_m = Vec3::Constant(std::numeric_limits<double>::infinity()), high_m = -low_m;
  for (const std::size_t t : pressed_instants(run)) {
    low_m = low_m.cwiseMin(run.instants[t].tool.position_m);
    high_m = high_m.cwiseMax(run.instants[t].tool.position_m);
  }
  const int axis = high_m.x() - low_m.x() >= high_m.y() - low_m.y() ? 0 : 1;
  if (!(high_m[axis] - low_m[axis] > 0.01 * size_m(run.surface))) return std::nullopt;
  return Travel{axis, low_m[axis], high_m[axis]};
}

constexpr std::array<const char*, 3> axis_names = {"x", "y", "z"};

std::string regions_text(std::size_t count) { return fmt::format("{} region{}", count, count == 1 ? "" : "s"); }

/// Consecutive instants of the same name as one span, bounded midway between instants; an empty name makes no span.
std::vector<Span> spans_by(const fast::Run& run, const std::function<std::string(const InstantRecord&)>& name,
                           const std::function<double(const InstantRecord&)>& shade) {
  std::vector<Span> spans;
  std::string before;
  for (std::size_t t = 0; t < run.instants.size(); ++t) {
    const InstantRecord& here = run.instants[t];
    const double from_s = t == 0 ? here.time_s : 0.5 * (run.instants[t - 1].time_s + here.time_s);
    const double to_s = t + 1 == run.instants.size() ? here.time_s : 0.5 * (here.time_s + run.instants[t + 1].time_s);
    const std::string now = name(here);
    if (!now.empty() && now == before) {
      spans.back().to = to_s;
    } else if (!now.empty()) {
      spans.push_back({now, from_s, to_s, shade(here)});
    }
    before = now;
  }
  return spans;
}

std::vector<Span> region_spans(const fast::Run& run) {
  return spans_by(
      run, [](const InstantRecord& r) { return r.regions.empty() ? "" : regions_text(r.regions.size()); },
      [](const InstantRecord& r) { return std::min(0.06 * static_cast<double>(r.regions.size()), 0.4); });
}

Curve curve(const fast::Run& run, const std::string& name, Look look, const Number& x, const Number& y) {
  return {name, look, series(run, x), series(run, y), run.instants.size() <= most_markers};
}

Plot over_time(const fast::Run& run, const std::string& title, const std::string& y_label) {
  Plot plot;
  plot.title = title;
  plot.x_label = "time [s]";
  plot.y_label = y_label;
  plot.x_range = {run.instants.front().time_s, run.instants.back().time_s};
  return plot;
}

/// Curves of the force components that are visible beside the largest, and of the magnitude unless it equals a single
/// component.
/// @returns a sentence about the components left out
std::string add_components(Plot& plot, const fast::Run& run, const std::string& symbol, const Number& x,
                           const std::function<Vec3(const InstantRecord&)>& force_n) {
  Vec3 largest_n = Vec3::Zero();
  for (const InstantRecord& record : run.instants) largest_n = largest_n.cwiseMax(force_n(record).cwiseAbs());
  constexpr std::array<Look, 3> looks = {Look::second, Look::third, Look::first};
  const double per_n = force_unit(run).per_n;
  std::vector<std::string> left_out;
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name = fmt::format("{}_{}{}", symbol, nth(axis_names, axis), axis == 2 ? " (up)" : "");
    if (largest_n[axis] <= visible_share * largest_n.maxCoeff()) {
      left_out.push_back(name);
      continue;
    }
    plot.curves.push_back(
        curve(run, name, nth(looks, axis), x, [&](const InstantRecord& r) { return per_n * force_n(r)[axis]; }));
  }
  if (left_out.size() < 2) {
    plot.curves.push_back(curve(run, "|" + symbol + "|", Look::plain, x,
                                [&](const InstantRecord& r) { return per_n * force_n(r).norm(); }));
  }
  if (left_out.empty() || left_out.size() == 3) return "";
  return fmt::format("{} below {} of the largest component, not drawn.", fmt::join(left_out, " and "),
                     percent_text(visible_share));
}

Look look_of(int id) {
  constexpr std::array<Look, 3> looks = {Look::first, Look::second, Look::third};
  return looks[static_cast<std::size_t>(id) % looks.size()];
}

/// One curve per region; they have names if there are several.
void add_regions(Plot& plot, const fast::Run& run,
                 const std::function<double(const InstantRecord&, const RegionRecord&)>& x,
                 const std::function<double(const RegionRecord&)>& y) {
  const int ids = region_ids(run);
  for (int id = 0; id < ids; ++id) {
    const auto of_region = [&](const auto& get) {
      return [id, get](const InstantRecord& record) {
        const RegionRecord* region = find_region(record, id);
        return region == nullptr ? no_value : get(record, *region);
      };
    };
    plot.curves.push_back(curve(run, ids > 1 ? fmt::format("region {}", id) : "", look_of(id), of_region(x),
                                of_region([&](const InstantRecord&, const RegionRecord& r) { return y(r); })));
  }
}

double area_mm2(const RegionRecord& region) { return 1e6 * region.area_m2; }
double depth_mm(const InstantRecord&, const RegionRecord& region) { return 1e3 * region.depth_m; }
double region_time_s(const InstantRecord& record, const RegionRecord&) { return record.time_s; }

Drawing drawing(const std::string& name, const std::string& caption, const Plot& plot) {
  return {name, caption, to_svg(plot)};
}

Drawing along_path(const fast::Run& run, const Travel& travel, const std::string& name, const std::string& title,
                   const std::string& symbol, const std::function<Vec3(const InstantRecord&)>& force_n) {
  Plot plot;
  plot.title = title;
  plot.x_label = fmt::format("{} of the tool [mm]", nth(axis_names, travel.axis));
  plot.y_label = force_label(run, "force on the tool");
  const std::string note = add_components(
      plot, run, symbol, [&](const InstantRecord& r) { return 1e3 * r.tool.position_m[travel.axis]; }, force_n);
  return drawing(name, note, plot);
}

/// A short description of the instant of a section.
std::string instant_text(const scene::Scene& scene, const fast::Run& run, std::size_t instant) {
  const InstantRecord& record = run.instants[instant];
  std::string text = fmt::format("{}{}s", number_text(record.time_s), no_break);
  if (most_regions(run) > 1) text += ", " + regions_text(record.regions.size());
  if (const auto travel = sideways(run)) {
    text += fmt::format(", {} = {}", nth(axis_names, travel->axis),
                        quantity_text(record.tool.position_m[travel->axis], "m"));
  } else {
    text += fmt::format(", {} deep", quantity_text(record.depth_m, "m"));
  }
  if (scene.contact.friction && !record.regions.empty()) text += slides(record) ? ", sliding" : ", stuck";
  return text;
}

/// Sets the range to the rest body and the nearby part of the tool.
void show_whole(Plot& plot, const scene::Surface& surface) {
  const double top_mm = 1e3 * tool_shown_below_m(surface);
  std::pair<double, double> x{0.0, 0.0}, z{0.0, 0.0};
  for (const Curve& curve : plot.curves) {
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      if (!std::isfinite(curve.x[i]) || !std::isfinite(curve.y[i])) continue;
      x = {std::min(x.first, curve.x[i]), std::max(x.second, curve.x[i])};
      z = {std::min(z.first, curve.y[i]), std::max(z.second, std::min(curve.y[i], top_mm))};
    }
  }
  const double margin_mm = 0.03 * std::max(x.second - x.first, z.second - z.first);
  plot.x_range = {x.first - margin_mm, x.second + margin_mm};
  plot.y_range = {z.first - margin_mm, z.second + margin_mm};
}

/// Ranges of equal scale at all instants; with several regions at a time also of the same place.
std::vector<Window> contact_windows(const scene::Scene& scene, const fast::Run& run,
                                    const std::vector<std::size_t>& instants) {
  std::vector<Window> windows;
  for (const std::size_t t : instants) windows.push_back(contact_window(scene, run.surface, run.instants[t]));
  Window widest = windows[0];
  double low_m = widest.x_m, high_m = widest.x_m;
  for (const Window& window : windows) {
    low_m = std::min(low_m, window.x_m - window.half_m);
    high_m = std::max(high_m, window.x_m + window.half_m);
    widest.top_m = std::max(widest.top_m, window.top_m);
    widest.half_m = std::max(widest.half_m, window.half_m);
  }
  if (most_regions(run) > 1) {
    const Window all{0.5 * (low_m + high_m), widest.top_m, 0.5 * (high_m - low_m)};
    return std::vector<Window>(windows.size(), all);
  }
  for (Window& window : windows) window.half_m = widest.half_m;
  return windows;
}

/// The same section at several instants, side by side.
/// @param show  sets the range of a plot, given its index among the instants shown
Drawing sections(const scene::Scene& scene, const fast::Run& run, const std::vector<std::size_t>& instants,
                 const std::string& name, const std::string& title, const std::string& caption,
                 const std::function<void(Plot&, std::size_t)>& show) {
  const int width_px = instants.size() > 2 ? 330 : 560, height_px = instants.size() > 2 ? 310 : 440;
  std::vector<std::string> panels;
  for (std::size_t i = 0; i < instants.size(); ++i) {
    const InstantRecord& record = run.instants[instants[i]];
    Plot plot =
        section_plot(scene, run.surface, record.tool, {{"deformed", Look::first, run.surface, record.displacement_m}});
    plot.title = instant_text(scene, run, instants[i]);
    show(plot, i);
    panels.push_back(to_svg(plot, width_px, height_px));
  }
  const bool one = panels.size() == 1;
  return {name, caption, one ? panels[0] : in_rows(title, panels, 3, width_px, height_px), !one};
}

/// Vertical displacement of the upper side of the section; vertical scale exaggerated.
Drawing dent(const scene::Scene& scene, const fast::Run& run, const std::vector<std::size_t>& instants) {
  Plot plot;
  plot.title = "Dent in the section";
  plot.x_label = "x at rest [mm]";
  plot.y_label = "displacement upwards [mm]";
  double low_mm = 0.0, high_mm = 0.0;
  for (std::size_t i = 0; i < instants.size(); ++i) {
    const InstantRecord& record = run.instants[instants[i]];
    std::vector<std::pair<double, double>> points_mm;
    for (const auto& outline : cut_at_y(run.surface, cut_y_m(run.surface, record.tool))) {
      for (const EdgePoint& p : outline) {
        if (p.of(run.surface.normals).z() < 0.1) continue;
        points_mm.emplace_back(1e3 * p.of(run.surface.points_m).x(), 1e3 * p.of(record.displacement_m).z());
      }
    }
    std::sort(points_mm.begin(), points_mm.end());
    Curve curve{instant_text(scene, run, instants[i]), look_of(static_cast<int>(i)), {}, {}, false};
    for (const auto& [x_mm, up_mm] : points_mm) {
      curve.x.push_back(x_mm);
      curve.y.push_back(up_mm);
      low_mm = std::min(low_mm, up_mm);
      high_mm = std::max(high_mm, up_mm);
    }
    plot.curves.push_back(std::move(curve));
  }
  if (low_mm < high_mm) plot.y_range = {1.06 * low_mm, 1.06 * high_mm};
  return drawing("dent", "Upper side only; vertical scale exaggerated.", plot);
}

}  // namespace

const std::vector<std::string>& drawing_names() {
  static const std::vector<std::string> names = {"force",         "friction", "regions", "depth", "area", "path",
                                                 "friction-path", "section",  "contact", "dent",  "view"};
  return names;
}

std::vector<Span> friction_spans(const fast::Run& run) {
  const auto state = [](const InstantRecord& record) -> std::string {
    if (record.regions.empty()) return "";
    return slides(record) ? "sliding" : "stuck";
  };
  return spans_by(run, state, [](const InstantRecord& record) { return slides(record) ? 0.16 : 0.06; });
}

std::vector<Drawing> force_drawings(const scene::Scene& scene, const fast::Run& run) {
  const bool friction = scene.contact.friction.has_value();
  const std::optional<Travel> travel = sideways(run);
  const auto normal_force = [per_n = force_unit(run).per_n](const RegionRecord& region) {
    return per_n * (region.force_n - region.friction_n).norm();
  };
  std::vector<Drawing> out;
  if (most_regions(run) == 0) return out;

  Plot force = over_time(run, "Force on the tool", force_label(run, "force on the tool"));
  const std::string force_note =
      add_components(force, run, "F", time_s, [](const InstantRecord& r) { return r.force_n(); });
  if (friction) force.spans = friction_spans(run);
  out.push_back(drawing("force", force_note, force));

  if (friction) {
    Plot plot = over_time(run, "Friction on the tool", force_label(run, "friction on the tool"));
    const std::string note = add_components(plot, run, "f", time_s, &InstantRecord::friction_n);
    plot.spans = friction_spans(run);
    out.push_back(drawing("friction", "The part of the force along the surface. " + note, plot));
  }
  if (most_regions(run) > 1) {
    Plot plot = over_time(run, "Normal force of each region", force_label(run, "normal force"));
    add_regions(plot, run, region_time_s, normal_force);
    plot.spans = region_spans(run);
    out.push_back(drawing("regions", "Regions as they are numbered in curve.csv.", plot));
  }
  if (travel) {
    out.push_back(along_path(run, *travel, "path", "Normal force along the path", "N", normal_n));
    if (friction) {
      out.push_back(
          along_path(run, *travel, "friction-path", "Friction along the path", "f", &InstantRecord::friction_n));
    }
  }

  Plot depth;
  depth.title = "Normal force over depth";
  depth.x_label = "depth [mm]";
  depth.y_label = force_label(run, "normal force");
  add_regions(depth, run, depth_mm, normal_force);
  out.push_back(drawing("depth", "", depth));

  const bool pressed = !travel && most_regions(run) == 1;
  Plot area = over_time(run, "Contact area", "contact area [mm²]");
  if (pressed) {
    area.x_label = "depth [mm]";
    area.x_range.reset();
  }
  add_regions(area, run, pressed ? depth_mm : region_time_s, area_mm2);
  out.push_back(drawing("area", "", area));
  return out;
}

std::vector<std::size_t> instants_shown(const fast::Run& run) {
  if (most_regions(run) > 1) {
    std::vector<Stage> stages = stages_of(run);
    const auto is_longer = [](const Stage& a, const Stage& b) { return a.to - a.from > b.to - b.from; };
    std::stable_sort(stages.begin(), stages.end(), is_longer);
    stages.resize(std::min(stages.size(), most_sections));
    std::vector<std::size_t> found;
    for (const Stage& stage : stages) found.push_back(last_largest(run, stage.from, stage.to, shallowest_region_m));
    std::sort(found.begin(), found.end());
    return found;
  }
  if (const auto travel = sideways(run)) {
    const std::vector<std::size_t> pressed = pressed_instants(run);
    std::vector<std::size_t> found;
    for (const double share : {0.0, 0.5, 1.0}) {
      const double wanted_m = travel->from_m + share * (travel->to_m - travel->from_m);
      const auto distance_m = [&](std::size_t t) {
        return std::abs(run.instants[t].tool.position_m[travel->axis] - wanted_m);
      };
      std::size_t nearest = pressed.front();
      for (const std::size_t t : pressed) {
        if (distance_m(t) <= distance_m(nearest) + 1e-9) nearest = t;
      }
      found.push_back(nearest);
    }
    return found;
  }
  return {deepest_of(run)};
}

std::vector<Drawing> shape_drawings(const scene::Scene& scene, const fast::Run& run) {
  const std::vector<std::size_t> shown = instants_shown(run);
  std::vector<Drawing> out = {sections(scene, run, shown, "section", "The whole section",
                                       "At the tool's centre; true scale.",
                                       [&](Plot& plot, std::size_t) { show_whole(plot, run.surface); })};
  if (most_regions(run) == 0) return out;
  const std::vector<Window> windows = contact_windows(scene, run, shown);
  out.push_back(sections(scene, run, shown, "contact", "Around the contact",
                         "The same, enlarged; straight lines between the surface's points.",
                         [&](Plot& plot, std::size_t i) { show_contact(plot, windows[i]); }));
  out.push_back(dent(scene, run, shown));

  std::size_t most = shown[shown.size() / 2];
  for (const std::size_t t : shown) {
    if (run.instants[t].regions.size() > run.instants[most].regions.size()) most = t;
  }
  out.push_back(
      {"view",
       "Cut in half at the tool's centre; the grey area is the tool's cut. True proportions, displacements not "
       "exaggerated.",
       half_cut_svg(scene, run.surface, run.instants[most], instant_text(scene, run, most))});
  return out;
}

}  // namespace touchstone::compare
