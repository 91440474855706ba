// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/metrics/path_metrics.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

namespace rsstab::stabilizer {
namespace {

constexpr int kWidth = 640;
constexpr int kHeight = 360;
constexpr double kFps = 30.0;
constexpr double kExact = 1e-9;  // closed forms in double precision

using Motions = std::vector<std::optional<Eigen::Matrix3d>>;

Eigen::Matrix3d Shift(const Eigen::Vector2d& by) {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
  matrix.topRightCorner<2, 1>() = by;
  return matrix;
}

Eigen::Matrix3d TurnAboutCentre(double angle) {
  const Eigen::Vector2d centre(0.5 * (kWidth - 1), 0.5 * (kHeight - 1));
  Eigen::Affine2d turn =
      Eigen::Translation2d(centre) * Eigen::Rotation2Dd(angle) * Eigen::Translation2d(-centre);
  return turn.matrix();
}

// Motions of a picture whose centre is at path(n).
Motions FollowPath(int count, const std::function<Eigen::Vector2d(int)>& path) {
  Motions motions;
  for (int n = 0; n < count; ++n) {
    motions.emplace_back(Shift(path(n + 1) - path(n)));
  }
  return motions;
}

double Phase(int n, double period) { return 2.0 * std::numbers::pi * n / period; }

TEST(PicturePath, AddsUpShiftTurnAndScale) {
  Eigen::Matrix3d zoom = Eigen::Matrix3d::Identity();
  zoom.topLeftCorner<2, 2>() *= 1.1;
  zoom(0, 2) = -0.1 * 0.5 * (kWidth - 1);  // about the centre
  zoom(1, 2) = -0.1 * 0.5 * (kHeight - 1);
  const Motions motions = {Shift({3, -2}), TurnAboutCentre(0.01), std::nullopt, zoom};
  const auto path = PicturePath(motions, kWidth, kHeight);
  ASSERT_EQ(path.size(), 5U);
  EXPECT_EQ(path[0].position, Eigen::Vector2d(0, 0));
  const double to_reference = 640.0 / kWidth;
  EXPECT_NEAR((path[4].position - to_reference * Eigen::Vector2d(3, -2)).norm(), 0.0, kExact);
  EXPECT_EQ(path[1].angle_rad, 0.0);
  EXPECT_NEAR(path[4].angle_rad, 0.01, kExact);
  EXPECT_NEAR(path[3].scale, 1.0, kExact);  // what was not measured counts as no motion
  EXPECT_NEAR(path[4].scale, 1.1, kExact);
}

TEST(Jitter, OfASineIsItsSecondDifference) {
  constexpr double kAmplitude = 6.0;
  constexpr int kPeriod = 10;
  // 200 changes of motion are 20 whole periods, so the sine's mean square is exactly a half.
  const Motions motions = FollowPath(
      201, [](int n) { return Eigen::Vector2d(kAmplitude * std::sin(Phase(n, kPeriod)), 0.0); });
  const double half = std::sin(std::numbers::pi / kPeriod);
  const double expected = kAmplitude * 4.0 * half * half / std::numbers::sqrt2;
  EXPECT_NEAR(Jitter(motions, kWidth, kHeight).value(), expected, kExact);
}

TEST(Jitter, OfASteadyPanIsZero) {
  const Motions motions = FollowPath(50, [](int n) { return Eigen::Vector2d(7.0 * n, -2.0 * n); });
  EXPECT_NEAR(Jitter(motions, kWidth, kHeight).value(), 0.0, kExact);
}

TEST(Jitter, OfATurnGrowsWithTheDistanceFromTheCentre) {
  // Turned to and fro: the motion changes by 2 a r at distance r (small angle).
  constexpr double kAngle = 1e-3;
  Motions motions;
  for (int n = 0; n < 20; ++n) {
    motions.emplace_back(TurnAboutCentre(n % 2 == 0 ? kAngle : -kAngle));
  }
  // 5x5 grid at -0.4, -0.2, 0, 0.2, 0.4 of the sides: mean square of a coordinate 0.08 side^2.
  const double mean_square_radius = 0.08 * (kWidth * kWidth + kHeight * kHeight);
  EXPECT_NEAR(Jitter(motions, kWidth, kHeight).value(),
              2.0 * kAngle * std::sqrt(mean_square_radius),
              1e-4);  // third order in the angle
}

TEST(Jitter, LeavesOutChangesThatWereNotMeasured) {
  Motions motions = FollowPath(20, [](int n) { return Eigen::Vector2d(3.0 * n, 0.0); });
  motions[7] = std::nullopt;
  EXPECT_NEAR(Jitter(motions, kWidth, kHeight).value(), 0.0, kExact);
  EXPECT_FALSE(Jitter(Motions(5), kWidth, kHeight).has_value());
  EXPECT_FALSE(Jitter({}, kWidth, kHeight).has_value());
}

TEST(Shake, KeepsFastAndDropsSlowMovement) {
  constexpr double kAmplitude = 5.0;
  const auto sine = [](double hz) {
    return FollowPath(300, [hz](int n) {
      return Eigen::Vector2d(0.0, kAmplitude * std::sin(Phase(n, kFps / hz)));
    });
  };
  // What a Gaussian mean over 0.25 s leaves of a sine: 1 - exp(-(0.25 w)^2 / 2). Cutting it off at
  // three standard deviations changes that by less than 0.5%.
  for (const double hz : {0.5, 1.0, 5.0}) {
    const double w = 0.25 * 2.0 * std::numbers::pi * hz;
    const double expected = kAmplitude / std::numbers::sqrt2 * (1.0 - std::exp(-0.5 * w * w));
    EXPECT_NEAR(Shake(sine(hz), kWidth, kHeight, kFps).value(), expected, 0.02 * kAmplitude) << hz;
  }
}

TEST(Shake, ScalesWithTheFrameRate) {
  // The same movement in seconds, filmed twice as often.
  const auto at_rate = [](double fps, int frames) {
    const Motions motions = FollowPath(
        frames, [fps](int n) { return Eigen::Vector2d(4.0 * std::sin(Phase(n, fps / 1.5)), 0.0); });
    return Shake(motions, kWidth, kHeight, fps).value();
  };
  EXPECT_NEAR(at_rate(30.0, 300), at_rate(60.0, 600), 0.05);  // sampling of the Gaussian
}

TEST(PathMetrics, AreStatedAt640PixelsWidth) {
  const auto path = [](double scale) {
    return FollowPath(100, [scale](int n) {
      return Eigen::Vector2d(scale * std::sin(1.3 * n), scale * std::cos(0.7 * n));
    });
  };
  const Motions small = path(1.0);
  const Motions large = path(3.0);
  EXPECT_NEAR(Jitter(small, 640, 360).value(), Jitter(large, 1920, 1080).value(), kExact);
  EXPECT_NEAR(Shake(small, 640, 360, kFps).value(), Shake(large, 1920, 1080, kFps).value(), kExact);
  EXPECT_NEAR(PathStability(small, 640, 360)->translation,
              PathStability(large, 1920, 1080)->translation, kExact);
}

TEST(PathStability, IsTheShareOfLowFrequencies) {
  // Third frequency (the constant part being the first) and the 21st, whole periods.
  constexpr int kCount = 240;
  constexpr double kLow = 9.0;
  constexpr double kHigh = 4.0;
  const Motions motions = FollowPath(kCount, [](int n) {
    return Eigen::Vector2d(kLow * std::sin(Phase(2 * n, kCount)),
                           kHigh * std::sin(Phase(20 * n, kCount)));
  });
  const auto stability = PathStability(motions, kWidth, kHeight);
  ASSERT_TRUE(stability);
  EXPECT_NEAR(stability->translation, kLow * kLow / (kLow * kLow + kHigh * kHigh), kExact);
  EXPECT_EQ(stability->rotation, 1.0);  // no turning at all
}

TEST(PathStability, CountsTheSixthFrequencyAndNotTheSeventh) {
  constexpr int kCount = 121;  // odd: the spectrum has no unpaired end
  for (const int cycles : {1, 5, 6}) {
    const Motions motions = FollowPath(kCount, [cycles](int n) {
      return Eigen::Vector2d(std::sin(Phase(cycles * n, kCount)), 0.0);
    });
    EXPECT_NEAR(PathStability(motions, kWidth, kHeight)->translation, cycles <= 5 ? 1.0 : 0.0,
                kExact);
  }
}

TEST(PathStability, TellsTurningApart) {
  constexpr int kCount = 200;
  Motions motions;
  const auto angle = [](int n) {
    return 0.02 * std::sin(Phase(3 * n, kCount)) + 0.01 * std::sin(Phase(40 * n, kCount));
  };
  for (int n = 0; n < kCount; ++n) {
    motions.emplace_back(TurnAboutCentre(angle(n + 1) - angle(n)));
  }
  const auto stability = PathStability(motions, kWidth, kHeight);
  EXPECT_NEAR(stability->rotation, 0.8, 1e-6);
  EXPECT_EQ(stability->translation, 1.0);
}

TEST(PathStability, OfAStillOrShortClip) {
  const auto still = PathStability(Motions(30, Eigen::Matrix3d::Identity()), kWidth, kHeight);
  EXPECT_EQ(still->translation, 1.0);
  EXPECT_EQ(still->rotation, 1.0);
  EXPECT_FALSE(PathStability(Motions(5, Eigen::Matrix3d::Identity()), kWidth, kHeight));
  EXPECT_FALSE(Shake(Motions(2, Eigen::Matrix3d::Identity()), kWidth, kHeight, kFps));
}

TEST(SimilarityAt, SeesTurnAndScaleWithTheirSigns) {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
  matrix.topLeftCorner<2, 2>() = 1.5 * Eigen::Rotation2Dd(0.3).toRotationMatrix();
  const LocalSimilarity similarity = SimilarityAt(matrix, {100.0, 50.0});
  EXPECT_NEAR(similarity.angle_rad, 0.3, kExact);  // x towards y
  EXPECT_NEAR(similarity.scale, 1.5, kExact);
}

TEST(SimilarityAt, FollowsPerspective) {
  // x / (1 + x / 1000) has the derivative 1 / (1 + x / 1000)^2 along x and 1 / (1 + x / 1000)
  // across it.
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
  matrix(2, 0) = 1e-3;
  EXPECT_NEAR(SimilarityAt(matrix, {500.0, 0.0}).scale, std::pow(1.5, -1.5), kExact);
}

}  // namespace
}  // namespace rsstab::stabilizer
