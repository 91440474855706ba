// SPDX-License-Identifier: Apache-2.0
#include "cli/pages/page_parts.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <utility>

#include "cli/report/difference_map.h"
#include "cli/report/preview.h"
#include "stabilizer/pipeline/version.h"

namespace rsstab::cli {
namespace {

const char* LensName(LensModel model) {
  switch (model) {
    case LensModel::kPinhole:
      return "pinhole";
    case LensModel::kFisheye:
      return "fisheye";
    case LensModel::kBrown:
      return "Brown distortion";
  }
  return "unknown";
}

}  // namespace

std::string ReadoutText(double readout_s, double sigma_s) {
  constexpr double kMilliseconds = 1000.0;
  const std::string sigma =
      sigma_s > 0.0 ? fmt::format(" \u00b1 {:.1f}", kMilliseconds * sigma_s) : "";
  return fmt::format("{:.1f}{} ms, {}", std::abs(readout_s) * kMilliseconds, sigma,
                     readout_s < 0.0 ? "last row first" : "first row to last");
}

std::string CameraText(const Camera& camera) {
  return fmt::format("{}, focal length {:.0f} px at {} \u00d7 {}", LensName(camera.model),
                     camera.fx, camera.width, camera.height);
}

std::string ClipText(const media::VideoInfo& info) {
  std::string text =
      fmt::format("{}: {}, {} \u00d7 {}, {:.5g} frames/s, {}", info.path, info.codec, info.width,
                  info.height, info.frame_rate.Value(), info.pixel_format);
  text += info.variable_frame_rate ? ", variable frame rate" : "";
  text += info.timestamps_repaired ? ", timestamps repaired" : "";
  text += info.interlaced ? ", interlaced" : "";
  return text;
}

int QuarterTurns(const media::VideoInfo& info) {
  constexpr double kQuarter = 90.0;
  return static_cast<int>(std::lround(info.rotation_degrees / kQuarter));
}

report::Table FiguresTable(const CompareReport& report) {
  report::Table table;
  table.headings = {"", "before", "after", "", ""};
  table.has_notes = true;
  for (const CompareFigure& figure : CompareFigures(report)) {
    if (!figure.output && figure.better == Better::kNeither) {
      continue;  // not asked for
    }
    const auto cell = [&](const std::optional<double>& value, const std::optional<double>& other) {
      report::TableCell result{value ? fmt::format("{:.{}f}", *value, figure.digits) : "\u2013"};
      if (value && other && figure.better != Better::kNeither) {
        result.best = figure.better == Better::kLower ? *value < *other : *value > *other;
      }
      return result;
    };
    const bool is_part = figure.name.starts_with("  ");
    table.rows.push_back({{is_part ? "\u2003" + figure.name.substr(2) : figure.name},
                          cell(figure.input, figure.output),
                          cell(figure.output, figure.input),
                          {figure.unit},
                          {figure.meaning}});
  }
  return table;
}

Result<report::ColorKey> DifferenceColorKey() {
  const auto key = report::DifferenceKey();
  if (!key) {
    return Propagate(key.error());
  }
  auto uri = DataUri(key->View(), report::PictureFormat::kPng);
  if (!uri) {
    return Propagate(uri.error());
  }
  return report::ColorKey{
      std::move(*uri), false, "the same",
      fmt::format("{} of 255 grey levels apart, or more", report::kFullDifference)};
}

void AddStages(const std::vector<StageTime>& stages, std::int64_t items, const std::string& unit,
               report::HtmlPage& html) {
  constexpr double kMilliseconds = 1000.0;
  if (stages.empty()) {
    return;
  }
  std::vector<report::Share> shares;
  double total = 0.0;
  const auto text = [items, &unit](double seconds) {
    return fmt::format("{:.2f} s", seconds) +
           (items > 0 ? fmt::format(", {:.1f} ms a {}",
                                    kMilliseconds * seconds / static_cast<double>(items), unit)
                      : "");
  };
  for (const StageTime& stage : stages) {
    shares.push_back({stage.name, stage.seconds, text(stage.seconds)});
    total += stage.seconds;
  }
  html.AddHeading("Time", "All in all " + text(total) + "; wall time.");
  if (shares.size() > 1) {
    html.Add(shares);
  }
}

std::string ProgramName() { return std::string("rs-stabilize ") + pipeline::kProgramVersion; }

std::string PageFooter() {
  return "Written by " + ProgramName() +
         ". This page is one file: nothing in it was or will be fetched from elsewhere.";
}

}  // namespace rsstab::cli
