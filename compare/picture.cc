#include "compare/picture.h"

#include "compare/section.h"
#include "compare/svg_plot.h"
#include "compare/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace touchstone::compare {
namespace {

using scene::Vec3;

struct Rgb {
  double r, g, b;
};

/// Viridis at even steps: equal steps look equally large, also in grey print and to the colour-blind.
constexpr std::array<Rgb, 9> viridis = {{{68, 1, 84},
                                         {71, 44, 122},
                                         {59, 81, 139},
                                         {44, 113, 142},
                                         {33, 144, 141},
                                         {39, 173, 129},
                                         {92, 200, 99},
                                         {170, 220, 50},
                                         {253, 231, 37}}};
/// Light to dark, for errors: no error is pale.
constexpr std::array<Rgb, 6> heat = {
    {{255, 247, 226}, {254, 217, 142}, {253, 166, 84}, {237, 100, 57}, {189, 34, 48}, {103, 0, 31}}};

enum class Map { displacement, error };

Rgb colour_of(Map map, double share) {
  const auto lookup = [share](const auto& table) {
    // Nothing moves: 0 / 0 takes the first colour too.
    const double at = (share > 0.0 ? std::min(share, 1.0) : 0.0) * static_cast<double>(table.size() - 1);
    const std::size_t low = std::min(static_cast<std::size_t>(at), table.size() - 2);
    const double t = at - static_cast<double>(low);
    const Rgb &a = table[low], &b = table[low + 1];
    return Rgb{(1 - t) * a.r + t * b.r, (1 - t) * a.g + t * b.g, (1 - t) * a.b + t * b.b};
  };
  return map == Map::displacement ? lookup(viridis) : lookup(heat);
}

std::string hex(const Rgb& c, double brightness) {
  const auto byte = [brightness](double v) { return static_cast<int>(std::clamp(v * brightness, 0.0, 255.0)); };
  return fmt::format("#{:02x}{:02x}{:02x}", byte(c.r), byte(c.g), byte(c.b));
}

/// Parallel projection from in front, above and a little to the right of the cut.
class Camera {
 public:
  /// @param seen_m  points that must lie within the given rectangle
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

 private:
  Vec3 towards_, right_, up_;
  double px_per_m_ = 1.0, x0_px_ = 0.0, y0_px_ = 0.0;
};

/// The tool's outline in the plane y = its centre.
std::vector<Vec3> tool_cut(const scene::Scene& scene, const scene::Pose& pose) {
  std::vector<Vec3> outline;
  constexpr int steps = 96;
  for (int i = 0; i < steps; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / steps;
    outline.push_back(pose.position_m + scene.tool.radius_m * Vec3(std::cos(angle), 0.0, std::sin(angle)));
  }
  return outline;
}

/// The plane of the cut, a hair off the tool's centre so that no rest point lies on it.
double cut_y_m(const scene::Surface& surface, const scene::Pose& pose) {
  const double low_m = surface.points_m.row(1).minCoeff(), high_m = surface.points_m.row(1).maxCoeff();
  const double hair_m = 1e-7 * (high_m - low_m);
  return std::clamp(pose.position_m.y(), low_m + 2 * hair_m, high_m - 2 * hair_m) - hair_m;
}

struct Face {
  double nearness_m;
  std::string svg;
};

/// One half of a body: its far surface from back to front, then the cut, which nothing hides.
std::string half_body(const scene::Surface& surface, const Eigen::Matrix3Xd& displacement_m, double y_m,
                      const Eigen::VectorXd& shade_by_m, double full_scale_m, Map map, const Camera& camera) {
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

/// Horizontal colour bar in millimetres.
/// @param clipped  values above the scale occur and take its last colour
std::string colour_bar(Map map, double full_scale_m, bool clipped, const std::string& what, double left_px,
                       double top_px, double width_px) {
  constexpr int strips = 48;
  std::string out;
  for (int i = 0; i < strips; ++i) {
    out += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"11\" fill=\"{}\"/>\n",
                       left_px + width_px * i / strips, top_px, width_px / strips + 0.5,
                       hex(colour_of(map, (i + 0.5) / strips), 1.0));
  }
  const double full_mm = 1e3 * full_scale_m;
  for (const double tick : nice_ticks(0.0, full_mm, 5)) {
    const double x = left_px + width_px * tick / full_mm;
    out += fmt::format("<line x1=\"{0:.1f}\" y1=\"{1:.1f}\" x2=\"{0:.1f}\" y2=\"{2:.1f}\" stroke=\"currentColor\"/>\n",
                       x, top_px + 11, top_px + 15);
    out += label(x, top_px + 27, "middle", number_text(tick));
  }
  return out + label(left_px + 0.5 * width_px, top_px + 44, "middle",
                     fmt::format("{} [mm]{}", what, clipped ? "; the last colour also stands for more" : ""));
}

double largest(const Eigen::VectorXd& values) {
  double found = 0.0;
  for (const double v : values) found = std::max(found, std::isfinite(v) ? v : 0.0);
  return found;
}

}  // namespace

