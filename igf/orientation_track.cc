// SPDX-License-Identifier: Apache-2.0
#include "igf/orientation_track.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "igf/base/rotation.h"

namespace rsstab::igf {
namespace {

constexpr double kMinQuaternionNorm = 1e-6;
// A guessed index this close to the right one is walked to; farther away, bisection is quicker.
constexpr int kMaxSteps = 4;

}  // namespace

Result<OrientationTrack> OrientationTrack::Create(std::vector<double> times_s,
                                                  std::vector<Eigen::Quaterniond> world_from_camera,
                                                  std::vector<TimeSpan> gaps) {
  if (times_s.size() != world_from_camera.size() || times_s.size() < 2) {
    return Fail(ErrorCode::kInvalidArgument,
                "an orientation track needs at least two samples and as many times as "
                "orientations, not {} times and {} orientations",
                times_s.size(), world_from_camera.size());
  }
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    if (!std::isfinite(times_s[i]) || (i > 0 && !(times_s[i] > times_s[i - 1]))) {
      return Fail(ErrorCode::kInvalidArgument,
                  "orientation sample {} at {} s: times must be finite and increase", i,
                  times_s[i]);
    }
    const double norm = world_from_camera[i].norm();
    if (!std::isfinite(norm) || norm < kMinQuaternionNorm) {
      return Fail(ErrorCode::kInvalidArgument,
                  "orientation sample {} at {} s: the quaternion has no direction", i, times_s[i]);
    }
    world_from_camera[i].coeffs() /= norm;
  }
  return OrientationTrack(std::move(times_s), std::move(world_from_camera), std::move(gaps));
}

OrientationTrack::OrientationTrack(std::vector<double> times_s,
                                   std::vector<Eigen::Quaterniond> world_from_camera,
                                   std::vector<TimeSpan> gaps)
    : times_s_(std::move(times_s)),
      world_from_camera_(std::move(world_from_camera)),
      gaps_(std::move(gaps)),
      intervals_per_s_(static_cast<double>(times_s_.size() - 1) /
                       (times_s_.back() - times_s_.front())) {}

bool OrientationTrack::Covers(double from_s, double to_s) const {
  return CoversSampleTimes(std::min(from_s, to_s) - offset_s_, std::max(from_s, to_s) - offset_s_);
}

bool OrientationTrack::CoversSampleTimes(double low, double high) const {
  // Written so that NaN is outside.
  if (!(low >= times_s_.front() && high < times_s_.back())) {
    return false;
  }
  // The first gap that ends after `low` is the only one that can overlap from below.
  const auto gap = std::upper_bound(gaps_.begin(), gaps_.end(), low,
                                    [](double t, const TimeSpan& g) { return t < g.end_s; });
  return gap == gaps_.end() || high <= gap->begin_s;
}

std::optional<Eigen::Quaterniond> OrientationTrack::CameraFromWorld(double time_s) const {
  const auto world_from_camera = WorldFromCamera(time_s - offset_s_);
  if (!world_from_camera) {
    return std::nullopt;
  }
  return world_from_camera->conjugate();
}

std::optional<Eigen::Vector3d> OrientationTrack::MeanRate(double from_s, double to_s) const {
  const double from_t = from_s - offset_s_;
  const double to_t = to_s - offset_s_;
  if (!(to_s > from_s) || !CoversSampleTimes(from_t, to_t)) {
    return std::nullopt;
  }
  return LogSo3(Eigen::Quaterniond(WorldFromCamera(from_t)->conjugate() * *WorldFromCamera(to_t))) /
         (to_s - from_s);
}

OrientationAnchor OrientationTrack::AnchorAt(double time_s) const {
  // Not std::clamp: NaN must end up inside, too.
  const double t = std::max(times_s_.front(), std::min(time_s - offset_s_, times_s_.back()));
  const std::size_t i = t < times_s_.back() ? IntervalAt(t) : times_s_.size() - 2;
  const Eigen::Quaterniond& q = world_from_camera_[i];
  return {times_s_[i] + offset_s_, q,
          LogSo3(Eigen::Quaterniond(q.conjugate() * world_from_camera_[i + 1])) /
              (times_s_[i + 1] - times_s_[i])};
}

OrientationTrack OrientationTrack::WithOffset(double offset_s) const {
  OrientationTrack shifted = *this;
  shifted.offset_s_ += offset_s;
  return shifted;
}

std::optional<Eigen::Quaterniond> OrientationTrack::WorldFromCamera(double t) const {
  if (!CoversSampleTimes(t, t)) {
    return std::nullopt;
  }
  const std::size_t i = IntervalAt(t);
  const double share = (t - times_s_[i]) / (times_s_[i + 1] - times_s_[i]);
  return world_from_camera_[i].slerp(share, world_from_camera_[i + 1]);
}

std::size_t OrientationTrack::IntervalAt(double t) const {
  const std::size_t last = times_s_.size() - 2;
  auto i = std::min(static_cast<std::size_t>((t - times_s_.front()) * intervals_per_s_), last);
  // Logs are nearly uniform: the guess is right or next to it.
  for (int step = 0; step < kMaxSteps; ++step) {
    if (t < times_s_[i]) {
      --i;
    } else if (t >= times_s_[i + 1]) {
      ++i;
    } else {
      return i;
    }
  }
  const auto after = std::upper_bound(times_s_.begin(), times_s_.end(), t);
  return static_cast<std::size_t>(after - times_s_.begin()) - 1;
}

}  // namespace rsstab::igf
