// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "tests/robustness/damage.h"

namespace rsstab::testing {
namespace {

class AnalysisDamage : public Damage {
 protected:
  void SetUp() override {
    WriteTestClip(Path("clip.mkv"));
    const ProgramResult run = Run({"analyze", "clip.mkv", "-o", "good"});
    ASSERT_EQ(run.exit_code, 0) << run.error;
    EXPECT_THAT(run.error, ::testing::ContainsRegex("at least [0-9.]+ % of each side kept"));
  }
  void ExpectRefused(const std::string& analysis, const std::string& words) {
    ExpectRefusal({"render", "clip.mkv", analysis, "-o", "out.mkv"}, 1, words);
  }
};

TEST_F(AnalysisDamage, UndamagedWorks) {
  ExpectSuccess({"render", "clip.mkv", "good", "-o", "out.mkv"}, "out.mkv", 12);
}

TEST_F(AnalysisDamage, MissingOrOfAnotherKind) {
  ExpectRefused("nowhere", "nowhere");
  ExpectRefused("clip.mkv", "clip.mkv");
  WriteText(Path("empty"), "");
  ExpectRefused("empty", "empty");
  WriteText(Path("text"), std::string(3000, 'x'));
  ExpectRefused("text", "text");
}

TEST_F(AnalysisDamage, CutOffAnywhere) {
  const Bytes good = ReadBytes(Path("good"));
  for (const std::size_t size : {std::size_t{7}, good.size() / 2, good.size() - 1}) {
    Bytes cut = good;
    cut.resize(size);
    WriteBytes(Path("cut"), cut);
    // Where it was cut, once it is long enough to be known as an analysis file.
    ExpectRefused("cut", size < 12 ? "cut" : "byte " + std::to_string(size));
  }
}

TEST_F(AnalysisDamage, AnyFlippedBitIsSeen) {
  const Bytes good = ReadBytes(Path("good"));
  for (int i = 0; i < 16; ++i) {
    Bytes flipped = good;
    const std::size_t at = good.size() * static_cast<std::size_t>(i) / 16 + 1;
    flipped[at] ^= static_cast<std::uint8_t>(1U << (i % 8));
    WriteBytes(Path("flipped"), flipped);
    ExpectRefused("flipped", "flipped");
  }
}

TEST_F(AnalysisDamage, FromAnotherClip) {
  TestClip other;
  other.width = 320;
  WriteTestClip(Path("wider.mkv"), other);
  ExpectRefusal({"render", "wider.mkv", "good", "-o", "out.mkv"}, 1, "analyse");
  other = {};
  other.frames = 20;
  WriteTestClip(Path("longer.mkv"), other);
  ExpectRefusal({"render", "longer.mkv", "good", "-o", "out.mkv"}, 1, "analyse");
  other.frames = 5;
  WriteTestClip(Path("shorter.mkv"), other);
  ExpectRefusal({"render", "shorter.mkv", "good", "-o", "out.mkv"}, 1, "analyse");
  other = {};
  other.shake_px = 40.0;  // same size, length and times, another picture
  WriteTestClip(Path("alike.mkv"), other);
  ExpectRefusal({"render", "alike.mkv", "good", "-o", "out.mkv"}, 1, "analyse");
}

TEST_F(AnalysisDamage, IsNotReplacedWithoutBeingTold) {
  ExpectRefusal({"analyze", "clip.mkv", "-o", "good"}, 1, "--overwrite");
  ExpectRefusal({"analyze", "clip.mkv", "-o", "clip.mkv", "--overwrite"}, 1, "clip.mkv");
  EXPECT_EQ(Run({"analyze", "clip.mkv", "-o", "good", "--overwrite"}).exit_code, 0);
}

}  // namespace
}  // namespace rsstab::testing
