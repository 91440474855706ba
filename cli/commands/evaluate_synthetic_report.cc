// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "cli/commands/evaluate_report_detail.h"
#include "cli/commands/evaluate_synthetic.h"

namespace rsstab::cli {
namespace {

using detail::Cell;
using detail::Dump;
using detail::Field;
using detail::HeaderJson;
using detail::HeaderText;
using detail::IntervalText;
using detail::Json;
using detail::kPercent;
using detail::OrNull;
using detail::ToJson;
using evaluation::GroupSummary;
using evaluation::MethodScore;
using evaluation::MethodSummary;
using evaluation::SkewLevel;
using evaluation::SkewResponse;

std::string GroupTitle(const GroupSummary& group) {
  return fmt::format("{}{}, {} pictures", group.motion,
                     group.structured_only ? ", structured photos" : "", group.pictures);
}

std::string GroupText(const GroupSummary& group) {
  std::size_t width = 12;
  for (const MethodSummary& m : group.methods) {
    width = std::max(width, m.method.size() + 2);
  }
  std::string text = fmt::format(
      "\n{}\n{:<{}}{:>5}{:>7}{:>8}{:>7}{:>6}{:>7}{:>6}{:>7}{:>6}{:>9}{:>18}{:>7}{:>7}{:>8}{:>8}\n",
      GroupTitle(group), "method", width, "left", "EPE", "median", "p90", "%", "u", "%", "v", "%",
      "change", "95% interval", "PSNR", "SSIM", "valid%", "ms");
  for (const MethodSummary& m : group.methods) {
    text += fmt::format("{:<{}}{:>5}", m.method, width, m.declined) + Cell(m.epe_px, 7, 2) +
            Cell(m.epe_median_px, 8, 2) + Cell(m.epe_p90_px, 7, 2) +
            Cell(kPercent * m.epe_ratio, 6, 0) + Cell(m.horizontal_px, 7, 2) +
            Cell(kPercent * m.horizontal_ratio, 6, 0) + Cell(m.vertical_px, 7, 2) +
            Cell(kPercent * m.vertical_ratio, 6, 0) + Cell(m.difference_px, 9, 2) +
            fmt::format("{:>18}", IntervalText(m.difference_interval, 2)) + Cell(m.psnr_db, 7, 2) +
            Cell(m.ssim, 7, 3) + Cell(kPercent * m.valid_share, 8, 1) + Cell(m.ms, 8, 1) + "\n";
  }
  return text;
}

// How often the truth lay inside the central 80% of the samples.
std::string CoverageText(const std::vector<GroupSummary>& groups) {
  std::string text;
  for (const GroupSummary& group : groups) {
    if (group.coverage) {
      evaluation::Coverage all;
      std::string axes;
      for (const evaluation::Coverage& axis : *group.coverage) {
        all += axis;
        axes += Cell(kPercent * axis.Share(), 8, 1);
      }
      text += fmt::format("{:<28}", group.motion + (group.structured_only ? ", structured" : "")) +
              axes + Cell(kPercent * all.Share(), 8, 1) + "\n";
    }
  }
  if (text.empty()) {
    return text;
  }
  return fmt::format(
             "\ntruth inside the central 80% of the samples, %\n{:<28}{:>8}{:>8}{:>8}{:>8}\n",
             "motion", "a", "b", "roll", "all") +
         text;
}

std::string SkewText(const SkewResponse& skew) {
  if (skew.photos == 0) {
    return "";
  }
  std::string text = fmt::format(
      "\nresponse to a known skew (px, top row to bottom row), {} photos\n{:>6}{:>10}{:>12}{:>10}"
      "{:>22}{:>10}\n",
      skew.photos, "k", "true", "predicted", "+-", "left after correcting", "+-");
  for (const SkewLevel& level : skew.levels) {
    text += Cell(level.factor, 6, 1) + Cell(level.true_px, 10, 2) +
            Cell(level.predicted_px, 12, 2) + Cell(level.predicted_error_px, 10, 2) +
            Cell(level.remainder_px, 22, 2) + Cell(level.remainder_error_px, 10, 2) + "\n";
  }
  text += fmt::format("slope {} {}, intercept {} px, R2 of the means {}\n",
                      Cell(skew.fit.slope, 0, 3), IntervalText(skew.slope_interval, 3),
                      Cell(skew.fit.intercept, 0, 2), Cell(skew.linearity, 0, 4));
  text += fmt::format(
      "left after correcting with the true motion: {} +- {} px; zero crossing at {} {} of the true "
      "readout\n",
      Cell(skew.remainder_px, 0, 3), Cell(skew.remainder_error_px, 0, 3),
      Cell(skew.zero_crossing, 0, 3), IntervalText(skew.zero_crossing_interval, 3));
  return text;
}

Json MethodJson(const MethodSummary& m) {
  return {{"epe", OrNull(m.epe_px)},
          {"epe_median", OrNull(m.epe_median_px)},
          {"epe_p90", OrNull(m.epe_p90_px)},
          {"epe_ratio", OrNull(m.epe_ratio)},
          {"u", OrNull(m.horizontal_px)},
          {"u_ratio", OrNull(m.horizontal_ratio)},
          {"v", OrNull(m.vertical_px)},
          {"v_ratio", OrNull(m.vertical_ratio)},
          {"epe_change", OrNull(m.difference_px)},
          {"epe_change_interval", ToJson(m.difference_interval)},
          {"psnr", OrNull(m.psnr_db)},
          {"ssim", OrNull(m.ssim)},
          {"valid", OrNull(m.valid_share)},
          {"ms", OrNull(m.ms)},
          {"declined", m.declined}};
}

Json GroupJson(const GroupSummary& group) {
  Json json;
  json["photos"] = group.structured_only ? "structured" : "all";
  json["motion"] = group.motion;
  json["samples"] = group.pictures;
  json["methods"] = Json::object();
  for (const MethodSummary& method : group.methods) {
    json["methods"][method.method] = MethodJson(method);
  }
  if (group.coverage) {
    evaluation::Coverage all;
    for (const evaluation::Coverage& axis : *group.coverage) {
      all += axis;
    }
    json["coverage"] = {{"a", OrNull((*group.coverage)[0].Share())},
                        {"b", OrNull((*group.coverage)[1].Share())},
                        {"roll", OrNull((*group.coverage)[2].Share())},
                        {"all", OrNull(all.Share())}};
  }
  return json;
}

Json SkewJson(const SkewResponse& skew) {
  Json json;
  json["photos"] = skew.photos;
  json["levels"] = Json::array();
  for (const SkewLevel& level : skew.levels) {
    json["levels"].push_back({{"k", level.factor},
                              {"true", OrNull(level.true_px)},
                              {"predicted", OrNull(level.predicted_px)},
                              {"predicted_error", OrNull(level.predicted_error_px)},
                              {"remainder", OrNull(level.remainder_px)},
                              {"remainder_error", OrNull(level.remainder_error_px)}});
  }
  json["slope"] = OrNull(skew.fit.slope);
  json["slope_interval"] = ToJson(skew.slope_interval);
  json["intercept"] = OrNull(skew.fit.intercept);
  json["linearity"] = OrNull(skew.linearity);
  json["remainder"] = OrNull(skew.remainder_px);
  json["remainder_error"] = OrNull(skew.remainder_error_px);
  json["zero_crossing"] = OrNull(skew.zero_crossing);
  json["zero_crossing_interval"] = ToJson(skew.zero_crossing_interval);
  return json;
}

}  // namespace

std::string FormatText(const SyntheticReport& report) {
  std::string text = HeaderText(report.header);
  for (const GroupSummary& group : report.groups) {
    text += GroupText(group);
  }
  text += CoverageText(report.groups);
  text += SkewText(report.skew);
  return text +
         "\nleft: pictures left as they are because they did not tell; EPE, u (horizontal part), v "
         "(vertical part) in px at 800x600; % of the uncorrected "
         "figure; change of the EPE against no correction; ms with whatever else was running\n";
}

std::string FormatJson(const SyntheticReport& report) {
  Json json;
  json["protocol"] = "synthetic-val";
  json.update(HeaderJson(report.header));
  json["photos"] = report.photos;
  for (const GroupSummary& group : report.groups) {
    if (!group.structured_only && group.motion == "all") {
      // What every data set reports.
      const Json all = GroupJson(group);
      json["samples"] = all["samples"];
      json["methods"] = all["methods"];
    }
  }
  json["groups"] = Json::array();
  for (const GroupSummary& group : report.groups) {
    json["groups"].push_back(GroupJson(group));
  }
  if (report.skew.photos > 0) {
    json["skew"] = SkewJson(report.skew);
  }
  return Dump(json);
}

std::string FormatCsv(const SyntheticReport& report) {
  std::string text =
      "photo,structured,motion,focal_widths,top_to_bottom,photo_per_pixel,method,epe,u,v,psnr,ssim,"
      "valid,ms,declined\n";
  for (const evaluation::SampleRecord& sample : report.samples) {
    for (const MethodScore& m : sample.methods) {
      text += fmt::format(
          "{},{},{},{:.4f},{},{:.4f},{},{:.4f},{:.4f},{:.4f},{:.3f},{:.5f},{:.5f},"
          "{:.2f},{}\n",
          Field(sample.photo), sample.structured ? 1 : 0,
          evaluation::MotionClassName(sample.motion_class), sample.focal_widths,
          sample.top_to_bottom ? 1 : 0, sample.photo_per_pixel, Field(m.method), m.epe_px,
          m.horizontal_px, m.vertical_px, m.psnr_db, m.ssim, m.valid_share, m.ms,
          m.declined ? 1 : 0);
    }
  }
  return text;
}

}  // namespace rsstab::cli
