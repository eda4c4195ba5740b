#include "compare/format/svg_plot.h"

#include "compare/format/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace touchstone::compare {
namespace {

constexpr int margin_left_min = 64, margin_right = 16, margin_top = 40, margin_bottom = 46;
constexpr double tick_gap = 7.0, y_title_px = 20.0;

/// Mean width of a letter in a 12 px sans-serif font; no font is loaded to measure it.
constexpr double letter_px = 6.6;

/// Width of a UTF-8 text; continuation bytes are not counted.
double text_width_px(std::string_view text) {
  return letter_px *
         static_cast<double>(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}
constexpr int legend_row = 18;

/// Maps values to pixels along one axis.
class Axis {
 public:
  Axis(double low, double high, bool log, double from_px, double to_px)
      : low_(low), high_(high), log_(log), from_px_(from_px), to_px_(to_px) {}

  [[nodiscard]] bool can_show(double value) const { return std::isfinite(value) && (!log_ || value > 0.0); }
  [[nodiscard]] double px(double value) const {
    const double share = log_ ? std::log(value / low_) / std::log(high_ / low_) : (value - low_) / (high_ - low_);
    // Values far outside the axis are clamped, which keeps the coordinates short.
    return from_px_ + std::clamp(share, -2.0, 3.0) * (to_px_ - from_px_);
  }
  [[nodiscard]] double low() const { return low_; }
  [[nodiscard]] double high() const { return high_; }
  [[nodiscard]] bool log() const { return log_; }
  [[nodiscard]] double from_px() const { return from_px_; }
  [[nodiscard]] double to_px() const { return to_px_; }

  [[nodiscard]] std::vector<double> ticks() const {
    if (!log_) {
      const int wanted = static_cast<int>(std::abs(to_px_ - from_px_)) / 36;
      return nice_ticks(low_, high_, std::clamp(wanted, 3, 10));
    }
    const int first = static_cast<int>(std::ceil(std::log10(low_) - 1e-9));
    const int last = static_cast<int>(std::floor(std::log10(high_) + 1e-9));
    const int every = 1 + (last - first) / 8;
    std::vector<double> out;
    for (int decade = first - 1; decade <= last; ++decade) {
      if (every > 1 && (decade - first) % every != 0) continue;
      for (const double factor : {1.0, 2.0, 5.0}) {
        if (factor > 1.0 && last - first > 1) continue;
        const double tick = factor * std::pow(10.0, decade);
        if (tick >= low_ * (1 - 1e-9) && tick <= high_ * (1 + 1e-9)) out.push_back(tick);
      }
    }
    return out;
  }

 private:
  double low_, high_;
  bool log_;
  double from_px_, to_px_;
};

/// Smallest and largest value that an axis must show.
struct Extent {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  [[nodiscard]] bool empty() const { return low > high; }

  /// The range with margins: extended to zero if that is near, else by a little.
  [[nodiscard]] std::pair<double, double> padded(bool log) const {
    if (log) return low == high ? std::pair(low / 2.0, high * 2.0) : std::pair(low / 1.25, high * 1.25);
    double from = low, to = high;
    if (from > 0.0 && from < 0.5 * to) from = 0.0;
    if (to < 0.0 && to > 0.5 * from) to = 0.0;
    const double span = to > from ? to - from : std::max(1e-12, std::abs(to));
    if (from != 0.0) from -= 0.04 * span;
    if (to != 0.0) to += 0.06 * span;
    if (from == to) to = from + span;
    return {from, to};
  }
};

std::string colour_of(const Curve& curve) { return curve.own_colour.empty() ? colour(curve.look) : curve.own_colour; }

std::string stroke(const Curve& curve) {
  const auto line = [&](const char* width, const char* dashes) {
    return fmt::format("stroke=\"{}\" stroke-width=\"{}\"{}", colour_of(curve), width,
                       *dashes == 0 ? "" : fmt::format(" stroke-dasharray=\"{}\"", dashes));
  };
  switch (curve.look) {
    case Look::reference:
    case Look::plain:
    case Look::first:
      return line("2", "");
    case Look::fast:
      return line("2", "6 3");
    case Look::outline:
      return line("1.2", "2 3");
    case Look::inclusion:
      return line("1.5", "9 4");
    case Look::second:
      return line("2", "8 4");
    case Look::third:
      return line("2", "2 3");
  }
  return "";
}

std::string text_at(double x, double y, const std::string& anchor, const std::string& text,
                    const std::string& extra = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" fill=\"currentColor\"{}>{}</text>\n", x, y,
                     anchor, extra, escape_xml(text));
}

std::string grid_line(double x1, double y1, double x2, double y2, double opacity) {
  return fmt::format(
      "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"currentColor\" stroke-opacity=\"{}\"/>\n",
      x1, y1, x2, y2, opacity);
}

std::string axes(const Plot& plot, const Axis& x, const Axis& y) {
  std::string out;
  for (const double tick : x.ticks()) {
    out += grid_line(x.px(tick), y.from_px(), x.px(tick), y.to_px(), 0.13);
    out += text_at(x.px(tick), y.from_px() + 17, "middle", number_text(tick));
  }
  for (const double tick : y.ticks()) {
    out += grid_line(x.from_px(), y.px(tick), x.to_px(), y.px(tick), 0.13);
    out += text_at(x.from_px() - tick_gap, y.px(tick) + 4, "end", number_text(tick));
  }
  if (!y.log() && !plot.same_scale && y.low() < 0.0 && y.high() > 0.0) {
    out += grid_line(x.from_px(), y.px(0.0), x.to_px(), y.px(0.0), 0.45);
  }
  out += grid_line(x.from_px(), y.from_px(), x.to_px(), y.from_px(), 0.6);
  out += grid_line(x.from_px(), y.from_px(), x.from_px(), y.to_px(), 0.6);
  out += text_at(0.5 * (x.from_px() + x.to_px()), y.from_px() + 37, "middle", plot.x_label);
  const double middle_px = 0.5 * (y.from_px() + y.to_px());
  out += text_at(15, middle_px, "middle", plot.y_label, fmt::format(" transform=\"rotate(-90 15 {:.1f})\"", middle_px));
  return out;
}

std::string shaded(double left_px, double top_px, double width_px, double height_px, double shade) {
  return fmt::format(
      "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"currentColor\" "
      "fill-opacity=\"{}\"/>\n",
      left_px, top_px, width_px, height_px, shade);
}

std::string span_area(const Span& span, const Axis& x, const Axis& y) {
  const double left_px = x.px(span.from);
  return shaded(left_px, y.to_px(), x.px(span.to) - left_px, y.from_px() - y.to_px(), span.shade);
}

std::string band_area(const Band& band, const Axis& x, const Axis& y) {
  std::string there, back;
  for (std::size_t i = 0; i < band.x.size(); ++i) {
    if (!x.can_show(band.x[i]) || !y.can_show(band.high[i]) || !std::isfinite(band.low[i])) continue;
    const double low = y.log() ? std::max(band.low[i], y.low()) : band.low[i];
    there += fmt::format("{:.1f},{:.1f} ", x.px(band.x[i]), y.px(band.high[i]));
    back = fmt::format("{:.1f},{:.1f} ", x.px(band.x[i]), y.px(low)) + back;
  }
  if (there.empty()) return "";
  return fmt::format("<polygon points=\"{}{}\" fill=\"{}\" fill-opacity=\"0.3\" stroke=\"none\"/>\n", there, back,
                     colour(band.look));
}

std::string bar_areas(const Bars& bars, const Plot& plot, const Axis& x, const Axis& y) {
  std::string out;
  for (std::size_t i = 0; i < bars.heights.size(); ++i) {
    if (!(bars.heights[i] > 0.0)) continue;
    const double left_px = x.px(bars.edges[i]), right_px = x.px(bars.edges[i + 1]), top_px = y.px(bars.heights[i]);
    // A gap of one pixel between two bars if they are wide enough.
    const double width_px = right_px - left_px > 4.0 ? right_px - left_px - 1.0 : right_px - left_px;
    out += fmt::format(
        "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\"><title>{}</title></rect>\n",
        left_px, top_px, std::max(width_px, 1.0), y.from_px() - top_px, colour(bars.look),
        escape_xml(fmt::format("{}: {} to {}; {}: {}", plot.x_label, number_text(bars.edges[i]),
                               number_text(bars.edges[i + 1]), plot.y_label, number_text(bars.heights[i], 4))));
  }
  return out;
}

std::string curve_line(const Curve& curve, const Axis& x, const Axis& y) {
  if (curve.points_only) return "";
  std::string path;
  bool pen_down = false;
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    const bool shown = x.can_show(curve.x[i]) && y.can_show(curve.y[i]);
    if (shown) path += fmt::format("{}{:.1f} {:.1f}", pen_down ? "L" : "M", x.px(curve.x[i]), y.px(curve.y[i]));
    pen_down = shown;
  }
  if (path.empty()) return "";
  const std::string fill =
      curve.filled ? fmt::format("fill=\"{}\" fill-opacity=\"0.16\" fill-rule=\"evenodd\"", colour_of(curve))
                   : "fill=\"none\"";
  return fmt::format("<path d=\"{}\" {} {} stroke-linejoin=\"round\"/>\n", path, fill, stroke(curve));
}

