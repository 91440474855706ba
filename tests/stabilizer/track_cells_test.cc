// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/track_cells.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "igf/base/rotation.h"

namespace rsstab::stabilizer {
namespace {

constexpr int kWidth = 640;
constexpr int kHeight = 360;
// Tracks are stored as floats: 640 px to 3e-5 px; in picture widths.
constexpr double kFloatNoise = 1e-7;

Eigen::Vector2d Plane(const Eigen::Vector2d& pixel) {
  return (pixel - Eigen::Vector2d(0.5 * (kWidth - 1), 0.5 * (kHeight - 1))) / kWidth;
}

using PixelMap = std::function<Eigen::Vector2d(const Eigen::Vector2d&)>;

PointTracks RandomTracks(int count, const PixelMap& to_from, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> x(0.0, kWidth - 1.0);
  std::uniform_real_distribution<double> y(0.0, kHeight - 1.0);
  PointTracks tracks{kWidth, kHeight, 0.1, 0.2, {}};
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d from(x(random), y(random));
    tracks.matches.push_back({from.cast<float>(), to_from(from).cast<float>()});
  }
  return tracks;
}

Eigen::Matrix<double, 2, 3> SomeAffine() {
  Eigen::Matrix<double, 2, 3> affine;
  affine << 0.01, 0.003, -0.02, -0.005, 0.015, 0.002;
  return affine;
}

Eigen::Vector2d MoveAffinely(const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d p = Plane(pixel);
  return pixel + kWidth * (SomeAffine() * Eigen::Vector3d(1.0, p.x(), p.y()));
}

void ExpectCellsFollow(const FramePairCells& pair, double tolerance) {
  EXPECT_LT((pair.affine - SomeAffine()).norm(), 3.0 * tolerance);
  for (const TrackCell& cell : pair.cells) {
    const Eigen::Vector2d moved = SomeAffine() * Eigen::Vector3d(1.0, cell.from.x(), cell.from.y());
    EXPECT_LT((cell.to - cell.from - moved).norm(), tolerance);
  }
}

// The means of both ends are a true pair, wherever in its cell the tracks lie.
TEST(TrackCells, AveragesAreTruePairs) {
  const PointTracks tracks = RandomTracks(400, MoveAffinely);
  const FramePairCells pair = SummarizeTracks(tracks, nullptr);
  EXPECT_EQ(pair.from_time_s, 0.1);
  EXPECT_EQ(pair.to_time_s, 0.2);
  EXPECT_EQ(pair.num_inliers, 400);
  EXPECT_GT(pair.cells.size(), 40U);
  ExpectCellsFollow(pair, 20.0 * kFloatNoise);
  double weight = 0.0;
  for (const TrackCell& cell : pair.cells) {
    weight += cell.weight;
    // The share of a pinhole's row is linear in y, so that of the mean is the mean of the shares.
    EXPECT_NEAR(cell.from_row_share, cell.from.y() * kWidth / kHeight, 1e-6);
    EXPECT_NEAR(cell.to_row_share, cell.to.y() * kWidth / kHeight, 1e-6);
  }
  EXPECT_NEAR(weight, 400.0, 1.0);
}

TEST(TrackCells, AnObjectThatMovesByItselfIsLeftOut) {
  // A third of the picture moves by 6 px more.
  const FramePairCells pair = SummarizeTracks(RandomTracks(400,
                                                           [](const Eigen::Vector2d& from) {
                                                             Eigen::Vector2d to =
                                                                 MoveAffinely(from);
                                                             if (from.x() < kWidth / 3.0) {
                                                               to += Eigen::Vector2d(5.0, 3.0);
                                                             }
                                                             return to;
                                                           }),
                                              nullptr);
  EXPECT_NEAR(pair.num_inliers, 267, 30);
  ExpectCellsFollow(pair, 0.01 / kWidth);
  for (const TrackCell& cell : pair.cells) {
    EXPECT_GT(cell.from.x(), -0.25);  // the first of four columns is the object's
  }
}

TEST(TrackCells, NoiseAveragesOut) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 0.3);
  const FramePairCells pair = SummarizeTracks(
      RandomTracks(2000,
                   [&](const Eigen::Vector2d& from) -> Eigen::Vector2d {
                     return MoveAffinely(from) + Eigen::Vector2d(noise(random), noise(random));
                   }),
      nullptr);
  // 40 tracks a cell; five standard deviations.
  ExpectCellsFollow(pair, 5.0 * 0.3 * std::sqrt(2.0 / 40.0) / kWidth);
  // Median of a two-dimensional Gaussian's length: 1.18 sigma.
  EXPECT_NEAR(pair.scatter * kWidth, 1.48 * 1.18 * 0.3, 0.05);
}

// A turning camera moves pixels behind its lens along a homography once the lens is taken out.
TEST(TrackCells, LensIsTakenOut) {
  Camera lens = Camera::Pinhole(kWidth, kHeight, 400.0);
  lens.cx += 10.0;
  lens.model = LensModel::kFisheye;
  lens.distortion = {0.02, -0.01, 0.0, 0.0};
  const Eigen::Quaterniond to_from = ExpSo3(Eigen::Vector3d(0.004, -0.01, 0.003));
  const PointTracks tracks = RandomTracks(4000, [&](const Eigen::Vector2d& from) {
    return *lens.ProjectRay(to_from * *lens.UnprojectPixel(from));
  });
  const auto worst = [&](const Camera* known) {
    double distance = 0.0;
    for (const TrackCell& cell : SummarizeTracks(tracks, known).cells) {
      const double f = 400.0 / kWidth;
      const Eigen::Vector3d ray(cell.from.x() / f, cell.from.y() / f, 1.0);
      distance = std::max(distance, (f * (to_from * ray).hnormalized() - cell.to).norm());
    }
    return distance * kWidth;
  };
  // What a homography bends beyond a smooth motion within a cell.
  constexpr double kCurvature = 0.03;
  EXPECT_LT(worst(&lens), kCurvature);
  EXPECT_GT(worst(nullptr), 10.0 * kCurvature);
  const Camera twice = lens.Rescaled(2 * kWidth, 2 * kHeight);
  EXPECT_LT(worst(&twice), kCurvature);
}

TEST(TrackCells, TooFewTracksSayNothing) {
  const auto cells = [](int count) {
    return SummarizeTracks(RandomTracks(count, MoveAffinely), nullptr).cells.size();
  };
  EXPECT_EQ(cells(0), 0U);
  EXPECT_EQ(cells(19), 0U);
  EXPECT_GT(cells(40), 0U);
  EXPECT_EQ(SummarizeTracks({}, nullptr).cells.size(), 0U);
}

}  // namespace
}  // namespace rsstab::stabilizer
