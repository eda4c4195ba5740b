#include "compare/report/picture.h"

#include "compare/format/text.h"
#include "compare/report/section.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

namespace touchstone::compare {
namespace {

using scene::Vec3;

struct Rgb {
  double r, g, b;
};

// A half-cut view, from the top: title, drawing, colour bar.
constexpr double view_top_px = 36, view_px = 350, bar_top_px = view_top_px + view_px + 10;
constexpr double view_height_px = bar_top_px + 52;
constexpr int row_px = 380;  ///< width of each of three

Rgb colour_of(ColourMap map, double share) {
  const std::vector<std::array<int, 3>>& table = colour_table(map);
  // Without any displacement this is 0 / 0, which takes the first colour.
  const double at = (share > 0.0 ? std::min(share, 1.0) : 0.0) * static_cast<double>(table.size() - 1);
  const std::size_t low = std::min(static_cast<std::size_t>(at), table.size() - 2);
  const double t = at - static_cast<double>(low);
  const auto between = [&](std::size_t i) { return (1 - t) * table[low][i] + t * table[low + 1][i]; };
  return {between(0), between(1), between(2)};
}

std::string hex(const Rgb& c, double brightness) {
  const auto byte = [brightness](double v) { return static_cast<int>(std::clamp(v * brightness, 0.0, 255.0)); };
  return fmt::format("#{:02x}{:02x}{:02x}", byte(c.r), byte(c.g), byte(c.b));
}

/// Parallel projection: the view is from the front, above and slightly from the right.
class Camera {
 public:
  /// @param seen_m  points that must lie inside the given rectangle
  Camera(const std::vector<Vec3>& seen_m, double left_px, double top_px, double width_px, double height_px) {
    const double azimuth = 24.0 * std::numbers::pi / 180.0, elevation = 30.0 * std::numbers::pi / 180.0;
    towards_ =
        Vec3(std::sin(azimuth) * std::cos(elevation), -std::cos(azimuth) * std::cos(elevation), std::sin(elevation));
    right_ = Vec3(std::cos(azimuth), std::sin(azimuth), 0.0);
    up_ = towards_.cross(right_);
    const double far_m = std::numeric_limits<double>::infinity();
    double left_m = far_m, right_m = -far_m, low_m = far_m, high_m = -far_m;
    for (const Vec3& p : seen_m) {
      left_m = std::min(left_m, p.dot(right_));
      right_m = std::max(right_m, p.dot(right_));
      low_m = std::min(low_m, p.dot(up_));
      high_m = std::max(high_m, p.dot(up_));
    }
    px_per_m_ = std::min(width_px / (right_m - left_m), height_px / (high_m - low_m));
    x0_px_ = left_px + 0.5 * width_px - 0.5 * px_per_m_ * (left_m + right_m);
    y0_px_ = top_px + 0.5 * height_px + 0.5 * px_per_m_ * (low_m + high_m);
  }
  [[nodiscard]] double x_px(const Vec3& p_m) const { return x0_px_ + px_per_m_ * p_m.dot(right_); }
  [[nodiscard]] double y_px(const Vec3& p_m) const { return y0_px_ - px_per_m_ * p_m.dot(up_); }
  [[nodiscard]] double nearness_m(const Vec3& p_m) const { return p_m.dot(towards_); }
  [[nodiscard]] bool faces(const Vec3& normal) const { return normal.dot(towards_) > 0.0; }

  [[nodiscard]] std::string path(const std::vector<Vec3>& places_m) const {
    std::string out;
    for (const Vec3& p : places_m) out += fmt::format("{}{:.1f} {:.1f}", out.empty() ? "M" : "L", x_px(p), y_px(p));
    return out + "Z";
  }
  [[nodiscard]] std::string path(const Outlines& outlines_m) const {
    std::string out;
    for (const std::vector<Vec3>& outline_m : outlines_m) out += path(outline_m);
    return out;
  }

