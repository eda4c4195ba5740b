#include "compare/report/viewer.h"

#include "compare/format/page.h"
#include "compare/format/svg_plot.h"
#include "compare/format/text.h"
#include "compare/report/picture.h"
#include "compare/viewer/viewer_bundle.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <set>
#include <span>

namespace touchstone::compare {
namespace {

using Json = nlohmann::ordered_json;

constexpr int chart_width_px = 560, chart_height_px = 250;
constexpr int viewer_tool_triangles = 1500;

/// Limit on the numbers of all instants together, which keeps the page at a few megabytes.
constexpr std::size_t numbers_max = 600'000;
constexpr std::size_t instants_max = 48;

std::string base64(std::span<const std::byte> bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (i + k < bytes.size() ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0u);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      out += i + k > bytes.size() ? '=' : digits[group >> (18 - 6 * k) & 63];
    }
  }
  return out;
}

static_assert(std::endian::native == std::endian::little, "the script reads little-endian numbers");

std::string encoded(const Eigen::Matrix3Xd& vectors) {
  const Eigen::Matrix3Xf single = vectors.cast<float>();
  return base64(std::as_bytes(std::span(single.data(), static_cast<std::size_t>(single.size()))));
}

std::string encoded(const std::vector<std::array<std::int32_t, 3>>& triangles) {
  return base64(std::as_bytes(std::span(triangles)));
}

Plot force_over_time(const Errors& errors) {
  Plot plot;
  plot.title = "Force over time";
  plot.x_label = "time [s]";
  plot.y_label = "force on the tool [N]";
  plot.x_range = {errors.instants.front().time_s, errors.instants.back().time_s};
  plot.cursor = errors.instants[errors.deepest].time_s;
  Curve reference{"reference", Look::reference, {}, {}}, fast{"fast model", Look::fast, {}, {}};
  for (const InstantErrors& e : errors.instants) {
    for (Curve* curve : {&reference, &fast}) curve->x.push_back(e.time_s);
    reference.y.push_back(e.force_reference_n);
    fast.y.push_back(e.force_fast_n);
  }
  plot.curves = {std::move(reference), std::move(fast)};
  return plot;
}

Json data_of(const scene::Scene& scene, const fast::Run& run, const reference::Result& result, const Errors& errors,
             const std::vector<std::size_t>& chosen) {
  Json data;
  data["points_m"] = encoded(run.surface.points_m);
  data["triangles"] = encoded(run.surface.triangles);
  const scene::Surface tool = scene::tool_surface(scene.tool, viewer_tool_triangles);
  data["tool"] = {{"points_m", encoded(tool.points_m)}, {"triangles", encoded(tool.triangles)}};
  for (const ColourMap map : {ColourMap::displacement, ColourMap::error}) {
    data["colours"][map == ColourMap::error ? "error" : "displacement"] = colour_table(map);
  }
  data["meanings"] = {{"displacement", "displacement"}, {"error", "distance between the two sides' points"}};
  data["deepest"] = std::find(chosen.begin(), chosen.end(), errors.deepest) - chosen.begin();
  const auto [left_px, right_px] = x_axis_px(force_over_time(errors), chart_width_px, chart_height_px);
  data["chart"] = {{"width_px", chart_width_px},
                   {"left_px", left_px},
                   {"right_px", right_px},
                   {"from_s", errors.instants.front().time_s},
                   {"to_s", errors.instants.back().time_s}};
  for (const std::size_t t : chosen) {
    const InstantErrors& e = errors.instants[t];
    const scene::Pose& pose = result.instants[t].tool;
    const Eigen::Vector4d xyzw = pose.orientation.coeffs();
    data["instants"].push_back(
        {{"time_s", e.time_s},
         {"words",
          fmt::format("{}{}s, {} deep: fast model {}, reference {}; largest shape error {}", number_text(e.time_s),
                      no_break, quantity_text(e.depth_m, "m"), quantity_text(e.force_fast_n, "N"),
                      quantity_text(e.force_reference_n, "N"), quantity_text(e.shape_max_m, "m"))},
         {"tool_m", {pose.position_m.x(), pose.position_m.y(), pose.position_m.z()}},
         {"tool_xyzw", {xyzw[0], xyzw[1], xyzw[2], xyzw[3]}},
         {"reference", encoded(result.instants[t].displacement_m)},
         {"fast", encoded(run.instants[t].displacement_m)}});
  }
  return data;
}