/// Error bars of the points whose uncertainty is known.
std::string error_bars(const Curve& curve, const Axis& x, const Axis& y) {
  std::string out;
  for (std::size_t i = 0; i < curve.y_half.size(); ++i) {
    if (!x.can_show(curve.x[i]) || !y.can_show(curve.y[i]) || !std::isfinite(curve.y_half[i])) continue;
    const double low = curve.y[i] - curve.y_half[i];
    const double x_px = x.px(curve.x[i]), top_px = y.px(curve.y[i] + curve.y_half[i]);
    const double bottom_px = y.px(y.log() ? std::max(low, y.low()) : low);
    constexpr double cap_px = 4.0;
    out += fmt::format(
        "<path class=\"bar\" d=\"M{0:.1f} {1:.1f}H{2:.1f}M{3:.1f} {1:.1f}V{4:.1f}M{0:.1f} {4:.1f}H{2:.1f}\" "
        "fill=\"none\" stroke=\"{5}\" stroke-width=\"1.5\"/>\n",
        x_px - cap_px, top_px, x_px + cap_px, x_px, bottom_px, colour_of(curve));
  }
  return out;
}

/// Marker of a point whose uncertainty is unknown.
std::string hollow_marker(const Curve& curve, double x_px, double y_px, const std::string& title_element) {
  return fmt::format(
      "<circle class=\"unknown\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" fill=\"none\" pointer-events=\"all\" "
      "stroke=\"{}\" stroke-width=\"1.5\">{}</circle>",
      x_px, y_px, colour_of(curve), title_element);
}

