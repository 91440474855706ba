// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/metrics/camera_residual.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "igf/base/homography.h"
#include "igf/base/rotation.h"
#include "stabilizer/metrics/frame_alignment_detail.h"
#include "stabilizer/metrics/luma_detail.h"
#include "stabilizer/metrics/metric_residuals.h"
#include "stabilizer/metrics/metric_solver_detail.h"
#include "stabilizer/metrics/path_metrics.h"
#include "stabilizer/metrics/robust_homography.h"

namespace rsstab::stabilizer {
namespace {

constexpr double kHuberPx = 1.0;  // at reference width; also the smallest outlier limit
constexpr double kOutlierSigmas = 4.0;
constexpr double kSigmaOfMedian = 1.4826;
constexpr int kGateRounds = 2;
constexpr int kMostIterations = 50;

using Parameters = std::array<double, 4>;  // rotation vector, log zoom

// Matches as rays times the focal length of the `to` camera: pixels of an ideal pinhole.
std::vector<RotationZoomResidual> IdealMatches(std::span<const PointMatch> matches,
                                               const Camera& from_camera, const Camera& to_camera) {
  std::vector<RotationZoomResidual> ideal;
  ideal.reserve(matches.size());
  const double focal = to_camera.fx;
  for (const PointMatch& match : matches) {
    const auto from = from_camera.UnprojectPixel(match.from.cast<double>());
    const auto to = to_camera.UnprojectPixel(match.to.cast<double>());
    // A pixel without a ray cannot be explained; far away, it ends up an outlier.
    const Eigen::Vector2d nowhere(1e6, 1e6);
    ideal.push_back({focal, from ? Eigen::Vector2d(from->hnormalized() * focal) : nowhere,
                     to ? Eigen::Vector2d(to->hnormalized() * focal) : nowhere});
  }
  return ideal;
}

double Length(const RotationZoomResidual& match, const Parameters& parameters) {
  Eigen::Vector2d residual;
  return match(parameters.data(), residual.data()) ? residual.norm() : 1e6;
}

bool Solve(std::span<const RotationZoomResidual> matches, std::span<const std::uint8_t> use,
           double huber_px, Parameters& parameters) {
  // However silent, Ceres complains on standard error of a start that cannot be evaluated.
  for (std::size_t i = 0; i < matches.size(); ++i) {
    Eigen::Vector2d unused;
    if (use[i] != 0 && !matches[i](parameters.data(), unused.data())) {
      return false;
    }
  }
  ceres::Problem problem;
  ceres::LossFunction* loss = huber_px > 0.0 ? new ceres::HuberLoss(huber_px) : nullptr;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (use[i] != 0) {
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<RotationZoomResidual, 2, 4>(
                                   new RotationZoomResidual(matches[i])),
                               loss, parameters.data());
    }
  }
  return SolveSmall(problem, kMostIterations);
}

// Marks what is no gross outlier; returns how many.
std::size_t Gate(std::span<const RotationZoomResidual> matches, const Parameters& parameters,
                 double smallest_limit, std::vector<std::uint8_t>& inlier) {
  std::vector<double> lengths;
  for (const RotationZoomResidual& match : matches) {
    lengths.push_back(Length(match, parameters));
  }
  std::vector<double> sorted = lengths;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double limit = std::max(smallest_limit, kOutlierSigmas * kSigmaOfMedian * *middle);
  std::size_t count = 0;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    inlier[i] = lengths[i] < limit ? 1 : 0;
    count += inlier[i];
  }
  return count;
}

// Shift, turn and zoom of the matches as a whole: near enough for the solver. The least squares
// similarity of the plane, z_to = s e^(i a) z_from + shift.
Parameters Start(std::span<const RotationZoomResidual> matches) {
  Eigen::Vector2d mean_from = Eigen::Vector2d::Zero();
  Eigen::Vector2d mean_to = Eigen::Vector2d::Zero();
  const auto count = static_cast<double>(matches.size());
  for (const RotationZoomResidual& match : matches) {
    mean_from += match.from_px / count;
    mean_to += match.to_px / count;
  }
  double along = 0.0;
  double across = 0.0;
  double square = 1e-12;
  for (const RotationZoomResidual& match : matches) {
    const Eigen::Vector2d a = match.from_px - mean_from;
    const Eigen::Vector2d b = match.to_px - mean_to;
    along += a.dot(b);
    across += a.x() * b.y() - a.y() * b.x();
    square += a.squaredNorm();
  }
  const double scale = std::hypot(along, across) / square;
  const double angle = std::atan2(across, along);
  const Eigen::Vector2d shift = mean_to - scale * (Eigen::Rotation2Dd(angle) * mean_from);
  const double focal = matches.front().focal_px;
  // Turning about y moves the picture along x, about x against y.
  return {-shift.y() / focal, shift.x() / focal, angle, std::log(std::max(scale, 1e-3))};
}

}  // namespace

