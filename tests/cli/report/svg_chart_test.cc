// SPDX-License-Identifier: Apache-2.0
#include "cli/report/svg_chart.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace rsstab::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

LineChart Ramp() {
  LineChart chart;
  chart.title = "Residual";
  chart.description = "It rises.";
  chart.x_label = "readout, ms";
  chart.y_label = "px";
  chart.series = {{"tracks", {{0, 0}, {10, 1}, {20, 2}}}};
  return chart;
}

// The points of the n-th path of a class, "x y x y ...", gaps left in as letters.
std::string PathOf(const std::string& svg, const std::string& css_class, int n = 0) {
  // The legend's samples come first; they start at M0.
  const std::string begin = "<path class=\"" + css_class + "\" d=\"";
  for (auto at = svg.find(begin); at != std::string::npos; at = svg.find(begin, at + 1)) {
    const std::string d =
        svg.substr(at + begin.size(), svg.find('"', at + begin.size()) - at - begin.size());
    if (d.size() > 1 && d[0] == 'M' && d[1] >= '1' && d[1] <= '9' && n-- == 0) {
      return d;
    }
  }
  return "";
}

std::vector<Eigen::Vector2d> PointsOf(const std::string& path) {
  std::vector<Eigen::Vector2d> points;
  std::string numbers = path;
  std::replace_if(
      numbers.begin(), numbers.end(), [](char c) { return c >= 'A' && c <= 'z'; }, ' ');
  std::istringstream stream(numbers);
  for (double x = 0.0, y = 0.0; stream >> x >> y;) {
    points.emplace_back(x, y);
  }
  return points;
}

TEST(SvgChart, LargerValuesStandHigherAndFurtherRight) {
  const auto points = PointsOf(PathOf(ChartElement(Ramp(), "a"), "line c1"));
  ASSERT_EQ(points.size(), 3U);
  EXPECT_LT(points[0].x(), points[1].x());
  EXPECT_GT(points[0].y(), points[1].y());  // y grows downwards in SVG
  EXPECT_NEAR(points[1].x() - points[0].x(), points[2].x() - points[1].x(), 0.11);
  EXPECT_NEAR(points[1].y() - points[0].y(), points[2].y() - points[1].y(), 0.11);
}

TEST(SvgChart, TellsItsMeaningWithoutBeingSeen) {
  const std::string svg = ChartElement(Ramp(), "a");
  EXPECT_THAT(svg, HasSubstr("role=\"img\""));
  EXPECT_THAT(svg, HasSubstr("aria-labelledby=\"a-t a-d\""));
  EXPECT_THAT(svg, HasSubstr("<title id=\"a-t\">Residual</title>"));
  EXPECT_THAT(svg, HasSubstr("<desc id=\"a-d\">It rises.</desc>"));
  for (const char* text : {">tracks<", ">readout, ms<", "px<", ">20<"}) {
    EXPECT_THAT(svg, HasSubstr(text));
  }
}

TEST(SvgChart, EscapesEveryText) {
  LineChart chart = Ramp();
  const std::string evil = "<script>\"&";
  chart.title = chart.description = chart.x_label = chart.y_label = evil;
  chart.series[0].name = evil;
  chart.band = ChartBand{evil, {0, 20}, {0, 1}, {1, 2}};
  chart.marks = {{5, evil}};
  const std::string svg = ChartElement(chart, "a");
  EXPECT_THAT(svg, Not(HasSubstr("<script>")));
  EXPECT_THAT(svg, Not(HasSubstr("\"&\"")));
}

TEST(SvgChart, GapsInterruptTheLine) {
  LineChart chart = Ramp();
  chart.series[0].points.insert(chart.series[0].points.begin() + 2,
                                {15, std::numeric_limits<double>::quiet_NaN()});
  const std::string path = PathOf(ChartElement(chart, "a"), "line c1");
  EXPECT_EQ(std::count(path.begin(), path.end(), 'M'), 2);
  EXPECT_THAT(path, Not(HasSubstr("nan")));
}

TEST(SvgChart, LongSeriesAreThinnedWithoutLosingASpike) {
  LineChart chart = Ramp();
  chart.series[0].points.clear();
  constexpr int kPoints = 200000;
  constexpr int kSpike = 123457;
  for (int i = 0; i < kPoints; ++i) {
    chart.series[0].points.emplace_back(i, i == kSpike ? 10.0 : std::sin(0.1 * i));
  }
  const std::string svg = ChartElement(chart, "a");
  EXPECT_LT(svg.size(), 40000U);
  const auto points = PointsOf(PathOf(svg, "line c1"));
  const auto highest = std::min_element(points.begin(), points.end(),
                                        [](auto& a, auto& b) { return a.y() < b.y(); });
  const double place =
      (highest->x() - points.front().x()) / (points.back().x() - points.front().x());
  EXPECT_NEAR(place, static_cast<double>(kSpike) / kPoints, 1e-3);
  EXPECT_LT(highest->y(), points.front().y() - 100.0);
}

TEST(SvgChart, ReachesZeroWhereAsked) {
  LineChart chart = Ramp();
  chart.series[0].points = {{0, 90}, {1, 100}};
  EXPECT_THAT(ChartElement(chart, "a"), Not(HasSubstr("class=\"zero\"")));
  chart.include_zero = true;
  EXPECT_THAT(ChartElement(chart, "a"), HasSubstr("class=\"zero\""));
}

TEST(SvgChart, BandEnclosesItsArea) {
  LineChart chart = Ramp();
  chart.band = ChartBand{"95 %", {0, 10, 20}, {0, 0.5, 1}, {1, 2, 3}};
  const auto points = PointsOf(PathOf(ChartElement(chart, "a"), "band"));
  ASSERT_EQ(points.size(), 6U);  // there along the upper values, back along the lower
  EXPECT_LT(points[0].y(), points[5].y());
  EXPECT_EQ(points[0].x(), points[5].x());
}

TEST(SvgChart, SaysWhenThereIsNothing) {
  LineChart chart = Ramp();
  chart.series.clear();
  EXPECT_THAT(ChartElement(chart, "a"), HasSubstr("nothing was measured"));
}

TEST(SvgChart, FileStandsAlone) {
  const std::string svg = ChartFile(Ramp());
  EXPECT_EQ(svg.rfind("<svg xmlns=", 0), 0U);
  EXPECT_THAT(svg, HasSubstr("prefers-color-scheme:dark"));
  EXPECT_THAT(svg, HasSubstr("var(--line-1)"));
}

}  // namespace
}  // namespace rsstab::report
