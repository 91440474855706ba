// SPDX-License-Identifier: Apache-2.0
#include "cli/media/encoder_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>

namespace rsstab::media {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;

EncoderIsThere Only(std::set<std::string> names) {
  return [names = std::move(names)](const std::string& name) { return names.count(name) > 0; };
}

TEST(EncoderChoice, FirstChoiceComesWithoutAWord) {
  const auto choice = ChooseEncoder("", Only({"libx264", "mpeg4", "libopenh264"}));
  ASSERT_TRUE(choice);
  EXPECT_EQ(choice->encoder, "libx264");
  EXPECT_THAT(choice->warning, IsEmpty());
}

TEST(EncoderChoice, FallsBackWithAClearWord) {
  const auto open = ChooseEncoder("", Only({"mpeg4", "libopenh264"}));
  ASSERT_TRUE(open);
  EXPECT_EQ(open->encoder, "libopenh264");
  EXPECT_THAT(open->warning, AllOf(HasSubstr("'libx264'"), HasSubstr("'libopenh264'")));
  const auto old = ChooseEncoder("", Only({"mpeg4"}));
  ASSERT_TRUE(old);
  EXPECT_EQ(old->encoder, "mpeg4");
  EXPECT_THAT(old->warning, HasSubstr("'mpeg4'"));
}

TEST(EncoderChoice, AskedForCodecIsNotReplacedByAnother) {
  const auto refused = ChooseEncoder("h264", Only({"mpeg4"}));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(refused.error().message, AllOf(HasSubstr("h264"), HasSubstr("--codec")));
  EXPECT_EQ(ChooseEncoder("av1", Only({"libaom-av1"}))->encoder, "libaom-av1");
  EXPECT_EQ(ChooseEncoder("h265", Only({"libx265"}))->encoder, "libx265");
  EXPECT_EQ(ChooseEncoder("utvideo", Only({"utvideo"}))->encoder, "utvideo");
}

TEST(EncoderChoice, QualityInTheEncodersOwnWords) {
  EXPECT_THAT(SettingsFor("libx264", {}, "", 0)->options,
              AllOf(Contains(Pair("crf", "18")), Contains(Pair("preset", "medium"))));
  EXPECT_THAT(SettingsFor("libx264", 23.5, "veryfast", 0)->options,
              AllOf(Contains(Pair("crf", "23.5")), Contains(Pair("preset", "veryfast"))));
  EXPECT_THAT(SettingsFor("libvpx-vp9", 30, "", 0)->options,
              AllOf(Contains(Pair("crf", "30")), Contains(Pair("b", "0"))));
  EXPECT_THAT(SettingsFor("libsvtav1", 30, "ultrafast", 2)->options,
              AllOf(Contains(Pair("preset", "12")), Contains(Pair("svtav1-params", "lp=2"))));
  EXPECT_THAT(SettingsFor("libsvtav1", 30, "7", 0)->options, Contains(Pair("preset", "7")));
  // Six steps of crf double the quantiser.
  EXPECT_DOUBLE_EQ(*SettingsFor("mpeg4", 18, "", 0)->quantiser, 2.0);
  EXPECT_DOUBLE_EQ(*SettingsFor("mpeg4", 24, "", 0)->quantiser, 4.0);
  EXPECT_DOUBLE_EQ(*SettingsFor("mjpeg", 51, "", 0)->quantiser, 31.0);
  EXPECT_FALSE(SettingsFor("ffv1", 18, "", 0)->quantiser);
  EXPECT_DOUBLE_EQ(SettingsFor("libopenh264", 24, "", 0)->bits_per_pixel, 0.1);
}

TEST(EncoderChoice, RefusesImpossibleWishes) {
  for (const double crf : {-1.0, 64.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_FALSE(SettingsFor("libx264", crf, "", 0)) << crf;
  }
  EXPECT_FALSE(SettingsFor("libx264", {}, "7", 0));
  EXPECT_FALSE(SettingsFor("libvpx-vp9", {}, "quick", 0));
}

}  // namespace
}  // namespace rsstab::media
