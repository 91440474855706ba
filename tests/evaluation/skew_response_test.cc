// SPDX-License-Identifier: Apache-2.0
#include "evaluation/skew_response.h"

#include <gtest/gtest.h>

#include <cmath>

#include "igf/base/seeded_random.h"
#include "tests/evaluation/test_methods.h"
#include "tests/evaluation/test_photos.h"

namespace rsstab::evaluation {
namespace {

using rsstab::testing::LevelAt;
using rsstab::testing::MakePhoto;
using rsstab::testing::ToldMethod;
using rsstab::testing::Waves;

TEST(SkewResponse, SkewIsTheBottomAgainstTheTop) {
  MotionField field(801, 601, 5, 7);
  for (int j = 0; j < 7; ++j) {
    for (int i = 0; i < 5; ++i) {
      field.At(i, j) = Eigen::Vector2f(static_cast<float>(2 * j + i), 3.0F);
    }
  }
  EXPECT_NEAR(SkewOf(field), 12.0, 1e-5);
}

// Sees the picture before and after: which place of the photo the middle of the top row shows.
class LookingMethod final : public MotionMethod {
 public:
  [[nodiscard]] std::string Name() const override { return "looking"; }
  [[nodiscard]] Result<MethodAnswer> Estimate(const MethodInput& input) override {
    MethodAnswer answer{MotionField(input.rs.width, input.rs.height, 2, 2), {}};
    // The photo is a ramp, so rows that are displaced are brighter or darker there.
    const float top = MeanLevel(input.rs, 0);
    const float bottom = MeanLevel(input.rs, input.rs.height - 1);
    const float left = LevelOf(input.rs, 0);
    const float right = LevelOf(input.rs, input.rs.width - 1);
    const float per_pixel = (right - left) / static_cast<float>(input.rs.width - 1);
    answer.field.At(0, 0).x() = answer.field.At(1, 0).x() = 0.0F;
    answer.field.At(0, 1).x() = answer.field.At(1, 1).x() = (top - bottom) / per_pixel;
    return answer;
  }

 private:
  static float MeanLevel(const FrameView& picture, int row) {
    float sum = 0.0F;
    for (int i = 0; i < 3 * picture.width; ++i) {
      sum += static_cast<float>(picture.planes[0].data[row * picture.planes[0].stride + i]);
    }
    return sum / static_cast<float>(3 * picture.width);
  }
  static float LevelOf(const FrameView& picture, int column) {
    float sum = 0.0F;
    for (int y = 0; y < picture.height; ++y) {
      sum += static_cast<float>(picture.planes[0].data[y * picture.planes[0].stride + 3 * column]);
    }
    return sum / static_cast<float>(picture.height);
  }
};

// The pictures themselves: skewed as stated before the correction, straight after it.
TEST(SkewResponse, PicturesAreSkewedAndPutRight) {
  constexpr double kReading_px = 0.7;  // from 8-bit levels of a ramp of 0.3 levels a pixel
  const Frame ramp = MakePhoto(640, 480, [](int x, int) { return 10.0 + 0.36 * x; });
  LookingMethod method;
  WorkerPool workers(1);
  const auto answers = AskForSkew(ramp.View(), method, 1, workers);
  ASSERT_TRUE(answers) << answers.error().message;
  ASSERT_EQ(answers->size(), kSkewFactors.size());
  for (const SkewAnswer& answer : *answers) {
    EXPECT_NEAR(answer.true_px, 16.0 * answer.factor, 0.5);
    EXPECT_NEAR(answer.predicted_px, answer.true_px, kReading_px) << answer.factor;
    EXPECT_NEAR(answer.remainder_px, 0.0, kReading_px) << answer.factor;
  }
}

TEST(SkewResponse, OfAMethodThatSeesHalfTheMotion) {
  const Frame photo = MakePhoto(200, 150, [](int x, int y) { return Waves(x, y); });
  ToldMethod half("half", 0.5);
  WorkerPool workers(1);
  const auto answers = AskForSkew(photo.View(), half, 1, workers);
  ASSERT_TRUE(answers) << answers.error().message;
  const SkewResponse response = SummariseSkew(std::vector(3, *answers), 1);
  EXPECT_EQ(response.photos, 3);
  EXPECT_NEAR(response.fit.slope, 0.5, 0.01);
  EXPECT_NEAR(response.fit.intercept, 0.0, 0.01);
  EXPECT_NEAR(response.linearity, 1.0, 1e-4);
  EXPECT_NEAR(response.remainder_px, 0.0, 1e-6);
  EXPECT_NEAR(response.zero_crossing, 1.0, 1e-6);
  EXPECT_EQ(response.levels.size(), kSkewFactors.size());
  EXPECT_NEAR(response.levels.front().predicted_error_px, 0.0, 1e-9);
}

TEST(SkewResponse, ABiasOfTheRemainderMovesTheZeroCrossing) {
  // Predicted 0.4 of the skew, and still 0.06 of it after correcting: the remainder vanishes only
  // when 15% more is corrected.
  SeededRandom random(3);
  std::vector<std::vector<SkewAnswer>> by_photo;
  for (int photo = 0; photo < 50; ++photo) {
    const double tilt = random.Normal();
    std::vector<SkewAnswer> answers;
    for (const double factor : kSkewFactors) {
      const double skew = 16.0 * factor;
      answers.push_back({factor, skew, 1.0 + tilt + 0.4 * skew, 0.5 + tilt + 0.06 * skew});
    }
    by_photo.push_back(answers);
  }
  const SkewResponse response = SummariseSkew(by_photo, 1);
  EXPECT_NEAR(response.fit.slope, 0.4, 1e-9);
  EXPECT_NEAR(response.fit.intercept, 1.0, 5.0 / std::sqrt(50.0));
  EXPECT_NEAR(response.remainder_slope, 0.06, 1e-9);
  EXPECT_NEAR(response.zero_crossing, 1.15, 1e-9);
  EXPECT_NEAR(response.zero_crossing_interval.low, 1.15, 1e-6);
  EXPECT_NEAR(response.remainder_px, 0.5, 5.0 / std::sqrt(50.0));
  EXPECT_NEAR(response.remainder_error_px, 1.0 / std::sqrt(50.0), 0.04);
}

TEST(SkewResponse, OfNoPhotosIsEmpty) {
  const SkewResponse response = SummariseSkew({}, 1);
  EXPECT_EQ(response.photos, 0);
  EXPECT_TRUE(response.levels.empty());
}

}  // namespace
}  // namespace rsstab::evaluation
