// SPDX-License-Identifier: Apache-2.0
// Versions, options, errors: everything around the frames.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>

#include "tests/plugin/capi/capi_test_support.h"
#include "tests/support/test_paths.h"

namespace rsstab::testing {
namespace {

using ::testing::HasSubstr;

TEST(Capi, SaysItsVersions) {
  EXPECT_EQ(rsstab_version(), RSSTAB_VERSION);
  EXPECT_EQ(rsstab_version() >> 16, static_cast<std::uint32_t>(RSSTAB_VERSION_MAJOR));
  EXPECT_THAT(rsstab_program_version(), HasSubstr("."));
  EXPECT_STREQ(rsstab_status_text(RSSTAB_END), "end of the clip");
  EXPECT_STREQ(rsstab_status_text(static_cast<rsstab_status>(-15)), "unknown status");
}

TEST(Capi, ListsEveryOptionOnceAndTakesItsOwnDefaults) {
  std::set<std::string> names;
  const OptionsHandle options = MakeOptions({});
  for (std::size_t i = 0; i < rsstab_option_count(); ++i) {
    const std::string name = rsstab_option_text(i, RSSTAB_OPTION_NAME);
    EXPECT_TRUE(names.insert(name).second) << name;
    EXPECT_STRNE(rsstab_option_text(i, RSSTAB_OPTION_HELP), "") << name;
    EXPECT_STRNE(rsstab_option_text(i, RSSTAB_OPTION_GROUP), "") << name;
    const std::string otherwise = rsstab_option_text(i, RSSTAB_OPTION_DEFAULT);
    EXPECT_EQ(rsstab_options_get(options.get(), name.c_str()), otherwise) << name;
    if (!otherwise.empty()) {
      EXPECT_EQ(rsstab_options_set(options.get(), name.c_str(), otherwise.c_str()), RSSTAB_OK);
    }
  }
  EXPECT_TRUE(names.contains("smoothness"));
  EXPECT_TRUE(names.contains("lookahead"));
  EXPECT_EQ(rsstab_option_text(rsstab_option_count(), RSSTAB_OPTION_NAME), nullptr);
  EXPECT_EQ(rsstab_option_text(0, static_cast<rsstab_option_field>(7)), nullptr);
}

TEST(Capi, RefusesWrongOptionsAndSaysWhy) {
  const OptionsHandle options = MakeOptions({{"crop", "0.9"}});
  EXPECT_EQ(rsstab_options_set(options.get(), "crop", "2"), RSSTAB_ERROR_INVALID_ARGUMENT);
  EXPECT_THAT(rsstab_options_error(options.get()), HasSubstr("0.1 to 1"));
  EXPECT_STREQ(rsstab_options_get(options.get(), "crop"), "0.9");
  EXPECT_STREQ(rsstab_options_error(options.get()), "");
  EXPECT_EQ(rsstab_options_set(options.get(), "cropp", "1"), RSSTAB_ERROR_NOT_FOUND);
  EXPECT_EQ(rsstab_options_set(options.get(), nullptr, "1"), RSSTAB_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(rsstab_options_set(nullptr, "crop", "1"), RSSTAB_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(rsstab_options_get(options.get(), "cropp"), nullptr);
}

TEST(Capi, RefusesImpossibleClips) {
  const OptionsHandle options = MakeOptions({});
  rsstab_instance* instance = nullptr;
  const auto refuses = [&](const rsstab_video& video) {
    const rsstab_status status = rsstab_create_live(options.get(), &video, &instance);
    EXPECT_EQ(instance, nullptr);
    EXPECT_STRNE(rsstab_options_error(options.get()), "");
    return status;
  };
  rsstab_video video = MakeVideo(0, 100, RSSTAB_PIXEL_GRAY8);
  EXPECT_EQ(refuses(video), RSSTAB_ERROR_INVALID_ARGUMENT);
  video = MakeVideo(100, 70000, RSSTAB_PIXEL_GRAY8);
  EXPECT_EQ(refuses(video), RSSTAB_ERROR_INVALID_ARGUMENT);
  video = MakeVideo(100, 100, RSSTAB_PIXEL_NONE);
  EXPECT_EQ(refuses(video), RSSTAB_ERROR_UNSUPPORTED);
  video = MakeVideo(100, 100, RSSTAB_PIXEL_GRAY8);
  video.time_base_den = 0;
  EXPECT_EQ(refuses(video), RSSTAB_ERROR_INVALID_ARGUMENT);
  video = MakeVideo(100, 100, RSSTAB_PIXEL_GRAY8);
  video.frame_rate_den = 0;
  EXPECT_EQ(refuses(video), RSSTAB_ERROR_INVALID_ARGUMENT);
  video = MakeVideo(100, 100, RSSTAB_PIXEL_GRAY8);
  video.struct_size = 4;
  EXPECT_EQ(refuses(video), RSSTAB_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(rsstab_create_live(options.get(), nullptr, &instance), RSSTAB_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(rsstab_create_live(options.get(), &video, nullptr), RSSTAB_ERROR_INVALID_ARGUMENT);
}

TEST(Capi, RefusesPicturesThatCannotBeRead) {
  const OptionsHandle options = MakeOptions({{"threads", "1"}});
  const rsstab_video video = MakeVideo(64, 48, RSSTAB_PIXEL_YUV420P10);
  rsstab_instance* made = nullptr;
  ASSERT_EQ(rsstab_create_live(options.get(), &video, &made), RSSTAB_OK);
  const InstanceHandle instance(made);
  const Frame frame = PaintShaky(Yuv420Layout(10), 64, 48, 0);
  int released = 0;
  const auto push = [&](const rsstab_picture& picture) {
    return rsstab_push(made, &picture, 0, &released,
                       [](void* data) { ++*static_cast<int*>(data); });
  };
  rsstab_picture picture = ToPicture(frame);
  picture.data[2] = nullptr;
  EXPECT_EQ(push(picture), RSSTAB_ERROR_INVALID_ARGUMENT);
  EXPECT_THAT(rsstab_error(made), HasSubstr("plane 2"));
  picture = ToPicture(frame);
  picture.stride[0] = 127;
  EXPECT_EQ(push(picture), RSSTAB_ERROR_INVALID_ARGUMENT);
  picture = ToPicture(frame);
  ++picture.data[0];
  EXPECT_EQ(push(picture), RSSTAB_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(released, 0);
  EXPECT_EQ(rsstab_push(made, nullptr, 0, nullptr, nullptr), RSSTAB_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(rsstab_pull(made, nullptr, nullptr, nullptr), RSSTAB_ERROR_INVALID_ARGUMENT);
}

TEST(Capi, LiveModeSaysWhichGyroLogItCannotUse) {
  const TemporaryFolder folder;
  const std::string log = (folder / "gyro.csv").string();
  {
    std::ofstream file(log);
    file << "t,gx,gy,gz\n";
    for (int i = 0; i < 400; ++i) {
      file << i / 200.0 << ",0,0,0\n";
    }
  }
  const rsstab_video video = MakeVideo(64, 48, RSSTAB_PIXEL_GRAY8);
  rsstab_instance* made = nullptr;
  OptionsHandle options = MakeOptions({{"rs", "gyro"}, {"gyro", log}, {"readout", "10"}});
  EXPECT_EQ(rsstab_create_live(options.get(), &video, &made), RSSTAB_ERROR_UNSUPPORTED);
  EXPECT_THAT(rsstab_options_error(options.get()), HasSubstr("gyro-offset"));
  ASSERT_EQ(rsstab_options_set(options.get(), "gyro-offset", "0"), RSSTAB_OK);
  ASSERT_EQ(rsstab_create_live(options.get(), &video, &made), RSSTAB_OK)
      << rsstab_options_error(options.get());
  rsstab_destroy(made);
}

TEST(Capi, LogsToTheHostOnly) {
  struct Lines {
    std::vector<std::string> all;
  } lines;
  const OptionsHandle options = MakeOptions({{"rs", "off"}, {"threads", "1"}});
  const auto log = [](void* user, rsstab_log_level level, const char* message) {
    EXPECT_LE(level, RSSTAB_LOG_INFO);
    static_cast<Lines*>(user)->all.emplace_back(message);
  };
  ASSERT_EQ(rsstab_options_set_log(options.get(), log, &lines, RSSTAB_LOG_INFO), RSSTAB_OK);
  const rsstab_video video = MakeVideo(64, 48, RSSTAB_PIXEL_GRAY8);
  rsstab_instance* made = nullptr;
  ::testing::internal::CaptureStderr();
  ::testing::internal::CaptureStdout();
  ASSERT_EQ(rsstab_create_live(options.get(), &video, &made), RSSTAB_OK);
  rsstab_destroy(made);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  ASSERT_FALSE(lines.all.empty());
  EXPECT_THAT(lines.all.front(), HasSubstr("rolling shutter"));
}

TEST(Capi, ToleratesNullObjects) {
  rsstab_destroy(nullptr);
  rsstab_options_destroy(nullptr);
  EXPECT_EQ(rsstab_flush(nullptr), RSSTAB_ERROR_INVALID_ARGUMENT);
  EXPECT_STRNE(rsstab_error(nullptr), "");
  EXPECT_EQ(rsstab_delay(nullptr), 0);
}

TEST(Capi, AnalysisAppearsOnlyWhenComplete) {
  const TemporaryFolder folder;
  const std::string path = (folder / "clip.rsstab").string();
  const OptionsHandle options = MakeOptions({{"rs", "off"}, {"threads", "1"}});
  const rsstab_video video = MakeVideo(64, 48, RSSTAB_PIXEL_GRAY8);
  const Frame frame = PaintShaky(GrayLayout(), 64, 48, 0);
  const rsstab_picture picture = ToPicture(frame);
  rsstab_instance* made = nullptr;
  ASSERT_EQ(rsstab_create_analyze(options.get(), &video, path.c_str(), &made), RSSTAB_OK);
  ASSERT_EQ(rsstab_push(made, &picture, 0, nullptr, nullptr), RSSTAB_OK);
  EXPECT_EQ(rsstab_peek(made, nullptr, nullptr), RSSTAB_ERROR_BAD_STATE);
  rsstab_destroy(made);
  EXPECT_FALSE(std::filesystem::exists(path));
  ASSERT_EQ(rsstab_create_analyze(options.get(), &video, path.c_str(), &made), RSSTAB_OK);
  EXPECT_EQ(rsstab_flush(made), RSSTAB_ERROR_CORRUPT_DATA);  // not a single frame
  EXPECT_EQ(rsstab_flush(made), RSSTAB_ERROR_BAD_STATE);
  rsstab_destroy(made);
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_EQ(rsstab_create_analyze(options.get(), &video, "/no/such/folder/a", &made),
            RSSTAB_ERROR_NOT_FOUND);
}

}  // namespace
}  // namespace rsstab::testing
