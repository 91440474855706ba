// SPDX-License-Identifier: Apache-2.0
#include "cli/pages/evaluation_tables.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

namespace rsstab::cli {
namespace {

using evaluation::MethodSummary;
using evaluation::PictureMethodSummary;
using report::ChartSeries;
using report::LineChart;
using report::Table;
using report::TableCell;

constexpr double kPercent = 100.0;

// A column of a table of methods. One without any value is left out.
template <typename Summary>
struct Column {
  const char* heading;
  int digits;
  int better;  // -1: lower values are, 1: higher ones, 0: neither
  double (*value)(const Summary& summary);
  // The end of an interval that begins at `value`.
  double (*until)(const Summary& summary) = nullptr;
};

std::string Number(double value, int digits) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, digits) : "\u2013";
}

// The best value of a column among `methods`; NaN where no value is better than another.
template <typename Summary>
double BestOf(const std::vector<Summary>& methods, const Column<Summary>& column) {
  double best = std::nan("");
  for (const Summary& method : methods) {
    const double value = column.value(method);
    if (column.better != 0 && std::isfinite(value) &&
        (!std::isfinite(best) || column.better * (value - best) > 0.0)) {
      best = value;
    }
  }
  return best;
}

template <typename Summary>
TableCell CellOf(const Summary& method, const Column<Summary>& column, double best) {
  const double value = column.value(method);
  if (column.until == nullptr || !std::isfinite(value)) {
    return {Number(value, column.digits), value == best};
  }
  return {Number(value, column.digits) + " to " + Number(column.until(method), column.digits)};
}

