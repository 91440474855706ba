// SPDX-License-Identifier: Apache-2.0
// The weights that we ship, on a picture of our own: a facade, recorded along known motions.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>

#include "rsdiff/single_image_motion.h"
#include "tests/support/test_paths.h"

namespace rsstab::rsdiff {
namespace {

constexpr int kWidth = 800;
constexpr int kHeight = 600;

// 0 outside [-1, 1], 1 inside, with an edge of about a pixel.
double Box(double distance_px, double half_px) {
  return std::clamp(half_px - std::abs(distance_px) + 0.5, 0.0, 1.0);
}

// A wall with courses of stone and rows of windows with crosses, sky above it.
double Facade(double x, double y) {
  constexpr double kRoof = 70.0;
  const double wall = std::clamp(y - kRoof + 0.5, 0.0, 1.0);
  const double course = 8.0 * Box(std::remainder(y, 24.0), 1.0);
  const double window_x = std::remainder(x - 60.0, 113.0);
  const double window_y = std::remainder(y - 150.0, 141.0);
  const double window = Box(window_x, 27.0) * Box(window_y, 43.0);
  const double cross = window * std::max(Box(window_x, 2.5), Box(window_y, 2.5));
  const double stone = 150.0 - course + 6.0 * std::sin(0.013 * x) * std::sin(0.021 * y);
  const double built = stone + window * (60.0 - stone) + cross * 120.0;
  return 215.0 + wall * (built - 215.0);
}

// The facade as recorded by a camera that is `shift_px(s)` to the right at the time s of the
// readout, -0.5 .. 0.5: a pixel of row s shows what the corrected picture has at x - shift.
Frame Recorded(const std::function<double(double)>& shift_px) {
  Frame frame = *AllocateFrame(GrayLayout(), kWidth, kHeight);
  const MutablePlaneView& plane = frame.planes[0];
  for (int y = 0; y < kHeight; ++y) {
    const double shift = shift_px((y + 0.5) / kHeight - 0.5);
    for (int x = 0; x < kWidth; ++x) {
      plane.data[y * plane.stride + x] =
          static_cast<std::uint8_t>(std::lround(Facade(x - shift, y)));
    }
  }
  return frame;
}

class ShippedModel : public ::testing::Test {
 protected:
  // Mean over the rows of |estimate - truth| of the horizontal displacement in the middle column,
  // and the same of the truth.
  struct Errors {
    double left_px = 0.0;
    double truth_px = 0.0;
  };

  [[nodiscard]] Errors Judge(const std::function<double(double)>& shift_px) {
    const Frame picture = Recorded(shift_px);
    const auto motion = estimator_.Estimate(picture.View());
    EXPECT_TRUE(motion) << motion.error().message;
    Errors errors;
    for (int y = 0; y < kHeight; ++y) {
      const double truth = shift_px((y + 0.5) / kHeight - 0.5) - shift_px(0.0);
      const double told = motion->field.Sample({kWidth / 2.0, static_cast<double>(y)}).x();
      errors.left_px += std::abs(told - truth) / kHeight;
      errors.truth_px += std::abs(truth) / kHeight;
    }
    return errors;
  }

  SingleImageEstimator estimator_ =
      *SingleImageEstimator::Load(rsstab::testing::SourceFile("rsdiff/models/compact"));
};

// What a picture full of upright edges must tell. A flipped sign would double what is left.
constexpr double kLeftOfClearMotion = 0.5;

TEST_F(ShippedModel, SeesSkewEitherWay) {
  for (const double skew_px : {-45.0, 45.0}) {
    const Errors errors = Judge([&](double s) { return skew_px * s; });
    EXPECT_LT(errors.left_px, kLeftOfClearMotion * errors.truth_px) << skew_px;
  }
}

TEST_F(ShippedModel, SeesBending) {
  for (const double cycles : {1.0, 2.0}) {
    const Errors errors =
        Judge([&](double s) { return 12.0 * std::sin(2.0 * std::numbers::pi * cycles * s + 0.7); });
    EXPECT_LT(errors.left_px, kLeftOfClearMotion * errors.truth_px) << cycles;
  }
}

TEST_F(ShippedModel, LeavesAStillPictureNearlyAlone) {
  const Frame picture = Recorded([](double) { return 0.0; });
  const auto motion = estimator_.Estimate(picture.View());
  ASSERT_TRUE(motion) << motion.error().message;
  EXPECT_LT(motion->field.RmsLength(), 2.0);
}

}  // namespace
}  // namespace rsstab::rsdiff
