// Line plots as SVG text, for a page without any library, display or script.
// Text and axes take the page's text colour; every marker shows its numbers when pointed at.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace touchstone::compare {

/// A point that is not there.
inline constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

/// Colours that the colour-blind can distinguish, on white and on black (Okabe and Ito, without yellow and black).
inline constexpr std::array palette = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00"};

/// What a curve shows; fixes colour and dash so that a side looks the same in every figure and in grey print. The
/// last three distinguish curves of one solver.
enum class Look { reference, fast, plain, outline, inclusion, first, second, third };

/// One curve; a point that is not finite, or not positive on a logarithmic axis, interrupts it.
struct Curve {
  std::string name;  ///< in the legend where a point is drawn; empty: not listed
  Look look = Look::plain;
  std::vector<double> x, y;
  bool markers = true;
  bool filled = false;          ///< the area within, holes left out
  std::string own_colour{};     ///< "#rrggbb" in place of the look's, where one side has many curves
  bool points_only = false;     ///< small markers and no line
  bool hidden_markers = false;  ///< found by a pointer only, where points lie close together
  /// Half height of a bar about each point, NaN where it is not known: the marker is then hollow. Empty: no bars.
  std::vector<double> y_half = {};
};

/// Area between two curves over x.
struct Band {
  std::string name;
  Look look = Look::reference;
  std::vector<double> x, low, high;
};

/// Columns side by side, such as a histogram's.
struct Bars {
  std::string name;
  Look look = Look::plain;
  std::vector<double> edges;    ///< ascending, one more than heights
  std::vector<double> heights;  ///< from the foot of the axis; zero draws nothing
};

/// A stretch of x, shaded over the whole height.
struct Span {
  std::string name;  ///< in the legend, once for all spans of that name
  double from = 0.0, to = 0.0;
  double shade = 0.1;  ///< 0 to 1, of the text's colour
};

/// A name beside a point, at a free place.
struct PointName {
  std::string name;
  double x = 0.0, y = 0.0;
};

struct Plot {
  std::string title;
  std::string x_label, y_label;  ///< with unit
  bool x_log = false, y_log = false;
  bool same_scale = false;                                    ///< x and y to one scale, for drawings
  std::optional<std::pair<double, double>> x_range, y_range;  ///< otherwise what the curves need
  std::optional<double> cursor;                               ///< an x marked by a line of class "cursor", for a script
  std::vector<Span> spans;
  std::vector<Band> bands;
  std::vector<Curve> curves;
  std::vector<PointName> names = {};
  std::vector<Bars> bars = {};
};

/// @returns one `<svg>` element, well-formed XML; without any point to draw it shows "nothing to show"
[[nodiscard]] std::string to_svg(const Plot& plot, int width_px = 560, int height_px = 360);

/// Where the x axis of such an element begins and ends [px].
[[nodiscard]] std::pair<double, double> x_axis_px(const Plot& plot, int width_px, int height_px);

/// Begins an `<svg>` element: its size, font and title; `</svg>` ends it.
[[nodiscard]] std::string svg_opening(const std::string& title, int width_px, int height_px);

/// Several `<svg>` elements of one size as one, `columns` to a row.
[[nodiscard]] std::string in_rows(const std::string& title, const std::vector<std::string>& svgs, int columns,
                                  int width_px, int height_px);

/// How a band appears in the plot: not at all, narrower than its line, or as an area.
enum class BandSeen { nowhere, narrower_than_the_line, area };
[[nodiscard]] BandSeen band_seen(const Plot& plot, const Band& band, int width_px = 560, int height_px = 360);

/// The same `<svg>` element as a file: dark on white, independent of a page's colours.
[[nodiscard]] std::string as_file(const std::string& svg);

/// Colour of a look, "#rrggbb".
[[nodiscard]] std::string colour(Look look);

/// Evenly spaced round numbers within a range, about `wanted` of them.
[[nodiscard]] std::vector<double> nice_ticks(double low, double high, int wanted);

}  // namespace touchstone::compare