 private:
  Vec3 towards_, right_, up_;
  double px_per_m_ = 1.0, x0_px_ = 0.0, y0_px_ = 0.0;
};

struct Face {
  double nearness_m;
  std::string svg;
};

/// One half of a body: its far surface from back to front, then the cut, which covers them.
std::string half_body(const scene::Surface& surface, const Eigen::Matrix3Xd& displacement_m, double y_m,
                      const Eigen::VectorXd& shade_by_m, double full_scale_m, ColourMap map, const Camera& camera) {
  const Vec3 light = Vec3(-0.35, -0.45, 0.82).normalized();
  const Eigen::Matrix3Xd place_m = surface.points_m + displacement_m;
  std::vector<Face> faces;
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    const std::vector<EdgePoint> polygon = triangle_behind_y(surface, i, y_m);
    if (polygon.empty()) continue;
    const auto& [a, b, c] = surface.triangles[i];
    const Vec3 normal = (place_m.col(b) - place_m.col(a)).cross(place_m.col(c) - place_m.col(a)).normalized();
    if (!normal.allFinite() || !camera.faces(normal)) continue;
    std::vector<Vec3> places_m;
    Vec3 middle_m = Vec3::Zero();
    for (const EdgePoint& corner : polygon) {
      places_m.push_back(corner.of(place_m));
      middle_m += places_m.back() / static_cast<double>(polygon.size());
    }
    const double value_m = (shade_by_m[a] + shade_by_m[b] + shade_by_m[c]) / 3.0;
    const std::string fill =
        hex(colour_of(map, value_m / full_scale_m), 0.80 + 0.24 * std::max(0.0, normal.dot(light)));
    faces.push_back({camera.nearness_m(middle_m),
                     fmt::format("<path d=\"{}\" fill=\"{}\" stroke=\"{}\"/>\n", camera.path(places_m), fill, fill)});
  }
  std::sort(faces.begin(), faces.end(), [](const Face& f, const Face& g) { return f.nearness_m < g.nearness_m; });
  std::string out = "<g stroke-width=\"0.7\" stroke-linejoin=\"round\">\n";
  for (const Face& face : faces) out += face.svg;
  out += "</g>\n";
  for (const auto& outline : cut_at_y(surface, y_m)) {
    std::vector<Vec3> places_m;
    for (const EdgePoint& p : outline) {
      if (const Vec3 at_m = p.of(place_m); at_m.allFinite()) places_m.push_back(at_m);
    }
    if (places_m.empty()) continue;
    out +=
        fmt::format("<path d=\"{}\" fill=\"#e9e6df\" stroke=\"#333\" stroke-width=\"1\" stroke-linejoin=\"round\"/>\n",
                    camera.path(places_m));
  }
  return out;
}

std::string label(double x, double y, const std::string& anchor, const std::string& text,
                  const std::string& extra = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" fill=\"currentColor\"{}>{}</text>\n", x, y,
                     anchor, extra, escape_xml(text));
}

double largest(const Eigen::VectorXd& values) {
  double found = 0.0;
  for (const double v : values) found = std::max(found, std::isfinite(v) ? v : 0.0);
  return found;
}

/// The parts of a half-cut view other than the displacement.
struct HalfCut {
  const scene::Surface& surface;
  double y_m;
  Outlines tool_m, inclusions_m;
  std::vector<Vec3> seen_m;  ///< what must be visible: rear half of the body at rest, nearby part of the tool

  HalfCut(const scene::Scene& scene, const scene::Surface& rest, const scene::Pose& pose)
      : surface(rest),
        y_m(cut_y_m(rest, pose)),
        tool_m(tool_outlines_m(scene.tool, pose, y_m)),
        inclusions_m(inclusion_outlines_m(scene.body, y_m)) {
    const double top_m = tool_shown_below_m(surface);
    for (const auto& outline_m : tool_m) {
      for (const Vec3& p_m : outline_m) seen_m.emplace_back(p_m.x(), p_m.y(), std::min(p_m.z(), top_m));
    }
    for (Eigen::Index i = 0; i < surface.points_m.cols(); ++i) {
      if (surface.points_m(1, i) >= y_m) seen_m.push_back(surface.points_m.col(i));
    }
    for (const auto& outline : cut_at_y(surface, y_m)) {
      for (const EdgePoint& p : outline) seen_m.push_back(p.of(surface.points_m));
    }
  }

