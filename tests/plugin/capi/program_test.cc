// SPDX-License-Identifier: Apache-2.0
// What the library applies is what the program renders, bit for bit.
#include <gtest/gtest.h>

#include "cli/media/video_reader.h"
#include "tests/plugin/capi/capi_test_support.h"
#include "tests/support/run_program.h"
#include "tests/support/test_clip.h"
#include "tests/support/test_paths.h"

namespace rsstab::testing {
namespace {

ProgramResult RunRsStabilize(const std::vector<std::string>& arguments) {
  return RunProgram(RSSTAB_PROGRAM, arguments);
}

TEST(CapiAndProgram, ApplyEqualsRenderFrameForFrame) {
  const TemporaryFolder folder;
  const std::string clip = (folder / "clip.mkv").string();
  const std::string analysis = (folder / "clip.rsstab").string();
  const std::string steady = (folder / "steady.mkv").string();
  TestClip description;
  description.width = 200;
  description.height = 122;
  description.frames = 40;
  WriteTestClip(clip, description);
  ProgramResult result = RunRsStabilize({"analyze", clip, "-o", analysis});
  ASSERT_EQ(result.exit_code, 0) << result.error;
  result = RunRsStabilize({"render", clip, analysis, "-o", steady, "--codec", "ffv1"});
  ASSERT_EQ(result.exit_code, 0) << result.error;

  auto input = media::VideoReader::Open(clip, {});
  auto rendered = media::VideoReader::Open(steady, {});
  ASSERT_TRUE(input && rendered);
  rsstab_video video = MakeVideo(description.width, description.height, RSSTAB_PIXEL_YUV420P);
  video.time_base_num = static_cast<std::int32_t>((*input)->info().time_base.num);
  video.time_base_den = static_cast<std::int32_t>((*input)->info().time_base.den);
  const OptionsHandle options = MakeOptions({{"threads", "2"}});
  rsstab_instance* made = nullptr;
  ASSERT_EQ(rsstab_create_apply(options.get(), &video, analysis.c_str(), &made), RSSTAB_OK)
      << rsstab_options_error(options.get());
  const InstanceHandle instance(made);
  int frames = 0;
  while (true) {
    const auto in = (*input)->Read();
    const auto out = (*rendered)->Read();
    ASSERT_TRUE(in && out);
    ASSERT_EQ(in->has_value(), out->has_value());
    if (!*in) {
      break;
    }
    const Frame& picture = (*in)->frame;
    const Frame applied = *AllocateFrame(picture.layout, picture.width, picture.height);
    const rsstab_picture from = ToPicture(picture);
    const rsstab_buffer to = ToBuffer(applied);
    ASSERT_EQ(rsstab_render(made, &from, (*in)->pts, &to), RSSTAB_OK) << rsstab_error(made);
    EXPECT_EQ(Bytes(applied), Bytes((*out)->frame)) << "frame " << frames;
    ++frames;
  }
  EXPECT_EQ(frames, description.frames);
}

}  // namespace
}  // namespace rsstab::testing
