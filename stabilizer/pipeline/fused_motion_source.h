// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_FUSED_MOTION_SOURCE_H_
#define RSSTAB_STABILIZER_PIPELINE_FUSED_MOTION_SOURCE_H_

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "igf/base/camera.h"
#include "igf/base/readout_motion.h"
#include "igf/base/rs_motion_source.h"
#include "stabilizer/rs_motion_fusion.h"

namespace rsstab::pipeline {

// Readout motion from one rotation spline over the clip (stabilizer::RsMotionFusion). Answers for a
// frame once it has observed some frames beyond it; needs no picture.
class FusedMotionSource final : public RsMotionSource {
 public:
  // `name`: what the log and the analysis file call it. `camera` of the image size in which fields
  // are wanted, with its readout; `lens_is_known`: its distortion and principal point are to be
  // taken out of the tracks. Errors: kInvalidArgument for an invalid camera or one without readout.
  [[nodiscard]] static Result<std::unique_ptr<FusedMotionSource>> Create(
      std::string name, const Camera& camera, bool lens_is_known,
      const stabilizer::RsMotionModel& model);

  [[nodiscard]] std::string Name() const override { return name_; }
  [[nodiscard]] bool NeedsImage() const override { return false; }
  void Observe(const PointTracks& tracks, double time_s) override;
  void FinishObserving() override;
  [[nodiscard]] int DelayFrames() const override { return stabilizer::kFusionDelayFrames; }
  [[nodiscard]] std::int64_t NumAnswerable() const override;

  // In order of frames; a frame before the one asked for last is forgotten.
  // Errors: kUntrustworthy where no tracks lead to either neighbour.
  [[nodiscard]] Result<RsMotion> EstimateMotion(const FrameContext& frame) override;
  // Orientation of the middle row of the frame asked for last, or of the one before it if no cut
  // lies between them, by that frame's time.
  [[nodiscard]] std::optional<Eigen::Quaterniond> CameraFromWorld(double time_s) const override;

 private:
  FusedMotionSource(std::string name, const Camera& camera, bool lens_is_known,
                    const stabilizer::RsMotionModel& model);
  void TakeDecided();

  struct Decided {
    double frame_time_s = 0.0;
    stabilizer::FusedFrame motion;
  };

  std::string name_;
  Camera camera_;
  bool lens_is_known_;
  stabilizer::RsMotionFusion fusion_;
  std::deque<double> times_s_;   // of observed frames that are not decided
  std::deque<Decided> decided_;  // from first_decided_ on
  std::int64_t first_decided_ = 0;
  std::int64_t asked_for_ = -1;
};

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_FUSED_MOTION_SOURCE_H_
