// SPDX-License-Identifier: Apache-2.0
#include "cli/pages/picture_exhibits.h"

#include <cmath>
#include <optional>
#include <utility>

#include "evaluation/picture_protocol.h"

namespace rsstab::cli {
namespace {

using evaluation::MethodFigures;
using evaluation::PictureRecord;

// How much a method gained on a picture: px of error where the truth is known, else dB.
std::optional<double> GainOf(const PictureRecord& record, std::size_t method) {
  const MethodFigures& figures = record.methods[method];
  const MethodFigures& untouched = record.methods.front();
  const double px = untouched.epe_px - figures.epe_px;
  if (std::isfinite(px)) {
    return px;
  }
  const double db = figures.psnr_db - figures.untouched_psnr_db;
  return std::isfinite(db) ? std::optional(db) : std::nullopt;
}

}  // namespace

std::size_t ShownMethod(const PictureReport& report) {
  std::vector<MethodStanding> methods;
  for (const auto& method : report.groups.front().methods) {
    const double epe = method.epe_px.mean;
    methods.push_back({method.method, std::isfinite(epe) ? -epe : method.psnr_db.mean});
  }
  return MethodToShow(methods);
}

std::vector<ChosenPicture> ChoosePictures(const PictureReport& report, std::size_t method) {
  std::vector<std::optional<double>> gains;
  for (const PictureRecord& record : report.records) {
    gains.push_back(GainOf(record, method));
  }
  return ChooseByGain(gains);
}

Status AddPictures(const PictureReport& report, const evaluation::PictureSet& set,
                   const EvaluateOptions& options, const evaluation::MethodFactory& factory,
                   report::HtmlPage& html) {
  const std::size_t method = ShownMethod(report);
  const auto inspect = [&](std::size_t index,
                           evaluation::MethodSet& methods) -> Result<InspectedRecord> {
    const PictureRecord& record = report.records[index];
    auto inspection = evaluation::InspectPicture(set, record.clip, record.name,
                                                 static_cast<std::uint64_t>(options.seed), methods);
    if (!inspection) {
      return Propagate(std::move(inspection.error()));
    }
    return InspectedRecord{std::move(*inspection), record.methods, record.name};
  };
  return ShowPictures(ChoosePictures(report, method), method, factory, inspect, html);
}

}  // namespace rsstab::cli