  /// One view under its title, its colour bar below.
  [[nodiscard]] std::string svg(const std::string& title, const Eigen::Matrix3Xd& displacement_m,
                                const Eigen::VectorXd& shade_by_m, const ColourScale& scale, int width_px) const {
    const Camera camera(seen_m, 14, view_top_px, width_px - 28, view_px);
    std::string out = svg_opening(title, width_px, static_cast<int>(view_height_px));
    out += label(0.5 * width_px, 20, "middle", title, " font-size=\"14\" font-weight=\"600\"");
    // Its own viewport, so that a diverged shape does not cover the neighbouring views.
    out += fmt::format(
        "<svg x=\"{0:.0f}\" y=\"{1:.0f}\" width=\"{2:.0f}\" height=\"{3:.0f}\" viewBox=\"{0:.0f} {1:.0f} {2:.0f} "
        "{3:.0f}\" "
        "overflow=\"hidden\">\n",
        0.0, view_top_px - 6, static_cast<double>(width_px), view_px + 12);
    out += half_body(surface, displacement_m, y_m, shade_by_m, scale.full, scale.map, camera);
    if (!inclusions_m.empty()) {
      out += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.4\" stroke-dasharray=\"6 3\"/>\n",
                         camera.path(inclusions_m), colour(Look::inclusion));
    }
    if (!tool_m.empty()) {
      out += fmt::format(
          "<path d=\"{}\" fill=\"#8a8a8a\" fill-opacity=\"0.22\" fill-rule=\"evenodd\" stroke=\"#8a8a8a\" "
          "stroke-width=\"1.4\"/>\n",
          camera.path(tool_m));
    }
    return out + "</svg>\n" + colour_bar(scale, 40, bar_top_px, width_px - 80) + "</svg>\n";
  }
};

/// The section of a body is one closed curve. On the reference's mesh it has gaps where one face meets two smaller ones
/// along a curved edge.
constexpr double gap_share = 5e-3;

std::vector<std::vector<EdgePoint>> cut_of(const DeformedBody& body, double y_m) {
  return cut_at_y(body.surface, y_m, gap_share);
}

Outlines moved_m(const DeformedBody& body, const std::vector<std::vector<EdgePoint>>& cut) {
  Outlines outlines_m;
  for (const auto& outline : cut) {
    outlines_m.emplace_back();
    for (const EdgePoint& p : outline) {
      outlines_m.back().push_back(p.of(body.surface.points_m) + p.of(body.displacement_m));
    }
  }
  return outlines_m;
}

/// Small markers at the selected points of the cut.
void add_points(Plot& plot, const DeformedBody& body, double y_m, const std::function<bool(const EdgePoint&)>& wanted) {
  Curve curve{"", body.look, {}, {}};
  curve.points_only = true;
  for (const auto& outline : cut_of(body, y_m)) {
    for (const EdgePoint& p : outline) {
      if (!wanted(p)) continue;
      const Vec3 at_mm = 1e3 * (p.of(body.surface.points_m) + p.of(body.displacement_m));
      if (!curve.x.empty() && std::hypot(curve.x.back() - at_mm.x(), curve.y.back() - at_mm.z()) < 1e-3) continue;
      curve.x.push_back(at_mm.x());
      curve.y.push_back(at_mm.z());
    }
  }
  plot.curves.push_back(std::move(curve));
}

void add_outlines(Plot& plot, const std::string& name, Look look, const Outlines& outlines_m, bool filled = false) {
  if (outlines_m.empty()) return;
  Curve curve{name, look, {}, {}, false, filled};
  constexpr double lift_pen = std::numeric_limits<double>::quiet_NaN();
  for (const auto& outline_m : outlines_m) {
    for (std::size_t i = 0; i <= outline_m.size(); ++i) {
      const Vec3& p_m = outline_m[i % outline_m.size()];
      curve.x.push_back(1e3 * p_m.x());
      curve.y.push_back(1e3 * p_m.z());
    }
    curve.x.push_back(lift_pen);
    curve.y.push_back(lift_pen);
  }
  plot.curves.push_back(std::move(curve));
}

}  // namespace

const std::vector<std::array<int, 3>>& colour_table(ColourMap map) {
  static const std::vector<std::array<int, 3>> viridis = {{68, 1, 84},    {71, 44, 122},  {59, 81, 139},
                                                          {44, 113, 142}, {33, 144, 141}, {39, 173, 129},
                                                          {92, 200, 99},  {170, 220, 50}, {253, 231, 37}};
  static const std::vector<std::array<int, 3>> magma = {{252, 253, 191}, {254, 194, 135}, {251, 135, 97},
                                                        {229, 80, 100},  {181, 54, 122},  {129, 37, 129},
                                                        {79, 18, 123},   {28, 16, 68}};
  return map == ColourMap::displacement ? viridis : magma;
}

std::string colour_at(ColourMap map, double share) { return hex(colour_of(map, share), 1.0); }

