// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_CROP_STAGE_H_
#define RSSTAB_STABILIZER_PIPELINE_CROP_STAGE_H_

#include <cstddef>
#include <deque>
#include <optional>
#include <variant>
#include <vector>

#include "stabilizer/analysis_file.h"
#include "stabilizer/crop_planner.h"
#include "stabilizer/online_zoom_planner.h"
#include "stabilizer/pipeline/clip_geometry.h"
#include "stabilizer/pipeline/rs_selection.h"
#include "stabilizer/pipeline/stabilize_options.h"

namespace rsstab::pipeline {

// Gives frames whose path is decided the crop that hides their borders: what each allows, planned
// over time. They come out with the zoom planner's look-ahead. In order, not thread safe.
class CropStage {
 public:
  // `lookahead`: frames that each decision waits for; empty: as many as the planner wants.
  // `selection` must outlive it.
  CropStage(const StabilizeOptions& options, const ClipGeometry& clip, const RsSelection* selection,
            std::optional<std::size_t> lookahead);

  // How many frames the planner wants to look ahead.
  [[nodiscard]] static int WantedLookahead(double frames_per_second);

  // The next frame, complete but for its crop ratio.
  void Push(stabilizer::FrameAnalysis frame);
  // No more frames will come.
  void Finish();
  // Takes the fixed zoom of `options` for the frames to come.
  void Update(const StabilizeOptions& options);
  // Frames decided since the last call.
  [[nodiscard]] std::vector<stabilizer::FrameAnalysis> TakeReady();

 private:
  ClipGeometry clip_;
  const RsSelection* selection_;
  double largest_ratio_ = 1.0;  // that the options let any frame keep
  std::variant<stabilizer::ZoomPlanner, stabilizer::OnlineZoomPlanner> planner_;
  std::deque<stabilizer::FrameAnalysis> waiting_;
};

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_CROP_STAGE_H_