/// Round for the reference and square for the fast model, so that they differ in a grey print.
std::string marker(const Curve& curve, double x_px, double y_px, const std::string& title_element) {
  const double half_px = curve.points_only ? 1.8 : 3.0;
  if (curve.look == Look::fast) {
    return fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:g}\" height=\"{:g}\" fill=\"{}\">{}</rect>",
                       x_px - half_px, y_px - half_px, 2 * half_px, 2 * half_px, colour_of(curve), title_element);
  }
  return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:g}\" fill=\"{}\">{}</circle>", x_px, y_px, half_px,
                     colour_of(curve), title_element);
}

std::string bar_words(const Curve& curve, std::size_t point) {
  if (curve.y_half.empty()) return "";
  return " ± " + (std::isfinite(curve.y_half[point]) ? number_text(curve.y_half[point], 4) : std::string("unknown"));
}

std::string curve_markers(const Curve& curve, const Plot& plot, const Axis& x, const Axis& y) {
  std::string out;
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    if (!x.can_show(curve.x[i]) || !y.can_show(curve.y[i])) continue;
    const double px = x.px(curve.x[i]), py = y.px(curve.y[i]);
    const std::string tip =
        escape_xml(fmt::format("{}{}{}: {}; {}: {}", curve.name, curve.name.empty() ? "" : " | ", plot.x_label,
                               number_text(curve.x[i], 4), plot.y_label, number_text(curve.y[i], 4))) +
        bar_words(curve, i);
    if (curve.hidden_markers) {
      out += fmt::format(
          "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"none\" "
          "pointer-events=\"all\"><title>{}</title></circle>\n",
          px, py, tip);
      continue;
    }
    const bool hollow = !curve.y_half.empty() && !std::isfinite(curve.y_half[i]);
    out += (hollow ? hollow_marker : marker)(curve, px, py, "<title>" + tip + "</title>") + "\n";
  }
  return out;
}

