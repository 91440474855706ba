// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_CLIP_OBSERVER_H_
#define RSSTAB_STABILIZER_PIPELINE_CLIP_OBSERVER_H_

#include <cstdint>
#include <optional>
#include <vector>

#include "igf/base/camera.h"
#include "igf/base/log.h"
#include "igf/base/point_tracks.h"
#include "stabilizer/clip_calibration.h"
#include "stabilizer/pipeline/rs_source_selection.h"

namespace rsstab::pipeline {

// Gathers, frame by frame, what the choice of the rolling-shutter source rests on. Memory is
// bounded. In order, not thread safe.
class ClipObserver {
 public:
  ClipObserver(const StabilizeOptions& options, const ClipGeometry& clip, const RsInputs& inputs,
               Logger logger);

  // The next frame: its tracks from the frame before it (empty for the first), and its picture.
  void Push(const PointTracks& tracks, stabilizer::GrayImage picture);

  // What was gathered so far; lives as long as the observer and until the next Push().
  [[nodiscard]] ClipEvidence Conclude();

 private:
  StabilizeOptions options_;
  double frame_interval_s_;
  Logger logger_;
  std::int64_t num_frames_ = 0;
  std::vector<PointTracks> sync_tracks_;
  std::optional<Camera> lens_;  // taken out of the tracks before they calibrate
  stabilizer::ClipCalibrator calibrator_;
  std::optional<ReadoutPictures> pictures_;  // when single pictures are to be asked
};

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_CLIP_OBSERVER_H_
