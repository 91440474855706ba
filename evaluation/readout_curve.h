// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_EVALUATION_READOUT_CURVE_H_
#define RSSTAB_EVALUATION_READOUT_CURVE_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <string_view>

#include "igf/base/camera.h"
#include "igf/base/motion_field.h"
#include "igf/base/readout_motion.h"
#include "igf/base/result.h"
#include "igf/base/seeded_random.h"

namespace rsstab::evaluation {

// amplitude * sin(2 pi cycles s + phase)
struct Tone {
  double amplitude = 0.0;
  double cycles = 0.0;  // over one readout
  double phase_rad = 0.0;
};

// How a camera turns while one frame is read out, as a smooth function of time. Values are
// (a, b, r): displacement G of the image centre, in image heights, x to the right and y down, and
// roll in rad; they stand for camera_row_from_reference = exp([w]x) with
//   w = (-b H / fy, a H / fx, r),
// the convention of rsdiff/rotation_curve.h, restated here because truth and estimate must not
// share code. Time s runs from -0.5 to 0.5 over the readout and may go beyond; at the middle row
// s = 0, and the value is zero there.
struct ReadoutCurve {
  Eigen::Vector3d steady = Eigen::Vector3d::Zero();        // times s
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  // times s^2
  std::array<Tone, 3> tones;                               // of a, b, r
  bool top_to_bottom = true;                               // which row is exposed first
  double strength = 1.0;                                   // factor on everything above

  [[nodiscard]] Eigen::Vector3d AtTime(double s) const;
  // s = (row + 0.5) / height - 0.5, negated when the bottom row is exposed first. Rows beyond the
  // frame are allowed.
  [[nodiscard]] Eigen::Vector3d AtRow(double row, int height) const;
  // camera_row_from_reference at a row of the camera's image.
  [[nodiscard]] Eigen::Quaterniond RowRotation(const Camera& camera, double row) const;
};

// What a frame of the synthetic protocol goes through; docs/evaluation.md defines them.
enum class MotionClass {
  kSkewTwist,    // steady yaw and roll
  kStretch,      // steady pitch
  kOscillation,  // yaw, pitch and roll, each 0.5 to 3 cycles
  kMixed,        // steady, accelerated and oscillating at once, about all axes
  kStill,        // none
};
inline constexpr std::array<MotionClass, 4> kMovingClasses = {
    MotionClass::kSkewTwist, MotionClass::kStretch, MotionClass::kOscillation, MotionClass::kMixed};

// "skew-twist", "stretch", "oscillation", "mixed", "still".
[[nodiscard]] std::string_view MotionClassName(MotionClass motion_class);

// A random curve of a class, of arbitrary strength, in either readout direction.
[[nodiscard]] ReadoutCurve DrawCurve(MotionClass motion_class, SeededRandom& random);

// The curve's exact motion for igf/base, reference the middle row.
// Errors: those of ReadoutMotion::Create.
[[nodiscard]] Result<ReadoutMotion> MotionOfCurve(const ReadoutCurve& curve, const Camera& camera);

// The true field, on a grid so fine that bilinear interpolation between its vertices stays within
// 0.01 px for motions of 25 px and 3 cycles at 800x600. Errors: as above.
[[nodiscard]] Result<MotionField> TruthField(const ReadoutCurve& curve, const Camera& camera);

// Sets the curve's strength such that the field's mean length, over the pixels whose source lies
// inside the recorded frame, is `mean_px` > 0: the end-point error of leaving the frame as it is.
// Errors: kInvalidArgument for a curve without motion or a length that no strength reaches.
[[nodiscard]] Status ScaleToMeanLength(ReadoutCurve& curve, const Camera& camera, double mean_px);

}  // namespace rsstab::evaluation

#endif  // RSSTAB_EVALUATION_READOUT_CURVE_H_
