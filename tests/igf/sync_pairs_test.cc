// SPDX-License-Identifier: Apache-2.0
#include "igf/sync_pairs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace rsstab::igf {
namespace {

PointTracks Pair(double from_time_s, float dx, int matches) {
  PointTracks tracks{640, 360, from_time_s, from_time_s + 0.04, {}};
  for (int i = 0; i < matches; ++i) {
    const auto x = static_cast<float>(20 + i);
    tracks.matches.push_back({{x, 100.0F}, {x + dx, 100.0F}});
  }
  return tracks;
}

TEST(SyncPairs, UndoesTheLensAndTimesTheRows) {
  // A camera of twice the tracks' size: rescaled to theirs.
  const Camera camera = Camera::Pinhole(1280, 720, 1000.0);
  PointTracks tracks{640, 360, 1.0, 1.04, {}};
  tracks.matches.push_back({{319.5F, 179.5F}, {419.5F, 359.0F}});
  const auto pairs = PrepareSyncPairs({&tracks, 1}, camera, 1, 10);
  ASSERT_TRUE(pairs);
  const SyncMatch& match = pairs->at(0).matches.at(0);
  EXPECT_NEAR(match.from.norm(), 0.0, 1e-9);
  EXPECT_NEAR(match.to.x(), 100.0 / 500.0, 1e-9);
  EXPECT_NEAR(match.from_row_share, 0.0, 1e-9);
  EXPECT_NEAR(match.to_row_share, 359.5 / 360.0 - 0.5, 1e-9);
  EXPECT_NEAR(match.column_share, 0.0, 1e-9);
  EXPECT_NEAR(match.px_per_unit, 500.0, 1e-3);
  EXPECT_NEAR(pairs->at(0).median_motion_px.x(), 100.0, 1e-5);
}

TEST(SyncPairs, LeavesOutWhatCannotBeUsed) {
  const Camera camera = Camera::Pinhole(640, 360, 500.0);
  std::vector<PointTracks> tracks = {Pair(0.0, 1.0F, 20), Pair(0.04, 1.0F, 3),
                                     Pair(0.08, 1.0F, 20)};
  tracks[2].to_time_s = tracks[2].from_time_s;  // a repeated timestamp
  tracks[0].matches[4].to.x() = std::nanf("");
  const auto pairs = PrepareSyncPairs(tracks, camera, 8, 100);
  ASSERT_TRUE(pairs);
  ASSERT_EQ(pairs->size(), 1U);
  EXPECT_EQ(pairs->front().matches.size(), 19U);
}

TEST(SyncPairs, ThinsEvenly) {
  const PointTracks tracks = Pair(0.0, 1.0F, 100);
  const auto pairs = PrepareSyncPairs({&tracks, 1}, Camera::Pinhole(640, 360, 500.0), 8, 40);
  ASSERT_TRUE(pairs);
  EXPECT_LE(pairs->front().matches.size(), 40U);
  EXPECT_GE(pairs->front().matches.size(), 30U);
}

TEST(SyncPairs, RefusesMixedSizes) {
  std::vector<PointTracks> tracks = {Pair(0.0, 1.0F, 20), Pair(0.04, 1.0F, 20)};
  tracks[1].width = 320;
  const auto pairs = PrepareSyncPairs(tracks, Camera::Pinhole(640, 360, 500.0), 8, 40);
  ASSERT_FALSE(pairs);
  EXPECT_EQ(pairs.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(pairs.error().message, ::testing::HasSubstr("frame pair 1"));
}

TEST(SyncPairs, SelectsChangesAndTheWholeClip) {
  std::vector<SyncPair> pairs;
  for (int i = 0; i < 100; ++i) {
    SyncPair pair;
    pair.from_time_s = i;
    pair.median_motion_px = {i == 70 ? 9.0 : 0.0, 0.0};  // one jerk
    pairs.push_back(pair);
  }
  const std::vector<SyncPair> selected = SelectInformativePairs(pairs, 10);
  ASSERT_EQ(selected.size(), 10U);
  bool has_jerk = false;
  for (std::size_t i = 0; i < selected.size(); ++i) {
    has_jerk = has_jerk || selected[i].from_time_s == 70.0;
    EXPECT_TRUE(i == 0 || selected[i].from_time_s > selected[i - 1].from_time_s);
  }
  EXPECT_TRUE(has_jerk);
  EXPECT_GE(selected.back().from_time_s, 80.0);
  EXPECT_EQ(SelectInformativePairs(pairs, 200).size(), 100U);
}

}  // namespace
}  // namespace rsstab::igf
