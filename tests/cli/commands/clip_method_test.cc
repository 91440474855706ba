// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/clip_method.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/support/test_paths.h"

namespace rsstab::cli {
namespace {

using pipeline::RsChoice;
using ::testing::Contains;
using ::testing::HasSubstr;

TEST(ClipMethods, EveryWordIsAMethod) {
  const std::vector<std::string> names = ClipMethodNames();
  for (const char* name : {"input", "off", "gyro", "auto", "diffusion", "vidstab", "deshake"}) {
    EXPECT_THAT(names, Contains(name));
  }
  const auto methods = ParseClipMethods(fmt::format("{}", fmt::join(names, ",")));
  ASSERT_TRUE(methods) << methods.error().message;
  EXPECT_EQ(methods->size(), names.size());
  EXPECT_EQ(methods->front().tool, ClipTool::kNone);
  EXPECT_EQ(methods->back().tool, ClipTool::kDeshake);
}

TEST(ClipMethods, OptionsGoWithTheirMethodOnly) {
  const auto methods =
      ParseClipMethods("off@smoothness=0.25,tripod=true,gyro@gyro-offset=-0.005,readout=20,off");
  ASSERT_TRUE(methods) << methods.error().message;
  ASSERT_EQ(methods->size(), 3U);
  EXPECT_EQ((*methods)[0].name, "off@smoothness=0.25,tripod=true");
  EXPECT_EQ((*methods)[0].options.rs, RsChoice::kOff);
  EXPECT_EQ((*methods)[0].options.smoothness_s, 0.25);
  EXPECT_TRUE((*methods)[0].options.tripod);
  EXPECT_EQ((*methods)[1].options.rs, RsChoice::kGyro);
  EXPECT_EQ((*methods)[1].options.gyro_offset_s, -0.005);
  EXPECT_DOUBLE_EQ((*methods)[1].options.readout_s.value(), 0.020);
  EXPECT_FALSE((*methods)[2].options.tripod);
}

TEST(ClipMethods, MistakesAreNamed) {
  struct Case {
    const char* list;
    const char* says;
  };
  for (const Case& mistake : {
           Case{"input,warp", "there is no method 'warp'; choose from input, "},
           Case{"", "at least one of input, "},
           Case{"off,,gyro", "names no method"},
           Case{"off@smoothnes=1", "--smoothnes"},
           Case{"off@smoothness=calm", "'calm'"},
           Case{"off@rs=gyro", "--rs"},
           Case{"off@gyro=log.csv", "--rs off uses no gyro log"},
           Case{"vidstab@smoothness=1", "'vidstab' takes no options"},
           Case{"input@crop=1", "'input' takes no options"},
       }) {
    const auto methods = ParseClipMethods(mistake.list);
    ASSERT_FALSE(methods) << mistake.list;
    EXPECT_EQ(methods.error().code, ErrorCode::kInvalidArgument);
    EXPECT_THAT(methods.error().message, HasSubstr(mistake.says)) << mistake.list;
  }
  EXPECT_THAT(ParseClipMethods("warp").error().message, HasSubstr("vidstab, deshake"));
}

TEST(ClipMethods, ForeignToolsThatAreNotThereAreTold) {
  const rsstab::testing::TemporaryFolder empty;
  const char* const path = std::getenv("PATH");
  const std::string before = path == nullptr ? "" : path;
  setenv("PATH", empty.path().c_str(), 1);
  const auto vidstab = WhyToolIsMissing(ClipTool::kVidstab);
  const auto own = WhyToolIsMissing(ClipTool::kOwn);
  setenv("PATH", before.c_str(), 1);
  ASSERT_TRUE(vidstab);
  EXPECT_EQ(vidstab->code, ErrorCode::kNotFound);
  EXPECT_THAT(vidstab->message, HasSubstr("ffmpeg"));
  EXPECT_FALSE(own);
}

}  // namespace
}  // namespace rsstab::cli
