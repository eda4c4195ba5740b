#include "compare/report/stress_section.h"

#include "compare/format/svg_plot.h"
#include "compare/format/text.h"
#include "compare/report/picture.h"
#include "compare/report/section.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace touchstone::compare {
namespace {

constexpr int section_columns = 97, section_rows = 41;  // odd: one column at the tool's centre
constexpr int section_colours = 32;
constexpr int section_px = 560, section_drawing_px = 400, section_bar_px = 56;

/// From 0 to 1, with small steps at both ends: at the contact, and where a round body's outline is steep.
double graded(double share) { return share * share * (3.0 - 2.0 * share); }

/// Where a line of constant x cuts a closed convex outline: lowest and highest z.
std::pair<double, double> z_range_m(const Outlines& outlines_m, double x_m) {
  std::pair<double, double> range(std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity());
  for (const auto& outline_m : outlines_m) {
    for (std::size_t i = 0; i < outline_m.size(); ++i) {
      const scene::Vec3 &a_m = outline_m[i], &b_m = outline_m[(i + 1) % outline_m.size()];
      if ((a_m.x() < x_m) == (b_m.x() < x_m)) continue;
      const double z_m = a_m.z() + (b_m.z() - a_m.z()) * (x_m - a_m.x()) / (b_m.x() - a_m.x());
      range = {std::min(range.first, z_m), std::max(range.second, z_m)};
    }
  }
  return range;
}

/// What 99.5 % of the values do not exceed, so that a peak at a sharp edge leaves the colours of the rest.
double nearly_largest(Eigen::RowVectorXd values) {
  std::sort(values.begin(), values.end());
  return values[static_cast<Eigen::Index>(0.995 * static_cast<double>(values.size() - 1))];
}

}  // namespace

SectionGrid section_grid(const scene::Surface& surface, const scene::Pose& tool) {
  const double y_m = cut_y_m(surface, tool);
  Outlines outlines_m;
  double low_m = std::numeric_limits<double>::infinity(), high_m = -low_m;
  for (const auto& outline : cut_at_y(surface, y_m)) {
    outlines_m.emplace_back();
    for (const EdgePoint& p : outline) {
      outlines_m.back().push_back(p.of(surface.points_m));
      low_m = std::min(low_m, outlines_m.back().back().x());
      high_m = std::max(high_m, outlines_m.back().back().x());
    }
  }
  // Slightly inside, where a column has a length.
  const double hair_m = 1e-6 * (high_m - low_m),
               center_m = std::clamp(tool.position_m.x(), low_m + hair_m, high_m - hair_m);
  SectionGrid grid{Eigen::Matrix3Xd(3, Eigen::Index{section_columns} * section_rows), section_rows};
  for (int column = 0; column < section_columns; ++column) {
    const double side = 2.0 * column / (section_columns - 1) - 1.0;
    const double reach_m = side < 0.0 ? center_m - low_m - hair_m : high_m - hair_m - center_m;
    const double x_m = center_m + std::copysign(graded(std::abs(side)), side) * reach_m;
    const auto [bottom_m, top_m] = z_range_m(outlines_m, x_m);
    for (int row = 0; row < section_rows; ++row) {
      const double share = graded(1.0 - static_cast<double>(row) / (section_rows - 1));
      grid.rest_m.col(Eigen::Index{column} * section_rows + row) =
          scene::Vec3(x_m, y_m, top_m + share * (bottom_m - top_m));
    }
  }
  return grid;
}