bool can_show(double value, bool log) { return std::isfinite(value) && (!log || value > 0.0); }

/// A curve without any value is not drawn and has no entry in the legend.
bool any_point(const Plot& plot, const std::vector<double>& x, const std::vector<double>& y) {
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (can_show(x[i], plot.x_log) && can_show(y[i], plot.y_log)) return true;
  }
  return false;
}

struct LegendEntry {
  std::string name, swatch;  ///< swatch: SVG, 26 px wide, centred at (0, 0)
  double width_px = 0.0;
};

std::vector<LegendEntry> legend_entries(const Plot& plot) {
  std::vector<LegendEntry> entries;
  const auto add = [&](const std::string& name, std::string swatch) {
    if (!name.empty()) entries.push_back({name, std::move(swatch), 33.0 + 18.0 + text_width_px(name)});
  };
  for (const Curve& curve : plot.curves) {
    if (!any_point(plot, curve.x, curve.y)) continue;
    std::string swatch = fmt::format("<line x1=\"0\" y1=\"0\" x2=\"26\" y2=\"0\" {}/>", stroke(curve));
    if (curve.markers && !curve.hidden_markers) swatch += marker(curve, 13.0, 0.0, "");
    add(curve.name, std::move(swatch));
  }
  for (const Band& band : plot.bands) {
    if (!any_point(plot, band.x, band.high)) continue;
    add(band.name, fmt::format("<rect x=\"0\" y=\"-5\" width=\"26\" height=\"10\" fill=\"{}\" fill-opacity=\"0.3\"/>",
                               colour(band.look)));
  }
  for (const Bars& bars : plot.bars) {
    add(bars.name, fmt::format("<rect x=\"7\" y=\"-5\" width=\"12\" height=\"10\" fill=\"{}\"/>", colour(bars.look)));
  }
  std::set<std::string> listed;
  for (const Span& span : plot.spans) {
    if (listed.insert(span.name).second) add(span.name, shaded(0.0, -6.0, 26.0, 12.0, span.shade));
  }
  return entries;
}

/// Legend above the axes, with as many entries per row as fit.
struct Legend {
  std::string svg;
  int rows = 0;
};

Legend legend(const Plot& plot, double left_px, double right_px, double top_px) {
  Legend out;
  double x = right_px, y = top_px - legend_row;
  for (const LegendEntry& entry : legend_entries(plot)) {
    if (x + entry.width_px > right_px + 18.0) {
      x = left_px;
      y += legend_row;
      ++out.rows;
    }
    out.svg += fmt::format("<g transform=\"translate({:.1f} {:.1f})\">{}</g>\n", x, y - 4, entry.swatch);
    out.svg += text_at(x + 33, y, "start", entry.name);
    x += entry.width_px;
  }
  return out;
}

