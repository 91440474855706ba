// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_FRAME_RENDERER_H_
#define RSSTAB_STABILIZER_PIPELINE_FRAME_RENDERER_H_

#include <memory>
#include <optional>

#include "igf/base/camera.h"
#include "igf/base/frame.h"
#include "igf/base/result.h"
#include "stabilizer/analysis_file.h"
#include "stabilizer/pipeline/stabilize_options.h"

namespace rsstab::pipeline {

// What is the same for every frame that is rendered.
struct RenderGeometry {
  int width = 0;  // of the pictures, px
  int height = 0;
  int analysed_width = 0;  // that the analyses are stated for; of the same shape
  int analysed_height = 0;
  std::optional<Camera> camera;  // of the analysed size
};

// One frame's analysis and picture -> the steady picture. Every pixel has a source inside the
// picture. Frames in any order; not thread safe (uses its own worker threads inside).
class FrameRenderer {
 public:
  // Takes interpolation and threads from `options`.
  FrameRenderer(const RenderGeometry& geometry, const StabilizeOptions& options);
  ~FrameRenderer();
  FrameRenderer(const FrameRenderer&) = delete;
  FrameRenderer& operator=(const FrameRenderer&) = delete;

  void set_interpolation(stabilizer::Interpolation interpolation);

  // Fills `destination`, which has the layout and size of `picture` and shares no memory with it.
  // `crop_ratio`: share of a side that the frame may keep, narrowed further should a border show.
  [[nodiscard]] Status Render(const FrameView& picture, const stabilizer::FrameAnalysis& analysis,
                              double crop_ratio, Frame& destination);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_FRAME_RENDERER_H_
