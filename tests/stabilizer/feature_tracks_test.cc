// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/feature_tracks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/support/random_scene.h"

namespace rsstab::stabilizer {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 240;
// Lucas-Kanade on a noise-free picture rounded to 8 bits.
constexpr float kTrackingError = 0.08F;

GrayImage Picture(const testing::WaveScene& scene, const Eigen::Vector2d& shift) {
  GrayImage image{kWidth, kHeight, {}};
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double level = scene.At(Eigen::Vector2d(x, y) - shift);
      image.pixels.push_back(static_cast<std::uint8_t>(std::clamp(level, 0.0, 255.0) + 0.5));
    }
  }
  return image;
}

TEST(FeatureTracker, FollowsAKnownSubPixelShift) {
  const testing::WaveScene scene(3);
  FeatureTracker tracker({});
  ASSERT_TRUE(tracker.Push(Picture(scene, {0.0, 0.0}), 0.0));
  const Eigen::Vector2d shift(7.3, -4.6);
  const auto output = tracker.Push(Picture(scene, shift), 0.04);
  ASSERT_TRUE(output);
  EXPECT_GT(output->tracks.matches.size(), 80U);
  EXPECT_EQ(output->tracks.to_time_s, 0.04);
  int good = 0;
  for (const PointMatch& m : output->tracks.matches) {
    good += (m.to - m.from - shift.cast<float>()).norm() < kTrackingError ? 1 : 0;
  }
  EXPECT_GE(good, static_cast<int>(output->tracks.matches.size() * 9 / 10));
}

TEST(FeatureTracker, SpreadsOnePointPerCell) {
  const testing::WaveScene scene(4);
  FeatureTrackerOptions options;
  FeatureTracker tracker(options);
  ASSERT_TRUE(tracker.Push(Picture(scene, {0.0, 0.0}), 0.0));
  const auto output = tracker.Push(Picture(scene, {0.0, 0.0}), 0.04);
  std::set<std::pair<int, int>> cells;
  for (const PointMatch& m : output->tracks.matches) {
    cells.insert({static_cast<int>(m.from.x()) / options.cell_px,
                  static_cast<int>(m.from.y()) / options.cell_px});
  }
  EXPECT_EQ(cells.size(), output->tracks.matches.size());
  EXPECT_GT(cells.size(), 16U * 12U / 2U);
}

TEST(FeatureTracker, FindsNewPointsWhereOldOnesLeft) {
  const testing::WaveScene scene(5);
  FeatureTracker tracker({});
  std::size_t last = 0;
  for (int i = 0; i < 12; ++i) {
    const auto output = tracker.Push(Picture(scene, {10.0 * i, 0.0}), 0.04 * i);
    ASSERT_TRUE(output);
    last = static_cast<std::size_t>(
        std::count_if(output->tracks.matches.begin(), output->tracks.matches.end(),
                      [](const PointMatch& m) { return m.to.x() < 100.0F; }));
  }
  EXPECT_GT(last,
            20U);  // a third of the scene has passed: without re-detection the left third is empty
}

TEST(FeatureTracker, FindsNothingInAFlatPicture) {
  FeatureTracker tracker({});
  const GrayImage flat{kWidth, kHeight, std::vector<std::uint8_t>(kWidth * kHeight, 16)};
  for (int i = 0; i < 3; ++i) {
    const auto output = tracker.Push(flat, 0.04 * i);
    ASSERT_TRUE(output);
    EXPECT_EQ(output->attempted, 0);
    EXPECT_TRUE(output->tracks.matches.empty());
  }
}

TEST(FeatureTracker, HoldsStillOnTinyPicturesAndRefusesSizeChanges) {
  FeatureTracker tracker({});
  EXPECT_TRUE(tracker.Push({1, 1, {7}}, 0.0));
  EXPECT_TRUE(tracker.Push({1, 1, {7}}, 0.04));
  FeatureTracker other({});
  ASSERT_TRUE(other.Push(Picture(testing::WaveScene(1), {0.0, 0.0}), 0.0));
  EXPECT_FALSE(other.Push({64, 64, std::vector<std::uint8_t>(64 * 64)}, 0.04));
}

}  // namespace
}  // namespace rsstab::stabilizer
