// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/global_motion.h"

#include <gtest/gtest.h>

#include <random>

#include "igf/base/homography.h"
#include "stabilizer/normalized_coordinates.h"

namespace rsstab::stabilizer {
namespace {

constexpr double kAspect = 0.5625;
constexpr double kNoise = 0.1 / kReferenceWidthPx;

Eigen::Matrix3d SomeMotion() {
  Eigen::Matrix3d h;
  h << 1.004, -0.006, 0.012, 0.005, 0.998, -0.008, 0.015, -0.01, 1.0;
  return h;
}

std::vector<RectifiedMatch> Matches(const Eigen::Matrix3d& h, int count, double outlier_share,
                                    unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-0.5, 0.5);
  std::normal_distribution<double> noise(0.0, kNoise);
  std::vector<RectifiedMatch> matches;
  for (int i = 0; i < count; ++i) {
    RectifiedMatch m;
    m.from = {unit(random), unit(random) * kAspect};
    m.to = Project(h, m.from) + Eigen::Vector2d(noise(random), noise(random));
    if (i < outlier_share * count) {
      // Half of them agree with each other: an object that moves by itself.
      m.to = i % 2 == 0 ? Eigen::Vector2d(m.from + Eigen::Vector2d(0.03, 0.0))
                        : Eigen::Vector2d(unit(random), unit(random) * kAspect);
    }
    matches.push_back(m);
  }
  return matches;
}

// Largest error over the picture, px at the reference width.
double WorstError(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  double worst = 0.0;
  for (const double x : {-0.5, 0.0, 0.5}) {
    for (const double y : {-0.28, 0.0, 0.28}) {
      worst = std::max(worst, (Project(a, {x, y}) - Project(b, {x, y})).norm());
    }
  }
  return worst * kReferenceWidthPx;
}

TEST(GlobalMotion, FindsAHomographyUnderNoiseAndOutliers) {
  for (unsigned seed = 0; seed < 8; ++seed) {
    const auto motion = EstimateGlobalMotion(Matches(SomeMotion(), 300, 0.4, seed));
    EXPECT_EQ(motion.rung, MotionRung::kHomography);
    // 180 good points with 0.1 px of noise: 0.03 px in the middle, a few times that in a corner.
    EXPECT_LT(WorstError(motion.to_from, SomeMotion()), 0.15);
    EXPECT_NEAR(motion.num_inliers, 180, 12);
  }
}

TEST(GlobalMotion, DirectionIsEarlierToLater) {
  Eigen::Matrix3d shift = Eigen::Matrix3d::Identity();
  shift(0, 2) = 0.02;
  const auto motion = EstimateGlobalMotion(Matches(shift, 100, 0.0, 1));
  EXPECT_NEAR(motion.to_from(0, 2), 0.02, 1e-3);
}

TEST(GlobalMotion, FewPointsGiveASimilarity) {
  Eigen::Matrix3d similarity = Eigen::Matrix3d::Identity();
  similarity.topLeftCorner<2, 2>() << 1.01, -0.02, 0.02, 1.01;
  similarity(0, 2) = 0.01;
  const auto motion = EstimateGlobalMotion(Matches(similarity, 14, 0.0, 2));
  EXPECT_EQ(motion.rung, MotionRung::kSimilarity);
  EXPECT_LT(WorstError(motion.to_from, similarity), 0.6);
  EXPECT_NEAR(AffineAnisotropy(motion.to_from), 1.0, 1e-4);
}

TEST(GlobalMotion, PointsInOneCornerBendNothing) {
  auto matches = Matches(Eigen::Matrix3d::Identity(), 400, 0.0, 3);
  std::erase_if(matches,
                [](const RectifiedMatch& m) { return m.from.x() > -0.3 || m.from.y() > -0.1; });
  ASSERT_GT(matches.size(), 8U);
  const auto motion = EstimateGlobalMotion(matches);
  EXPECT_EQ(motion.rung, MotionRung::kSimilarity);
}

TEST(GlobalMotion, NothingToGoByHoldsThePrediction) {
  Eigen::Matrix3d predicted = Eigen::Matrix3d::Identity();
  predicted(1, 2) = 0.03;
  const auto motion = EstimateGlobalMotion({}, {.predicted = predicted});
  EXPECT_EQ(motion.rung, MotionRung::kHold);
  EXPECT_EQ(motion.to_from, predicted);
}

TEST(GlobalMotion, CorrectsAPredictionByASimilarityOnly) {
  // Far from commuting: the correction comes after the prediction (2.6 px apart the other way).
  Eigen::Matrix3d predicted = SomeMotion();
  predicted(0, 2) = 0.2;
  Eigen::Matrix3d correction = Eigen::Matrix3d::Identity();
  correction(0, 0) = correction(1, 1) = 1.02;
  correction(0, 2) = 0.004;
  const auto matches = Matches(correction * predicted, 300, 0.3, 5);
  const auto motion =
      EstimateGlobalMotion(matches, {.predicted = predicted, .finest = MotionRung::kSimilarity});
  EXPECT_EQ(motion.rung, MotionRung::kSimilarity);
  EXPECT_LT(WorstError(motion.to_from, correction * predicted), 0.1);
}

TEST(GlobalMotion, SameInputSameBits) {
  const auto matches = Matches(SomeMotion(), 300, 0.4, 9);
  EXPECT_EQ(EstimateGlobalMotion(matches).to_from, EstimateGlobalMotion(matches).to_from);
}

}  // namespace
}  // namespace rsstab::stabilizer
