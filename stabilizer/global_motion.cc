// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/global_motion.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <opencv2/calib3d.hpp>

#include "igf/base/homography.h"
#include "stabilizer/normalized_coordinates.h"

namespace rsstab::stabilizer {
namespace {

using Vector8d = Eigen::Matrix<double, 8, 1>;
using Matrix8d = Eigen::Matrix<double, 8, 8>;

constexpr double kPx = 1.0 / kReferenceWidthPx;  // one reference pixel in normalised units
constexpr double kRansacThreshold = 1.5 * kPx;
constexpr int kRansacIterations = 300;
constexpr double kRansacConfidence = 0.995;
constexpr int kReweightings = 4;
constexpr double kMinScale = 0.08 * kPx;  // below this the noise of the tracker itself
constexpr double kMaxScale = 1.0 * kPx;
// Points needed for each rung, and zones of a 3x3 grid they must lie in.
constexpr int kMinHomographyPoints = 24;
constexpr std::size_t kMinHomographyZones = 5;
constexpr int kMinSimilarityPoints = 8;
// Standard deviations of a similarity's distance to a homography between neighbouring frames:
// stretch and shear, and perspective (per picture width).
constexpr double kStretchSigma = 0.01;
constexpr double kPerspectiveSigma = 0.02;
constexpr double kSimilarityOnlySigma = 1e-6;
// A motion beyond these is a wrong estimate, not a camera.
constexpr double kMaxShift = 0.5;
constexpr double kMinAnisotropy = 0.8;

Eigen::Matrix3d FromParameters(const Vector8d& h) {
  Eigen::Matrix3d m;
  m << 1.0 + h(0), h(1), h(2), h(3), 1.0 + h(4), h(5), h(6), h(7), 1.0;
  return m;
}

Vector8d ToParameters(const Eigen::Matrix3d& homography) {
  const Eigen::Matrix3d m = homography / homography(2, 2);
  Vector8d h;
  h << m(0, 0) - 1.0, m(0, 1), m(0, 2), m(1, 0), m(1, 1) - 1.0, m(1, 2), m(2, 0), m(2, 1);
  return h;
}

// Information (inverse variance) of the prior: quadratic form in h.
Matrix8d PriorInformation(double stretch_sigma, double perspective_sigma) {
  Matrix8d prior = Matrix8d::Zero();
  const double stretch = 1.0 / (stretch_sigma * stretch_sigma);
  const double perspective = 1.0 / (perspective_sigma * perspective_sigma);
  Vector8d difference = Vector8d::Zero();  // h0 - h4 = 0 and h1 + h3 = 0 for a similarity
  difference(0) = 1.0;
  difference(4) = -1.0;
  Vector8d sum = Vector8d::Zero();
  sum(1) = 1.0;
  sum(3) = 1.0;
  prior += stretch * (difference * difference.transpose() + sum * sum.transpose());
  prior(6, 6) += perspective;
  prior(7, 7) += perspective;
  return prior;
}

// Where a point goes, with the derivative by h.
struct Linearization {
  Eigen::Vector2d mapped;
  Eigen::Matrix<double, 2, 8> jacobian;
};
Linearization Linearize(const Vector8d& h, const Eigen::Vector2d& p) {
  const double w = 1.0 + h(6) * p.x() + h(7) * p.y();
  const double inv = 1.0 / w;
  const double u = ((1.0 + h(0)) * p.x() + h(1) * p.y() + h(2)) * inv;
  const double v = (h(3) * p.x() + (1.0 + h(4)) * p.y() + h(5)) * inv;
  Linearization l;
  l.mapped = {u, v};
  l.jacobian << p.x() * inv, p.y() * inv, inv, 0.0, 0.0, 0.0, -u * p.x() * inv,
      -u * p.y() * inv,  //
      0.0, 0.0, 0.0, p.x() * inv, p.y() * inv, inv, -v * p.x() * inv, -v * p.y() * inv;
  return l;
}

double MedianResidual(std::span<const RectifiedMatch> matches, const std::vector<bool>& use,
                      const Eigen::Matrix3d& h) {
  std::vector<double> lengths;
  lengths.reserve(matches.size());
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (use[i]) {
      lengths.push_back((Project(h, matches[i].from) - matches[i].to).norm());
    }
  }
  if (lengths.empty()) {
    return 0.0;
  }
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return *middle;
}

// Gauss-Newton with Geman-McClure weights; the scale follows the median residual.
Eigen::Matrix3d Refine(std::span<const RectifiedMatch> matches, const std::vector<bool>& use,
                       const Eigen::Matrix3d& start, const Matrix8d& prior) {
  Vector8d h = ToParameters(start);
  for (int iteration = 0; iteration < kReweightings; ++iteration) {
    // For a 2-D Gaussian the median length is 1.18 standard deviations.
    const double sigma =
        std::clamp(MedianResidual(matches, use, FromParameters(h)) / 1.18, kMinScale, kMaxScale);
    const double scale_sq = 9.0 * sigma * sigma;
    Matrix8d information = prior;
    Vector8d gradient = prior * h;
    for (std::size_t i = 0; i < matches.size(); ++i) {
      if (!use[i]) {
        continue;
      }
      const Linearization l = Linearize(h, matches[i].from);
      const Eigen::Vector2d residual = l.mapped - matches[i].to;
      const double ratio = scale_sq / (scale_sq + residual.squaredNorm());
      const double weight = ratio * ratio / (sigma * sigma);
      information.noalias() += weight * l.jacobian.transpose() * l.jacobian;
      gradient.noalias() += weight * l.jacobian.transpose() * residual;
    }
    h -= information.ldlt().solve(gradient);
  }
  return FromParameters(h);
}

bool IsPlausible(const Eigen::Matrix3d& h) {
  if (!InvertChecked(h) || AffineAnisotropy(h) < kMinAnisotropy) {
    return false;
  }
  for (const double x : {-0.5, 0.5}) {
    for (const double y : {-0.5, 0.5}) {
      const auto mapped = ProjectChecked(h, {x, y});
      if (!mapped || (*mapped - Eigen::Vector2d(x, y)).norm() > kMaxShift) {
        return false;
      }
    }
  }
  return true;
}

std::size_t OccupiedZones(std::span<const RectifiedMatch> matches,
                          const std::vector<bool>& inlier) {
  std::bitset<9> zones;
  double half_height = 0.1;
  for (const RectifiedMatch& m : matches) {
    half_height = std::max(half_height, std::abs(m.from.y()));
  }
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (inlier[i]) {
      const auto column = std::clamp(static_cast<int>((matches[i].from.x() + 0.5) * 3.0), 0, 2);
      const auto row =
          std::clamp(static_cast<int>((matches[i].from.y() / half_height + 1.0) * 1.5), 0, 2);
      zones.set(static_cast<std::size_t>(row) * 3 + static_cast<std::size_t>(column));
    }
  }
  return zones.count();
}

