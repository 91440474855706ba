// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_COMPARE_H_
#define RSSTAB_CLI_COMMANDS_COMPARE_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <ostream>
#include <string>

#include "cli/commands/compare_options.h"
#include "igf/base/log.h"
#include "igf/base/result.h"
#include "stabilizer/metrics/camera_residual.h"
#include "stabilizer/metrics/pair_metrics.h"
#include "stabilizer/quality_metrics.h"

namespace rsstab::cli {

// What is measured; both clips are read where both are needed.
enum class CompareScope {
  kBoth,
  kInputOnly,   // the input as it is; no output is opened
  kOutputOnly,  // the output, and what it took from the input
};

struct CompareReport {
  struct Clip {
    std::string path;
    int width = 0;
    int height = 0;
    double frames_per_second = 0.0;
    stabilizer::ClipMetrics metrics;
    std::optional<stabilizer::TruthMetrics> truth;
  };
  Clip input;
  Clip output;
  stabilizer::PairMetrics pair;
};

// Called after each pair of frames; `frames` 0 when unknown; false stops.
using CompareProgress = std::function<bool(std::int64_t frames_done, std::int64_t frames)>;

// Measures both clips in one go. Frames belong together by their number; where one clip is longer,
// its further frames count for itself only, with a warning. What `scope` leaves out keeps its
// default. Memory does not grow with the clip but for about 100 bytes a frame. Errors: those of the
// reader, naming the clip; kNotFound for a truth without its files; kCancelled.
[[nodiscard]] Result<CompareReport> CompareClips(const CompareOptions& options,
                                                 const Logger& logger,
                                                 const CompareProgress& progress = {},
                                                 CompareScope scope = CompareScope::kBoth);

// The report as a table for people, and as one JSON object (figures that could not be measured are
// null). Both end with a line feed.
[[nodiscard]] std::string FormatCompareText(const CompareReport& report);
[[nodiscard]] std::string FormatCompareJson(const CompareReport& report);

// CompareClips, then the report to `out` in the form that was asked for.
[[nodiscard]] Status RunCompare(const CompareOptions& options, const Logger& logger,
                                std::ostream& out, const CompareProgress& progress = {});

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_COMPARE_H_
