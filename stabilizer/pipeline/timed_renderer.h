// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_TIMED_RENDERER_H_
#define RSSTAB_STABILIZER_PIPELINE_TIMED_RENDERER_H_

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "igf/base/frame.h"
#include "igf/base/log.h"
#include "igf/base/result.h"
#include "stabilizer/analysis_file.h"
#include "stabilizer/interpolation.h"
#include "stabilizer/pipeline/stabilize_options.h"

namespace rsstab::pipeline {

// Pass 2 for hosts that seek: frames in any order, each found in the analysis file by its time, and
// by its picture where the times have been shifted. Not thread safe.
class TimedRenderer {
 public:
  // Takes interpolation and threads from `options`. The pictures may have another size than the
  // analysed ones, if of the same shape within 1 %.
  // Errors: those of AnalysisReader; kInvalidArgument when the shape is another one.
  [[nodiscard]] static Result<std::unique_ptr<TimedRenderer>> Create(
      const StabilizeOptions& options, const std::string& analysis_path, int width, int height,
      Logger logger);
  ~TimedRenderer();
  TimedRenderer(const TimedRenderer&) = delete;
  TimedRenderer& operator=(const TimedRenderer&) = delete;

  [[nodiscard]] const stabilizer::ClipAnalysis& clip() const;
  // When the `record`th frame of the file is shown, seconds of the analysed clip's clock; empty: it
  // has none.
  [[nodiscard]] std::optional<double> TimeOf(std::int64_t record) const;
  void set_interpolation(stabilizer::Interpolation interpolation);

  // Renders the picture shown at `time_s` into `destination`, which has its layout and size.
  // kNotFound when the file has no record of it, with the reason; `destination` is then as it was.
  // Other errors: kCorruptData for a damaged record, kInvalidArgument.
  [[nodiscard]] Status Render(const FrameView& picture, double time_s, Frame& destination);

  // Forgets what was found out about shifted times.
  void Reset();

 private:
  struct Impl;
  explicit TimedRenderer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_TIMED_RENDERER_H_
