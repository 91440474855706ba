// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_TESTS_EVALUATION_BASELINES_MOVING_FRAMES_H_
#define RSSTAB_TESTS_EVALUATION_BASELINES_MOVING_FRAMES_H_

#include <functional>
#include <utility>
#include <vector>

#include "evaluation/motion_method.h"
#include "evaluation/photo_scene.h"
#include "igf/base/readout_motion.h"
#include "igf/base/rolling_shutter.h"
#include "igf/base/rotation.h"
#include "igf/base/seeded_random.h"
#include "igf/intra_gyro_field.h"
#include "tests/evaluation/test_photos.h"

namespace rsstab::testing {

inline constexpr double kFrameIntervalS = 1.0 / 30.0;

// Three consecutive rolling-shutter frames of patches of many grey levels, taken by a camera whose
// rotation vector (camera_from_world) is a function of time; the middle one at 0.
struct MovingFrames {
  Camera camera;
  std::vector<Frame> frames;  // at -1, 0 and 1 frame intervals
  MotionField truth;          // of the middle frame

  explicit MovingFrames(const std::function<Eigen::Vector3d(double time_s)>& rotation,
                        double readout_s = 0.02, double reference_row = 239.0 / 2.0) {
    camera = Camera::Pinhole(320, 240, 300.0);
    camera.readout_s = readout_s;
    const auto at = [&](double time_s) { return ExpSo3<double>(rotation(time_s)); };
    std::vector<evaluation::RowOrientation> exposures;
    for (const double frame : {-1.0, 0.0, 1.0}) {
      exposures.emplace_back([this, at, frame, readout_s](int row) {
        return at(RowExposureTime(frame * kFrameIntervalS, static_cast<double>(row), camera.height,
                                  readout_s));
      });
    }
    // Patches of several sizes, so that points are found again over large and small distances.
    const Frame photo = MakePhoto(480, 360, [](int x, int y) {
      double level = 30.0;
      for (const int size : {9, 24, 70}) {
        const auto patch = static_cast<std::uint64_t>((y / size) * 1000 + x / (size + 2));
        level += static_cast<double>(MixBits(patch + static_cast<std::uint64_t>(size)) % 64);
      }
      return level;
    });
    const auto scene = evaluation::PhotoScene::Create(photo.View(), camera, exposures).value();
    for (const evaluation::RowOrientation& exposure : exposures) {
      frames.push_back(scene.Record(exposure, {1.0, frames.size()}).value());
    }
    std::vector<double> times;
    std::vector<Eigen::Quaterniond> world_from_camera;
    for (int i = -400; i <= 400; ++i) {
      times.push_back(1e-4 * i);
      world_from_camera.push_back(at(times.back()).conjugate());
    }
    const auto track = igf::OrientationTrack::Create(times, world_from_camera).value();
    const auto motion =
        igf::ComputeReadoutMotion(camera, track, 0.0, readout_s, reference_row).value();
    truth = ComputeReadoutField(camera, motion).value();
    truth.set_reference_row(reference_row);
  }

  // What `method` makes of the middle frame, given the frames on the sides where there are any.
  [[nodiscard]] Result<evaluation::MethodAnswer> Ask(evaluation::MotionMethod& method,
                                                     const Frame* before,
                                                     const Frame* after) const {
    evaluation::MethodInput input;
    input.rs = frames[1].View();
    const FrameView previous = before != nullptr ? before->View() : FrameView();
    const FrameView next = after != nullptr ? after->View() : FrameView();
    input.previous = before != nullptr ? &previous : nullptr;
    input.next = after != nullptr ? &next : nullptr;
    input.camera = &camera;
    input.frame_interval_s = kFrameIntervalS;
    input.reference_row = truth.reference_row();
    return method.Estimate(input);
  }
};

// Mean length of the difference of two fields of one grid, px.
inline double MeanDifference(const MotionField& a, const MotionField& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.vertices().size(); ++i) {
    sum += static_cast<double>((a.vertices()[i] - b.vertices()[i]).norm());
  }
  return sum / static_cast<double>(a.vertices().size());
}

}  // namespace rsstab::testing

#endif  // RSSTAB_TESTS_EVALUATION_BASELINES_MOVING_FRAMES_H_
