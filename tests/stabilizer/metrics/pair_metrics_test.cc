// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/metrics/pair_metrics.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tests/stabilizer/metrics/textured_picture.h"

namespace rsstab::stabilizer {
namespace {

using testing::AboutCentre;
using testing::Look;
using testing::MakeScene;
using testing::ViewOf;

// Fits to tracks between resampled pictures.
constexpr double kFit = 1e-3;

// An output that shows the input at `input_from_output`; what lies beyond the input is `fill`.
cv::Mat Render(const cv::Mat& input, const Eigen::Matrix3d& input_from_output, int border,
               int fill = 0) {
  cv::Mat map(2, 3, CV_64F);
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 3; ++column) {
      map.at<double>(row, column) = input_from_output(row, column);
    }
  }
  cv::Mat output;
  cv::warpAffine(input, output, map, input.size(), cv::INTER_CUBIC | cv::WARP_INVERSE_MAP, border,
                 cv::Scalar(fill));
  return output;
}

PairMetrics Compare(const cv::Mat& input, const cv::Mat& output) {
  PairMeter meter;
  EXPECT_TRUE(meter.Push(ViewOf(input), ViewOf(output)));
  return meter.Measure();
}

TEST(PairMeter, CropRatioOfAZoomedTurnedAndShiftedPicture) {
  const cv::Mat input = Look(MakeScene(), Eigen::Matrix3d::Identity());
  const Eigen::Matrix2d linear = 0.8 * Eigen::Rotation2Dd(0.04).toRotationMatrix();
  const PairMetrics metrics =
      Compare(input, Render(input, AboutCentre(linear, {25.0, -15.0}), cv::BORDER_REPLICATE));
  EXPECT_EQ(metrics.frames, 1);
  EXPECT_EQ(metrics.unaligned, 0);
  EXPECT_NEAR(metrics.crop.value(), 0.8, kFit);
  EXPECT_NEAR(metrics.smallest_crop.value(), 0.8, kFit);
  EXPECT_NEAR(metrics.distortion.value(), 1.0, kFit);
  EXPECT_EQ(metrics.undefined.value(), 0.0);
}

TEST(PairMeter, DistortionOfAStretchedPicture) {
  const cv::Mat input = Look(MakeScene(), Eigen::Matrix3d::Identity());
  Eigen::Matrix2d stretch;
  stretch << 0.80, 0.0, 0.0, 0.84;
  const PairMetrics metrics =
      Compare(input, Render(input, AboutCentre(stretch, {0.0, 0.0}), cv::BORDER_REPLICATE));
  EXPECT_NEAR(metrics.distortion.value(), 0.80 / 0.84, kFit);
  EXPECT_NEAR(metrics.crop.value(), std::sqrt(0.80 * 0.84), kFit);
}

TEST(PairMeter, TakesMeanAndWorstOverFrames) {
  const cv::Mat input = Look(MakeScene(), Eigen::Matrix3d::Identity());
  PairMeter meter;
  for (const double crop : {0.9, 0.7}) {
    const cv::Mat output = Render(
        input, AboutCentre(crop * Eigen::Matrix2d::Identity(), {0.0, 0.0}), cv::BORDER_REPLICATE);
    ASSERT_TRUE(meter.Push(ViewOf(input), ViewOf(output)));
  }
  EXPECT_NEAR(meter.Measure().crop.value(), 0.8, kFit);
  EXPECT_NEAR(meter.Measure().smallest_crop.value(), 0.7, kFit);
}

TEST(PairMeter, UndefinedPixelsEvenWhenFilledIn) {
  const cv::Mat input = Look(MakeScene(), Eigen::Matrix3d::Identity());
  // Shifted by 64 of 640 px: a tenth has no source, less the 1 px of tolerance.
  const Eigen::Matrix3d shift = AboutCentre(Eigen::Matrix2d::Identity(), {64.0, 0.0});
  const double expected = (64.0 - 1.5) / 640.0;
  for (const int border : {cv::BORDER_REPLICATE, cv::BORDER_REFLECT, cv::BORDER_CONSTANT}) {
    const PairMetrics metrics = Compare(input, Render(input, shift, border));
    EXPECT_NEAR(metrics.undefined.value(), expected, 0.003) << border;
    EXPECT_NEAR(metrics.worst_undefined.value(), expected, 0.003) << border;
  }
}

TEST(PairMeter, BlackBorderInsideTheInputCounts) {
  const cv::Mat input = Look(MakeScene(), Eigen::Matrix3d::Identity());
  cv::Mat output = input.clone();
  output.rowRange(0, 36).setTo(0);  // a tenth, black without need
  EXPECT_NEAR(Compare(input, output).undefined.value(), 0.1, 0.01);
  // The same black in both pictures is scene, not border.
  EXPECT_NEAR(Compare(output, output).undefined.value(), 0.0, 1e-9);
}

TEST(PairMeter, LeavesOutPicturesThatShareNothing) {
  const cv::Mat input = Look(MakeScene(), Eigen::Matrix3d::Identity());
  const cv::Mat flat(360, 640, CV_8U, cv::Scalar(80));
  const PairMetrics metrics = Compare(input, flat);
  EXPECT_EQ(metrics.unaligned, 1);
  EXPECT_FALSE(metrics.crop);
  EXPECT_FALSE(metrics.undefined);
}

TEST(PairMeter, PicturesOfDifferentSizesAreStatedAtOneWidth) {
  const cv::Mat input = Look(MakeScene(), Eigen::Matrix3d::Identity());
  cv::Mat half;
  cv::resize(input, half, {}, 0.5, 0.5, cv::INTER_AREA);
  EXPECT_NEAR(Compare(input, half).crop.value(), 1.0, 2e-3);
}

}  // namespace
}  // namespace rsstab::stabilizer
