// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <functional>

#include "tests/robustness/damage.h"

namespace rsstab::testing {
namespace {

// A clip of 12 frames (0.4 s) and gyro logs that have something wrong with them.
class GyroDamage : public Damage {
 protected:
  void SetUp() override { WriteTestClip(Path("clip.mkv")); }

  // A log of `seconds` at 200 Hz; `change` may rewrite line i.
  void WriteLog(double seconds,
                const std::function<std::string(int i, const std::string& line)>& change = {}) {
    std::string text = "t,gx,gy,gz\n";
    for (int i = 0; i < static_cast<int>(seconds * 200.0); ++i) {
      const std::string line = std::to_string(i / 200.0) + ",0.01,-0.02,0.03";
      text += (change ? change(i, line) : line) + "\n";
    }
    WriteText(Path("log.csv"), text);
  }

  void ExpectRefused(const std::string& words) {
    ExpectRefusal({"clip.mkv", "-o", "out.mkv", "--rs", "gyro", "--gyro", "log.csv",
                   "--gyro-offset", "0", "--readout", "16", "--focal", "150"},
                  1, words);
  }
};

TEST_F(GyroDamage, UndamagedWorks) {
  WriteLog(2.0);
  ExpectSuccess({"clip.mkv", "-o", "out.mkv", "--rs", "gyro", "--gyro", "log.csv", "--gyro-offset",
                 "-0.5", "--readout", "16", "--focal", "150"},
                "out.mkv", 12);
}

TEST_F(GyroDamage, MissingEmptyAndHeaderOnly) {
  ExpectRefused("log.csv");
  WriteText(Path("log.csv"), "");
  ExpectRefused("log.csv");
  WriteText(Path("log.csv"), "t,gx,gy,gz\n");
  ExpectRefused("log.csv");
}

TEST_F(GyroDamage, NotANumber) {
  WriteLog(2.0, [](int i, const std::string& line) { return i == 77 ? "0.385,nan,0,0" : line; });
  ExpectRefused("log.csv");
  WriteLog(2.0, [](int i, const std::string& line) { return i == 77 ? "0.385,inf,0,0" : line; });
  ExpectRefused("log.csv");
  WriteLog(2.0, [](int i, const std::string& line) { return i == 77 ? "0.385,abc,0,0" : line; });
  ExpectRefused("log.csv");
}

TEST_F(GyroDamage, TimeRunsBackwards) {
  WriteLog(2.0, [](int i, const std::string& line) { return i == 77 ? "0.1,0,0,0" : line; });
  ExpectRefused("log.csv");
}

TEST_F(GyroDamage, ColumnsMissing) {
  WriteLog(2.0, [](int i, const std::string& line) { return i == 77 ? "0.385,1" : line; });
  ExpectRefused("log.csv");
  WriteText(Path("log.csv"), "a,b,c\n1,2,3\n");
  ExpectRefused("log.csv");
}

TEST_F(GyroDamage, GapInTheMiddle) {
  std::string text = "t,gx,gy,gz\n";
  for (const double start : {0.0, 30.0}) {
    for (int i = 0; i < 100; ++i) {
      text += std::to_string(start + i / 200.0) + ",0,0,0\n";
    }
  }
  WriteText(Path("log.csv"), text);
  ExpectRefused("log.csv");
}

TEST_F(GyroDamage, BinaryRubbishAsLog) {
  Bytes bytes(5000);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = static_cast<std::uint8_t>(i * 37 + i / 11);
  }
  WriteBytes(Path("log.csv"), bytes);
  ExpectRefused("log.csv");
}

TEST_F(GyroDamage, LogNowhereNearTheClip) {
  WriteLog(2.0);
  ExpectRefusal({"clip.mkv", "-o", "out.mkv", "--rs", "gyro", "--gyro", "log.csv", "--gyro-offset",
                 "1000", "--readout", "16", "--focal", "150"},
                1, "log.csv");
}

TEST_F(GyroDamage, ShorterThanTheClipLeavesTheRestAlone) {
  WriteLog(0.2);
  ExpectSuccess({"clip.mkv", "-o", "out.mkv", "--rs", "gyro", "--gyro", "log.csv", "--gyro-offset",
                 "0", "--readout", "16", "--focal", "150"},
                "out.mkv", 12);
}

TEST_F(GyroDamage, WantedButNotThere) {
  ExpectRefusal({"clip.mkv", "-o", "out.mkv", "--rs", "gyro"}, 1, "--gyro");
}

TEST_F(GyroDamage, AutoGoesOnWithoutATrustworthyLog) {
  // Nothing to synchronise with: a log of constant rate.
  WriteLog(2.0);
  ExpectSuccess({"clip.mkv", "-o", "out.mkv", "--gyro", "log.csv"}, "out.mkv", 12);
}

TEST_F(GyroDamage, BadAxes) {
  WriteLog(2.0);
  ExpectRefusal({"clip.mkv", "-o", "out.mkv", "--rs", "gyro", "--gyro", "log.csv", "--gyro-axes",
                 "xxz", "--gyro-offset", "0", "--readout", "16", "--focal", "150"},
                1, "xxz");
}

TEST_F(GyroDamage, BadCameraFiles) {
  const std::pair<const char*, const char*> files[] = {
      {"nothing", ""},
      {"text", "hello"},
      {"cut", R"({"width": 160, "height":)"},
      {"no size", R"({"fx": 100})"},
      {"negative focal", R"({"width": 160, "height": 120, "fx": -100, "fy": 100})"},
      {"text size", R"({"width": "wide", "height": 120})"},
      {"fisheye with 2", R"({"width": 160, "height": 120, "fx": 100, "fy": 100,
                             "model": "fisheye", "distortion": [1, 2]})"},
      {"unknown model", R"({"width": 160, "height": 120, "model": "bent"})"},
      {"other shape", R"({"width": 120, "height": 160, "fx": 100, "fy": 100})"},
      {"deep", nullptr}};
  for (const auto& [name, text] : files) {
    SCOPED_TRACE(name);
    WriteText(Path("camera.json"), text != nullptr ? text : std::string(100000, '['));
    ExpectRefusal({"clip.mkv", "-o", "out.mkv", "--camera", "camera.json"}, 1, "camera.json");
  }
  ExpectRefusal({"clip.mkv", "-o", "out.mkv", "--camera", "gone.json"}, 1, "gone.json");
}

}  // namespace
}  // namespace rsstab::testing
