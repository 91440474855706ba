// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/evaluate.h"

#include <array>
#include <functional>
#include <opencv2/core/utility.hpp>
#include <optional>
#include <utility>

#include "cli/commands/evaluate_clips.h"
#include "cli/commands/evaluate_methods.h"
#include "cli/commands/evaluate_pictures.h"
#include "cli/commands/evaluate_synthetic.h"
#include "cli/pages/evaluation_page.h"
#include "cli/pages/report_file.h"
#include "cli/stage_times.h"
#include "igf/base/parallel_for.h"

namespace rsstab::cli {
namespace {

// What a run writes beside its table, opened before it begins: a long run should not end at a name
// that cannot be written.
struct Outputs {
  std::optional<ReportFile> csv;
  std::optional<ReportFile> json;
  std::optional<ReportFile> page;
};

Result<Outputs> OpenOutputs(const EvaluateOptions& options) {
  Outputs outputs;
  const std::array<std::pair<std::optional<ReportFile>*, std::string>, 3> files = {
      {{&outputs.csv, options.csv},
       {&outputs.json, options.json},
       {&outputs.page, options.report}}};
  for (const auto& [file, name] : files) {
    if (name.empty()) {
      continue;
    }
    std::vector<std::string> others = {options.state};
    for (const auto& [other_file, other_name] : files) {
      if (other_file != file) {
        others.push_back(other_name);
      }
    }
    auto opened = ReportFile::Open(name, options.overwrite, others);
    if (!opened) {
      return Propagate(opened.error());
    }
    file->emplace(std::move(*opened));
  }
  return outputs;
}

// Makes the page of a report, given how long its figures took.
template <typename Report>
using PageMaker =
    std::function<Result<std::string>(const Report& report, const std::vector<StageTime>& stages)>;

// Lets `evaluate` make the report, and writes it: first the table to `out`, then the other forms to
// their files. One that fails takes no other with it.
template <typename Report>
Status WriteReport(const EvaluateOptions& options, const EvaluationOutput& out,
                   const Logger& logger, const std::function<Result<Report>()>& evaluate,
                   const PageMaker<Report>& make_page) {
  auto outputs = OpenOutputs(options);
  if (!outputs) {
    return Propagate(outputs.error());
  }
  StageTimes times;
  const Result<Report> made = times.Measure("Evaluate", evaluate);
  if (!made) {
    return Propagate(made.error());
  }
  const Report& report = *made;
  Status result = out(FormatText(report));
  const auto write = [&](std::optional<ReportFile>& file, const std::string& name,
                         const Result<std::string>& content) {
    const Status written =
        content ? file->Write(*content) : Status(Propagate(content.error(), name));
    if (!written && !result) {
      logger->error("evaluate: {}", written.error().message);
    } else if (!written) {
      result = written;
    }
  };
  if (outputs->csv) {
    write(outputs->csv, options.csv, FormatCsv(report));
  }
  if (outputs->json) {
    write(outputs->json, options.json, FormatJson(report));
  }
  if (outputs->page) {
    write(outputs->page, options.report, make_page(report, times.stages()));
  }
  return result;
}

}  // namespace

Status RunEvaluate(const EvaluateOptions& options, const Logger& logger,
                   const EvaluationOutput& out, const evaluation::EvaluationProgress& progress) {
  if (options.protocol == EvaluationProtocol::kClips || !options.clips.empty()) {
    return WriteReport<ClipsReport>(
        options, out, logger, [&] { return EvaluateClips(options, logger, progress); },
        [](const auto& report, const auto& stages) { return MakeEvaluationPage(report, stages); });
  }
  if (ResolveThreadCount(options.jobs) > 1) {
    // The photographs are what runs in parallel; OpenCV's own threads would only get in the way.
    cv::setNumThreads(1);
  }
  EvaluateOptions chosen = options;
  chosen.methods = MethodsAskedFor(options);
  const auto factory = MakeMethodFactory(chosen);
  if (!factory) {
    return Propagate(factory.error());
  }
  for (const std::string& method : MethodsWithoutWeights(chosen)) {
    logger->info("evaluate: {} is left out; --{}-model names its weights", method,
                 method.substr(0, method.find('@')));
  }
  if (options.protocol != EvaluationProtocol::kSyntheticVal) {
    Status written = WriteReport<PictureReport>(
        options, out, logger, [&] { return EvaluatePictures(chosen, *factory, logger, progress); },
        [&](const auto& report, const auto& stages) {
          return MakeEvaluationPage(report, chosen, *factory, stages);
        });
    if (written) {
      RemoveOwnState(chosen);
    }
    return written;
  }
  return WriteReport<SyntheticReport>(
      options, out, logger, [&] { return EvaluateSynthetic(options, *factory, logger, progress); },
      [&](const auto& report, const auto& stages) {
        return MakeEvaluationPage(report, options, *factory, stages);
      });
}

}  // namespace rsstab::cli
