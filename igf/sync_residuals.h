// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_SYNC_RESIDUALS_H_
#define RSSTAB_IGF_SYNC_RESIDUALS_H_

#include <ceres/jet.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "igf/base/rotation.h"
#include "igf/orientation_track.h"
#include "igf/sync_pairs.h"

namespace rsstab::igf {

inline double ScalarPart(double value) { return value; }
template <typename T, int N>
double ScalarPart(const ceres::Jet<T, N>& value) {
  return value.a;
}

// One-parameter radial lens (Fitzgibbon's division model) between the image plane of a pinhole, u,
// and that of the lens, d: u = d / (1 + curvature |d|^2). 0 is a pinhole, -1/3 nearly an
// equidistant fisheye. Exact inverses of each other for curvature |u|^2 < 1/4.
template <typename T>
[[nodiscard]] Eigen::Matrix<T, 2, 1> BendPlane(const Eigen::Matrix<T, 2, 1>& u,
                                               const T& curvature) {
  using std::sqrt;
  return u * (T(2.0) / (T(1.0) + sqrt(T(1.0) - 4.0 * curvature * u.squaredNorm())));
}
template <typename T>
[[nodiscard]] Eigen::Matrix<T, 2, 1> StraightenPlane(const Eigen::Matrix<T, 2, 1>& d,
                                                     const T& curvature) {
  return d / (T(1.0) + curvature * d.squaredNorm());
}

// Row-timed track residual, px: pi(K R(t') R(t)^T K^-1 x) - x', with t and t' the exposure times of
// the match's two rows on the gyro's clock.
// Parameters: offset (s, t_video = t_gyro + offset), gyro bias (3, rad/s), logarithm of the true
// over the assumed focal length, curvature of the lens, readout (s), and the drift (2, px) that the
// scene adds in this part of the picture for a while (parallax of a camera that moves steadily).
class SyncTrackResidual {
 public:
  static constexpr int kResiduals = 2;

  // `track` (gyro clock, bias still in it) must outlive the residual.
  SyncTrackResidual(const OrientationTrack& track, double from_time_s, double to_time_s,
                    const SyncMatch& match)
      : track_(&track), from_time_s_(from_time_s), to_time_s_(to_time_s), match_(match) {}

  [[nodiscard]] const SyncMatch& match() const { return match_; }

  template <typename T>
  bool operator()(const T* offset_s, const T* bias_rad_s, const T* log_focal, const T* curvature,
                  const T* readout_s, const T* drift_px, T* residual_px) const {
    using std::exp;
    const T from_s = from_time_s_ + readout_s[0] * match_.from_row_share - offset_s[0];
    const T to_s = to_time_s_ + readout_s[0] * match_.to_row_share - offset_s[0];
    const Eigen::Matrix<T, 3, 1> bias(bias_rad_s[0], bias_rad_s[1], bias_rad_s[2]);
    // The two times are a frame or so apart, so a constant bias acts to first order: with
    // world_from_camera q' = q D, the true D is D exp(-bias (t' - t)).
    const Eigen::Quaternion<T> to_from_from =
        ExpSo3(Eigen::Matrix<T, 3, 1>(bias * (to_s - from_s))) *
        (WorldFromCamera(to_s).conjugate() * WorldFromCamera(from_s));
    const T focal = exp(log_focal[0]);
    const Eigen::Matrix<T, 2, 1> from = match_.from.template cast<T>() / focal;
    if (!(1.0 + ScalarPart(curvature[0]) * ScalarPart(from.squaredNorm()) > kMinDepth)) {
      return false;  // beyond the image circle of so bent a lens
    }
    const Eigen::Matrix<T, 2, 1> straight = StraightenPlane(from, curvature[0]);
    const Eigen::Matrix<T, 3, 1> moved =
        to_from_from * Eigen::Matrix<T, 3, 1>(straight.x(), straight.y(), T(1.0));
    if (!(ScalarPart(moved.z()) > kMinDepth)) {
      return false;
    }
    const Eigen::Matrix<T, 2, 1> seen(moved.x() / moved.z(), moved.y() / moved.z());
    if (!(4.0 * ScalarPart(curvature[0]) * ScalarPart(seen.squaredNorm()) < 1.0 - kMinDepth)) {
      return false;
    }
    const Eigen::Matrix<T, 2, 1> to = BendPlane(seen, curvature[0]);
    residual_px[0] = match_.px_per_unit * (focal * to.x() - match_.to.x()) + drift_px[0];
    residual_px[1] = match_.px_per_unit * (focal * to.y() - match_.to.y()) + drift_px[1];
    return true;
  }

 private:
  static constexpr double kMinDepth = 1e-2;

  template <typename T>
  [[nodiscard]] Eigen::Quaternion<T> WorldFromCamera(const T& time_s) const {
    const OrientationAnchor anchor = track_->AnchorAt(ScalarPart(time_s));
    const Eigen::Matrix<T, 3, 1> turn =
        anchor.rate_rad_s.template cast<T>() * (time_s - anchor.time_s);
    return anchor.world_from_camera.template cast<T>() * ExpSo3(turn);
  }

  const OrientationTrack* track_;
  double from_time_s_;
  double to_time_s_;
  SyncMatch match_;
};

// (value - expected) / sigma for N numbers: what is known before any track is looked at.
template <int N>
class SyncPriorResidual {
 public:
  static constexpr int kResiduals = N;

  SyncPriorResidual(double expected, double sigma) : expected_(expected), sigma_(sigma) {}

  template <typename T>
  bool operator()(const T* value, T* residual) const {
    for (int i = 0; i < N; ++i) {
      residual[i] = (value[i] - expected_) / sigma_;
    }
    return true;
  }

 private:
  double expected_;
  double sigma_;
};

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_SYNC_RESIDUALS_H_
