// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_ANALYZER_H_
#define RSSTAB_STABILIZER_PIPELINE_ANALYZER_H_

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "igf/base/frame.h"
#include "igf/base/log.h"
#include "igf/base/result.h"
#include "stabilizer/analysis_file.h"
#include "stabilizer/pipeline/motion_stage.h"
#include "stabilizer/pipeline/rs_source_selection.h"
#include "stabilizer/pipeline/stabilize_options.h"

namespace rsstab::pipeline {

// Pass 1: pictures in, analysis file out. Keeps no pictures; memory is bounded by the look-ahead of
// the smoother. In order, not thread safe.
class Analyzer {
 public:
  // `inputs`: what is known of camera and gyro. `analysis_path`: the file to write; it appears
  // under that name only when Finish() succeeds. Errors: kInvalidArgument, kIo.
  [[nodiscard]] static Result<std::unique_ptr<Analyzer>> Create(const StabilizeOptions& options,
                                                                const ClipGeometry& clip,
                                                                RsInputs inputs,
                                                                const std::string& analysis_path,
                                                                Logger logger);
  ~Analyzer();
  Analyzer(const Analyzer&) = delete;
  Analyzer& operator=(const Analyzer&) = delete;

  // The next frame. `pts` in ticks of the stream is what the renderer finds the frame by; `time_s`
  // is the time of the middle row. The view is not kept.
  [[nodiscard]] Status PushFrame(const FrameView& frame, std::int64_t pts, double time_s);

  // No more frames will come: solves what is open and completes the file. `cancelled` is asked now
  // and then (may be empty); true ends with kCancelled. Errors: kCorruptData without a single
  // frame; kUntrustworthy when a gyro was asked for and cannot be brought into step with the
  // picture.
  [[nodiscard]] Result<stabilizer::ClipAnalysis> Finish(
      const std::function<bool()>& cancelled = {});

 private:
  struct Impl;
  explicit Analyzer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_ANALYZER_H_
