// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_COMPARE_H_
#define RSSTAB_CLI_COMMANDS_COMPARE_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "cli/commands/compare_options.h"
#include "cli/media/video_reader.h"
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
    std::vector<stabilizer::PicturePose> poses;  // one a frame
  };
  Clip input;
  Clip output;
  stabilizer::PairMetrics pair;
};

// Called after each pair of frames; `frames` 0 when unknown; false stops.
using CompareProgress = std::function<bool(std::int64_t frames_done, std::int64_t frames)>;

// What has just been measured. Everything lives for the call only.
struct ComparedFrames {
  std::int64_t index = 0;
  const media::VideoInfo* input_info = nullptr;
  const media::VideoInfo* output_info = nullptr;
  const stabilizer::ClipMeter* input_meter = nullptr;
  // Null where a clip has ended, the twin also without a truth.
  const media::VideoFrame* input = nullptr;
  const media::VideoFrame* output = nullptr;
  const media::VideoFrame* twin = nullptr;
  std::optional<double> input_residual;  // camera residual of the input's frame, px
  const Camera* camera = nullptr;        // of the twin; null without a truth
};
// Sees each pair of frames of a comparison of both clips, in order; an error ends it.
using CompareObserver = std::function<Status(const ComparedFrames& frames)>;

// Measures both clips in one go. Frames belong together by their number; where one clip is longer,
// its further frames count for itself only, with a warning. What `scope` leaves out keeps its
// default. Memory does not grow with the clip but for about 100 bytes a frame. Errors: those of the
// reader, naming the clip; kNotFound for a truth without its files, kInvalidArgument for one of
// another shape; kCancelled.
[[nodiscard]] Result<CompareReport> CompareClips(const CompareOptions& options,
                                                 const Logger& logger,
                                                 const CompareProgress& progress = {},
                                                 CompareScope scope = CompareScope::kBoth,
                                                 const CompareObserver& observer = {});

// One line of the report.
enum class Better { kLower, kHigher, kNeither };
struct CompareFigure {
  std::string name;
  std::string unit;
  std::optional<double> input;
  std::optional<double> output;
  int digits = 3;  // after the point
  Better better = Better::kLower;
  std::string meaning;  // in a few words; docs/metrics.md has the definition
};
[[nodiscard]] std::vector<CompareFigure> CompareFigures(const CompareReport& report);

// The report as a table for people, and as one JSON object (figures that could not be measured are
// null). Both end with a line feed.
[[nodiscard]] std::string FormatCompareText(const CompareReport& report);
[[nodiscard]] std::string FormatCompareJson(const CompareReport& report);

// CompareClips, then the report to `out` in the form that was asked for, and as a page where that
// was asked for.
[[nodiscard]] Status RunCompare(const CompareOptions& options, const Logger& logger,
                                std::ostream& out, const CompareProgress& progress = {});

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_COMPARE_H_
