// SPDX-License-Identifier: Apache-2.0
#include "igf/gyro_log_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "tests/support/gpmf_writer.h"
#include "tests/support/test_paths.h"

namespace rsstab::igf {
namespace {

using ::rsstab::testing::Bytes;
using ::testing::HasSubstr;

constexpr char kCsv[] = "t,gx,gy,gz\n0,0,0,0\n0.01,0,0,0\n";
constexpr char kGcsv[] = "GYROFLOW IMU LOG\norientation,XYZ\nt,gx,gy,gz\n0,0,0,0\n5,0,0,0\n";
constexpr char kJson[] = " {\"raw_imu\": [[0,0,0,0],[0.01,0,0,0]]}";

std::string Gpmf() {
  using namespace ::rsstab::testing;
  const Bytes device = KlvNest(
      "DEVC",
      {KlvUint32("DVID", 1),
       KlvNest("STRM", {KlvInt16("SCAL", {1000}), KlvInt16("GYRO", std::vector<int>(600, 1), 3)})});
  const Bytes file = Join({device, device});
  return {file.begin(), file.end()};
}

std::span<const std::uint8_t> AsBytes(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

class GyroLogReader : public ::testing::Test {
 protected:
  std::string Write(const std::string& name, const std::string& content) {
    const std::string path = (folder_ / name).string();
    std::ofstream(path, std::ios::binary) << content;
    return path;
  }
  static std::string MessageOf(const std::string& path) {
    const auto recording = ReadGyroLog(path);
    EXPECT_FALSE(recording.has_value()) << path;
    if (recording) {
      return {};
    }
    EXPECT_THAT(recording.error().message, HasSubstr(path));
    return recording.error().message;
  }

  ::rsstab::testing::TemporaryFolder folder_;
};

TEST_F(GyroLogReader, RecognisesByContentWhateverTheName) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {kCsv, "csv"}, {kGcsv, "gcsv"}, {kJson, "gyroflow"}, {Gpmf(), "GPMF"}};
  for (const auto& [content, format] : cases) {
    const auto recording = ReadGyroLog(Write("log.txt", content));
    ASSERT_TRUE(recording.has_value()) << format << ": " << recording.error().message;
    EXPECT_EQ(recording->format, format);
  }
}

TEST_F(GyroLogReader, NotesNominalTiming) {
  const auto recording = ReadGyroLog(Write("payloads.raw", Gpmf()));
  ASSERT_TRUE(recording.has_value());
  ASSERT_FALSE(recording->notes.empty());
  EXPECT_THAT(recording->notes.back(), HasSubstr("1.001 s"));
  EXPECT_NEAR(recording->gyro.mean_rate_hz(), 200.0 / 1.001, 1e-6);
}

TEST_F(GyroLogReader, FindsGpmfBehindGarbage) {
  const auto recording = ReadGyroLog(Write("payloads.raw", std::string(10000, '\3') + Gpmf()));
  ASSERT_TRUE(recording.has_value()) << recording.error().message;
  EXPECT_EQ(recording->gyro.samples().size(), 400U);
}

TEST_F(GyroLogReader, SaysWhatTheFileIsNot) {
  EXPECT_THAT(MessageOf((folder_ / "absent.csv").string()), HasSubstr("no such file"));
  EXPECT_THAT(MessageOf(folder_.path().string()), HasSubstr("not a regular file"));
  EXPECT_THAT(MessageOf(Write("empty.csv", "")), HasSubstr("empty"));
  EXPECT_THAT(MessageOf(Write("clip.mp4", std::string("\0\0\0\x18", 4) + "ftypmp42")),
              HasSubstr("a video"));
  EXPECT_THAT(MessageOf(Write("clip.mkv", "\x1a\x45\xdf\xa3")), HasSubstr("a video"));
  EXPECT_THAT(MessageOf(Write("binary.csv", std::string("\x7f"
                                                        "ELF\1\2\3\0",
                                                        8))),
              HasSubstr("not a gyro log"));
  EXPECT_THAT(MessageOf(Write("utf16.csv", std::string("\xff\xfet\0,\0g\0", 8))),
              HasSubstr("UTF-8"));
  EXPECT_THAT(MessageOf(Write("prose.txt", "Dear diary,\ntoday\n")), HasSubstr("no column \"t\""));
  EXPECT_THAT(MessageOf(Write("cut.gcsv", "GYROFLOW IMU LOG\nversion,1")),
              HasSubstr("no line of column names"));
  EXPECT_THAT(MessageOf(Write("cut.raw", Gpmf().substr(0, 50))), HasSubstr("no gyro"));
}

TEST_F(GyroLogReader, ErrorsKeepTheirCode) {
  EXPECT_EQ(ReadGyroLog((folder_ / "absent").string()).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(ReadGyroLog(Write("v", "\x1a\x45\xdf\xa3")).error().code, ErrorCode::kUnsupported);
  EXPECT_EQ(ReadGyroLog(Write("e", "")).error().code, ErrorCode::kCorruptData);
}

TEST(GyroLogReaderDamage, RandomBytesNeverCrash) {
  std::mt19937 random(13);
  for (const std::string& start : {std::string(), std::string(kCsv), std::string(kJson), Gpmf()}) {
    for (int round = 0; round < 500; ++round) {
      std::string content = start.substr(0, random() % (start.size() + 1));
      for (unsigned i = 0; i < random() % 64; ++i) {
        content += static_cast<char>(random());
      }
      const auto recording = ParseGyroFile(AsBytes(content));
      EXPECT_TRUE(recording.has_value() || !recording.error().message.empty());
    }
  }
}

TEST(GyroLogReaderRealFiles, ReadsEveryLog) {
  const auto folder = ::rsstab::testing::DevelopmentData("gyro");
  if (!folder) {
    GTEST_SKIP() << "development data gyro is not there";
  }
  for (const char* name : {"hero5.raw", "hero6.raw", "hero7.raw", "karma.raw", "Fusion.raw",
                           "GX016015.MP4.gyroflow", "karma_gyro.csv"}) {
    const auto recording = ReadGyroLog((*folder / name).string());
    EXPECT_TRUE(recording.has_value()) << recording.error().message;
  }
}

}  // namespace
}  // namespace rsstab::igf
