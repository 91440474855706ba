// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_RENDERER_H_
#define RSSTAB_STABILIZER_PIPELINE_RENDERER_H_

#include <cstdint>
#include <memory>
#include <string>

#include "igf/base/frame.h"
#include "igf/base/log.h"
#include "igf/base/result.h"
#include "stabilizer/analysis_file.h"
#include "stabilizer/pipeline/stabilize_options.h"

namespace rsstab::pipeline {

// Pass 2: one frame in, one frame out, by an analysis file. Frames in the order of pass 1; not
// thread safe (uses its own worker threads inside).
class Renderer {
 public:
  // Takes interpolation and threads from `options`; the rest was decided in pass 1.
  // Errors: those of AnalysisReader::Open; kInvalidArgument when the clip has another size.
  [[nodiscard]] static Result<std::unique_ptr<Renderer>> Create(const StabilizeOptions& options,
                                                                const std::string& analysis_path,
                                                                int width, int height,
                                                                Logger logger);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  [[nodiscard]] const stabilizer::ClipAnalysis& clip() const;

  // The stabilised frame: same size and layout; `origin` of `frame` is handed on. Every pixel has a
  // source inside the picture. Errors: kInvalidArgument when the frame is not the one that was
  // analysed (another clip, re-timed, or more frames), naming the frame.
  [[nodiscard]] Result<Frame> Render(const Frame& frame, std::int64_t pts);

  // To be called after the last frame: kInvalidArgument when the analysed clip had more.
  [[nodiscard]] Status Finish();

 private:
  struct Impl;
  explicit Renderer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_RENDERER_H_