std::string half_cut_svg(const scene::Scene& scene, const fast::Run& run, const reference::Result& result,
                         std::size_t instant) {
  constexpr double panel_px = 380, drawing_px = 350, top_px = 36, bar_top_px = top_px + drawing_px + 10;
  constexpr double width_px = 3 * panel_px, height_px = bar_top_px + 52;
  const scene::Surface& surface = run.surface;
  const Eigen::Matrix3Xd& fast_m = run.instants[instant].displacement_m;
  const Eigen::Matrix3Xd& reference_m = result.instants[instant].displacement_m;
  const scene::Pose& pose = result.instants[instant].tool;
  const double y_m = cut_y_m(surface, pose);

  const Eigen::VectorXd fast_size_m = fast_m.colwise().norm();
  const Eigen::VectorXd reference_size_m = reference_m.colwise().norm();
  const Eigen::VectorXd error_m = (fast_m - reference_m).colwise().norm();
  // The reference sets the scale: a fast model gone wild must not wash out the truth.
  const double full_m = largest(reference_size_m) > 0.0 ? largest(reference_size_m) : largest(fast_size_m);
  const double full_error_m = largest(error_m);
  const bool clipped = largest(fast_size_m) > 1.001 * full_m;

  // One view for all panels: the rest body's rear half and the tool.
  std::vector<Vec3> seen_m = tool_cut(scene, pose);
  for (Eigen::Index i = 0; i < surface.points_m.cols(); ++i) {
    if (surface.points_m(1, i) >= y_m) seen_m.push_back(surface.points_m.col(i));
  }
  for (const auto& outline : cut_at_y(surface, y_m)) {
    for (const EdgePoint& p : outline) seen_m.push_back(p.of(surface.points_m));
  }

  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "font-family=\"system-ui, sans-serif\" font-size=\"12\" role=\"img\">\n<title>Both deformed bodies, cut in half, "
      "and the error between them</title>\n",
      width_px, height_px);
  struct Panel {
    std::string title;
    const Eigen::Matrix3Xd& displacement_m;
    const Eigen::VectorXd& shade_by_m;
    double full_m;
    Map map;
  };
  const Panel panels[] = {{"Reference", reference_m, reference_size_m, full_m, Map::displacement},
                          {"Fast model", fast_m, fast_size_m, full_m, Map::displacement},
                          {"Error, on the reference's shape", reference_m, error_m, full_error_m, Map::error}};
  double left_px = 0.0;
  for (const Panel& panel : panels) {
    const Camera camera(seen_m, left_px + 14, top_px, panel_px - 28, drawing_px);
    out += label(left_px + 0.5 * panel_px, 20, "middle", panel.title, " font-size=\"14\" font-weight=\"600\"");
    // A viewport of its own keeps a body gone wild out of its neighbours.
    out += fmt::format(
        "<svg x=\"{0:.0f}\" y=\"{1:.0f}\" width=\"{2:.0f}\" height=\"{3:.0f}\" viewBox=\"{0:.0f} {1:.0f} {2:.0f} "
        "{3:.0f}\" "
        "overflow=\"hidden\">\n",
        left_px, top_px - 6, panel_px, drawing_px + 12);
    out += half_body(surface, panel.displacement_m, y_m, panel.shade_by_m, panel.full_m, panel.map, camera);
    out +=
        fmt::format("<path d=\"{}\" fill=\"#8a8a8a\" fill-opacity=\"0.22\" stroke=\"#8a8a8a\" stroke-width=\"1.4\"/>\n",
                    camera.path(tool_cut(scene, pose)));
    out += "</svg>\n";
    left_px += panel_px;
  }
  out += colour_bar(Map::displacement, full_m, clipped, "displacement", 0.5 * panel_px, bar_top_px, panel_px);
  out += colour_bar(Map::error, full_error_m, false, "distance between the two sides' points", 2 * panel_px + 40,
                    bar_top_px, panel_px - 80);
  return out + "</svg>\n";
}

std::string section_svg(const scene::Scene& scene, const fast::Run& run, const reference::Result& result,
                        std::size_t instant, double half_width_m) {
  const scene::Surface& surface = run.surface;
  const scene::Pose& pose = result.instants[instant].tool;
  const double y_m = cut_y_m(surface, pose);
  const Eigen::Matrix3Xd rest_m = Eigen::Matrix3Xd::Zero(3, surface.points_m.cols());

  Plot plot;
  plot.x_label = "x [mm]";
  plot.y_label = "z [mm]";
  plot.same_scale = true;
  const auto add = [&](const std::string& name, Look look, const std::vector<Vec3>& outline_m) {
    Curve curve{name, look, {}, {}, false};
    for (std::size_t i = 0; i <= outline_m.size(); ++i) {
      const Vec3& p = outline_m[i % outline_m.size()];
      curve.x.push_back(1e3 * p.x());
      curve.y.push_back(1e3 * p.z());
    }
    plot.curves.push_back(std::move(curve));
  };
  const auto add_body = [&](const std::string& name, Look look, const Eigen::Matrix3Xd& displacement_m) {
    std::string legend_name = name;
    for (const auto& outline : cut_at_y(surface, y_m)) {
      std::vector<Vec3> places_m;
      for (const EdgePoint& p : outline) places_m.push_back(p.of(surface.points_m) + p.of(displacement_m));
      add(std::exchange(legend_name, ""), look, places_m);
    }
  };
  add_body("rest", Look::outline, rest_m);
  add("tool", Look::plain, tool_cut(scene, pose));
  add_body("reference", Look::reference, result.instants[instant].displacement_m);
  add_body("fast model", Look::fast, run.instants[instant].displacement_m);

  if (half_width_m > 0.0) {
    plot.title = "Around the contact";
    const Vec3 contact_m = scene::body_shape(scene.body)->query(pose.position_m).point_m;
    plot.x_range = {1e3 * (contact_m.x() - half_width_m), 1e3 * (contact_m.x() + half_width_m)};
    plot.y_range = {1e3 * (contact_m.z() - 0.75 * half_width_m), 1e3 * (contact_m.z() + 0.5 * half_width_m)};
  } else {
    plot.title = "The whole section";
  }
  return to_svg(plot, 560, 440);
}

}  // namespace touchstone::compare