template <typename Summary>
Table MakeTable(std::string caption, const std::vector<Summary>& methods,
                const std::vector<Column<Summary>>& columns) {
  Table table;
  table.caption = std::move(caption);
  table.headings = {"method"};
  std::vector<std::pair<Column<Summary>, double>> shown;  // with the best value
  for (const auto& column : columns) {
    if (std::any_of(methods.begin(), methods.end(),
                    [&](const Summary& method) { return std::isfinite(column.value(method)); })) {
      shown.emplace_back(column, BestOf(methods, column));
      table.headings.push_back(column.heading);
    }
  }
  for (const Summary& method : methods) {
    std::vector<TableCell> row = {{method.method}};
    for (const auto& [column, best] : shown) {
      row.push_back(CellOf(method, column, best));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

const std::vector<Column<MethodSummary>>& SyntheticColumns() {
  using S = MethodSummary;
  static const std::vector<Column<S>> columns = {
      {"EPE, px", 2, -1, [](const S& s) { return s.epe_px; }},
      {"median", 2, -1, [](const S& s) { return s.epe_median_px; }},
      {"worst 10 %", 2, -1, [](const S& s) { return s.epe_p90_px; }},
      {"left, %", 1, -1, [](const S& s) { return kPercent * s.epe_ratio; }},
      {"sideways, px", 2, -1, [](const S& s) { return s.horizontal_px; }},
      {"up and down, px", 2, -1, [](const S& s) { return s.vertical_px; }},
      {"PSNR, dB", 2, 1, [](const S& s) { return s.psnr_db; }},
      {"SSIM", 3, 1, [](const S& s) { return s.ssim; }},
      {"ms", 1, 0, [](const S& s) { return s.ms; }}};
  return columns;
}

const std::vector<Column<PictureMethodSummary>>& PictureColumns() {
  using S = PictureMethodSummary;
  static const std::vector<Column<S>> columns = {
      {"EPE, px", 2, -1, [](const S& s) { return s.epe_px.mean; }},
      {"95 % interval", 2, 0, [](const S& s) { return s.epe_px.interval.low; },
       [](const S& s) { return s.epe_px.interval.high; }},
      {"median", 2, -1, [](const S& s) { return s.epe_median_px; }},
      {"worst 10 %", 2, -1, [](const S& s) { return s.epe_p90_px; }},
      {"PSNR, dB", 2, 1, [](const S& s) { return s.psnr_db.mean; }},
      {"SSIM", 3, 1, [](const S& s) { return s.ssim.mean; }},
      {"flicker, px", 2, -1, [](const S& s) { return s.flicker_px.mean; }},
      {"ms", 1, 0, [](const S& s) { return s.ms; }},
      {"pictures", 0, 0, [](const S& s) { return static_cast<double>(s.pictures); }}};
  return columns;
}

// `errors`: one list for each method, NaN = not known.
std::vector<LineChart> Cumulative(const std::vector<std::string>& methods,
                                  std::vector<std::vector<double>> errors) {
  LineChart chart;
  chart.title = "How many pictures come how close";
  chart.description =
      "For each method, the share of the pictures whose end-point error is at most so large.";
  chart.x_label = "end-point error, px";
  chart.y_label = "% of the pictures";
  chart.include_zero = true;
  double largest = 0.0;
  for (const auto& values : errors) {
    for (const double value : values) {
      largest = std::isfinite(value) ? std::max(largest, value) : largest;
    }
  }
  bool any = false;
  for (std::size_t m = 0; m < methods.size(); ++m) {
    std::vector<double>& values = errors[m];
    std::erase_if(values, [](double value) { return !std::isfinite(value); });
    std::sort(values.begin(), values.end());
    ChartSeries series;
    series.name = methods[m];
    series.points.emplace_back(0.0, 0.0);
    for (std::size_t i = 0; i < values.size(); ++i) {
      series.points.emplace_back(
          values[i], kPercent * static_cast<double>(i + 1) / static_cast<double>(values.size()));
    }
    series.points.emplace_back(largest, kPercent);
    any = any || !values.empty();
    if (!values.empty()) {
      chart.series.push_back(std::move(series));
    }
  }
  return any ? std::vector<LineChart>{std::move(chart)} : std::vector<LineChart>{};
}

// Both reports hold, for each picture, the figures of each method in one order.
template <typename Records>
std::vector<LineChart> ChartsOf(const Records& records) {
  std::vector<std::string> methods;
  std::vector<std::vector<double>> errors;
  for (const auto& record : records) {
    for (std::size_t m = 0; m < record.methods.size(); ++m) {
      if (m == methods.size()) {
        methods.push_back(record.methods[m].method);
        errors.emplace_back();
      }
      errors[m].push_back(record.methods[m].epe_px);
    }
  }
  return Cumulative(methods, std::move(errors));
}

}  // namespace

std::vector<Table> FigureTables(const SyntheticReport& report) {
  std::vector<Table> tables;
  for (const evaluation::GroupSummary& group : report.groups) {
    tables.push_back(MakeTable(
        fmt::format("{} motion{}, {} pictures", group.motion,
                    group.structured_only ? ", structured photographs" : "", group.pictures),
        group.methods, SyntheticColumns()));
  }
  return tables;
}

std::vector<Table> FigureTables(const PictureReport& report) {
  std::vector<Table> tables;
  for (const evaluation::PictureGroup& group : report.groups) {
    tables.push_back(MakeTable(fmt::format("{}, {} pictures", group.title, group.pictures),
                               group.Asked(), PictureColumns()));
  }
  return tables;
}

std::vector<LineChart> ErrorCharts(const SyntheticReport& report) {
  std::vector<evaluation::SampleRecord> moving;
  std::copy_if(report.samples.begin(), report.samples.end(), std::back_inserter(moving),
               [](const evaluation::SampleRecord& sample) {
                 return sample.motion_class != evaluation::MotionClass::kStill;
               });
  return ChartsOf(moving);
}

std::vector<LineChart> ErrorCharts(const PictureReport& report) { return ChartsOf(report.records); }

std::vector<LineChart> SkewCharts(const SyntheticReport& report) {
  if (report.skew.photos == 0) {
    return {};
  }
  LineChart chart;
  chart.title = "Answer to a known skew";
  chart.description =
      "Predicted against true skew, first row to last row; the ideal is the dashed "
      "line.";
  chart.x_label = "true, px";
  chart.y_label = "predicted, px";
  ChartSeries ideal;
  ideal.name = "ideal";
  ideal.dashed = true;
  ChartSeries answer;
  answer.name = "predicted";
  answer.markers = true;
  report::ChartBand band;
  band.name = "standard error";
  for (const evaluation::SkewLevel& level : report.skew.levels) {
    ideal.points.emplace_back(level.true_px, level.true_px);
    answer.points.emplace_back(level.true_px, level.predicted_px);
    band.x.push_back(level.true_px);
    band.low.push_back(level.predicted_px - level.predicted_error_px);
    band.high.push_back(level.predicted_px + level.predicted_error_px);
  }
  chart.series = {std::move(ideal), std::move(answer)};
  chart.band = std::move(band);
  return {std::move(chart)};
}

}  // namespace rsstab::cli
