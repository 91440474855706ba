// SPDX-License-Identifier: Apache-2.0
#include "evaluation/path_angle_score.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <utility>

#include "igf/base/rotation.h"

namespace rsstab::evaluation {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

using stabilizer::FrameOrientation;

// Mean and root mean square of vectors.
class VectorSums {
 public:
  void Add(const Eigen::Vector3d& v) {
    sum_ += v;
    squares_ += v.cwiseAbs2();
    ++count_;
  }
  [[nodiscard]] std::optional<Eigen::Vector3d> Mean() const {
    return count_ > 0 ? std::optional<Eigen::Vector3d>(sum_ / count_) : std::nullopt;
  }
  [[nodiscard]] std::optional<Eigen::Vector3d> Axes() const {
    return count_ > 0 ? std::optional<Eigen::Vector3d>((squares_ / count_).cwiseSqrt())
                      : std::nullopt;
  }
  [[nodiscard]] std::optional<double> Length() const {
    return count_ > 0 ? std::optional(std::sqrt(squares_.sum() / count_)) : std::nullopt;
  }

 private:
  Eigen::Vector3d sum_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d squares_ = Eigen::Vector3d::Zero();
  double count_ = 0.0;
};

// The rotation that all of them are closest to: q and -q are one, so the largest eigenvector of the
// sum of q q^T (Markley et al. 2007).
Eigen::Quaterniond MeanRotation(const std::vector<Eigen::Quaterniond>& rotations) {
  Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
  for (const Eigen::Quaterniond& q : rotations) {
    sum += q.coeffs() * q.coeffs().transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(sum);
  const Eigen::Vector4d mean = solver.eigenvectors().col(3);
  return Eigen::Quaterniond(mean).normalized();
}

struct Errors {
  std::int64_t frames = 0;
  VectorSums angles;
  VectorSums steps;
};

// Radians; steps in the axes of the later frame.
Errors Compare(const OrientationPath& found, const OrientationPath& reference) {
  Errors errors;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Eigen::Quaterniond>> gauges;
  for (std::size_t n = 0; n < found.size(); ++n) {
    if (!found[n] || !reference[n]) {
      continue;
    }
    ++errors.frames;
    const FrameOrientation& a = *found[n];
    const FrameOrientation& b = *reference[n];
    // A = B G: what of the path is the free choice of the world frame, and the same in all frames.
    gauges[{a.world, b.world}].push_back(b.camera_from_world.conjugate() * a.camera_from_world);
    if (n == 0 || !found[n - 1] || !reference[n - 1] || found[n - 1]->world != a.world ||
        reference[n - 1]->world != b.world) {
      continue;
    }
    const Eigen::Quaterniond step =
        a.camera_from_world * found[n - 1]->camera_from_world.conjugate();
    const Eigen::Quaterniond true_step =
        b.camera_from_world * reference[n - 1]->camera_from_world.conjugate();
    errors.steps.Add(LogSo3<double>(step * true_step.conjugate()));
  }
  for (const auto& [worlds, rotations] : gauges) {
    const Eigen::Quaterniond gauge = MeanRotation(rotations);
    for (const Eigen::Quaterniond& rotation : rotations) {
      errors.angles.Add(LogSo3<double>(rotation * gauge.conjugate()));
    }
  }
  return errors;
}

// A camera that stands still, wherever the other path is known, in its worlds.
OrientationPath Still(const OrientationPath& path) {
  OrientationPath still(path.size());
  for (std::size_t n = 0; n < path.size(); ++n) {
    if (path[n]) {
      still[n] = FrameOrientation{Eigen::Quaterniond::Identity(), path[n]->world};
    }
  }
  return still;
}

std::optional<double> Scaled(const std::optional<double>& value, double scale) {
  return value ? std::optional(scale * *value) : std::nullopt;
}

}  // namespace

Result<OrientationPath> ReadOrientationPath(const std::string& analysis_file) {
  const auto reader = stabilizer::AnalysisReader::Open(analysis_file);
  if (!reader) {
    return Propagate(reader.error());
  }
  OrientationPath path;
  while (true) {
    const auto frame = (*reader)->Next();
    if (!frame) {
      return Propagate(frame.error());
    }
    if (!*frame) {
      return path;
    }
    path.push_back((*frame)->orientation);
  }
}

OrientationPath TruePath(const igf::SimulationTruth& truth) {
  OrientationPath path;
  for (const double time_s : truth.frame_times_s) {
    const auto camera_from_world = truth.orientation.CameraFromWorld(time_s);
    path.push_back(camera_from_world ? std::optional(FrameOrientation{*camera_from_world, 0})
                                     : std::nullopt);
  }
  return path;
}

Result<PathAngleScore> ScorePathAngle(const OrientationPath& found,
                                      const OrientationPath& reference, double frame_interval_s) {
  if (found.size() != reference.size() || !(frame_interval_s > 0.0)) {
    return Fail(ErrorCode::kInvalidArgument,
                "a path of {} orientations is not compared with one of {}, {} s apart: they belong "
                "to different clips",
                found.size(), reference.size(), frame_interval_s);
  }
  PathAngleScore score;
  const Errors errors = Compare(found, reference);
  const Errors uncorrected = Compare(Still(reference), reference);
  score.known_share =
      found.empty() ? 0.0 : static_cast<double>(errors.frames) / static_cast<double>(found.size());
  const double to_rate = kDegrees / frame_interval_s;
  score.angle_deg = Scaled(errors.angles.Length(), kDegrees);
  score.uncorrected_angle_deg = Scaled(uncorrected.angles.Length(), kDegrees);
  score.rate_deg_s = Scaled(errors.steps.Length(), to_rate);
  score.uncorrected_rate_deg_s = Scaled(uncorrected.steps.Length(), to_rate);
  if (const auto axes = errors.steps.Axes()) {
    score.rate_axes_deg_s = to_rate * *axes;
    score.drift_axes_deg_s = to_rate * *errors.steps.Mean();
  }
  return score;
}

}  // namespace rsstab::evaluation
