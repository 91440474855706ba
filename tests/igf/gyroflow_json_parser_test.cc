// SPDX-License-Identifier: Apache-2.0
#include "igf/gyroflow_json_parser.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "tests/support/test_paths.h"

namespace rsstab::igf {
namespace {

using ::testing::HasSubstr;

TEST(GyroflowJsonParser, TurnsRightUpBackToCameraAxes) {
  const auto recording =
      ParseGyroflowJson(R"({"raw_imu": [[0.5, 1, 2, 3, 0, 1, 0], [0.51, 4, 5, 6]], "other": 1})");
  ASSERT_TRUE(recording.has_value()) << recording.error().message;
  const auto samples = recording->gyro.samples();
  ASSERT_EQ(samples.size(), 2U);
  EXPECT_EQ(samples[0].time_s, 0.5);
  EXPECT_EQ(samples[0].rate_rad_s, Eigen::Vector3d(1, -2, -3));
  EXPECT_EQ(samples[1].rate_rad_s, Eigen::Vector3d(4, -5, -6));
}

TEST(GyroflowJsonParser, NamesWhatIsWrong) {
  const auto message = [](const std::string& text) {
    const auto recording = ParseGyroflowJson(text);
    EXPECT_FALSE(recording.has_value());
    return recording ? std::string() : recording.error().message;
  };
  EXPECT_THAT(message(""), HasSubstr("not a whole JSON object"));
  EXPECT_THAT(message("{\"raw_imu\": [[0"), HasSubstr("not a whole JSON object"));
  EXPECT_THAT(message("[1]"), HasSubstr("not a whole JSON object"));
  EXPECT_THAT(message("{\"raw_imu\": 3}"), HasSubstr("no \"raw_imu\" rows"));
  EXPECT_THAT(message("{\"gyro_source\": {\"raw_imu\": \"packed\"}}"), HasSubstr("export"));
  EXPECT_THAT(message("{\"raw_imu\": [[0,1,2,3],[1,2,3]]}"), HasSubstr("row 1"));
  EXPECT_THAT(message("{\"raw_imu\": [[0,1,2,3],[1,2,\"x\",3]]}"), HasSubstr("row 1"));
  EXPECT_THAT(message("{\"raw_imu\": [[0,1,2,1e999]]}"), HasSubstr("not a whole"));
  EXPECT_THAT(message("{\"raw_imu\": [[1,0,0,0],[0,0,0,0]]}"), HasSubstr("runs backwards"));
  EXPECT_THAT(message(std::string(200000, '[')), HasSubstr("not a whole"));
  EXPECT_THAT(message("{\"raw_imu\": " + std::string(200000, '[')), HasSubstr("not a whole"));
}

TEST(GyroflowJsonParser, ARealShakyLog) {
  const auto path = ::rsstab::testing::DevelopmentData("gyro/GX016015.MP4.gyroflow");
  if (!path) {
    GTEST_SKIP() << "development data gyro/GX016015.MP4.gyroflow is not there";
  }
  std::ifstream in(*path);
  const std::string text(std::istreambuf_iterator<char>(in), {});
  const auto recording = ParseGyroflowJson(text);
  ASSERT_TRUE(recording.has_value()) << recording.error().message;
  EXPECT_EQ(recording->gyro.samples().size(), 5426U);
  EXPECT_NEAR(recording->gyro.mean_rate_hz(), 200.93, 0.01);
  EXPECT_NEAR(recording->gyro.start_s(), 0.045, 0.001);
  EXPECT_NEAR(recording->gyro.end_s(), 27.045, 0.001);
  EXPECT_TRUE(recording->gyro.gaps().empty());
}

}  // namespace
}  // namespace rsstab::igf
