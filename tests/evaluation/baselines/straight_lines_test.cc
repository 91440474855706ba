// SPDX-License-Identifier: Apache-2.0
#include "evaluation/baselines/straight_lines.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "evaluation/baselines/manhattan_motion.h"
#include "igf/base/readout_motion.h"
#include "tests/evaluation/baselines/moving_frames.h"

namespace rsstab::evaluation {
namespace {

using rsstab::testing::MakePhoto;
using rsstab::testing::MeanDifference;

constexpr int kWidth = 640;
constexpr int kHeight = 480;

// Segments count as twenty independent ones at most, however exact, so that the pull towards rest
// leaves 40% of a motion.
constexpr double kMostLeft = 0.45;

Camera TestCamera() { return Camera::Pinhole(kWidth, kHeight, kWidth); }

// A skewing, twisting and slightly accelerated turn: 9 px of displacement in the mean.
RowMotion TrueMotion() {
  RowMotion motion;
  motion.rate = {0.01, 0.05, 0.03};
  motion.change = {0.0, 0.03, 0.0};
  return motion;
}

ReadoutMotion Exact(const RowMotion& motion) {
  std::vector<Eigen::Quaterniond> rotations;
  for (int i = 0; i < 257; ++i) {
    rotations.push_back(motion.AtRow((kHeight - 1.0) * i / 256.0, kHeight));
  }
  return ReadoutMotion::Create(TestCamera(), rotations).value();
}

// Edges of a room seen from a corner: many segments along three directions at right angles, as
// seen without rolling shutter, in pixels.
std::vector<EdgeSegment> RoomEdges() {
  const Eigen::Matrix3d axes = (Eigen::AngleAxisd(0.25, Eigen::Vector3d::UnitX()) *
                                Eigen::AngleAxisd(0.6, Eigen::Vector3d::UnitY()) *
                                Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitZ()))
                                   .toRotationMatrix();
  SeededRandom random(7);
  const Eigen::Matrix3d k = TestCamera().K();
  std::vector<EdgeSegment> edges;
  while (edges.size() < 90) {
    const Eigen::Vector3d begin(random.Uniform(-2.0, 2.0), random.Uniform(-1.5, 1.5),
                                random.Uniform(4.0, 8.0));
    const Eigen::Vector3d end = begin + random.Uniform(0.8, 2.0) * axes.col(random.Integer(0, 2));
    const EdgeSegment edge{(k * begin).hnormalized(), (k * end).hnormalized()};
    const Eigen::AlignedBox2d view(Eigen::Vector2d(20, 20),
                                   Eigen::Vector2d(kWidth - 20, kHeight - 20));
    if (view.contains(edge.a) && view.contains(edge.b) && edge.Length() > 60.0) {
      edges.push_back(edge);
    }
  }
  return edges;
}

// The edges as the rolling shutter bends them, each in `pieces`.
std::vector<EdgeSegment> Recorded(const std::vector<EdgeSegment>& edges,
                                  const ReadoutMotion& motion, int pieces) {
  std::vector<EdgeSegment> recorded;
  for (const EdgeSegment& edge : edges) {
    for (int i = 0; i < pieces; ++i) {
      const auto at = [&](double share) {
        return *motion.RsFromGs(edge.a + share * (edge.b - edge.a));
      };
      recorded.push_back({at(static_cast<double>(i) / pieces), at((i + 1.0) / pieces)});
    }
  }
  return recorded;
}

TEST(StraightLines, ExactSegmentsGiveTheMotion) {
  const auto found =
      FitManhattanMotion(Recorded(RoomEdges(), Exact(TrueMotion()), 2), TestCamera(), 1);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_GT(found->inliers, 150);
  const MotionField truth = ComputeReadoutField(TestCamera(), Exact(TrueMotion())).value();
  const MotionField field = ComputeReadoutField(TestCamera(), Exact(*found)).value();
  const MotionField none(kWidth, kHeight, truth.columns(), truth.rows());
  EXPECT_LT(MeanDifference(field, truth), kMostLeft * MeanDifference(none, truth));
  EXPECT_GT(found->rate.y(), 0.03);  // and not the other way
}

TEST(StraightLines, APictureOfARoomIsStraightened) {
  const ReadoutMotion motion = Exact(TrueMotion());
  Frame picture = MakePhoto(kWidth, kHeight, [](int, int) { return 60.0; });
  cv::Mat canvas(kHeight, kWidth, CV_8UC3, picture.planes[0].data,
                 static_cast<std::size_t>(picture.planes[0].stride));
  constexpr int kShift = 4;
  for (const EdgeSegment& edge : RoomEdges()) {
    std::vector<cv::Point> curve;
    for (const EdgeSegment& piece : Recorded({edge}, motion, 40)) {
      curve.emplace_back(static_cast<int>(std::lround(piece.a.x() * (1 << kShift))),
                         static_cast<int>(std::lround(piece.a.y() * (1 << kShift))));
    }
    cv::polylines(canvas, curve, false, cv::Scalar(220, 220, 220), 3, cv::LINE_AA, kShift);
  }
  const MotionField truth = ComputeReadoutField(TestCamera(), motion).value();
  const MotionField none(kWidth, kHeight, truth.columns(), truth.rows());
  MethodInput input;
  input.rs = picture.View();
  input.seed = 3;
  StraightLinesMethod method(false);
  const auto answer = method.Estimate(input);
  ASSERT_TRUE(answer) << answer.error().message;
  const double untouched = MeanDifference(none, truth);
  ASSERT_GT(untouched, 6.0);
  EXPECT_LT(MeanDifference(answer->field, truth), kMostLeft * untouched);
}

TEST(StraightLines, PicturesWithoutSuchLinesAreRefused) {
  StraightLinesMethod method(false);
  const Frame flat = MakePhoto(320, 240, [](int, int) { return 90.0; });
  MethodInput input;
  input.rs = flat.View();
  EXPECT_EQ(method.Estimate(input).error().code, ErrorCode::kUntrustworthy);
  // Segments in all directions.
  SeededRandom random(5);
  std::vector<EdgeSegment> wild;
  for (int i = 0; i < 120; ++i) {
    const Eigen::Vector2d a(random.Uniform(50.0, 590.0), random.Uniform(50.0, 430.0));
    const double angle = random.Uniform(0.0, 6.3);
    wild.push_back({a, a + 40.0 * Eigen::Vector2d(std::cos(angle), std::sin(angle))});
  }
  const auto motion = FitManhattanMotion(wild, TestCamera(), 1);
  EXPECT_FALSE(motion && motion->rate.norm() > 0.02);
}

TEST(StraightLines, ARoomAtRestStaysAsItIs) {
  const auto found = FitManhattanMotion(RoomEdges(), TestCamera(), 2);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_LT(found->rate.norm(), 1e-3);
  EXPECT_LT(found->change.norm(), 1e-3);
}

}  // namespace
}  // namespace rsstab::evaluation