/// Escaped for a script element, so that neither HTML nor XML finds markup in it.
std::string script_text(const Json& data) {
  std::string out;
  for (const char c : data.dump(-1, ' ', false, Json::error_handler_t::replace)) {
    out += c == '<' || c == '>' || c == '&' ? fmt::format("\\u{:04x}", static_cast<int>(c)) : std::string(1, c);
  }
  return out;
}

constexpr const char* stage = R"(<div class="stage" data-part="stage"><div data-part="canvas" class="canvas"></div>
<canvas data-part="marks" class="marks" role="img"></canvas>
<span class="side reference" data-part="name-reference">Reference</span>
<span class="side fast" data-part="name-fast">Fast model</span></div>
<div class="bar"><div data-part="bar" class="colours"></div>
<div data-part="bar-numbers" class="numbers"><span></span><span></span><span></span><span></span><span></span></div>
<div data-part="bar-name" class="dim"></div></div>
<div class="controls"><button type="button" data-part="play" class="play">Play</button>
<label class="time">Instant <input type="range" min="0" step="1" data-part="instant"/></label></div>
<p data-part="words"></p>
<div class="controls">
<label>Show <select data-part="side"><option value="both">both</option><option value="reference">the reference</option>
<option value="fast">the fast model</option></select></label>
<label>coloured by <select data-part="colour"><option value="displacement">displacement</option>
<option value="error">error</option></select></label>
<label><input type="checkbox" data-part="tool" checked="checked"/> tool</label>
<button type="button" data-part="reset">First view</button>
<button type="button" data-part="save">Save PNG</button>
</div>
<p class="keys dim" id="viewer-keys" data-part="keys">Click the picture, then: drag or <kbd>arrow keys</kbd> to turn,
wheel or <kbd>+</kbd> <kbd>-</kbd> to zoom, <kbd>Shift</kbd> and drag to move, <kbd>Space</kbd> to play or pause,
<kbd>Home</kbd> for the first view, <kbd>Esc</kbd> to leave the picture. Both bodies turn together.</p>
)";

}  // namespace

std::vector<std::size_t> viewer_instants(std::size_t count, std::size_t deepest, Eigen::Index points) {
  const std::size_t fit = numbers_max / (6 * static_cast<std::size_t>(std::max<Eigen::Index>(points, 1)));
  const std::size_t wanted = std::min({count, instants_max, std::max<std::size_t>(fit, 3)});
  std::set<std::size_t> chosen;
  if (wanted < count) {
    // One place is reserved for the deepest instant.
    for (std::size_t i = 0; i + 1 < wanted; ++i) chosen.insert(i * (count - 1) / (wanted - 2));
    chosen.insert(deepest);
  } else {
    for (std::size_t i = 0; i < count; ++i) chosen.insert(i);
  }
  return {chosen.begin(), chosen.end()};
}

std::string viewer_section(const scene::Scene& scene, const fast::Run& run, const reference::Result& result,
                           const Errors& errors) {
  const std::size_t count = errors.instants.size();
  const std::vector<std::size_t> chosen = viewer_instants(count, errors.deepest, run.surface.points_m.cols());
  // In print the still picture below is used.
  std::string out = "<section class=\"screen\">\n" + tag("h3", "Both bodies in space");
  out += tag("p",
             "The view in space needs scripts and WebGL, which this browser does not offer; the still picture below "
             "shows the deepest instant.",
             "id=\"viewer-still\" class=\"dim\"") +
         "\n<div id=\"viewer\" class=\"viewer\" hidden=\"hidden\">\n" + stage +
         "<div data-part=\"chart\" class=\"chart\">" +
         to_svg(force_over_time(errors), chart_width_px, chart_height_px) + "</div>\n";
  if (chosen.size() < count) {
    out += tag("p", fmt::format("{} of {} instants; all are in surface.pvd.", chosen.size(), count), "class=\"dim\"");
  }
  out += "</div>\n</section>\n<script type=\"application/json\" id=\"viewer-data\">" +
         script_text(data_of(scene, run, result, errors, chosen)) + "</script>\n";
  return out + "<script>//<![CDATA[\n" + std::string(viewer_bundle) + "\n//]]></script>\n";
}

}  // namespace touchstone::compare