/// Places each name at the first candidate position around its point where it covers no point, line or other name. A
/// thin line connects names that are further away.
std::string point_names(const Plot& plot, const Axis& x, const Axis& y) {
  struct Box {
    double left, top, right, bottom;
    [[nodiscard]] bool overlaps(const Box& other) const {
      return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
    }
  };
  constexpr double height_px = 13.0, gap_px = 6.0;
  std::vector<Box> taken;
  constexpr double marker_px = 3.0, line_px = 1.0;
  const auto take = [&taken](double px, double py, double half_px) {
    taken.push_back({px - half_px, py - half_px, px + half_px, py + half_px});
  };
  for (const Curve& curve : plot.curves) {
    std::optional<std::pair<double, double>> before;
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      if (!x.can_show(curve.x[i]) || !y.can_show(curve.y[i])) {
        before.reset();
        continue;
      }
      const std::pair now(x.px(curve.x[i]), y.px(curve.y[i]));
      if (curve.markers) take(now.first, now.second, marker_px);
      if (before && !curve.points_only) {
        const int pieces = 1 + static_cast<int>(std::hypot(now.first - before->first, now.second - before->second) /
                                                (2.0 * marker_px));
        for (int k = 0; k <= pieces; ++k) {
          const double share = static_cast<double>(k) / pieces;
          take(std::lerp(before->first, now.first, share), std::lerp(before->second, now.second, share), line_px);
        }
      }
      before = now;
    }
  }
  std::string out;
  for (const PointName& one : plot.names) {
    if (!x.can_show(one.x) || !y.can_show(one.y)) continue;
    const double px = x.px(one.x), py = y.px(one.y), width_px = 0.91 * text_width_px(one.name);
    std::optional<Box> place;
    for (int ring = 0; ring < 6 && !place; ++ring) {
      const double away_px = ring * height_px;
      for (const auto& [left, middle] :
           {std::pair(px + gap_px, py), std::pair(px - gap_px - width_px, py), std::pair(px + gap_px, py - away_px),
            std::pair(px + gap_px, py + away_px), std::pair(px - gap_px - width_px, py - away_px),
            std::pair(px - gap_px - width_px, py + away_px), std::pair(px - 0.5 * width_px, py - away_px),
            std::pair(px - 0.5 * width_px, py + away_px)}) {
        const Box box{left, middle - 0.5 * height_px, left + width_px, middle + 0.5 * height_px};
        const bool inside =
            box.left >= x.from_px() && box.right <= x.to_px() && box.top >= y.to_px() && box.bottom <= y.from_px();
        if (!inside || std::any_of(taken.begin(), taken.end(), [&](const Box& b) { return b.overlaps(box); })) continue;
        place = box;
        break;
      }
    }
    if (!place) place = Box{px + gap_px, py - 0.5 * height_px, px + gap_px + width_px, py + 0.5 * height_px};
    taken.push_back(*place);
    const double middle_px = 0.5 * (place->top + place->bottom);
    if (std::abs(middle_px - py) > height_px) {
      out += grid_line(px, py, std::clamp(px, place->left, place->right), middle_px, 0.3);
    }
    out += text_at(place->left, middle_px + 4.0, "start", one.name, " font-size=\"11\"");
  }
  return out;
}

/// Widens one of the ranges so that both axes have the same scale.
void give_same_scale(std::pair<double, double>& x, std::pair<double, double>& y, double width_px, double height_px) {
  const double per_px = std::max((x.second - x.first) / width_px, (y.second - y.first) / height_px);
  const auto widen = [per_px](std::pair<double, double>& range, double px) {
    const double more = 0.5 * (per_px * px - (range.second - range.first));
    range = {range.first - more, range.second + more};
  };
  widen(x, width_px);
  widen(y, height_px);
}

/// Both axes with their pixel ranges, and the legend above them.
struct Frame {
  Axis x, y;
  Legend names;
};

