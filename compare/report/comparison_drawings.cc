#include "compare/report/comparison_drawings.h"

#include "compare/format/text.h"
#include "compare/report/picture.h"
#include "compare/report/stress_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace touchstone::compare {
namespace {

constexpr const char* band_name = "reference's uncertainty";

/// One number per instant; a plot leaves out NaN.
template <class Get>
std::vector<double> series(const Errors& errors, const Get& get) {
  std::vector<double> out;
  for (const InstantErrors& e : errors.instants) out.push_back(get(e));
  return out;
}

/// The quantity along the horizontal axis.
struct Abscissa {
  std::string name, label;
  std::vector<double> values;
};

Abscissa depth_of(const Errors& errors) {
  return {"depth", "depth [mm]", series(errors, [](const InstantErrors& e) { return 1e3 * e.depth_m; })};
}

Abscissa time_of(const Errors& errors) {
  return {"time", "time [s]", series(errors, [](const InstantErrors& e) { return e.time_s; })};
}

/// Whether the depth only increases: two instants at one depth would be drawn above each other.
bool only_deeper(const Abscissa& depth) {
  return std::adjacent_find(depth.values.begin(), depth.values.end(), [](double before, double now) {
           return now > 0.0 ? now < before * (1.0 + 1e-6) : now < before;
         }) == depth.values.end();
}

Plot plot_over(const Abscissa& x, const std::string& title, const std::string& y_label) {
  Plot plot;
  plot.title = title;
  plot.x_label = x.label;
  plot.y_label = y_label;
  return plot;
}

/// Force of both sides with the reference's uncertainty as a band.
Plot force_over(const Errors& errors, const Abscissa& x) {
  Plot plot = plot_over(x, "Force over " + x.name, "force on the tool [N]");
  Band band{band_name, Look::reference, x.values, {}, {}};
  for (const InstantErrors& e : errors.instants) {
    band.low.push_back(std::max(0.0, e.force_reference_n - e.force_uncertainty_n));
    band.high.push_back(e.force_reference_n + e.force_uncertainty_n);
  }
  plot.bands.push_back(std::move(band));
  plot.curves.push_back({"reference", Look::reference, x.values,
                         series(errors, [](const InstantErrors& e) { return e.force_reference_n; })});
  plot.curves.push_back(
      {"fast model", Look::fast, x.values, series(errors, [](const InstantErrors& e) { return e.force_fast_n; })});
  return plot;
}

/// Caption about the reference's uncertainty in a plot of its force.
std::string band_caption(const Plot& plot, const Errors& errors, const reference::Result& result) {
  const std::optional<double> known = force_known_to(errors);
  std::string text;
  switch (band_seen(plot, plot.bands.front())) {
    case BandSeen::nowhere:
      return "The reference's uncertainty is unknown, so no band is drawn. " + why_uncertainty_unknown(result);
    case BandSeen::narrower_than_the_line:
      text = known ? fmt::format("The reference's uncertainty, at most {} of its force, is narrower than its line.",
                                 percent_text(*known))
                   : "The reference's uncertainty is narrower than its line.";
      break;
    case BandSeen::area:
      text = "The blue band is the reference's uncertainty.";
      break;
  }
  const reference::Refinement& refinement = result.refinement;
  const double asked = refinement.error_asked;
  const bool missed =
      asked > 0.0 && (known.value_or(0.0) > asked || errors.shape_rel_l2.uncertainty.value_or(0.0) > asked);
  if (missed && !refinement.why_ended.empty()) {
    text +=
        fmt::format(" The requested uncertainty of {} was not reached: {}.", percent_text(asked), refinement.why_ended);
  }
  return text;
}

Drawing logarithmic(Plot plot, const Errors& errors) {
  plot.title = "Force over depth, both axes logarithmic";
  plot.x_log = plot.y_log = true;
  // At a grazing instant the force is round-off, which would take most of the decades.
  for (std::size_t t = 0; t < errors.instants.size(); ++t) {
    if (errors.instants[t].in_contact) continue;
    for (Curve& curve : plot.curves) curve.y[t] = no_value;
    plot.bands.front().high[t] = no_value;
  }
  return {"force-logarithmic", "A power law is a straight line here, and a small force is not lost beside a large one.",
          to_svg(plot)};
}

/// Friction of both sides over the slip path.
Drawing friction_drawing(const Errors& errors) {
  const Abscissa path{"path", "path of the tool along the surface [mm]",
                      series(errors, [](const InstantErrors& e) { return 1e3 * e.path_m; })};
  Plot plot = plot_over(path, "Friction over the path", "friction on the tool [N]");
  plot.curves.push_back({"reference", Look::reference, path.values,
                         series(errors, [](const InstantErrors& e) { return e.friction_reference_n; })});
  plot.curves.push_back({"fast model", Look::fast, path.values,
                         series(errors, [](const InstantErrors& e) { return e.friction_fast_n; })});
  return {"friction", slip_text(errors), to_svg(plot)};
}

double largest(const std::vector<double>& values) {
  double found = 0.0;
  for (const double v : values) found = std::max(found, std::isfinite(v) ? v : 0.0);
  return found;
}

/// An error in percent and the reference's uncertainty in the same norm. The axis is logarithmic if the values differ
/// too much for a linear one.
Drawing error_drawing(const Abscissa& x, const std::string& name, const std::string& title, const std::string& y_label,
                      const std::vector<double>& error, const std::vector<double>& uncertainty, std::string caption) {
  Plot plot = plot_over(x, title + " over " + x.name, y_label);
  plot.curves.push_back({"fast model's error", Look::fast, x.values, error});
  plot.curves.push_back({"reference's own uncertainty", Look::reference, x.values, uncertainty});
  plot.y_log = largest(uncertainty) > 0.0 && largest(error) > 20.0 * largest(uncertainty);
  if (std::none_of(uncertainty.begin(), uncertainty.end(), [](double v) { return std::isfinite(v); })) {
    caption += " The reference's own uncertainty is unknown.";
  }
  return {name, std::move(caption), to_svg(plot)};
}

Drawing force_error(const Errors& errors, const Abscissa& x) {
  return error_drawing(
      x, "force-error", "Relative force error", "|difference| / reference [%]",
      series(errors, [](const InstantErrors& e) { return 100.0 * e.force_error_rel.value_or(no_value); }),
      series(errors,
             [](const InstantErrors& e) {
               return e.force_error_rel ? 100.0 * e.force_uncertainty_n / e.force_reference_n : no_value;
             }),
      "Relative to the reference's force at the same instant.");
}

Drawing shape_error(const Errors& errors, const Abscissa& x) {
  return error_drawing(
      x, "shape-error", "Shape error", "error / displacement, RMS [%]",
      series(errors, [](const InstantErrors& e) { return 100.0 * e.shape_rel_l2.value.value_or(no_value); }),
      series(errors, [](const InstantErrors& e) { return 100.0 * e.shape_rel_l2.uncertainty.value_or(no_value); }),
      "Over the whole surface, weighted by area. A surface that never moves has an error of 100 %.");
}

Drawing largest_error(const Errors& errors, const Abscissa& x) {
  Plot plot = plot_over(x, "Largest shape error over " + x.name, "distance [mm]");
  plot.curves.push_back({"of one point from its reference position", Look::fast, x.values,
                         series(errors, [](const InstantErrors& e) { return 1e3 * e.shape_max_m; })});
  plot.curves.push_back({"between the two surfaces", Look::plain, x.values,
                         series(errors, [](const InstantErrors& e) { return 1e3 * e.hausdorff_m; })});
  return {"shape-largest-error",
          "Displacement errors along the surface do not separate the surfaces, which are then closer than the points.",
          to_svg(plot)};
}

std::string known_text(const std::optional<double>& uncertainty_rel) {
  return uncertainty_rel && std::isfinite(*uncertainty_rel) ? "known to " + percent_text(*uncertainty_rel)
                                                            : "with unknown uncertainty";
}

/// Half axes of the reference's contact, of a round one its radius, each with its uncertainty as a bar. Nothing is
/// drawn where there is no contact.
Drawing contact_size(const reference::Result& result, const ReferenceQuality& quality, const Abscissa& x) {
  constexpr double looks_round = 0.01;  // lines closer than this lie on each other
  const bool round = std::ranges::all_of(result.instants, [](const scene::ReferenceInstant& instant) {
    return instant.contact_half_axes_m[1] >= (1.0 - looks_round) * instant.contact_half_axes_m[0];
  });
  Plot plot =
      plot_over(x, (round ? "Radius of the contact over " : "Half axes of the contact over ") + x.name, "length [mm]");
  const std::array curves = {std::pair(round ? "radius" : "long", Look::reference), std::pair("short", Look::plain)};
  std::string caption = "Of the reference's contact that pushes most. At the largest";
  for (int axis = 0; axis < (round ? 1 : 2); ++axis) {
    Curve& curve = plot.curves.emplace_back(Curve{curves[axis].first, curves[axis].second, x.values, {}});
    for (const scene::ReferenceInstant& instant : result.instants) {
      const double length_m = instant.contact_half_axes_m[axis];
      curve.y.push_back(length_m > 0.0 ? 1e3 * length_m : no_value);
      curve.y_half.push_back(1e3 * instant.contact_half_axes_uncertainty_m[axis]);
    }
    caption += fmt::format("{} {}, {}", axis == 0 ? "" : " and", quantity_text(quality.contact_half_axes_m[axis], "m"),
                           known_text(quality.contact_half_axes_uncertainty_rel[axis]));
  }
  return {"contact-size", caption + ".", to_svg(plot)};
}

std::string traction_caption(const scene::ReferenceInstant& at) {
  return fmt::format(
      "Pressure and friction of the tool on the body in the section's plane, per current area, at the deepest instant; "
      "the reference on its own mesh. The largest pressure at a node is {:.4g} kPa, {}.",
      1e-3 * at.pressure_peak_pa, known_text(at.pressure_peak_uncertainty_pa / at.pressure_peak_pa));
}

}  // namespace

