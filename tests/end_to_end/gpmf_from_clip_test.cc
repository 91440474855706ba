// SPDX-License-Identifier: Apache-2.0
// A GoPro clip's telemetry from the container to rates in camera axes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "cli/media/telemetry_track.h"
#include "igf/gpmf_parser.h"
#include "tests/support/test_paths.h"

namespace rsstab {
namespace {

TEST(GpmfFromClip, EqualsTheDecodedLog) {
  const auto clip = testing::DevelopmentData("clips/karma.mp4");
  const auto csv = testing::DevelopmentData("gyro/karma_gyro.csv");
  if (!clip || !csv) {
    GTEST_SKIP() << "development data clips/karma.mp4 or gyro/karma_gyro.csv is not there";
  }
  const auto track = media::ReadTelemetry(clip->string(), "gpmd");
  ASSERT_TRUE(track.has_value()) << track.error().message;
  std::vector<igf::GpmfPayload> payloads;
  for (const media::TelemetryPayload& payload : *track) {
    payloads.push_back({payload.bytes, payload.start_s, payload.duration_s});
  }
  ASSERT_EQ(payloads.size(), 13U);
  const auto recording = igf::ParseGpmf(payloads);
  ASSERT_TRUE(recording.has_value()) << recording.error().message;
  const auto samples = recording->gyro.samples();
  ASSERT_EQ(samples.size(), 4795U);

  std::ifstream in(*csv);
  std::string line;
  std::getline(in, line);  // t_s,gx,gy,gz in stored order Z, X, Y
  double worst_time_s = 0.0;
  double worst_rate = 0.0;
  for (const igf::GyroSample& sample : samples) {
    ASSERT_TRUE(std::getline(in, line));
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream row(line);
    double t = 0.0;
    double up = 0.0;
    double left = 0.0;
    double back = 0.0;
    ASSERT_TRUE(row >> t >> up >> left >> back);
    worst_time_s = std::max(worst_time_s, std::abs(sample.time_s - t));
    worst_rate = std::max(
        worst_rate, (sample.rate_rad_s - Eigen::Vector3d(-left, -up, -back)).cwiseAbs().maxCoeff());
  }
  EXPECT_LT(worst_time_s, 1e-6);  // the file has six decimals
  EXPECT_LT(worst_rate, 1e-8);    // and nine
}

}  // namespace
}  // namespace rsstab