void MarkInliers(std::span<const RectifiedMatch> matches, GlobalMotion& motion) {
  motion.inlier.assign(matches.size(), false);
  motion.num_inliers = 0;
  double sum = 0.0;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const double squared = (Project(motion.to_from, matches[i].from) - matches[i].to).squaredNorm();
    if (squared < kRansacThreshold * kRansacThreshold) {
      motion.inlier[i] = true;
      ++motion.num_inliers;
      sum += squared;
    }
  }
  motion.residual_px =
      motion.num_inliers > 0 ? std::sqrt(sum / motion.num_inliers) * kReferenceWidthPx : 0.0;
}

// RANSAC.
std::optional<Eigen::Matrix3d> Consensus(std::span<const RectifiedMatch> matches, bool homography) {
  std::vector<cv::Point2f> from;
  std::vector<cv::Point2f> to;
  from.reserve(matches.size());
  to.reserve(matches.size());
  for (const RectifiedMatch& m : matches) {
    // float32 keeps 1e-7 of the width, a ten-thousandth of a pixel.
    from.emplace_back(static_cast<float>(m.from.x()), static_cast<float>(m.from.y()));
    to.emplace_back(static_cast<float>(m.to.x()), static_cast<float>(m.to.y()));
  }
  Eigen::Matrix3d result = Eigen::Matrix3d::Identity();
  try {
    cv::Mat m;
    if (homography) {
      m = cv::findHomography(from, to, cv::RANSAC, kRansacThreshold, cv::noArray(),
                             kRansacIterations, kRansacConfidence);
    } else {
      m = cv::estimateAffinePartial2D(from, to, cv::noArray(), cv::RANSAC, kRansacThreshold,
                                      kRansacIterations, kRansacConfidence);
    }
    if (m.empty()) {
      return std::nullopt;
    }
    for (int r = 0; r < m.rows; ++r) {
      for (int c = 0; c < 3; ++c) {
        result(r, c) = m.at<double>(r, c);
      }
    }
  } catch (const cv::Exception&) {
    return std::nullopt;  // degenerate points
  }
  if (!result.allFinite() || !IsPlausible(result)) {
    return std::nullopt;
  }
  return result;
}

}  // namespace

GlobalMotion EstimateGlobalMotion(std::span<const RectifiedMatch> matches,
                                  const GlobalMotionOptions& options) {
  const Eigen::Matrix3d& predicted = options.predicted;
  GlobalMotion motion;
  motion.to_from = predicted;
  motion.inlier.assign(matches.size(), false);
  if (static_cast<int>(matches.size()) < kMinSimilarityPoints) {
    return motion;
  }
  // Move the earlier points by the prediction, so that the priors see only what is left.
  std::vector<RectifiedMatch> remaining(matches.begin(), matches.end());
  for (RectifiedMatch& m : remaining) {
    m.from = Project(predicted, m.from);
  }
  const std::array<MotionRung, 2> rungs = {MotionRung::kHomography, MotionRung::kSimilarity};
  for (const MotionRung rung : rungs) {
    const bool homography = rung == MotionRung::kHomography;
    if (homography && options.finest != MotionRung::kHomography) {
      continue;
    }
    const auto consensus = Consensus(remaining, homography);
    if (!consensus) {
      continue;
    }
    GlobalMotion candidate;
    candidate.rung = rung;
    candidate.to_from = *consensus;
    MarkInliers(remaining, candidate);
    const bool supported =
        homography ? candidate.num_inliers >= kMinHomographyPoints &&
                         OccupiedZones(remaining, candidate.inlier) >= kMinHomographyZones
                   : candidate.num_inliers >= kMinSimilarityPoints;
    if (!supported) {
      continue;
    }
    const Matrix8d prior = homography
                               ? PriorInformation(kStretchSigma, kPerspectiveSigma)
                               : PriorInformation(kSimilarityOnlySigma, kSimilarityOnlySigma);
    candidate.to_from = Refine(remaining, candidate.inlier, candidate.to_from, prior);
    if (!IsPlausible(candidate.to_from)) {
      continue;
    }
    MarkInliers(remaining, candidate);
    candidate.to_from = candidate.to_from * predicted;
    candidate.to_from /= candidate.to_from(2, 2);
    return candidate;
  }
  return motion;
}

}  // namespace rsstab::stabilizer
