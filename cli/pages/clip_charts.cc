// SPDX-License-Identifier: Apache-2.0
#include "cli/pages/clip_charts.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

namespace rsstab::cli {
namespace {

using report::ChartSeries;
using report::LineChart;
using stabilizer::PicturePose;

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kPercent = 100.0;
const char* const kTime = "time, s";

LineChart Chart(std::string title, std::string unit, std::string description) {
  LineChart chart;
  chart.title = std::move(title);
  chart.description = std::move(description);
  chart.x_label = kTime;
  chart.y_label = std::move(unit);
  return chart;
}

ChartSeries PathSeries(const char* name, const CompareReport::Clip& clip,
                       const std::function<double(const PicturePose&)>& value) {
  ChartSeries series;
  series.name = name;
  for (std::size_t n = 0; n < clip.poses.size(); ++n) {
    series.points.emplace_back(static_cast<double>(n) / clip.frames_per_second,
                               value(clip.poses[n]));
  }
  return series;
}

ChartSeries MomentSeries(const std::vector<RsMoment>& moments, double RsMoment::*value,
                         double scale = 1.0) {
  ChartSeries series;
  for (const RsMoment& moment : moments) {
    series.points.emplace_back(moment.time_s, scale * moment.*value);
  }
  return series;
}

// How far a value would be off if the readout time were by one standard deviation: as a share of
// it, 0 where it is exact or there is none.
double ReadoutUncertainty(const stabilizer::ClipAnalysis& analysis) {
  return analysis.readout_s != 0.0 ? analysis.readout_sigma_s / std::abs(analysis.readout_s) : 0.0;
}

// Its legend tells how wide it gets, since that can be less than the line's own width.
std::optional<report::ChartBand> BandAround(const ChartSeries& series, double share,
                                            const char* unit) {
  if (!(share > 0.0)) {
    return std::nullopt;
  }
  report::ChartBand band;
  double widest = 0.0;
  for (const Eigen::Vector2d& point : series.points) {
    const double reach = share * std::abs(point.y());
    widest = std::max(widest, reach);
    band.x.push_back(point.x());
    band.low.push_back(point.y() - reach);
    band.high.push_back(point.y() + reach);
  }
  band.name =
      fmt::format("\u00b1 1 standard deviation of the readout: {:.2f} {} at most", widest, unit);
  return band;
}

}  // namespace

std::vector<LineChart> PathCharts(const CompareReport& report) {
  struct Part {
    const char* title;
    const char* unit;
    std::function<double(const PicturePose&)> value;
  };
  const std::vector<Part> parts = {
      {"Sideways", "px to the right", [](const PicturePose& p) { return p.position.x(); }},
      {"Up and down", "px down", [](const PicturePose& p) { return p.position.y(); }},
      {"Rotation", "degrees clockwise",
       [](const PicturePose& p) { return kDegrees * p.angle_rad; }},
      {"Zoom", "% of the first frame", [](const PicturePose& p) { return kPercent * p.scale; }}};
  std::vector<LineChart> charts;
  for (const Part& part : parts) {
    LineChart chart = Chart(part.title, part.unit,
                            "How the picture's content moved since the first frame, before and "
                            "after.");
    chart.series = {PathSeries("before", report.input, part.value),
                    PathSeries("after", report.output, part.value)};
    charts.push_back(std::move(chart));
  }
  return charts;
}

std::vector<LineChart> RsCharts(const std::vector<RsMoment>& moments,
                                const stabilizer::ClipAnalysis& analysis) {
  const double uncertainty = ReadoutUncertainty(analysis);
  std::vector<LineChart> charts;
  const auto add = [&](const char* title, const char* unit, const char* description,
                       ChartSeries series) -> LineChart& {
    charts.push_back(Chart(title, unit, description));
    charts.back().series = {ChartSeries{}, std::move(series)};  // in the colour of what was done
    return charts.back();
  };
  const auto add_motion = [&](const char* title, const char* axis, const char* unit,
                              const char* description, double RsMoment::*value) {
    LineChart& chart = add(title, axis, description, MomentSeries(moments, value));
    chart.band = BandAround(chart.series.back(), uncertainty, unit);
    chart.include_zero = true;
  };
  add_motion("Skew", "px, last row further right", "px",
             "How much further right the last row of each frame was recorded than the first.",
             &RsMoment::sideways_px);
  add_motion("Stretch", "px, last row further down", "px",
             "How much further down the last row of each frame was recorded than the first.",
             &RsMoment::upright_px);
  add_motion("Twist", "degrees clockwise", "degrees",
             "How far the last row of each frame is turned against the first.",
             &RsMoment::turn_deg);
  add("Kept of each side", "%", "How much of the picture's width and height is shown.",
      MomentSeries(moments, &RsMoment::kept_ratio, kPercent));
  return charts;
}

std::vector<LineChart> TruthCharts(const CompareReport& report) {
  if (!report.input.truth || !report.output.truth) {
    return {};
  }
  const auto series = [](const char* name, const CompareReport::Clip& clip) {
    ChartSeries result;
    result.name = name;
    for (std::size_t n = 0; n < clip.truth->frame_residual.size(); ++n) {
      result.points.emplace_back(static_cast<double>(n) / clip.frames_per_second,
                                 clip.truth->frame_residual[n]);
    }
    return result;
  };
  LineChart chart = Chart("Camera residual", "px",
                          "How far each frame is from what a global shutter would have seen.");
  chart.series = {series("before", report.input), series("after", report.output)};
  chart.include_zero = true;
  return {std::move(chart)};
}

}  // namespace rsstab::cli