/// Nothing if the plot has no point.
std::optional<Frame> frame_of(const Plot& plot, int width_px, int height_px) {
  Extent x_extent, y_extent;
  const auto include = [&](const std::vector<double>& x, const std::vector<double>& y) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (!can_show(x[i], plot.x_log) || !can_show(y[i], plot.y_log)) continue;
      x_extent.include(x[i]);
      y_extent.include(y[i]);
    }
  };
  for (const Curve& curve : plot.curves) {
    include(curve.x, curve.y);
    std::vector<double> ends(curve.y_half.size());
    for (const double sign : {1.0, -1.0}) {
      // As for a band, the lower end does not count on a logarithmic axis.
      if (sign < 0.0 && plot.y_log) continue;
      for (std::size_t i = 0; i < ends.size(); ++i) ends[i] = curve.y[i] + sign * curve.y_half[i];
      if (!ends.empty()) include(curve.x, ends);
    }
  }
  for (const Band& band : plot.bands) {
    include(band.x, band.high);
    // The lower edge of a band may come close to zero and would dominate a logarithmic axis.
    if (!plot.y_log) include(band.x, band.low);
  }
  for (const Bars& bars : plot.bars) {
    for (std::size_t i = 0; i < bars.heights.size(); ++i) {
      if (bars.heights[i] > 0.0) include({bars.edges[i], bars.edges[i + 1]}, {bars.heights[i], bars.heights[i]});
      if (bars.heights[i] > 0.0 && !plot.y_log) y_extent.include(0.0);
    }
  }
  if (x_extent.empty() || y_extent.empty()) return std::nullopt;
  const double right_px = width_px - margin_right, bottom_px = height_px - margin_bottom;
  // The tick labels determine the left margin, the margin the rows of the legend, and the rows the ticks: iterate.
  double left_px = margin_left_min;
  for (int round = 0;; ++round) {
    std::pair<double, double> x_range = plot.x_range.value_or(x_extent.padded(plot.x_log));
    std::pair<double, double> y_range = plot.y_range.value_or(y_extent.padded(plot.y_log));
    Legend names = legend(plot, left_px, right_px, margin_top + 2);
    const double top_px = margin_top + legend_row * names.rows;
    if (plot.same_scale) give_same_scale(x_range, y_range, right_px - left_px, bottom_px - top_px);
    const Axis x(x_range.first, x_range.second, plot.x_log, left_px, right_px);
    const Axis y(y_range.first, y_range.second, plot.y_log, bottom_px, top_px);
    double needed_px = margin_left_min;
    for (const double tick : y.ticks()) {
      needed_px = std::max(needed_px, y_title_px + tick_gap + text_width_px(number_text(tick)));
    }
    if (needed_px <= left_px || round == 2) return Frame{x, y, std::move(names)};
    left_px = std::ceil(needed_px);
  }
}

}  // namespace

std::string colour(Look look) {
  switch (look) {
    case Look::reference:
      return "#1f77b4";
    case Look::fast:
      return "#e4600a";
    case Look::plain:
      return "#6a51a3";
    case Look::outline:
      return "#8a8a8a";
    case Look::inclusion:
      return "#a03070";
    case Look::first:
      return "#e4600a";
    case Look::second:
      return "#1f77b4";
    case Look::third:
      return "#2e8b57";
  }
  return "";
}

std::string svg_opening(const std::string& title, int width_px, int height_px) {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" "
      "font-family=\"system-ui, sans-serif\" font-size=\"12\" role=\"img\">\n<title>{2}</title>\n",
      width_px, height_px, escape_xml(title));
}

std::pair<double, double> x_axis_px(const Plot& plot, int width_px, int height_px) {
  const std::optional<Frame> frame = frame_of(plot, width_px, height_px);
  return frame ? std::pair(frame->x.from_px(), frame->x.to_px())
               : std::pair<double, double>(margin_left_min, width_px - margin_right);
}

BandSeen band_seen(const Plot& plot, const Band& band, int width_px, int height_px) {
  const std::optional<Frame> frame = frame_of(plot, width_px, height_px);
  if (!frame || !any_point(plot, band.x, band.high)) return BandSeen::nowhere;
  constexpr double line_px = 4.0;  // the outline makes the line wide enough to see
  for (std::size_t i = 0; i < band.x.size(); ++i) {
    if (!frame->x.can_show(band.x[i]) || !frame->y.can_show(band.high[i]) || !std::isfinite(band.low[i])) continue;
    const double low = frame->y.log() ? std::max(band.low[i], frame->y.low()) : band.low[i];
    if (frame->y.px(low) - frame->y.px(band.high[i]) > line_px) return BandSeen::area;
  }
  return BandSeen::narrower_than_the_line;
}

