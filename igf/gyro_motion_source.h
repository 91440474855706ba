// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_GYRO_MOTION_SOURCE_H_
#define RSSTAB_IGF_GYRO_MOTION_SOURCE_H_

#include <optional>
#include <string>

#include "igf/base/camera.h"
#include "igf/base/rs_motion_source.h"
#include "igf/intra_gyro_field.h"
#include "igf/orientation_track.h"

namespace rsstab::igf {

// Readout motion told by a gyro log. Needs no picture. Calls are independent of each other.
class GyroMotionSource final : public RsMotionSource {
 public:
  // `camera` of the image size in which fields are wanted; `readout_s` signed, first row to last;
  // `track` on the video clock, bias removed.
  // Errors: kInvalidArgument for an invalid camera, readout or grid.
  [[nodiscard]] static Result<GyroMotionSource> Create(Camera camera, double readout_s,
                                                       OrientationTrack track,
                                                       const FieldGrid& grid = {});

  [[nodiscard]] std::string Name() const override { return "gyro"; }
  [[nodiscard]] bool NeedsImage() const override { return false; }
  // Errors: kUntrustworthy where the log does not cover the frame's readout.
  [[nodiscard]] Result<RsMotion> EstimateMotion(const FrameContext& frame) override;
  [[nodiscard]] std::optional<Eigen::Quaterniond> CameraFromWorld(double time_s) const override;
  [[nodiscard]] std::optional<Eigen::Quaterniond> TurnBetween(double from_s,
                                                              double to_s) const override;

 private:
  GyroMotionSource(Camera camera, double readout_s, OrientationTrack track, const FieldGrid& grid);

  Camera camera_;
  double readout_s_;
  OrientationTrack track_;
  FieldGrid grid_;
};

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_GYRO_MOTION_SOURCE_H_
