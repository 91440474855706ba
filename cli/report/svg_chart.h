// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_REPORT_SVG_CHART_H_
#define RSSTAB_CLI_REPORT_SVG_CHART_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rsstab::report {

// One line of a chart. Points are (x, y) in the units of the axes, x rising; a point that is not
// finite interrupts the line.
struct ChartSeries {
  std::string name;  // for the legend; empty: not in it
  std::vector<Eigen::Vector2d> points;
  bool dashed = false;
  bool markers = false;  // a dot on every point, for few measured values
};

// The area between two values over x, drawn behind the lines (a confidence band).
struct ChartBand {
  std::string name;
  std::vector<double> x;
  std::vector<double> low;
  std::vector<double> high;
};

// A dashed vertical line with a label at its top, for one distinguished x.
struct ChartMark {
  double x = 0.0;
  std::string label;
};

struct LineChart {
  std::string title;        // shown above
  std::string description;  // one sentence for those who cannot see it
  std::string x_label;      // with the unit: "time, s"
  std::string y_label;      // "px"
  std::vector<ChartSeries> series;
  std::optional<ChartBand> band;
  std::vector<ChartMark> marks;
  bool include_zero = false;  // the y axis reaches zero
  int width = 400;            // units that become CSS px at the chart's own size
  int height = 250;
};

// The chart as an <svg> element to stand inside an HTML page that holds ChartStyle(). Long series
// are thinned to what the width can show: the smallest and largest value of each unit stay, so that
// no spike is lost. `id` makes the element's ids unique on the page (letters, digits, hyphens).
[[nodiscard]] std::string ChartElement(const LineChart& chart, std::string_view id);

// The same as an SVG file of its own; light or dark as the viewer prefers.
[[nodiscard]] std::string ChartFile(const LineChart& chart);

// CSS rules of the charts, and of the custom properties (colours) that they use:
// --paper, --ink, --faint, --grid, --line-1 .. --line-6.
[[nodiscard]] std::string_view ChartStyle();
// CSS that sets those properties on `:root`, with the dark ones under prefers-color-scheme.
[[nodiscard]] std::string_view ColorStyle();

}  // namespace rsstab::report

#endif  // RSSTAB_CLI_REPORT_SVG_CHART_H_