std::string colour_bar(const ColourScale& scale, double left_px, double top_px, double width_px) {
  constexpr int strips = 48;
  std::string out;
  for (int i = 0; i < strips; ++i) {
    out += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"11\" fill=\"{}\"/>\n",
                       left_px + width_px * i / strips, top_px, width_px / strips + 0.5,
                       colour_at(scale.map, (i + 0.5) / strips));
  }
  const double full = scale.per_unit * scale.full;
  for (const double tick : nice_ticks(0.0, full, 5)) {
    const double x = left_px + width_px * tick / full;
    out += fmt::format("<line x1=\"{0:.1f}\" y1=\"{1:.1f}\" x2=\"{0:.1f}\" y2=\"{2:.1f}\" stroke=\"currentColor\"/>\n",
                       x, top_px + 11, top_px + 15);
    out += label(x, top_px + 27, "middle", number_text(tick));
  }
  return out + label(left_px + 0.5 * width_px, top_px + 44, "middle",
                     fmt::format("{} [{}]{}", scale.what, scale.unit,
                                 scale.clipped ? "; larger values have the last colour" : ""));
}

double tool_shown_below_m(const scene::Surface& surface) {
  const Vec3 lower_m = surface.points_m.rowwise().minCoeff(), upper_m = surface.points_m.rowwise().maxCoeff();
  return upper_m.z() + 0.5 * (upper_m - lower_m).maxCoeff();
}

std::vector<std::string> half_cut_svgs(const scene::Scene& scene, const fast::Run& run, const reference::Result& result,
                                       std::size_t instant) {
  const Eigen::Matrix3Xd& fast_m = run.instants[instant].displacement_m;
  const Eigen::Matrix3Xd& reference_m = result.instants[instant].displacement_m;
  const Eigen::VectorXd fast_size_m = fast_m.colwise().norm();
  const Eigen::VectorXd reference_size_m = reference_m.colwise().norm();
  const Eigen::VectorXd error_m = (fast_m - reference_m).colwise().norm();
  // The reference determines the colour scale, so that a diverged fast model does not hide the reference's colours.
  const double full_m = largest(reference_size_m) > 0.0 ? largest(reference_size_m) : largest(fast_size_m);
  const bool clipped = largest(fast_size_m) > 1.001 * full_m;
  const HalfCut cut(scene, run.surface, result.instants[instant].tool);
  constexpr const char* between = "distance between the two sides' points";
  return {
      cut.svg("Reference", reference_m, reference_size_m, {ColourMap::displacement, full_m, "displacement"}, row_px),
      cut.svg("Fast model", fast_m, fast_size_m, {ColourMap::displacement, full_m, "displacement", clipped}, row_px),
      cut.svg("Error, on the reference's shape", reference_m, error_m, {ColourMap::error, largest(error_m), between},
              row_px)};
}

std::string half_cuts_in_a_row(const std::vector<std::string>& half_cuts) {
  return in_rows("Both deformed bodies, cut in half, and the error between them", half_cuts,
                 static_cast<int>(half_cuts.size()), row_px, static_cast<int>(view_height_px));
}

std::string half_cut_svg(const scene::Scene& scene, const scene::Surface& surface, const scene::InstantRecord& record,
                         const std::string& title) {
  const Eigen::VectorXd size_m = record.displacement_m.colwise().norm();
  return HalfCut(scene, surface, record.tool)
      .svg(title, record.displacement_m, size_m, {ColourMap::displacement, largest(size_m), "displacement"}, 560);
}

Plot section_plot(const scene::Scene& scene, const scene::Surface& surface, const scene::Pose& pose,
                  const std::vector<DeformedBody>& bodies) {
  const double y_m = cut_y_m(surface, pose);
  const Eigen::Matrix3Xd still_m = Eigen::Matrix3Xd::Zero(3, surface.points_m.cols());
  const auto outlines_of = [&](const DeformedBody& body) { return moved_m(body, cut_of(body, y_m)); };
  Plot plot;
  plot.x_label = "x [mm]";
  plot.y_label = "z [mm]";
  plot.same_scale = true;
  add_outlines(plot, "rest", Look::outline, outlines_of({"", Look::outline, surface, still_m}));
  add_outlines(plot, "inclusion, at rest", Look::inclusion, inclusion_outlines_m(scene.body, y_m));
  add_outlines(plot, "tool", Look::plain, tool_outlines_m(scene.tool, pose, y_m), true);
  for (const DeformedBody& body : bodies) add_outlines(plot, body.name, body.look, outlines_of(body));
  return plot;
}