std::vector<double> nice_ticks(double low, double high, int wanted) {
  const double raw = (high - low) / wanted;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  double step = 10.0 * power;
  for (const double factor : {5.0, 2.0, 1.0}) {
    if (factor * power >= raw * (1.0 - 1e-9)) step = factor * power;
  }
  std::vector<double> ticks;
  const double slack = 1e-9 * (high - low);
  for (double n = std::ceil((low - slack) / step); n * step <= high + slack; ++n) ticks.push_back(n * step);
  return ticks;
}

std::string to_svg(const Plot& plot, int width_px, int height_px) {
  std::string out = svg_opening(plot.title, width_px, height_px);
  out += text_at(0.5 * width_px, 20, "middle", plot.title, " font-size=\"14\" font-weight=\"600\"");
  const std::optional<Frame> frame = frame_of(plot, width_px, height_px);
  if (!frame) {
    return out + text_at(0.5 * width_px, 0.5 * height_px, "middle", "nothing to show") + "</svg>\n";
  }
  const auto& [x, y, names] = *frame;
  const double left_px = x.from_px(), right_px = x.to_px(), top_px = y.to_px(), bottom_px = y.from_px();

  out += axes(plot, x, y);
  out += names.svg;
  // A nested viewport clips what lies outside the axes; a marker on the edge is drawn whole.
  const double edge = 4.0;
  out += fmt::format(
      "<svg x=\"{0:.1f}\" y=\"{1:.1f}\" width=\"{2:.1f}\" height=\"{3:.1f}\" viewBox=\"{0:.1f} {1:.1f} {2:.1f} "
      "{3:.1f}\" "
      "overflow=\"hidden\">\n",
      left_px - edge, top_px - edge, right_px - left_px + 2 * edge, bottom_px - top_px + 2 * edge);
  for (const Span& span : plot.spans) out += span_area(span, x, y);
  for (const Band& band : plot.bands) out += band_area(band, x, y);
  for (const Bars& bars : plot.bars) out += bar_areas(bars, plot, x, y);
  for (const Curve& curve : plot.curves) out += curve_line(curve, x, y);
  for (const Curve& curve : plot.curves) out += error_bars(curve, x, y);
  for (const Curve& curve : plot.curves) {
    if (curve.markers) out += curve_markers(curve, plot, x, y);
  }
  out += point_names(plot, x, y);
  if (plot.cursor) {
    out += fmt::format(
        "<line class=\"cursor\" x1=\"{0:.1f}\" y1=\"{1}\" x2=\"{0:.1f}\" y2=\"{2:.1f}\" stroke=\"currentColor\" "
        "stroke-width=\"1.5\"/>\n",
        x.px(*plot.cursor), top_px, bottom_px);
  }
  return out + "</svg>\n</svg>\n";
}

std::string in_rows(const std::string& title, const std::vector<std::string>& svgs, int columns, int width_px,
                    int height_px) {
  const int count = static_cast<int>(svgs.size());
  std::string out =
      svg_opening(title, width_px * std::min(columns, count), height_px * ((count + columns - 1) / columns));
  for (int i = 0; i < count; ++i) {
    out += fmt::format("<g transform=\"translate({} {})\">\n{}</g>\n", width_px * (i % columns),
                       height_px * (i / columns), svgs[static_cast<std::size_t>(i)]);
  }
  return out + "</svg>\n";
}

std::string as_file(const std::string& svg) {
  constexpr std::string_view opening = "<svg ", title_end = "</title>\n";
  const std::size_t ground = svg.find(title_end) + title_end.size();
  return fmt::format("{}color=\"#1c1e21\" {}<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n{}", opening,
                     svg.substr(opening.size(), ground - opening.size()), svg.substr(ground));
}

}  // namespace touchstone::compare
