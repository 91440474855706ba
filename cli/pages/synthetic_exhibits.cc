// SPDX-License-Identifier: Apache-2.0
#include "cli/pages/synthetic_exhibits.h"

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

namespace rsstab::cli {
namespace {

using evaluation::MethodFigures;
using evaluation::MethodScore;
using evaluation::MotionClass;
using evaluation::SampleRecord;

// A still picture that is moved by less looks the same.
constexpr double kVisible_px = 0.5;

std::vector<MethodFigures> FiguresOf(const SampleRecord& record) {
  std::vector<MethodFigures> figures;
  for (const MethodScore& score : record.methods) {
    MethodFigures& method = figures.emplace_back();
    method.method = score.method;
    method.declined = score.declined;
    method.epe_px = score.epe_px;
    method.psnr_db = score.psnr_db;
  }
  return figures;
}

}  // namespace

std::size_t ShownMethod(const SyntheticReport& report) {
  for (const evaluation::GroupSummary& group : report.groups) {
    if (group.motion == "all" && !group.structured_only) {
      std::vector<MethodStanding> methods;
      for (const evaluation::MethodSummary& method : group.methods) {
        methods.push_back({method.method, -method.epe_px});
      }
      return MethodToShow(methods);
    }
  }
  return 0;
}

std::vector<ChosenPicture> ChoosePictures(const SyntheticReport& report, std::size_t method) {
  std::vector<std::optional<double>> gains;
  std::optional<std::size_t> most_moved;
  const auto error_px = [&](std::size_t i) { return report.samples[i].methods[method].epe_px; };
  for (std::size_t i = 0; i < report.samples.size(); ++i) {
    const SampleRecord& record = report.samples[i];
    if (record.motion_class != MotionClass::kStill) {
      gains.emplace_back(record.methods.front().epe_px - record.methods[method].epe_px);
      continue;
    }
    gains.emplace_back(std::nullopt);
    if (error_px(i) > kVisible_px && (!most_moved || error_px(i) > error_px(*most_moved))) {
      most_moved = i;
    }
  }
  std::vector<ChosenPicture> chosen = ChooseByGain(gains);
  if (most_moved) {
    chosen.push_back({*most_moved, "moves a still picture most"});
  }
  return chosen;
}

Status AddPictures(const SyntheticReport& report, const EvaluateOptions& options,
                   const evaluation::MethodFactory& factory, report::HtmlPage& html) {
  const std::size_t method = ShownMethod(report);
  const auto inspect = [&](std::size_t index,
                           evaluation::MethodSet& methods) -> Result<InspectedRecord> {
    const SampleRecord& record = report.samples[index];
    auto inspection = evaluation::InspectSyntheticSample(
        std::filesystem::path(options.photos) / record.photo, record.motion_class,
        static_cast<std::uint64_t>(options.seed), methods);
    if (!inspection) {
      return Propagate(std::move(inspection.error()));
    }
    return InspectedRecord{
        std::move(*inspection), FiguresOf(record),
        record.photo + ", " + std::string(evaluation::MotionClassName(record.motion_class))};
  };
  return ShowPictures(ChoosePictures(report, method), method, factory, inspect, html);
}

}  // namespace rsstab::cli