std::vector<Drawing> ComparisonDrawings::all() const {
  std::vector<Drawing> out = {force};
  out.insert(out.end(), forces.begin(), forces.end());
  out.push_back(shape_error);
  out.insert(out.end(), shapes.begin(), shapes.end());
  out.push_back({"bodies", "", bodies_in_a_row, true});
  return out;
}

const std::vector<std::string>& ComparisonDrawings::names() {
  static const std::vector<std::string> all_names = {"force-over-depth",
                                                     "force-over-time",
                                                     "force-logarithmic",
                                                     "friction",
                                                     "force-error",
                                                     "shape-error",
                                                     "section",
                                                     "section-contact",
                                                     "shape-largest-error",
                                                     "traction",
                                                     "contact-size",
                                                     "stress",
                                                     "bodies"};
  return all_names;
}

std::optional<double> force_known_to(const Errors& errors) {
  for (const InstantErrors& e : errors.instants) {
    if (e.in_contact && !std::isfinite(e.force_uncertainty_n)) return std::nullopt;
  }
  const std::optional<double>& known = errors.reference.force_uncertainty_rel;
  return known && std::isfinite(*known) ? known : std::nullopt;
}

std::string why_uncertainty_unknown(const reference::Result& result) {
  const std::string& why = result.refinement.why_ended;
  std::string ended = why.empty() ? "" : "Refinement ended: " + why + ".";
  if (why.find("uncertainty") != std::string::npos) return ended;
  const std::size_t meshes = result.levels.size();
  return (meshes < 3 ? fmt::format("It was solved on {} mesh{}, and an uncertainty needs three.",
                                   meshes == 1 ? "one" : "two", meshes == 1 ? "" : "es")
                     : "Its meshes do not show how far it is from the exact solution.") +
         (ended.empty() ? "" : " " + ended);
}

