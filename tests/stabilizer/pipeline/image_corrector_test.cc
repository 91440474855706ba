// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/image_corrector.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>

#include "tests/support/random_scene.h"
#include "tests/support/skew_model.h"

namespace rsstab::pipeline {
namespace {

constexpr int kWidth = 400;
constexpr int kHeight = 300;
// Grid of field and map (below 0.05 px together) on a slope of some 10 levels per px, rounding.
constexpr double kMeanError = 1.0;
constexpr int kBorder = 24;  // px that the motion moves out of view

Frame Picture(const std::function<double(double x, double y)>& level, int width = kWidth,
              int height = kHeight) {
  Frame frame = *AllocateFrame(GrayLayout(), width, height);
  for (int y = 0; y < height; ++y) {
    std::uint8_t* row = frame.planes[0].data + y * frame.planes[0].stride;
    for (int x = 0; x < width; ++x) {
      row[x] = static_cast<std::uint8_t>(std::lround(std::clamp(level(x, y), 0.0, 255.0)));
    }
  }
  return frame;
}

// What the camera recorded while it moved as the skew model says.
Frame Recorded(const testing::WaveScene& scene) {
  return Picture([&scene](double x, double y) {
    return scene.At(testing::UnskewedFromRecorded({x, y}, kWidth, kHeight, kWidth));
  });
}

ImageCorrector Corrector(const ImageCorrectionOptions& options) {
  auto estimator = rsdiff::SingleImageEstimator::Load(testing::SkewModel());
  if (!estimator) {
    throw std::runtime_error(estimator.error().message);
  }
  auto corrector = ImageCorrector::Create(std::move(*estimator), options);
  if (!corrector) {
    throw std::runtime_error(corrector.error().message);
  }
  return std::move(*corrector);
}

// Mean difference in levels, away from the borders.
double MeanDifference(const Frame& a, const Frame& b) {
  double sum = 0.0;
  int count = 0;
  for (int y = kBorder; y < a.height - kBorder; ++y) {
    for (int x = kBorder; x < a.width - kBorder; ++x, ++count) {
      sum += std::abs(a.planes[0].data[y * a.planes[0].stride + x] -
                      b.planes[0].data[y * b.planes[0].stride + x]);
    }
  }
  return sum / count;
}

Result<CorrectedImage> EstimateAndCorrect(const Frame& picture,
                                          const ImageCorrectionOptions& options) {
  ImageCorrector corrector = Corrector(options);
  const auto motion = corrector.Estimate(picture.View());
  if (!motion) {
    return Propagate(motion.error());
  }
  return corrector.Correct(picture.View(), motion->field);
}

TEST(ImageCorrector, UndoesTheMotionThatTheModelSees) {
  const testing::WaveScene scene(3);
  const Frame recorded = Recorded(scene);
  const Frame truth = Picture([&](double x, double y) { return scene.At({x, y}); });
  ASSERT_GT(MeanDifference(recorded, truth), 10.0);
  const auto corrected = EstimateAndCorrect(recorded, {.full_frame = true});
  ASSERT_TRUE(corrected) << corrected.error().message;
  EXPECT_LT(MeanDifference(corrected->picture, truth), kMeanError);
  EXPECT_EQ(corrected->kept_ratio, 1.0);
}

TEST(ImageCorrector, ZoomsAsFarAsBordersNeed) {
  const testing::WaveScene scene(3);
  const auto corrected = EstimateAndCorrect(Recorded(scene), {});
  ASSERT_TRUE(corrected) << corrected.error().message;
  const double kept = corrected->kept_ratio;
  // The corners move by some 17 px of 200, the zoom is centred.
  EXPECT_GT(kept, 0.90);
  EXPECT_LT(kept, 0.96);
  const Frame truth = Picture([&](double x, double y) {
    const Eigen::Vector2d centre((kWidth - 1) / 2.0, (kHeight - 1) / 2.0);
    return scene.At(centre + kept * (Eigen::Vector2d(x, y) - centre));
  });
  EXPECT_LT(MeanDifference(corrected->picture, truth), kMeanError);
}

TEST(ImageCorrector, FullFrameLetsTheEdgeGoOn) {
  const Frame white = Picture([](double, double) { return 255.0; });
  const auto corrected = EstimateAndCorrect(white, {.full_frame = true});
  ASSERT_TRUE(corrected);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      ASSERT_EQ(corrected->picture.planes[0].data[y * corrected->picture.planes[0].stride + x],
                255);
    }
  }
}

TEST(ImageCorrector, StrengthScalesTheMotion) {
  const Frame picture = Recorded(testing::WaveScene(3));
  const auto whole = Corrector({}).Estimate(picture.View());
  const auto half = Corrector({.strength = 0.5}).Estimate(picture.View());
  ASSERT_TRUE(whole && half);
  EXPECT_NEAR(half->field.MaxLength(), 0.5 * whole->field.MaxLength(), 1e-4);
}

TEST(ImageCorrector, StrengthZeroChangesNoSample) {
  const Frame picture = Recorded(testing::WaveScene(3));
  // One sample has an infinite spread; none of it is left.
  const ImageCorrectionOptions options{.sampling = {.samples = 1}, .strength = 0.0};
  const auto motion = Corrector(options).Estimate(picture.View());
  ASSERT_TRUE(motion);
  EXPECT_EQ(motion->field.MaxLength(), 0.0);
  EXPECT_EQ(motion->spread_px, 0.0);
  const auto corrected = EstimateAndCorrect(picture, options);
  ASSERT_TRUE(corrected);
  EXPECT_EQ(corrected->kept_ratio, 1.0);
  for (int y = 0; y < kHeight; ++y) {
    ASSERT_EQ(
        std::memcmp(picture.planes[0].data + y * picture.planes[0].stride,
                    corrected->picture.planes[0].data + y * corrected->picture.planes[0].stride,
                    kWidth),
        0);
  }
}

TEST(ImageCorrector, TakesPicturesOfAnySize) {
  for (const auto& [width, height] :
       {std::pair(1, 1), std::pair(1, 9), std::pair(7, 1), std::pair(2, 3), std::pair(33, 17)}) {
    const Frame picture = Picture([](double, double) { return 128.0; }, width, height);
    const auto corrected = EstimateAndCorrect(picture, {});
    ASSERT_TRUE(corrected) << width << "x" << height << ": " << corrected.error().message;
    EXPECT_EQ(corrected->picture.width, width);
    EXPECT_EQ(corrected->picture.height, height);
    EXPECT_EQ(corrected->picture.planes[0].data[0], 128);
  }
}

TEST(ImageCorrector, RefusesWhatMakesNoSense) {
  auto estimator = rsdiff::SingleImageEstimator::Load(testing::SkewModel());
  ASSERT_TRUE(estimator);
  const auto corrector = ImageCorrector::Create(std::move(*estimator), {.strength = 2.5});
  ASSERT_FALSE(corrector);
  EXPECT_EQ(corrector.error().code, ErrorCode::kInvalidArgument);
  const Frame picture = Recorded(testing::WaveScene(3));
  EXPECT_FALSE(Corrector({}).Correct(picture.View(), MotionField(10, 10, 2, 2)));
}

}  // namespace
}  // namespace rsstab::pipeline
