// SPDX-License-Identifier: Apache-2.0
#include "evaluation/hand_motion.h"

#include <cmath>
#include <utility>
#include <vector>

#include "igf/base/readout_motion.h"
#include "igf/base/seeded_random.h"
#include "igf/intra_gyro_field.h"
#include "igf/motion_presets.h"

namespace rsstab::evaluation {
namespace {

constexpr double kPresetLengthS = 10.0;
constexpr int kInstants = 8;
constexpr double kReferenceWidth = 800.0;

// The preset's motion about one instant, at `scale` times its size.
class ScaledMotion {
 public:
  ScaledMotion(const igf::PresetMotion& motion, double instant_s)
      : motion_(motion), instant_s_(instant_s), rest_(motion.Angles(instant_s)) {}

  // `time_s` counts from the first frame, whose middle row is at the instant.
  [[nodiscard]] Eigen::Quaterniond WorldFromCamera(double time_s, double scale) const {
    const Eigen::Vector3d angles = scale * (motion_.Angles(instant_s_ + time_s) - rest_);
    return Eigen::AngleAxisd(angles.y(), Eigen::Vector3d::UnitY()) *
           Eigen::AngleAxisd(angles.x(), Eigen::Vector3d::UnitX()) *
           Eigen::AngleAxisd(angles.z(), Eigen::Vector3d::UnitZ());
  }

  [[nodiscard]] Result<igf::OrientationTrack> Track(double begin_s, double end_s,
                                                    double scale) const {
    std::vector<double> times;
    std::vector<Eigen::Quaterniond> orientations;
    const auto samples =
        static_cast<int>(std::ceil((end_s - begin_s) * igf::kPresetSamplingHz)) + 2;
    for (int i = 0; i < samples; ++i) {
      times.push_back(begin_s + i / igf::kPresetSamplingHz);
      orientations.push_back(WorldFromCamera(times.back(), scale));
    }
    return igf::OrientationTrack::Create(std::move(times), std::move(orientations));
  }

 private:
  const igf::PresetMotion& motion_;
  double instant_s_;
  Eigen::Vector3d rest_;
};

// Mean length of the field of the frame at `time_s`, first row's view, over a grid of its pixels
// that have a source.
Result<double> MeanLength(const Camera& camera, const igf::OrientationTrack& track, double time_s) {
  constexpr int kAcross = 21;
  constexpr int kDown = 31;
  const auto motion = igf::ComputeReadoutMotion(camera, track, time_s, *camera.readout_s, 0.0);
  if (!motion) {
    return Propagate(motion.error());
  }
  double sum = 0.0;
  int count = 0;
  for (int j = 0; j < kDown; ++j) {
    for (int i = 0; i < kAcross; ++i) {
      const Eigen::Vector2d pixel((i + 0.5) / kAcross * camera.width - 0.5,
                                  (j + 0.5) / kDown * camera.height - 0.5);
      const auto source = motion->RsFromGs(pixel);
      if (source && source->x() >= 0.0 && source->x() <= camera.width - 1.0 && source->y() >= 0.0 &&
          source->y() <= camera.height - 1.0) {
        sum += (*source - pixel).norm();
        ++count;
      }
    }
  }
  if (count == 0) {
    return Fail(ErrorCode::kInvalidArgument, "a motion leaves no pixel inside the frame");
  }
  return sum / count;
}

}  // namespace

Result<HandMotion> MakeHandMotion(const MotionStrength& strength, const Camera& camera, int frames,
                                  double frame_interval_s, double margin_s, std::uint64_t seed) {
  if (!camera.readout_s || frames < 1) {
    return Fail(ErrorCode::kInvalidArgument,
                "a camera without readout time, or no frame, has no motion inside frames");
  }
  SeededRandom random(seed);
  const igf::MotionPreset preset =
      igf::kMotionPresets[static_cast<std::size_t>(random.Integer(0, 3))];
  const igf::PresetMotion motion(preset, random.Bits(), kPresetLengthS);
  const double target_px =
      random.Uniform(strength.least_px, strength.most_px) * camera.width / kReferenceWidth;
  const double begin_s = -margin_s - std::abs(*camera.readout_s);
  const double end_s = (frames - 1) * frame_interval_s + margin_s + std::abs(*camera.readout_s);
  const double judged_s = frames / 2 * frame_interval_s;
  double instant_s = 0.0;
  double fastest = -1.0;
  for (int i = 0; i < kInstants; ++i) {
    const double candidate_s = random.Uniform(0.0, kPresetLengthS);
    const double half_s = *camera.readout_s / 2.0;
    const double speed = (motion.Angles(candidate_s + judged_s + half_s) -
                          motion.Angles(candidate_s + judged_s - half_s))
                             .norm();
    if (speed > fastest) {
      fastest = speed;
      instant_s = candidate_s;
    }
  }
  const ScaledMotion scaled(motion, instant_s);
  // The length is nearly proportional to the scale, so a few proportional steps suffice.
  constexpr int kMaxSteps = 20;
  constexpr double kClose = 1e-3;
  double scale = 0.1;
  for (int step = 0; step < kMaxSteps; ++step) {
    auto track = scaled.Track(begin_s, end_s, scale);
    if (!track) {
      return Propagate(track.error());
    }
    const auto length = MeanLength(camera, *track, judged_s);
    if (!length) {
      return Propagate(length.error());
    }
    const double ratio = target_px / *length;
    if (std::abs(ratio - 1.0) < kClose) {
      return HandMotion{std::string(igf::MotionPresetName(preset)), std::move(*track),
                        frame_interval_s};
    }
    scale *= ratio;
  }
  return Fail(ErrorCode::kInvalidArgument, "no size of a motion displaces a frame by {} px",
              target_px);
}

}  // namespace rsstab::evaluation
