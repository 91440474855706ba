// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_ONLINE_RS_SOURCE_H_
#define RSSTAB_STABILIZER_PIPELINE_ONLINE_RS_SOURCE_H_

#include <cstdint>

#include "igf/base/log.h"
#include "igf/base/result.h"
#include "igf/base/rs_motion_source.h"
#include "stabilizer/pipeline/frame_observation.h"
#include "stabilizer/pipeline/motion_stage.h"
#include "stabilizer/pipeline/rs_source_selection.h"
#include "stabilizer/pipeline/stabilize_options.h"

namespace rsstab::pipeline {

// A rolling-shutter source that has to see some frames more before it can tell one frame's motion
// (a sliding window over tracks). It is shown every frame's observation in order, and asked for a
// frame's motion once it has decided it.
class DelayedRsSource : public RsMotionSource {
 public:
  // Frames beyond frame n that it wants to have seen before frame n is decided.
  [[nodiscard]] virtual int DelayFrames() const = 0;
  // The next frame; `image` only when NeedsImage().
  [[nodiscard]] virtual Status Observe(const FrameObservation& observation,
                                       const FrameView* image) = 0;
  // No more frames will come: all become decided.
  [[nodiscard]] virtual Status Finish() = 0;
  // EstimateMotion() answers for frames 0 .. num_decided() - 1.
  [[nodiscard]] virtual std::int64_t num_decided() const = 0;
};

struct OnlineRsSelection {
  RsSelection selection;
  DelayedRsSource* delayed = nullptr;  // selection.source, when it is one; null: it answers at once
};

// Chooses the source of a clip that is not known yet. A gyro log is used with the offset that
// `options` give, or refused; kAuto takes what can be had without looking ahead, and says what.
// Errors: those of SelectRsSource; kUnsupported for a choice that needs the whole clip.
[[nodiscard]] Result<OnlineRsSelection> SelectOnlineRsSource(const StabilizeOptions& options,
                                                             const ClipGeometry& clip,
                                                             RsInputs inputs, const Logger& logger);

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_ONLINE_RS_SOURCE_H_