std::string slip_text(const Errors& errors) {
  const std::optional<double>&fast_m = errors.slip_onset_fast_m, &reference_m = errors.slip_onset_reference_m;
  if (fast_m && reference_m) {
    return fmt::format("Slip begins after {} of the path in the fast model and after {} in the reference.",
                       quantity_text(*fast_m, "m"), quantity_text(*reference_m, "m"));
  }
  const auto begins = [](const std::string& side, const std::optional<double>& path_m) {
    return side + (path_m ? " slips after " + quantity_text(*path_m, "m") + " of the path" : " never slips");
  };
  return begins("The fast model", fast_m) + ", " + begins("the reference", reference_m) + ".";
}

Plot force_plot(const Errors& errors) {
  const Abscissa depth = depth_of(errors);
  return force_over(errors, only_deeper(depth) ? depth : time_of(errors));
}

ComparisonDrawings comparison_drawings(const scene::Scene& scene, const fast::Run& run, const reference::Result& result,
                                       const Errors& errors, const reference::Inside* inside) {
  const Abscissa depth = depth_of(errors), time = time_of(errors);
  const bool deeper = only_deeper(depth);
  const Abscissa &first = deeper ? depth : time, &second = deeper ? time : depth;
  const auto force_drawing = [&](const Abscissa& x) {
    const Plot plot = force_over(errors, x);
    return Drawing{"force-over-" + x.name, band_caption(plot, errors, result), to_svg(plot)};
  };
  ComparisonDrawings out;
  out.force = force_drawing(first);
  out.shape_error = shape_error(errors, first);
  out.forces.push_back(force_drawing(second));
  if (deeper) out.forces.push_back(logarithmic(force_over(errors, depth), errors));
  if (errors.friction) out.forces.push_back(friction_drawing(errors));
  out.forces.push_back(force_error(errors, first));
  out.shapes = {
      {"section", "Deformed position of the rest body's cut plane; true scale.",
       section_svg(scene, run, result, errors.deepest, false)},
      {"section-contact",
       "In contact the surface should lie on the tool, and nowhere inside it. The reference is drawn on "
       "its own mesh, with dots at its nodes in this plane. The fast model is straight between its own points, "
       "the squares.",
       section_svg(scene, run, result, errors.deepest, true)},
      largest_error(errors, first)};
  if (const std::optional<Plot> plot = traction_plot(run.surface, result, errors.deepest)) {
    out.shapes.push_back({"traction", traction_caption(result.instants[errors.deepest]), to_svg(*plot)});
  }
  if (errors.reference.contact_half_axes_m[0] > 0.0) {
    out.shapes.push_back(contact_size(result, errors.reference, first));
  }
  if (inside) {
    const scene::InstantRecord& record = result.instants[errors.deepest];
    const SectionGrid grid = section_grid(run.surface, record.tool);
    const reference::PointValues values = inside->at(grid.rest_m, errors.deepest);
    out.shapes.push_back(
        {"stress", stress_section_caption(grid, values), stress_section_svg(scene, run.surface, record, grid, values)});
  }
  const std::vector<std::string> bodies = half_cut_svgs(scene, run, result, errors.deepest);
  out.bodies = {{"reference", "", bodies[0]}, {"fast", "", bodies[1]}, {"error", "", bodies[2]}};
  out.bodies_in_a_row = half_cuts_in_a_row(bodies);
  return out;
}

}  // namespace touchstone::compare
