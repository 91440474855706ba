// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/evaluate_pairs.h"

#include <spdlog/fmt/fmt.h>

#include <utility>

#include "cli/commands/evaluate_report_detail.h"
#include "igf/base/parallel_for.h"

namespace rsstab::cli {
namespace {

using detail::Cell;
using detail::Dump;
using detail::Field;
using detail::HeaderJson;
using detail::HeaderText;
using detail::Json;
using detail::kPercent;
using detail::OrNull;
using evaluation::EvaluationProgress;
using evaluation::MethodFactory;
using evaluation::PairScore;

// Mean over the pairs of one method's figure.
double MeanOf(const PairReport& report, std::size_t method, double PairScore::*figure) {
  double sum = 0.0;
  for (const evaluation::PairRecord& pair : report.pairs) {
    sum += pair.methods[method].*figure;
  }
  return sum / static_cast<double>(report.pairs.size());
}

std::string PairRow(const std::string& name, const PairScore& s) {
  return fmt::format("{:<24}{:<12}", name, s.method) + Cell(s.untouched_psnr_db, 9, 2) +
         Cell(s.psnr_db, 9, 2) + Cell(s.untouched_ssim, 9, 3) + Cell(s.ssim, 9, 3) +
         Cell(kPercent * s.valid_share, 8, 1) + Cell(s.moved_px, 8, 2) + Cell(s.ms, 8, 1) + "\n";
}

PairScore MeanScore(const PairReport& report, std::size_t method) {
  PairScore mean;
  mean.method = report.pairs.front().methods[method].method;
  for (double PairScore::*figure :
       {&PairScore::psnr_db, &PairScore::ssim, &PairScore::untouched_psnr_db,
        &PairScore::untouched_ssim, &PairScore::valid_share, &PairScore::moved_px,
        &PairScore::ms}) {
    mean.*figure = MeanOf(report, method, figure);
  }
  return mean;
}

Json PairJson(const PairScore& s) {
  return {{"psnr", OrNull(s.psnr_db)},
          {"psnr_untouched", OrNull(s.untouched_psnr_db)},
          {"ssim", OrNull(s.ssim)},
          {"ssim_untouched", OrNull(s.untouched_ssim)},
          {"valid", OrNull(s.valid_share)},
          {"moved", OrNull(s.moved_px)},
          {"ms", OrNull(s.ms)}};
}

}  // namespace

std::string FormatText(const PairReport& report) {
  std::string text =
      HeaderText(report.header) + fmt::format("\n{:<24}{:<12}{:>9}{:>9}{:>9}{:>9}{:>8}{:>8}{:>8}\n",
                                              "pair", "method", "PSNR in", "out", "SSIM in", "out",
                                              "valid%", "moved", "ms");
  for (const evaluation::PairRecord& pair : report.pairs) {
    for (const PairScore& score : pair.methods) {
      text += PairRow(pair.name, score);
    }
  }
  if (!report.pairs.empty()) {
    for (std::size_t method = 0; method < report.pairs.front().methods.size(); ++method) {
      text += PairRow("mean", MeanScore(report, method));
    }
  }
  return text +
         "\nin: the untouched picture over the same pixels; moved: mean displacement, px of the "
         "picture\n";
}

std::string FormatJson(const PairReport& report) {
  Json json;
  json["protocol"] = "pairs";
  json.update(HeaderJson(report.header));
  json["samples"] = report.pairs.size();
  json["methods"] = Json::object();
  if (!report.pairs.empty()) {
    for (std::size_t method = 0; method < report.pairs.front().methods.size(); ++method) {
      const PairScore mean = MeanScore(report, method);
      json["methods"][mean.method] = PairJson(mean);
    }
  }
  json["pairs"] = Json::array();
  for (const evaluation::PairRecord& pair : report.pairs) {
    Json entry = {{"name", pair.name}, {"width", pair.width}, {"height", pair.height}};
    for (const PairScore& score : pair.methods) {
      entry["methods"][score.method] = PairJson(score);
    }
    json["pairs"].push_back(std::move(entry));
  }
  return Dump(json);
}

std::string FormatCsv(const PairReport& report) {
  std::string text =
      "pair,width,height,method,psnr,psnr_untouched,ssim,ssim_untouched,valid,moved,ms\n";
  for (const evaluation::PairRecord& pair : report.pairs) {
    for (const PairScore& s : pair.methods) {
      text += fmt::format("{},{},{},{},{:.3f},{:.3f},{:.5f},{:.5f},{:.5f},{:.4f},{:.2f}\n",
                          Field(pair.name), pair.width, pair.height, s.method, s.psnr_db,
                          s.untouched_psnr_db, s.ssim, s.untouched_ssim, s.valid_share, s.moved_px,
                          s.ms);
    }
  }
  return text;
}

Result<PairReport> EvaluatePairs(const EvaluateOptions& options, const MethodFactory& factory,
                                 const Logger& logger, const EvaluationProgress& progress) {
  if (options.pairs.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                "--pairs: the protocol pairs needs a folder to look for them.");
  }
  auto pairs = evaluation::FindImagePairs(options.pairs);
  if (!pairs) {
    return Propagate(pairs.error());
  }
  if (options.limit > 0 && static_cast<std::int64_t>(pairs->size()) > options.limit) {
    pairs->resize(static_cast<std::size_t>(options.limit));
  }
  auto records = evaluation::RunImagePairs(
      *pairs, {static_cast<std::uint64_t>(options.seed), ResolveThreadCount(options.jobs)}, factory,
      progress);
  if (!records) {
    return Propagate(records.error());
  }
  PairReport report{MakeHeader(options, std::move(records->failures)), std::move(records->pairs)};
  WarnOfFailures(report.header, logger);
  return report;
}

}  // namespace rsstab::cli
