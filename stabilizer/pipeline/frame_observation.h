// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_FRAME_OBSERVATION_H_
#define RSSTAB_STABILIZER_PIPELINE_FRAME_OBSERVATION_H_

#include <cstdint>

#include "igf/base/frame.h"
#include "igf/base/point_tracks.h"
#include "igf/base/result.h"
#include "stabilizer/feature_tracks.h"
#include "stabilizer/luma_proxy.h"

namespace rsstab::pipeline {

// What pass 1 keeps of a frame once its picture is gone.
struct FrameObservation {
  std::int64_t pts = 0;  // stream ticks
  double time_s = 0.0;   // middle row, video clock
  stabilizer::LumaFingerprint fingerprint{};
  int attempted_points = 0;  // looked for; the matches are those found
  PointTracks tracks;        // previous frame -> this one, proxy pixels
};

struct ObservedFrame {
  FrameObservation observation;
  stabilizer::GrayImage proxy;  // for those who need to see more of it
};

// Looks at the next frame of a clip. Errors: those of stabilizer::MakeLumaProxy and
// stabilizer::FeatureTracker::Push.
[[nodiscard]] Result<ObservedFrame> ObserveFrame(stabilizer::FeatureTracker& tracker,
                                                 const FrameView& frame, std::int64_t pts,
                                                 double time_s);

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_FRAME_OBSERVATION_H_
