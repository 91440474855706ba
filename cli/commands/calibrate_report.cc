// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "cli/commands/calibrate.h"
#include "cli/report/svg_chart.h"

namespace rsstab::cli {
namespace {

using Json = nlohmann::ordered_json;
using pipeline::CalibratedValue;
using pipeline::CalibrationReport;
using stabilizer::ReadoutHypothesis;
using stabilizer::ShutterVerdict;

constexpr double kMilliseconds = 1e3;
constexpr int kBarColumns = 40;

// "20.1 ms, 95 % between 19.8 and 20.4 ms", and whether to believe it.
std::string ValueText(const CalibratedValue& v, double scale, const char* unit, int digits) {
  if (v.given) {
    return fmt::format("{:.{}f} {} (given)\n", v.value * scale, digits, unit);
  }
  std::string text = fmt::format("{:.{}f} {}", v.value * scale, digits, unit);
  if (v.sigma > 0.0) {
    text += fmt::format(", 95 % between {:.{}f} and {:.{}f} {}", v.low() * scale, digits,
                        v.high() * scale, digits, unit);
  }
  return v.trusted ? text + "\n" : text + "\n              not trusted: " + v.reason + "\n";
}

std::string VerdictText(const CalibrationReport& report) {
  switch (report.verdict) {
    case ShutterVerdict::kRolling:
      return report.readout_s.value < 0.0 ? "rolling shutter, read from bottom to top"
                                          : "rolling shutter";
    case ShutterVerdict::kGlobal:
      return "no rolling shutter to speak of";
    case ShutterVerdict::kCannotBeTold:
      return "cannot be told from this clip";
    case ShutterVerdict::kGiven:
      break;
  }
  return "as given";
}

// A tenth of the way down is a factor of e^(scale / 10) less likely; far off, bars end.
std::string CurveText(const pipeline::EvidenceCurve& curve) {
  double lowest = 0.0;
  for (const ReadoutHypothesis& h : curve.points) {
    lowest = std::min(lowest, h.log_evidence);
  }
  std::string text =
      fmt::format("\nHow well readout times explain the clip ({}; ln of the evidence, best = 0)\n",
                  curve.source);
  for (const ReadoutHypothesis& h : curve.points) {
    const double height = lowest < 0.0 ? 1.0 - h.log_evidence / lowest : 1.0;
    text +=
        fmt::format("{:8.1f} ms {:10.1f}  {}\n", h.readout_s * kMilliseconds, h.log_evidence,
                    std::string(static_cast<std::size_t>(std::lround(height * kBarColumns)), '#'));
  }
  return text;
}

std::string OpinionText(const char* who, double value_s, double sigma_s) {
  return fmt::format("              {} alone: {:.2f} +- {:.2f} ms\n", who, value_s * kMilliseconds,
                     sigma_s * kMilliseconds);
}

Json OpinionJson(double value_s, double sigma_s) {
  return {{"value", value_s}, {"sigma", sigma_s}};
}

Json ValueJson(const CalibratedValue& v) {
  Json json = {{"value", v.value}, {"sigma", v.sigma}};
  const bool has_interval = v.given || v.sigma > 0.0;
  json["low"] = has_interval ? Json(v.low()) : Json(nullptr);
  json["high"] = has_interval ? Json(v.high()) : Json(nullptr);
  json["given"] = v.given;
  json["trusted"] = v.trusted;
  if (!v.trusted) {
    json["reason"] = v.reason;
  }
  return json;
}

}  // namespace

std::string FormatCalibrationText(const CalibrationReport& report, const std::string& clip) {
  std::string text = fmt::format("clip          {}\nshutter       {}\n", clip, VerdictText(report));
  text += "readout       " + ValueText(report.readout_s, kMilliseconds, "ms", 2);
  if (!report.readout_s.given && report.tracks_readout_s) {
    text += OpinionText("tracks", report.tracks_readout_s->value, report.tracks_readout_s->sigma);
  }
  if (report.pictures) {
    text += OpinionText("single images", report.pictures->readout_s, report.pictures->sigma_s);
  }
  text += "focal length  " + ValueText(report.focal_px, 1.0, "px", 1);
  if (report.gyro_offset_s) {
    text += report.gyro_offset_s->trusted
                ? "gyro offset   " + ValueText(*report.gyro_offset_s, kMilliseconds, "ms", 2)
                : "gyro offset   not found: " + report.gyro_offset_s->reason + "\n";
  }
  text += fmt::format("based on      {} stretch{} of the clip\n", report.num_stretches,
                      report.num_stretches == 1 ? "" : "es");
  for (const pipeline::EvidenceCurve& curve : report.curves) {
    text += CurveText(curve);
  }
  return text;
}

std::string FormatCalibrationJson(const CalibrationReport& report, const std::string& clip) {
  Json json;
  json["clip"] = clip;
  json["verdict"] = stabilizer::NameOf(report.verdict);
  json["readout_s"] = ValueJson(report.readout_s);
  json["tracks_readout_s"] = report.tracks_readout_s ? OpinionJson(report.tracks_readout_s->value,
                                                                   report.tracks_readout_s->sigma)
                                                     : Json(nullptr);
  json["pictures_readout_s"] =
      report.pictures ? OpinionJson(report.pictures->readout_s, report.pictures->sigma_s)
                      : Json(nullptr);
  json["focal_px"] = ValueJson(report.focal_px);
  json["gyro_offset_s"] = report.gyro_offset_s ? ValueJson(*report.gyro_offset_s) : Json(nullptr);
  json["stretches"] = report.num_stretches;
  json["parallax_px"] = report.parallax_px;
  json["curves"] = Json::array();
  for (const pipeline::EvidenceCurve& curve : report.curves) {
    Json points = Json::array();
    for (const ReadoutHypothesis& h : curve.points) {
      points.push_back({{"readout_s", h.readout_s}, {"log_evidence", h.log_evidence}});
    }
    json["curves"].push_back({{"source", curve.source}, {"points", std::move(points)}});
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string FormatCalibrationChart(const CalibrationReport& report) {
  report::LineChart chart;
  chart.title = "How well readout times explain the clip";
  chart.description =
      "Logarithm of the evidence for each readout time, by source, with the value found.";
  chart.x_label = "readout time, ms";
  chart.y_label = "ln evidence, best = 0";
  chart.width = 640;
  chart.height = 360;
  double lowest = 0.0;
  for (const pipeline::EvidenceCurve& curve : report.curves) {
    report::ChartSeries series;
    series.name = curve.source;
    series.markers = true;
    for (const ReadoutHypothesis& h : curve.points) {
      series.points.emplace_back(h.readout_s * kMilliseconds, h.log_evidence);
      lowest = std::min(lowest, h.log_evidence);
    }
    chart.series.push_back(std::move(series));
  }
  const CalibratedValue& found = report.readout_s;
  if (found.trusted) {
    chart.marks.push_back(
        {found.value * kMilliseconds, fmt::format("{:.2f} ms", found.value * kMilliseconds)});
    if (found.sigma > 0.0) {
      const double low = found.low() * kMilliseconds;
      const double high = found.high() * kMilliseconds;
      chart.band = report::ChartBand{"95 %", {low, high}, {lowest, lowest}, {0.0, 0.0}};
    }
  }
  return report::ChartFile(chart);
}

}  // namespace rsstab::cli
