// SPDX-License-Identifier: Apache-2.0
#include "igf/sync_fit.h"

#include <gtest/gtest.h>

#include <vector>

#include "igf/base/rotation.h"

namespace rsstab::igf {
namespace {

constexpr double kFrameS = 1.0 / 30.0;

// A log that turns by more than 90 degrees from one frame to the next takes every point out of
// sight.
TEST(FitSync, RefusesInSilenceALogThatLooksAway) {
  std::vector<double> times_s;
  std::vector<Eigen::Quaterniond> orientations;
  std::vector<SyncPair> pairs;
  for (int i = 0; i <= 100; ++i) {
    times_s.push_back((i - 50) * kFrameS / 2.0);
    orientations.push_back(ExpSo3(Eigen::Vector3d(0.0, 1.1 * i, 0.0)));
  }
  for (int i = 0; i < 20; ++i) {
    SyncPair pair;
    pair.from_time_s = (i - 10) * kFrameS;
    pair.to_time_s = (i - 9) * kFrameS;
    for (int k = 0; k < 20; ++k) {
      const Eigen::Vector2d point(0.05 * (k % 5), 0.05 * (k % 4));
      pair.matches.push_back({point, point, 0.0, 0.0, 0.0, 500.0});
    }
    pairs.push_back(pair);
  }
  const auto track = OrientationTrack::Create(times_s, orientations);
  ASSERT_TRUE(track) << track.error().message;
  ::testing::internal::CaptureStderr();
  EXPECT_FALSE(FitSync(pairs, *track, {}, {}));
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace rsstab::igf
