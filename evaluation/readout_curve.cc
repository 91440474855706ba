// SPDX-License-Identifier: Apache-2.0
#include "evaluation/readout_curve.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "igf/base/rotation.h"

namespace rsstab::evaluation {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

// Root mean square distance of a 4:3 picture's pixels from its centre, in image heights: what a
// roll of 1 rad moves them by.
constexpr double kRollArm = 0.481;

constexpr double kLeastCycles = 0.5;
constexpr double kMostCycles = 3.0;

// Vertices of the truth: every 2 rows and 12.5 columns of 800x600. A sine of 25 px and 3 cycles
// bends by 25 (2 pi 3 2 / 600)^2 / 8 = 0.01 px between two rows, perspective by less across.
constexpr FieldGrid kTruthGrid{65, 301};

// A direction in (a, b, roll moved at arm's length), uniform on the sphere.
Eigen::Vector3d DrawAxis(SeededRandom& random) {
  Eigen::Vector3d axis;
  do {
    axis = Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal());
  } while (axis.norm() < 1e-3);
  axis.normalize();
  axis.z() /= kRollArm;
  return axis;
}

void DrawTones(SeededRandom& random, double size, ReadoutCurve& curve) {
  const Eigen::Vector3d axis = DrawAxis(random);
  for (int c = 0; c < 3; ++c) {
    curve.tones[static_cast<std::size_t>(c)] = {
        size * axis[c], random.Uniform(kLeastCycles, kMostCycles), random.Uniform(0.0, kTurn)};
  }
}

// Steady, accelerated and oscillating parts whose values have similar root mean squares: s has
// 0.29 over the readout, s^2 about its middle value 0.11, a sine 0.7.
constexpr double kSteadySize = 1.0 / 0.29;
constexpr double kAcceleratedSize = 1.0 / 0.11;
constexpr double kToneSize = 1.0 / 0.7;
constexpr double kLeastShare = 0.2;

ReadoutCurve DrawMixed(SeededRandom& random) {
  ReadoutCurve curve;
  const auto share = [&random] { return random.Uniform(kLeastShare, 1.0); };
  curve.steady = share() * kSteadySize * DrawAxis(random);
  curve.acceleration = share() * kAcceleratedSize * DrawAxis(random);
  DrawTones(random, share() * kToneSize, curve);
  return curve;
}

// Mean length of the field over the visible pixels, from a grid of pixels.
Result<double> MeanLength(const ReadoutCurve& curve, const Camera& camera) {
  constexpr int kAcross = 41;
  constexpr int kDown = 61;
  const Result<ReadoutMotion> motion = MotionOfCurve(curve, camera);
  if (!motion) {
    return Propagate(motion.error());
  }
  double sum = 0.0;
  int count = 0;
  for (int j = 0; j < kDown; ++j) {
    for (int i = 0; i < kAcross; ++i) {
      // Centres of equal cells, so that the mean is that over all pixels.
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

Eigen::Vector3d ReadoutCurve::AtTime(double s) const {
  Eigen::Vector3d value = s * steady + s * s * acceleration;
  for (int c = 0; c < 3; ++c) {
    const Tone& tone = tones[static_cast<std::size_t>(c)];
    value[c] += tone.amplitude *
                (std::sin(kTurn * tone.cycles * s + tone.phase_rad) - std::sin(tone.phase_rad));
  }
  return strength * value;
}

Eigen::Vector3d ReadoutCurve::AtRow(double row, int height) const {
  const double s = (row + 0.5) / height - 0.5;
  return AtTime(top_to_bottom ? s : -s);
}

Eigen::Quaterniond ReadoutCurve::RowRotation(const Camera& camera, double row) const {
  const Eigen::Vector3d value = AtRow(row, camera.height);
  return ExpSo3(Eigen::Vector3d(-value.y() * camera.height / camera.fy,
                                value.x() * camera.height / camera.fx, value.z()));
}

std::string_view MotionClassName(MotionClass motion_class) {
  switch (motion_class) {
    case MotionClass::kSkewTwist:
      return "skew-twist";
    case MotionClass::kStretch:
      return "stretch";
    case MotionClass::kOscillation:
      return "oscillation";
    case MotionClass::kMixed:
      return "mixed";
    case MotionClass::kStill:
      return "still";
  }
  return "?";
}

ReadoutCurve DrawCurve(MotionClass motion_class, SeededRandom& random) {
  const bool top_to_bottom = random.Uniform() < 0.5;
  ReadoutCurve curve;
  switch (motion_class) {
    case MotionClass::kSkewTwist: {
      const double angle = random.Uniform(0.0, kTurn);
      curve.steady = {std::cos(angle), 0.0, std::sin(angle) / kRollArm};
      break;
    }
    case MotionClass::kStretch:
      curve.steady.y() = random.Uniform() < 0.5 ? -1.0 : 1.0;
      break;
    case MotionClass::kOscillation:
      DrawTones(random, 1.0, curve);
      break;
    case MotionClass::kMixed:
      curve = DrawMixed(random);
      break;
    case MotionClass::kStill:
      break;
  }
  curve.top_to_bottom = top_to_bottom;
  return curve;
}

Result<ReadoutMotion> MotionOfCurve(const ReadoutCurve& curve, const Camera& camera) {
  std::vector<Eigen::Quaterniond> rotations;
  const int count = ReadoutMotion::KnotCount(camera.height);
  rotations.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    rotations.push_back(curve.RowRotation(camera, (camera.height - 1.0) * i / (count - 1)));
  }
  return ReadoutMotion::Create(camera, rotations);
}

Result<MotionField> TruthField(const ReadoutCurve& curve, const Camera& camera) {
  const Result<ReadoutMotion> motion = MotionOfCurve(curve, camera);
  if (!motion) {
    return Propagate(motion.error());
  }
  return ComputeReadoutField(camera, *motion, kTruthGrid);
}

Status ScaleToMeanLength(ReadoutCurve& curve, const Camera& camera, double mean_px) {
  // The length is nearly proportional to the strength, so a few proportional steps suffice.
  constexpr int kMaxSteps = 20;
  constexpr double kClose = 1e-4;
  constexpr double kStart = 0.005;  // a few px of displacement
  curve.strength = kStart;
  for (int i = 0; i < kMaxSteps; ++i) {
    const Result<double> length = MeanLength(curve, camera);
    if (!length) {
      return Propagate(length.error());
    }
    if (!(*length > 0.0)) {
      return Fail(ErrorCode::kInvalidArgument, "a curve without motion cannot be scaled");
    }
    const double ratio = mean_px / *length;
    if (std::abs(ratio - 1.0) < kClose) {
      return {};
    }
    curve.strength *= ratio;
  }
  return Fail(ErrorCode::kInvalidArgument, "no strength of a motion gives a mean length of {} px",
              mean_px);
}

}  // namespace rsstab::evaluation
