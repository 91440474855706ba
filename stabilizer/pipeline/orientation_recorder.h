// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_ORIENTATION_RECORDER_H_
#define RSSTAB_STABILIZER_PIPELINE_ORIENTATION_RECORDER_H_

#include <cstdint>
#include <optional>

#include "igf/base/rs_motion_source.h"
#include "stabilizer/analysis_file.h"

namespace rsstab::pipeline {

// Notes where the camera looked, frame by frame, and which frames may be compared. In order.
class OrientationRecorder {
 public:
  // Of the frame whose middle row was exposed at `time_s`, which `source` was asked about last.
  // Empty where the source does not know.
  [[nodiscard]] std::optional<stabilizer::FrameOrientation> Next(const RsMotionSource& source,
                                                                 double time_s) {
    const auto camera_from_world = source.CameraFromWorld(time_s);
    if (!camera_from_world) {
      previous_s_.reset();
      return std::nullopt;
    }
    if (!previous_s_ || !source.TurnBetween(*previous_s_, time_s)) {
      ++num_worlds_;
    }
    previous_s_ = time_s;
    return stabilizer::FrameOrientation{*camera_from_world, num_worlds_ - 1};
  }

 private:
  std::optional<double> previous_s_;  // of the frame before, where its orientation is known
  std::uint32_t num_worlds_ = 0;
};

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_ORIENTATION_RECORDER_H_