Window contact_window(const scene::Scene& scene, const scene::Surface& surface, const scene::InstantRecord& record) {
  const auto body = scene::body_shape(scene.body);
  constexpr int steps = 16;
  const double size_m = (surface.points_m.rowwise().maxCoeff() - surface.points_m.rowwise().minCoeff()).maxCoeff();
  Vec3 low_m = Vec3::Constant(std::numeric_limits<double>::infinity()), high_m = -low_m;
  for (const auto& outline_m : tool_outlines_m(scene.tool, record.tool, cut_y_m(surface, record.tool))) {
    for (std::size_t i = 0; i < outline_m.size(); ++i) {
      const Vec3& next_m = outline_m[(i + 1) % outline_m.size()];
      for (int step = 0; step < steps; ++step) {
        const Vec3 p_m = outline_m[i] + (next_m - outline_m[i]) * step / steps;
        if (body->signed_distance_m(p_m) > 0.0) continue;
        low_m = low_m.cwiseMin(p_m);
        high_m = high_m.cwiseMax(p_m);
      }
    }
  }
  if (!(low_m.x() <= high_m.x())) low_m = high_m = body->query(record.tool.position_m).point_m;
  return {0.5 * (low_m.x() + high_m.x()), high_m.z(),
          std::max({0.85 * (high_m.x() - low_m.x()), 2.5 * record.depth_m, 0.01 * size_m})};
}

void show_contact(Plot& plot, const Window& window) {
  plot.x_range = {1e3 * (window.x_m - window.half_m), 1e3 * (window.x_m + window.half_m)};
  plot.y_range = {1e3 * (window.top_m - 0.75 * window.half_m), 1e3 * (window.top_m + 0.5 * window.half_m)};
}

namespace {

bool is_node(const reference::BoundarySurface& own, const EdgePoint& p) {
  const bool at_a = p.share < 0.5;
  return (at_a ? p.share : 1.0 - p.share) < 1e-3 && own.is_node[static_cast<std::size_t>(at_a ? p.a : p.b)];
}

}  // namespace

std::string section_svg(const scene::Scene& scene, const fast::Run& run, const reference::Result& result,
                        std::size_t instant, bool around_contact) {
  const scene::Pose& pose = result.instants[instant].tool;
  const reference::BoundarySurface& own = result.deepest_surface;
  const DeformedBody reference{"reference", Look::reference, own.rest, own.displacement_m};
  const DeformedBody fast{"fast model", Look::fast, run.surface, run.instants[instant].displacement_m};
  Plot plot = section_plot(scene, run.surface, pose, {reference, fast});
  if (around_contact) {
    plot.title = "Around the contact";
    const double y_m = cut_y_m(run.surface, pose);
    add_points(plot, reference, y_m, [&](const EdgePoint& p) { return is_node(own, p); });
    add_points(plot, fast, y_m, [](const EdgePoint&) { return true; });
    show_contact(plot, contact_window(scene, run.surface, result.instants[instant]));
  } else {
    plot.title = "The whole section";
  }
  return to_svg(plot, 560, 440);
}

std::optional<Plot> traction_plot(const scene::Surface& surface, const reference::Result& result, std::size_t instant) {
  const reference::BoundarySurface& own = result.deepest_surface;
  if (own.traction_pa.size() == 0) return std::nullopt;
  std::vector<std::pair<double, double>> points;  // deformed place, traction
  for (const auto& outline : cut_at_y(own.rest, cut_y_m(surface, result.instants[instant].tool))) {
    for (const EdgePoint& p : outline) {
      if (!is_node(own, p)) continue;
      const double traction_pa = p.of(own.traction_pa).norm();
      if (traction_pa > 0.0)
        points.emplace_back(p.of(own.rest.points_m).x() + p.of(own.displacement_m).x(), traction_pa);
    }
  }
  if (points.empty()) return std::nullopt;
  std::sort(points.begin(), points.end());
  Plot plot;
  plot.title = "Traction across the contact";
  plot.x_label = "x [mm]";
  plot.y_label = "traction [kPa]";
  Curve& curve = plot.curves.emplace_back(Curve{"reference", Look::reference, {}, {}});
  for (const auto& [x_m, traction_pa] : points) {
    curve.x.push_back(1e3 * x_m);
    curve.y.push_back(1e-3 * traction_pa);
  }
  return plot;
}

}  // namespace touchstone::compare
