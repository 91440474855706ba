// SPDX-License-Identifier: Apache-2.0
#include "rsdiff/diffusion_motion_source.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <utility>

#include "tests/support/test_paths.h"

namespace rsstab::rsdiff {
namespace {

SingleImageEstimator TinyEstimator() {
  return std::move(
      *SingleImageEstimator::Load(rsstab::testing::SourceFile("tests/rsdiff/data/tiny_model")));
}

Frame Stripes(int phase) {
  Frame frame = *AllocateFrame(GrayLayout(), 320, 240);
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      frame.planes[0].data[y * frame.planes[0].stride + x] =
          static_cast<std::uint8_t>((x + y / 5 + phase) / 8 % 2 * 150 + 40);
    }
  }
  return frame;
}

RsMotion Estimate(DiffusionMotionSource& source, const Frame& picture, std::int64_t index) {
  const FrameView view = picture.View();
  return *source.EstimateMotion({index, 0.04 * static_cast<double>(index), &view});
}

TEST(DiffusionMotionSource, NeedsThePicture) {
  auto source = *DiffusionMotionSource::Create(TinyEstimator(), {});
  EXPECT_EQ(source.Name(), "diffusion");
  EXPECT_TRUE(source.NeedsImage());
  const auto motion = source.EstimateMotion({3, 0.12, nullptr});
  ASSERT_FALSE(motion);
  EXPECT_NE(motion.error().message.find("frame 3"), std::string::npos);
}

// Every frame starts from the same noise: equal pictures give equal fields, in any order.
TEST(DiffusionMotionSource, ChangesNoMoreThanThePicturesDo) {
  auto source = *DiffusionMotionSource::Create(TinyEstimator(), {});
  const RsMotion first = Estimate(source, Stripes(0), 0);
  const RsMotion other = Estimate(source, Stripes(3), 1);
  const RsMotion again = Estimate(source, Stripes(0), 2);
  const auto same = [](const RsMotion& a, const RsMotion& b) {
    return std::memcmp(a.field.vertices().data(), b.field.vertices().data(),
                       a.field.vertices().size_bytes()) == 0;
  };
  EXPECT_TRUE(same(first, again));
  EXPECT_FALSE(same(first, other));
  EXPECT_EQ(first.field.width(), 320);
  EXPECT_EQ(first.field.reference_row(), 119.5);
}

TEST(DiffusionMotionSource, StrengthScalesTheFieldAndItsSpread) {
  auto whole = *DiffusionMotionSource::Create(TinyEstimator(), {});
  auto half = *DiffusionMotionSource::Create(TinyEstimator(), {.strength = 0.5});
  auto none = *DiffusionMotionSource::Create(TinyEstimator(), {.strength = 0.0});
  const RsMotion full = Estimate(whole, Stripes(0), 0);
  const RsMotion weak = Estimate(half, Stripes(0), 0);
  EXPECT_GT(full.field.MaxLength(), 0.0);
  EXPECT_NEAR(weak.field.MaxLength(), 0.5 * full.field.MaxLength(), 1e-4);
  EXPECT_NEAR(weak.spread_px, 0.5 * full.spread_px, 1e-6);
  EXPECT_EQ(Estimate(none, Stripes(0), 0).field.MaxLength(), 0.0);
  auto lone = *DiffusionMotionSource::Create(TinyEstimator(),
                                             {.sampling = {.samples = 1}, .strength = 0.0});
  EXPECT_EQ(Estimate(lone, Stripes(0), 0).spread_px, 0.0);
}

TEST(DiffusionMotionSource, RefusesWhatMakesNoSense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(DiffusionMotionSource::Create(TinyEstimator(), {.strength = -0.1}));
  EXPECT_FALSE(DiffusionMotionSource::Create(TinyEstimator(), {.strength = 2.1}));
  EXPECT_FALSE(DiffusionMotionSource::Create(TinyEstimator(), {.strength = nan}));
  EXPECT_FALSE(DiffusionMotionSource::Create(TinyEstimator(), {.focal_px = 0.0}));
}

}  // namespace
}  // namespace rsstab::rsdiff