std::string stress_section_svg(const scene::Scene& scene, const scene::Surface& surface,
                               const scene::InstantRecord& record, const SectionGrid& grid,
                               const reference::PointValues& values) {
  const Eigen::Matrix3Xd place_m = grid.rest_m + values.displacement_m;
  const Eigen::RowVectorXd stress_pa = reference::von_mises_pa(values.stress_pa);
  const double full_pa = nearly_largest(stress_pa);
  const double top_m = tool_shown_below_m(surface);
  const Outlines tool_m = tool_outlines_m(scene.tool, record.tool, cut_y_m(surface, record.tool));
  double left_m = place_m.row(0).minCoeff(), right_m = place_m.row(0).maxCoeff();
  double low_m = place_m.row(2).minCoeff(), high_m = place_m.row(2).maxCoeff();
  for (const auto& outline_m : tool_m) {
    for (const scene::Vec3& p_m : outline_m) {
      left_m = std::min(left_m, p_m.x());
      right_m = std::max(right_m, p_m.x());
      high_m = std::max(high_m, std::min(p_m.z(), top_m));
    }
  }
  const double px_per_m =
      std::min((section_px - 20) / (right_m - left_m), (section_drawing_px - 16) / (high_m - low_m));
  const auto x_px = [&](double x_m) { return 0.5 * section_px + px_per_m * (x_m - 0.5 * (left_m + right_m)); };
  const auto y_px = [&](double z_m) { return section_drawing_px - 8 - px_per_m * (z_m - low_m); };

  // The cells of one colour are one path.
  std::vector<std::string> paths(section_colours);
  const auto corner = [&](Eigen::Index k) {
    return fmt::format("{:.1f} {:.1f}", x_px(place_m(0, k)), y_px(place_m(2, k)));
  };
  for (Eigen::Index column = 0; column + 1 < place_m.cols() / grid.rows; ++column) {
    for (Eigen::Index row = 0; row + 1 < grid.rows; ++row) {
      const Eigen::Index a = column * grid.rows + row, b = a + grid.rows;
      const double mean_pa = 0.25 * (stress_pa[a] + stress_pa[a + 1] + stress_pa[b] + stress_pa[b + 1]);
      const double share = full_pa > 0.0 ? std::clamp(mean_pa / full_pa, 0.0, 1.0) : 0.0;
      paths[static_cast<std::size_t>(std::min(share * section_colours, section_colours - 1.0))] +=
          "M" + corner(a) + "L" + corner(b) + "L" + corner(b + 1) + "L" + corner(a + 1) + "Z";
    }
  }
  const std::string title = "Stress in the section";
  std::string out = svg_opening(title, section_px, section_drawing_px + section_bar_px);
  out += fmt::format("<svg width=\"{}\" height=\"{}\" overflow=\"hidden\">\n<g stroke-width=\"0.6\">\n", section_px,
                     section_drawing_px);
  for (int i = 0; i < section_colours; ++i) {
    if (paths[static_cast<std::size_t>(i)].empty()) continue;
    out += fmt::format("<path d=\"{0}\" fill=\"{1}\" stroke=\"{1}\"/>\n", paths[static_cast<std::size_t>(i)],
                       colour_at(ColourMap::displacement, (i + 0.5) / section_colours));
  }
  out += "</g>\n";
  const auto add_outlines = [&](const Outlines& outlines_m, const char* look) {
    for (const auto& outline_m : outlines_m) {
      std::string path;
      for (const scene::Vec3& p_m : outline_m) {
        path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", x_px(p_m.x()), y_px(p_m.z()));
      }
      out += fmt::format("<path d=\"{}Z\" fill=\"none\" stroke-width=\"1.4\" {}/>\n", path, look);
    }
  };
  add_outlines(tool_m, "stroke=\"#8a8a8a\"");
  add_outlines(inclusion_outlines_m(scene.body, grid.rest_m(1, 0)), "stroke=\"#ffffff\" stroke-dasharray=\"6 3\"");
  return out + "</svg>\n" +
         colour_bar({ColourMap::displacement, full_pa, "von Mises stress", stress_pa.maxCoeff() > 1.001 * full_pa,
                     "kPa", 1e-3},
                    40, section_drawing_px + 4, section_px - 80) +
         "</svg>\n";
}

std::string stress_section_caption(const SectionGrid& grid, const reference::PointValues& values) {
  Eigen::Index at = 0;
  const double largest_pa = reference::von_mises_pa(values.stress_pa).maxCoeff(&at);
  const scene::Vec3 place_m = grid.rest_m.col(at);
  return fmt::format(
      "Von Mises' stress inside the reference's body at the deepest instant, in the plane through the tool's centre, "
      "where the points have moved to; true scale. Largest: {} kPa at x = {}, z = {} of the body at rest.",
      number_text(1e-3 * largest_pa), quantity_text(place_m.x(), "m"), quantity_text(place_m.z(), "m"));
}

}  // namespace touchstone::compare
