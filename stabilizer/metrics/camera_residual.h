// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_METRICS_CAMERA_RESIDUAL_H_
#define RSSTAB_STABILIZER_METRICS_CAMERA_RESIDUAL_H_

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "igf/base/camera.h"
#include "igf/base/frame.h"
#include "igf/base/point_tracks.h"
#include "igf/base/result.h"

namespace rsstab::stabilizer {

// The turned and zoomed view that explains matches best: x_to = pi(K R K^-1 Z x_from), Z = zoom
// about the principal point.
struct RotationZoom {
  Eigen::Quaterniond to_from_from = Eigen::Quaterniond::Identity();
  double zoom = 1.0;
  std::vector<std::uint8_t> inlier;  // one a match; 0 = left out as a wrong match
  std::size_t inliers = 0;
  double rms_px = 0.0;  // over the inliers, px of `to_camera`
};

// Least squares over the matches that are no gross outliers: first with Huber's loss (1 px at 640
// px width), then without those beyond 1 px and beyond four robust standard deviations
// (1.4826 x median), plain. Pixels go through the cameras' own lens models; both cameras are the
// same lens at the sizes of the two pictures. Empty with fewer than 12 matches.
[[nodiscard]] std::optional<RotationZoom> FitRotationZoom(std::span<const PointMatch> matches,
                                                          const Camera& from_camera,
                                                          const Camera& to_camera);

// How far a clip is from pictures that a global shutter could have taken. px at 640 px width,
// root mean square over all matches of all frames.
struct TruthMetrics {
  std::int64_t frames = 0;
  std::int64_t unaligned = 0;  // frames in which nothing agreed; left out
  double matches_per_frame = 0.0;
  // Against the exact global-shutter picture of the same instant, after the best rotation and zoom
  // of the true camera: sees skew, stretch, bending and wrong perspective. Tracking two encodings
  // of one picture leaves about 0.1 px.
  std::optional<double> camera_residual;
  std::optional<double> worst_frame;  // the largest camera residual of a single frame
  std::optional<double> bend;         // the same after the best free homography
  std::vector<float> frame_residual;  // camera residual of each frame; NaN where nothing agreed
};

// Compares a clip with its global-shutter twin. Any order, not thread safe; keeps a few numbers,
// and one for each frame.
class TruthMeter {
 public:
  // `camera` of the twin's pictures; another picture size is the same view, scaled.
  // Errors: a camera that does not validate.
  [[nodiscard]] static Result<TruthMeter> Create(const Camera& camera);

  // A frame and the twin's frame of the same index. Errors: kInvalidArgument for a frame without
  // samples.
  [[nodiscard]] Status Push(const FrameView& frame, const FrameView& twin);

  [[nodiscard]] TruthMetrics Measure() const;

  // Camera residual of the last frame; empty where nothing agreed.
  [[nodiscard]] std::optional<double> LastResidual() const;

 private:
  explicit TruthMeter(Camera camera) : camera_(std::move(camera)) {}

  Camera camera_;
  std::int64_t frames_ = 0;
  std::int64_t aligned_ = 0;
  std::size_t matches_ = 0;
  double squares_ = 0.0;
  double bend_squares_ = 0.0;
  double worst_ = 0.0;
  std::vector<float> frame_residual_;
};

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_METRICS_CAMERA_RESIDUAL_H_