std::optional<RotationZoom> FitRotationZoom(std::span<const PointMatch> matches,
                                            const Camera& from_camera, const Camera& to_camera) {
  if (matches.size() < kFewestMatches) {
    return std::nullopt;
  }
  const std::vector<RotationZoomResidual> ideal = IdealMatches(matches, from_camera, to_camera);
  const double pixel = 1.0 / detail::ToReference(to_camera.width);
  RotationZoom result;
  result.inlier.assign(ideal.size(), 1);
  Parameters parameters = Start(ideal);
  if (!Solve(ideal, result.inlier, kHuberPx * pixel, parameters)) {
    return std::nullopt;
  }
  for (int round = 0; round < kGateRounds; ++round) {
    result.inliers = Gate(ideal, parameters, kHuberPx * pixel, result.inlier);
    if (result.inliers < kFewestMatches || !Solve(ideal, result.inlier, 0.0, parameters)) {
      return std::nullopt;
    }
  }
  double squares = 0.0;
  for (std::size_t i = 0; i < ideal.size(); ++i) {
    const double length = result.inlier[i] != 0 ? Length(ideal[i], parameters) : 0.0;
    squares += length * length;
  }
  result.rms_px = std::sqrt(squares / static_cast<double>(result.inliers));
  result.to_from_from =
      ExpSo3(Eigen::Vector3d(parameters[0], parameters[1], parameters[2])).normalized();
  result.zoom = std::exp(parameters[3]);
  return result;
}

Result<TruthMeter> TruthMeter::Create(const Camera& camera) {
  if (const Status valid = camera.Validate(); !valid) {
    return Propagate(valid.error());
  }
  return TruthMeter(camera);
}

Status TruthMeter::Push(const FrameView& frame, const FrameView& twin) {
  const auto frame_luma = detail::NativeLuma(frame);
  if (!frame_luma) {
    return Propagate(frame_luma.error());
  }
  const auto twin_luma = detail::NativeLuma(twin);
  if (!twin_luma) {
    return Propagate(twin_luma.error());
  }
  ++frames_;
  frame_residual_.push_back(std::numeric_limits<float>::quiet_NaN());
  const cv::Mat picture = detail::MetricPicture(*frame_luma, frame.layout.bit_depth);
  const cv::Mat truth = detail::MetricPicture(*twin_luma, twin.layout.bit_depth);
  const auto alignment = detail::AlignFrames(picture, truth);
  if (!alignment) {
    return {};
  }
  const auto fit = FitRotationZoom(alignment->matches, camera_.Rescaled(picture.cols, picture.rows),
                                   camera_.Rescaled(truth.cols, truth.rows));
  if (!fit) {
    return {};
  }
  std::vector<PointMatch> kept;
  for (std::size_t i = 0; i < alignment->matches.size(); ++i) {
    if (fit->inlier[i] != 0) {
      kept.push_back(alignment->matches[i]);
    }
  }
  const auto free = LeastSquaresHomography(kept, alignment->second_from_first);
  if (!free) {
    return {};
  }
  const double to_reference = detail::ToReference(truth.cols);
  for (const PointMatch& match : kept) {
    const Eigen::Vector2d expected = Project(*free, match.from.cast<double>());
    bend_squares_ +=
        (match.to.cast<double>() - expected).squaredNorm() * to_reference * to_reference;
  }
  const double residual = fit->rms_px * to_reference;
  squares_ += residual * residual * static_cast<double>(fit->inliers);
  worst_ = std::max(worst_, residual);
  frame_residual_.back() = static_cast<float>(residual);
  matches_ += fit->inliers;
  ++aligned_;
  return {};
}

std::optional<double> TruthMeter::LastResidual() const {
  if (frame_residual_.empty() || std::isnan(frame_residual_.back())) {
    return std::nullopt;
  }
  return frame_residual_.back();
}

TruthMetrics TruthMeter::Measure() const {
  TruthMetrics result;
  result.frames = frames_;
  result.unaligned = frames_ - aligned_;
  result.frame_residual = frame_residual_;
  if (matches_ > 0) {
    const auto count = static_cast<double>(matches_);
    result.matches_per_frame = count / static_cast<double>(aligned_);
    result.camera_residual = std::sqrt(squares_ / count);
    result.bend = std::sqrt(bend_squares_ / count);
    result.worst_frame = worst_;
  }
  return result;
}

}  // namespace rsstab::stabilizer
