// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/metrics/robust_homography.h"

#include <ceres/ceres.h>

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <memory>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <vector>

#include "igf/base/homography.h"
#include "stabilizer/metrics/metric_residuals.h"
#include "stabilizer/metrics/metric_solver_detail.h"

namespace rsstab::stabilizer {
namespace {

constexpr double kRansacPx = 3.0;
constexpr double kFewestInliersShare = 0.3;
constexpr int kMostIterations = 30;

// Shifts and scales pixels so that the matches' mean is 0 and their spread 1.
Eigen::Matrix3d Normaliser(std::span<const PointMatch> matches) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const PointMatch& match : matches) {
    mean += match.from.cast<double>();
  }
  mean /= static_cast<double>(matches.size());
  double square = 0.0;
  for (const PointMatch& match : matches) {
    square += (match.from.cast<double>() - mean).squaredNorm();
  }
  const double spread = std::sqrt(square / static_cast<double>(matches.size())) + 1e-9;
  Eigen::Matrix3d unit_from_pixel = Eigen::Matrix3d::Identity();
  unit_from_pixel.topRightCorner<2, 1>() = -mean / spread;
  unit_from_pixel(0, 0) = unit_from_pixel(1, 1) = 1.0 / spread;
  return unit_from_pixel;
}

// scale_px <= 0: plain least squares.
std::optional<Eigen::Matrix3d> Refine(std::span<const PointMatch> matches,
                                      const Eigen::Matrix3d& start, double scale_px) {
  const Eigen::Matrix3d unit = Normaliser(matches);
  Eigen::Matrix3d h = unit * start * unit.inverse();
  if (!h.allFinite() || std::abs(h(2, 2)) < 1e-9) {
    return std::nullopt;
  }
  h /= h(2, 2);
  std::array<double, 8> parameters = {h(0, 0), h(0, 1), h(0, 2), h(1, 0),
                                      h(1, 1), h(1, 2), h(2, 0), h(2, 1)};
  ceres::Problem problem;
  // The problem owns it from the first match on.
  ceres::LossFunction* loss = nullptr;
  for (const PointMatch& match : matches) {
    const HomographyResidual residual{Project(unit, match.from.cast<double>()),
                                      Project(unit, match.to.cast<double>())};
    // However silent, Ceres complains on standard error of a start that cannot be evaluated.
    if (Eigen::Vector2d unused; !residual(parameters.data(), unused.data())) {
      return std::nullopt;
    }
    if (loss == nullptr && scale_px > 0.0) {
      loss = new ceres::CauchyLoss(scale_px * unit(0, 0));
    }
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<HomographyResidual, 2, 8>(new HomographyResidual(residual)),
        loss, parameters.data());
  }
  if (!SolveSmall(problem, kMostIterations)) {
    return std::nullopt;
  }
  h << parameters[0], parameters[1], parameters[2], parameters[3], parameters[4], parameters[5],
      parameters[6], parameters[7], 1.0;
  h = unit.inverse() * h * unit;
  h /= h(2, 2);
  if (!h.allFinite() || !InvertChecked(h)) {
    return std::nullopt;
  }
  return h;
}

}  // namespace

std::optional<Eigen::Matrix3d> RobustHomography(std::span<const PointMatch> matches,
                                                double scale_px) {
  if (matches.size() < kFewestMatches) {
    return std::nullopt;
  }
  std::vector<cv::Point2f> from;
  std::vector<cv::Point2f> to;
  for (const PointMatch& match : matches) {
    from.emplace_back(match.from.x(), match.from.y());
    to.emplace_back(match.to.x(), match.to.y());
  }
  Eigen::Matrix3d start;
  try {
    const cv::Mat ransac = cv::findHomography(from, to, cv::RANSAC, kRansacPx);
    if (ransac.empty()) {
      return std::nullopt;
    }
    cv::cv2eigen(ransac, start);
  } catch (const cv::Exception&) {
    return std::nullopt;  // degenerate points
  }
  std::optional<Eigen::Matrix3d> h = Refine(matches, start, scale_px);
  if (!h) {
    return std::nullopt;
  }
  std::size_t inliers = 0;
  for (const PointMatch& match : matches) {
    const auto there = ProjectChecked(*h, match.from.cast<double>());
    inliers += there && (*there - match.to.cast<double>()).norm() < kRansacPx ? 1U : 0U;
  }
  if (static_cast<double>(inliers) < kFewestInliersShare * static_cast<double>(matches.size())) {
    return std::nullopt;
  }
  return h;
}

std::optional<Eigen::Matrix3d> LeastSquaresHomography(std::span<const PointMatch> matches,
                                                      const Eigen::Matrix3d& start) {
  return matches.size() < kFewestMatches ? std::nullopt : Refine(matches, start, 0.0);
}

}  // namespace rsstab::stabilizer
