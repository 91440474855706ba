// SPDX-License-Identifier: Apache-2.0
#include "igf/csv_parser.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <sstream>
#include <string>

namespace rsstab::igf {
namespace {

using ::testing::HasSubstr;

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

void ExpectSamples(const std::string& text, const std::vector<GyroSample>& expected,
                   const GyroParseOptions& options = {}) {
  const auto recording = ParseGyroCsv(text, options);
  ASSERT_TRUE(recording.has_value()) << recording.error().message << "\n" << text;
  const auto samples = recording->gyro.samples();
  ASSERT_EQ(samples.size(), expected.size()) << text;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(samples[i].time_s, expected[i].time_s, 1e-12) << text;
    EXPECT_LT((samples[i].rate_rad_s - expected[i].rate_rad_s).norm(), 1e-12) << text;
  }
}

void ExpectRefused(const std::string& text, const std::string& words) {
  const auto recording = ParseGyroCsv(text);
  ASSERT_FALSE(recording.has_value()) << text;
  EXPECT_EQ(recording.error().code, ErrorCode::kCorruptData);
  EXPECT_THAT(recording.error().message, HasSubstr(words)) << text;
}

const std::vector<GyroSample> kTwo = {{0.0, {1.0, -2.0, 0.5}}, {0.01, {0.25, 0.0, -0.125}}};

TEST(CsvParser, PlainHeader) {
  ExpectSamples("t,gx,gy,gz\n0,1,-2,0.5\n0.01,0.25,0,-0.125\n", kTwo);
}

TEST(CsvParser, BlanksCommentsLineEndsAndMark) {
  ExpectSamples(
      "\xef\xbb\xbf# made by a logger\r\n\r\n t , gx , gy , gz \r\n// comment\r\n0, 1, -2, 0.5\r\n"
      "%\r\n\r\n+1e-2,.25,0,-0.125",
      kTwo);
}

TEST(CsvParser, SemicolonsTabsDecimalCommasAndQuotes) {
  ExpectSamples("t;gx;gy;gz\n0;1;-2;0,5\n0,01;0,25;0;-0,125\n", kTwo);
  ExpectSamples("t\tgx\tgy\tgz\n0\t1\t-2\t0.5\n0.01\t0.25\t0\t-0.125\n", kTwo);
  ExpectSamples("\"t\",\"gx\",\"gy\",\"gz\"\n\"0\",1,-2,0.5\n0.01,0.25,0,-0.125\n", kTwo);
}

TEST(CsvParser, ColumnsInAnyOrderBesideOthers) {
  ExpectSamples("frame,gz,ax,gx,gy,t,gx\n1,0.5,9,1,-2,0,7\n2,-0.125,9,0.25,0,0.01,7\n", kTwo);
}

TEST(CsvParser, NamesAndUnits) {
  const std::string rows = "0,1,-2,0.5\n0.01,0.25,0,-0.125\n";
  for (const std::string header :
       {"time,wx,wy,wz", "timestamp,gyro_x,gyro_y,gyro_z", "t_s,gx_rad_s,gy_rad_s,gz_rad_s",
        "Time (s),Gyro X (rad/s),Gyro Y (rad/s),Gyro Z (rad/s)", "ts,omega_x,omega_y,omega_z",
        "T [sec],GYR.X,GYR.Y,GYR.Z", "t,gx_radps,gy_radps,gz_radps"}) {
    ExpectSamples(header + "\n" + rows, kTwo);
  }
  const std::vector<GyroSample> degrees = {{0.0, {1.0 * kRadPerDeg, -2.0 * kRadPerDeg, 0.0}},
                                           {0.01, {0.0, 0.0, 3.0 * kRadPerDeg}}};
  for (const std::string header :
       {"t_ms,gx_dps,gy_dps,gz_dps", "time (ms),gyro_x [deg/s],gyro_y [deg/s],gyro_z [deg/s]",
        "timestamp_ms,gx_deg_s,gy_deg_s,gz_deg_s",
        "t_ms,gx(\xc2\xb0/s),gy(\xc2\xb0/s),gz(\xc2\xb0/s)"}) {
    ExpectSamples(header + "\n0,1,-2,0\n10,0,0,3\n", degrees);
  }
  for (const std::string header : {"t_us,gx,gy,gz", "time (\xc2\xb5s),gx,gy,gz",
                                   "t [\xce\xbcs],gx,gy,gz", "timestamp_us,gx,gy,gz"}) {
    ExpectSamples(header + "\n0,1,-2,0.5\n10000,0.25,0,-0.125\n", kTwo);
  }
  ExpectSamples("t_ns,gx,gy,gz\n0,1,-2,0.5\n10000000,0.25,0,-0.125\n", kTwo);
}

TEST(CsvParser, AxisMapTurnsTheRates) {
  GyroParseOptions options;
  options.camera_from_sensor = Eigen::Matrix3d{{0, -1, 0}, {-1, 0, 0}, {0, 0, -1}};
  ExpectSamples("t,gx,gy,gz\n0,2,-1,-0.5\n0.01,0,-0.25,0.125\n",
                {{0.0, {1.0, -2.0, 0.5}}, {0.01, {0.25, 0.0, -0.125}}}, options);
}

TEST(CsvParser, NamesTheLineOfABadRow) {
  const std::string head = "# log\nt,gx,gy,gz\n0,0,0,0\n\n";
  ExpectRefused(head + "0.01,0,zero,0\n", "line 5, column 3: \"zero\" is not a finite number");
  ExpectRefused(head + "0.01,0,nan,0\n", "line 5, column 3: \"nan\"");
  ExpectRefused(head + "0.01,0,0,inf\n", "line 5, column 4: \"inf\"");
  ExpectRefused(head + "0.01,0,,0\n", "line 5, column 3: \"\"");
  ExpectRefused(head + "0.01,0,1e999,0\n", "line 5, column 3");
  ExpectRefused(head + "0.01,0,0\n0.02,0,0,0\n", "line 5 has 3 columns");
  ExpectRefused(head + "0.01,0,0,0\n0.01,0,0,0\n", "line 6: time repeats");
  ExpectRefused(head + "0.01,0,0,0\n0.005,0,0,0\n", "line 6: time runs backwards");
}

TEST(CsvParser, NamesWhatTheHeaderLacks) {
  ExpectRefused("", "no line of data");
  ExpectRefused("# only a comment\n", "no line of data");
  ExpectRefused("0,1,2,3\n0.01,1,2,3\n", "no column \"t\"");
  ExpectRefused("t,gx,gz\n0,1,2\n", "no column \"gy\"");
  ExpectRefused("t,gx_furlongs,gy,gz\n0,1,2,3\n", "no column \"gx\"");
  ExpectRefused("t,gx,gy,gz\n", "has 0 samples");
}

TEST(CsvParser, LeavesOutALastLineThatBreaksOff) {
  const auto recording = ParseGyroCsv("t,gx,gy,gz\n0,1,-2,0.5\n0.01,0.25,0,-0.125\n0.02,1");
  ASSERT_TRUE(recording.has_value()) << recording.error().message;
  EXPECT_EQ(recording->gyro.samples().size(), 2U);
  ASSERT_EQ(recording->notes.size(), 1U);
  EXPECT_THAT(recording->notes[0], HasSubstr("line 4 breaks off"));
}

TEST(CsvParser, ReadsWhatItWrites) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<GyroSample> samples;
  for (int i = 0; i < 100; ++i) {
    samples.push_back({i / 997.0 + 1e-5, {normal(random), normal(random), 1e-12 * normal(random)}});
  }
  const auto log = GyroLog::Create(samples);
  ASSERT_TRUE(log.has_value());
  std::ostringstream out;
  WriteGyroCsv(*log, out);
  const auto back = ParseGyroCsv(out.str());
  ASSERT_TRUE(back.has_value()) << back.error().message;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_EQ(back->gyro.samples()[i].time_s, samples[i].time_s);
    EXPECT_EQ(back->gyro.samples()[i].rate_rad_s, samples[i].rate_rad_s);
  }
}

TEST(CsvParserDamage, RandomBytesNeverCrash) {
  std::mt19937 random(7);
  std::string text = "t;gx_dps;gy (rad/s);gz\n";
  for (int i = 0; i < 30; ++i) {
    text += std::to_string(i) + "e-2;1,5;-0.25;+3\r\n";
  }
  for (int round = 0; round < 3000; ++round) {
    std::string damaged = text.substr(0, random() % (text.size() + 1));
    for (unsigned i = 0; i < random() % 8 && !damaged.empty(); ++i) {
      damaged[random() % damaged.size()] = static_cast<char>(random());
    }
    const auto recording = ParseGyroCsv(damaged);
    EXPECT_TRUE(recording.has_value() || !recording.error().message.empty());
  }
}

}  // namespace
}  // namespace rsstab::igf
