// SPDX-License-Identifier: Apache-2.0
#include "evaluation/synthetic_sample.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <set>

#include "stabilizer/metrics/field_metrics.h"
#include "tests/evaluation/test_photos.h"

namespace rsstab::evaluation {
namespace {

using rsstab::testing::MakePhoto;
using rsstab::testing::Waves;

Frame Photo() {
  return MakePhoto(200, 150, [](int x, int y) { return Waves(x, y); });
}

bool SamePixels(const Frame& a, const Frame& b) {
  for (int y = 0; y < a.height; ++y) {
    if (std::memcmp(a.planes[0].data + y * a.planes[0].stride,
                    b.planes[0].data + y * b.planes[0].stride,
                    static_cast<std::size_t>(3 * a.width)) != 0) {
      return false;
    }
  }
  return true;
}

TEST(SyntheticSample, KeepsToTheProtocol) {
  const Frame photo = Photo();
  for (const MotionClass motion_class : kMovingClasses) {
    const auto sample =
        MakeSyntheticSample(photo.View(), motion_class, SampleSeed(1, "a.jpg", motion_class));
    ASSERT_TRUE(sample) << sample.error().message;
    EXPECT_EQ(sample->rs.width, 800);
    EXPECT_EQ(sample->rs.height, 600);
    EXPECT_GE(sample->camera.fx, 400.0);
    EXPECT_LE(sample->camera.fx, 1600.0);
    const std::vector<Eigen::Vector2f> zero(sample->displacement.size(), Eigen::Vector2f::Zero());
    const double uncorrected =
        stabilizer::EndPointError(zero, sample->displacement, sample->valid).value();
    constexpr double kGridError = 0.05;
    EXPECT_GE(uncorrected, 6.0 - kGridError) << MotionClassName(motion_class);
    EXPECT_LE(uncorrected, 10.0 + kGridError) << MotionClassName(motion_class);
  }
}

TEST(SyntheticSample, StillFramesDoNotMove) {
  const auto sample = MakeSyntheticSample(Photo().View(), MotionClass::kStill, 5);
  ASSERT_TRUE(sample);
  EXPECT_LT(sample->truth.MaxLength(), 1e-9);  // K K^-1 is not quite the identity
  EXPECT_EQ(std::count(sample->valid.begin(), sample->valid.end(), 0), 0);
}

TEST(SyntheticSample, SameSeedSameSample) {
  const Frame photo = Photo();
  const auto one = MakeSyntheticSample(photo.View(), MotionClass::kMixed, 77);
  const auto two = MakeSyntheticSample(photo.View(), MotionClass::kMixed, 77);
  const auto other = MakeSyntheticSample(photo.View(), MotionClass::kMixed, 78);
  ASSERT_TRUE(one && two && other);
  EXPECT_TRUE(SamePixels(one->rs, two->rs));
  EXPECT_FALSE(SamePixels(one->rs, other->rs));
  EXPECT_NE(one->camera.fx, other->camera.fx);
}

TEST(SyntheticSample, SeedsDifferByRunPhotoAndClass) {
  std::set<std::uint64_t> seeds;
  for (const std::uint64_t run : {1ULL, 2ULL}) {
    for (const char* photo : {"a.jpg", "b.jpg"}) {
      for (const MotionClass motion_class : kMovingClasses) {
        seeds.insert(SampleSeed(run, photo, motion_class));
      }
    }
  }
  EXPECT_EQ(seeds.size(), 16U);
}

TEST(SyntheticSample, SourcesOutsideTheFrameAreToldByTheirSide) {
  const std::vector<Eigen::Vector2f> displacement = {{-0.1F, 0.0F}, {0.0F, 0.0F},  {0.1F, 0.0F},
                                                     {0.0F, 0.5F},  {0.0F, -0.5F}, {0.0F, -1.5F}};
  const std::vector<std::uint8_t> inside = SourcesInside(displacement, 3, 2);
  EXPECT_EQ(inside, (std::vector<std::uint8_t>{0, 1, 0, 0, 1, 0}));
}

}  // namespace
}  // namespace rsstab::evaluation
