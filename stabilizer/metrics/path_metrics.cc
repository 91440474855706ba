// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/metrics/path_metrics.h"

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "igf/base/homography.h"
#include "stabilizer/metrics/luma_detail.h"

namespace rsstab::stabilizer {
namespace {

constexpr int kGrid = 5;
constexpr double kGridMargin = 0.1;
constexpr double kSmoothS = 0.25;
constexpr double kCutOffSigmas = 3.0;
constexpr double kLeftOutS = 0.4;
constexpr std::size_t kFewestForShake = 3;
constexpr std::size_t kFewestForStability = 12;
constexpr int kLastLowFrequency = 5;  // 0 is the constant part, so this is the 6th

using Grid = std::array<Eigen::Vector2d, static_cast<std::size_t>(kGrid) * kGrid>;

Eigen::Vector2d Centre(int width, int height) { return {(width - 1) * 0.5, (height - 1) * 0.5}; }

Grid DisplacementsOnGrid(const Eigen::Matrix3d& motion, int width, int height) {
  Grid result;
  for (std::size_t i = 0; i < result.size(); ++i) {
    const std::size_t row = i / kGrid;
    const std::size_t column = i % kGrid;
    const double step = (1.0 - 2.0 * kGridMargin) / (kGrid - 1);
    const Eigen::Vector2d pixel((kGridMargin + step * static_cast<double>(column)) * width - 0.5,
                                (kGridMargin + step * static_cast<double>(row)) * height - 0.5);
    result[i] = Project(motion, pixel) - pixel;
  }
  return result;
}

// The pose after each motion, in px of width x height.
std::vector<PicturePose> Accumulate(MotionList motions, int width, int height) {
  std::vector<PicturePose> path;
  PicturePose pose;
  const Eigen::Vector2d centre = Centre(width, height);
  for (const auto& motion : motions) {
    if (motion) {
      const LocalSimilarity turn = SimilarityAt(*motion, centre);
      pose.position += Project(*motion, centre) - centre;
      pose.angle_rad += turn.angle_rad;
      pose.scale *= turn.scale;
    }
    path.push_back(pose);
  }
  return path;
}

// Energies of one component of the path.
struct Energy {
  double low = 0.0;  // 2nd to 6th frequency
  double all = 0.0;  // lower half but for the constant part
};

Energy SpectralEnergy(std::span<const double> signal) {
  const auto count = static_cast<double>(signal.size());
  double mean = 0.0;
  for (const double value : signal) {
    mean += value / count;
  }
  Energy energy;
  // Parseval: the squared magnitudes of all frequencies add up to N sum x^2, and a real signal has
  // the same in both halves; only the alternating frequency of an even length has no partner.
  double squares = 0.0;
  double alternating = 0.0;
  for (std::size_t i = 0; i < signal.size(); ++i) {
    squares += (signal[i] - mean) * (signal[i] - mean);
    alternating += i % 2 == 0 ? signal[i] - mean : mean - signal[i];
  }
  const double unpaired = signal.size() % 2 == 0 ? alternating * alternating : 0.0;
  energy.all = 0.5 * (count * squares - unpaired);
  for (int frequency = 1; frequency <= kLastLowFrequency; ++frequency) {
    std::complex<double> sum;
    for (std::size_t i = 0; i < signal.size(); ++i) {
      const double turn = frequency * static_cast<double>(i) / count;
      sum += (signal[i] - mean) * std::polar(1.0, -2.0 * std::numbers::pi * turn);
    }
    energy.low += std::norm(sum);
  }
  return energy;
}

double LowShare(const Energy& energy, std::size_t count, double still) {
  // `still`: movement below which there is nothing to tell (rounding).
  const double n = static_cast<double>(count);
  return energy.all < still * still * n * n ? 1.0 : std::min(1.0, energy.low / energy.all);
}

}  // namespace

std::vector<PicturePose> PicturePath(MotionList motions, int width, int height) {
  std::vector<PicturePose> path = Accumulate(motions, width, height);
  for (PicturePose& pose : path) {
    pose.position *= detail::ToReference(width);
  }
  path.insert(path.begin(), PicturePose{});
  return path;
}

LocalSimilarity SimilarityAt(const Eigen::Matrix3d& homography, const Eigen::Vector2d& pixel) {
  const Eigen::Vector3d image = homography * pixel.homogeneous();
  const Eigen::Matrix2d jacobian =
      (homography.topLeftCorner<2, 2>() - image.hnormalized() * homography.row(2).head<2>()) /
      image.z();
  return {std::atan2(jacobian(1, 0) - jacobian(0, 1), jacobian(0, 0) + jacobian(1, 1)),
          std::sqrt(std::abs(jacobian.determinant()))};
}

std::optional<double> Jitter(MotionList motions, int width, int height) {
  double squares = 0.0;
  std::size_t count = 0;
  for (std::size_t n = 1; n < motions.size(); ++n) {
    if (!motions[n - 1] || !motions[n]) {
      continue;
    }
    const Grid before = DisplacementsOnGrid(*motions[n - 1], width, height);
    const Grid after = DisplacementsOnGrid(*motions[n], width, height);
    for (std::size_t i = 0; i < before.size(); ++i) {
      squares += (after[i] - before[i]).squaredNorm();
      ++count;
    }
  }
  if (count == 0) {
    return std::nullopt;
  }
  return std::sqrt(squares / static_cast<double>(count)) * detail::ToReference(width);
}

std::optional<double> Shake(MotionList motions, int width, int height, double frames_per_second) {
  if (motions.size() < kFewestForShake || !(frames_per_second > 0.0)) {
    return std::nullopt;
  }
  const std::vector<PicturePose> path = PicturePath(motions, width, height);
  const double sigma = kSmoothS * frames_per_second;
  const auto reach = static_cast<std::ptrdiff_t>(kCutOffSigmas * sigma);
  const auto size = static_cast<std::ptrdiff_t>(path.size());
  const auto edge = static_cast<std::ptrdiff_t>(std::lround(kLeftOutS * frames_per_second));
  const std::ptrdiff_t left_out = size > 3 * edge ? edge : 0;
  double squares = 0.0;
  for (std::ptrdiff_t n = left_out; n < size - left_out; ++n) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double weights = 0.0;
    for (std::ptrdiff_t k = std::max<std::ptrdiff_t>(0, n - reach);
         k <= std::min(size - 1, n + reach); ++k) {
      const double distance = static_cast<double>(k - n) / sigma;
      const double weight = std::exp(-0.5 * distance * distance);
      sum += weight * path[static_cast<std::size_t>(k)].position;
      weights += weight;
    }
    squares += (path[static_cast<std::size_t>(n)].position - sum / weights).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(size - 2 * left_out));
}

std::optional<Stability> PathStability(MotionList motions, int width, int height) {
  if (motions.size() < kFewestForStability) {
    return std::nullopt;
  }
  constexpr double kStillPx = 1e-6;
  constexpr double kStillRad = 1e-9;
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> angle;
  for (const PicturePose& pose : Accumulate(motions, width, height)) {
    x.push_back(pose.position.x());
    y.push_back(pose.position.y());
    angle.push_back(pose.angle_rad);
  }
  const Energy along_x = SpectralEnergy(x);
  const Energy along_y = SpectralEnergy(y);
  const Energy both = {along_x.low + along_y.low, along_x.all + along_y.all};
  return Stability{LowShare(both, motions.size(), kStillPx),
                   LowShare(SpectralEnergy(angle), motions.size(), kStillRad)};
}

}  // namespace rsstab::stabilizer
