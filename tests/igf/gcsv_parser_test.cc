// SPDX-License-Identifier: Apache-2.0
#include "igf/gcsv_parser.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>

namespace rsstab::igf {
namespace {

using ::testing::HasSubstr;

constexpr char kRows[] = "t,gx,gy,gz,ax,ay,az\n0,10,20,30,-1137,-15689,-2986\n5,11,21,31,0,0,0\n";

std::string Log(const std::string& header, const std::string& rows = kRows) {
  return "GYROFLOW IMU LOG\nversion,1.3\n" + header + rows;
}

Eigen::Vector3d FirstRate(const Result<GyroRecording>& recording) {
  EXPECT_TRUE(recording.has_value()) << (recording ? "" : recording.error().message);
  if (!recording) {
    return Eigen::Vector3d::Zero();
  }
  return recording->gyro.samples()[0].rate_rad_s;
}

MATCHER_P3(IsRate, x, y, z, "") { return (arg - Eigen::Vector3d(x, y, z)).norm() < 1e-12; }

void ExpectRefused(const std::string& text, const std::string& words) {
  const auto recording = ParseGcsv(text);
  ASSERT_FALSE(recording.has_value()) << text;
  EXPECT_EQ(recording.error().code, ErrorCode::kCorruptData);
  EXPECT_THAT(recording.error().message, HasSubstr(words));
}

TEST(GcsvParser, ReadsScalesNamesAndReadout) {
  const auto recording = ParseGcsv(
      Log("id,cam_mark1\norientation,XYZ\nnote,a, b\nvendor,potatocam\nframe_readout_time,15.23\n"
          "frame_readout_direction,0\ntscale,0.001\ngscale,0.01\nascale,0.0005\n"));
  // Gyroflow's x up, y left, z back is (-y, -x, -z) in camera axes.
  EXPECT_THAT(FirstRate(recording), IsRate(-0.2, -0.1, -0.3));
  EXPECT_DOUBLE_EQ(recording->gyro.samples()[1].time_s, 0.005);
  EXPECT_EQ(recording->device_name, "potatocam cam_mark1");
  EXPECT_EQ(recording->format, "gcsv");
  ASSERT_TRUE(recording->readout_s.has_value());
  EXPECT_NEAR(*recording->readout_s, 15.23e-3, 1e-12);
  EXPECT_TRUE(recording->notes.empty());
}

TEST(GcsvParser, OrientationNamesTheSensorAxisThatSuppliesTheBodyAxis) {
  const auto rate = [](const std::string& orientation) {
    return FirstRate(ParseGcsv(Log("orientation," + orientation + "\ngscale,0.1\n")));
  };
  EXPECT_THAT(rate("XYZ"), IsRate(-2, -1, -3));
  EXPECT_THAT(rate("YxZ"), IsRate(1, -2, -3));  // body (2, -1, 3)
  EXPECT_THAT(rate("zxY"), IsRate(1, 3, -2));   // body (-3, -1, 2)
  EXPECT_THAT(rate("xzY"), IsRate(3, 1, -2));   // body (-1, -3, 2)
}

// A sensor whose x points up, on a camera that yaws to the right: positive about the down axis.
TEST(GcsvParser, AYawToTheRightIsPositiveY) {
  const auto recording = ParseGcsv(Log("orientation,XYZ\n", "t,gx,gy,gz\n0,-1,0,0\n5,-1,0,0\n"));
  EXPECT_THAT(FirstRate(recording), IsRate(0, 1, 0));
}

TEST(GcsvParser, DefaultsAreGyroflows) {
  const auto recording = ParseGcsv("CAMERA IMU LOG\r\nt,gx,gy,gz\r\n0,1,2,3\r\n5,1,2,3\r\n");
  EXPECT_THAT(FirstRate(recording), IsRate(3, 1, -2));  // xzY: body (-1, -3, 2)
  EXPECT_DOUBLE_EQ(recording->gyro.end_s(), 0.005);
  ASSERT_EQ(recording->notes.size(), 1U);
  EXPECT_THAT(recording->notes[0], HasSubstr("xzY is assumed"));
}

TEST(GcsvParser, ReadoutDirection) {
  const auto readout = [](const std::string& direction) {
    return ParseGcsv(Log("orientation,XYZ\nframe_readout_time,20\nframe_readout_direction," +
                         direction + "\n"))
        ->readout_s;
  };
  EXPECT_NEAR(readout("TopToBottom").value(), 0.02, 1e-12);
  EXPECT_NEAR(readout("1").value(), -0.02, 1e-12);
  EXPECT_NEAR(readout("BottomToTop").value(), -0.02, 1e-12);
  EXPECT_FALSE(readout("2").has_value());
  EXPECT_FALSE(readout("LeftToRight").has_value());
}

TEST(GcsvParser, AxisMapOfTheCallerWins) {
  GyroParseOptions options;
  options.camera_from_sensor = Eigen::Matrix3d::Identity();
  EXPECT_THAT(FirstRate(ParseGcsv(Log("orientation,nonsense\n"), options)), IsRate(10, 20, 30));
}

TEST(GcsvParser, NamesWhatIsWrong) {
  ExpectRefused("", "line 1");
  ExpectRefused("IMU LOG\n", "line 1");
  ExpectRefused("GYROFLOW IMU LOG\nversion,1\n", "no line of column names");
  ExpectRefused(Log("orientation,XYY\n"), "line 3, orientation");
  ExpectRefused(Log("tscale,fast\n"), "line 3: tscale is \"fast\"");
  ExpectRefused(Log("id,x\ngscale,0\n"), "line 4: gscale");
  ExpectRefused(Log("gscale,nan\n"), "line 3: gscale");
  ExpectRefused(Log("", "t,gx,gy\n0,1,2\n"), "line 3: no column \"gz\"");
  ExpectRefused(Log("orientation,XYZ\n", "t,gx,gy,gz\n0,1,2,3\n5,1,x,3\n"), "line 6, column 3");
  ExpectRefused(Log("orientation,XYZ\n", "t,gx,gy,gz\n0,1,2,3\n5,1,2,3\n5,1,2,3\n"),
                "line 7: time repeats");
  ExpectRefused(Log("orientation,XYZ\n", "t,gx,gy,gz\n"), "has 0 samples");
}

TEST(GcsvParserDamage, RandomBytesNeverCrash) {
  std::mt19937 random(11);
  const std::string text = Log("orientation,XYZ\nframe_readout_time,20\ngscale,0.01\n");
  for (int round = 0; round < 3000; ++round) {
    std::string damaged = text.substr(0, random() % (text.size() + 1));
    for (unsigned i = 0; i < random() % 8 && !damaged.empty(); ++i) {
      damaged[random() % damaged.size()] = static_cast<char>(random());
    }
    const auto recording = ParseGcsv(damaged);
    EXPECT_TRUE(recording.has_value() || !recording.error().message.empty());
  }
}

}  // namespace
}  // namespace rsstab::igf
