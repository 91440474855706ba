// SPDX-License-Identifier: Apache-2.0
#include "cli/media/video_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "cli/media/av_handles.h"
#include "tests/cli/media/media_test_support.h"
#include "tests/support/test_paths.h"

namespace rsstab::media {
namespace {

using ::rsstab::testing::TemporaryFolder;
using testing::Clip;
using testing::ClipRecipe;
using testing::CollectWarnings;
using testing::CopyClip;
using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using testing::HasEncoder;
using ::testing::HasSubstr;
using testing::LargestDifference;
using testing::MakeClip;
using testing::PlanarYuv;
using testing::Psnr;
using testing::ReadClip;
using testing::SmallRecipe;
using testing::TestPicture;

// Smooth 96x72 pictures at crf 10 to 18; a shift by one pixel or a swapped plane stays below 30 dB.
constexpr double kLossyPsnr = 34.0;

// depth, chroma shift x, chroma shift y
class VideoWriterLayouts : public ::testing::TestWithParam<std::tuple<int, int, int>> {};

TEST_P(VideoWriterLayouts, LosslessRoundTripIsExact) {
  const auto [depth, shift_x, shift_y] = GetParam();
  const TemporaryFolder folder;
  ClipRecipe recipe = SmallRecipe();
  recipe.description.width = 37;  // odd: chroma rounds up
  recipe.description.height = 23;
  recipe.description.layout = PlanarYuv(depth, shift_x, shift_y);
  recipe.options.codec = "ffv1";
  const Status made = MakeClip(folder / "a.mkv", recipe);
  ASSERT_TRUE(made) << made.error().message;
  const Result<Clip> clip = ReadClip(folder / "a.mkv");
  ASSERT_TRUE(clip) << clip.error().message;
  ASSERT_EQ(clip->frames.size(), 12U);
  for (std::size_t i = 0; i < clip->frames.size(); ++i) {
    Frame expected = TestPicture(recipe.description.layout, 37, 23, static_cast<int>(i));
    expected.layout = clip->info.layout;  // FFV1 does not keep the siting
    EXPECT_EQ(LargestDifference(clip->frames[i].frame, expected), 0) << "frame " << i;
  }
}

TEST_P(VideoWriterLayouts, H264KeepsTheFormat) {
  const auto [depth, shift_x, shift_y] = GetParam();
  if (!HasEncoder("libx264") || depth > 10) {
    GTEST_SKIP() << "libx264 is not there or does not do this depth";
  }
  const TemporaryFolder folder;
  ClipRecipe recipe = SmallRecipe();
  recipe.description.layout = PlanarYuv(depth, shift_x, shift_y);
  const Status made = MakeClip(folder / "a.mp4", recipe);
  ASSERT_TRUE(made) << made.error().message;
  const Result<Clip> clip = ReadClip(folder / "a.mp4");
  ASSERT_TRUE(clip) << clip.error().message;
  EXPECT_EQ(clip->info.layout, recipe.description.layout);
  ASSERT_EQ(clip->frames.size(), 12U);
  EXPECT_GT(Psnr(clip->frames[7].frame, TestPicture(clip->info.layout, 96, 72, 7)), kLossyPsnr);
}

INSTANTIATE_TEST_SUITE_P(DepthAndSubsampling, VideoWriterLayouts,
                         ::testing::Values(std::tuple(8, 1, 1), std::tuple(8, 1, 0),
                                           std::tuple(8, 0, 0), std::tuple(10, 1, 1),
                                           std::tuple(10, 1, 0), std::tuple(10, 0, 0),
                                           std::tuple(12, 1, 1), std::tuple(16, 0, 0)));

struct CodecCase {
  const char* codec;
  const char* encoder;
  const char* file;
};

class VideoWriterCodecs : public ::testing::TestWithParam<CodecCase> {};

TEST_P(VideoWriterCodecs, KeepsPicturesCountAndVariableTimes) {
  const CodecCase& test = GetParam();
  if (!HasEncoder(test.encoder)) {
    GTEST_SKIP() << "this libavcodec has no " << test.encoder;
  }
  const TemporaryFolder folder;
  ClipRecipe recipe = SmallRecipe();
  recipe.options.codec = test.codec;
  recipe.options.crf = 12;
  recipe.description.time_base = {1, 1000};  // what Matroska can say, too
  recipe.times = {0, 33, 67, 150, 160, 200, 1000, 1033, 1067, 1100, 1134, 1200};
  const Status made = MakeClip(folder / test.file, recipe);
  ASSERT_TRUE(made) << made.error().message;
  const Result<Clip> clip = ReadClip(folder / test.file);
  ASSERT_TRUE(clip) << clip.error().message;
  ASSERT_EQ(clip->frames.size(), recipe.times.size());
  for (std::size_t i = 0; i < clip->frames.size(); ++i) {
    EXPECT_NEAR(clip->frames[i].time_s, static_cast<double>(recipe.times[i]) * 1e-3, 1e-9)
        << "frame " << i;
  }
  EXPECT_TRUE(clip->info.variable_frame_rate);
  EXPECT_FALSE(clip->info.timestamps_repaired);
  Frame expected = TestPicture(recipe.description.layout, 96, 72, 9);
  expected.layout = clip->info.layout;
  if (clip->info.layout.chroma_shift_x == 1 && clip->info.layout.bit_depth == 8 &&
      clip->info.layout.chroma_shift_y == 1 && !clip->info.layout.full_range) {
    EXPECT_GT(Psnr(clip->frames[9].frame, expected), kLossyPsnr);
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, VideoWriterCodecs,
    ::testing::Values(CodecCase{"", "libx264", "a.mp4"}, CodecCase{"h264", "libx264", "a.mkv"},
                      CodecCase{"hevc", "libx265", "a.mp4"}, CodecCase{"hevc", "libx265", "a.mkv"},
                      CodecCase{"vp9", "libvpx-vp9", "a.webm"},
                      CodecCase{"vp9", "libvpx-vp9", "a.mp4"},
                      CodecCase{"av1", "libsvtav1", "a.mp4"},
                      CodecCase{"libaom-av1", "libaom-av1", "a.mkv"},
                      CodecCase{"mpeg4", "mpeg4", "a.mp4"}, CodecCase{"mjpeg", "mjpeg", "a.mov"},
                      CodecCase{"ffv1", "ffv1", "a.mkv"}, CodecCase{"prores", "prores_ks", "a.mov"},
                      CodecCase{"", "libvpx-vp9", "b.webm"}));

TEST(VideoWriter, TimesSurviveBFramesToTheTick) {
  if (!HasEncoder("libx264")) {
    GTEST_SKIP() << "needs libx264";
  }
  const TemporaryFolder folder;
  ClipRecipe recipe = SmallRecipe();
  recipe.frames = 40;
  recipe.options.preset = "medium";
  recipe.options.encoder_options = {{"bf", "3"}, {"b_strategy", "0"}};
  recipe.description.time_base = {1, 90000};
  for (int i = 0; i < recipe.frames; ++i) {
    recipe.times.push_back(4500 + i * 3003 + (i * i * 131) % 700);  // starts late, wavers
  }
  ASSERT_TRUE(MakeClip(folder / "a.mp4", recipe));
  const Result<Clip> clip = ReadClip(folder / "a.mp4");
  ASSERT_TRUE(clip);
  ASSERT_EQ(clip->info.time_base.den % 90000, 0);
  const std::int64_t factor = clip->info.time_base.den / 90000;
  std::vector<std::int64_t> expected = recipe.times;
  for (std::int64_t& time : expected) {
    time *= factor;
  }
  EXPECT_THAT(clip->Times(), ElementsAreArray(expected));
  // And once more through reader and writer.
  WriterOptions options;
  options.encoder_options = recipe.options.encoder_options;
  ASSERT_EQ(CopyClip(folder / "a.mp4", folder / "b.mp4", options), 40);
  const Result<Clip> copy = ReadClip(folder / "b.mp4");
  ASSERT_TRUE(copy);
  EXPECT_EQ(copy->info.time_base, clip->info.time_base);
  EXPECT_THAT(copy->Times(), ElementsAreArray(expected));
}

TEST(VideoWriter, KeepsTagsAspectAndRotation) {
  if (!HasEncoder("libx264")) {
    GTEST_SKIP() << "needs libx264";
  }
  const TemporaryFolder folder;
  ClipRecipe recipe = SmallRecipe();
  recipe.description.sample_aspect_ratio = {4, 3};
  recipe.description.rotation_degrees = 90.0;  // counter-clockwise
  recipe.description.layout.full_range = true;
  recipe.description.layout.chroma_offset_y = 0.0;
  recipe.description.color = {"pc", "bt2020", "arib-std-b67", "bt2020nc", "topleft"};
  recipe.description.metadata = {{"title", "A walk"}};
  for (const char* name : {"a.mp4", "a.mkv"}) {
    ASSERT_TRUE(MakeClip(folder / name, recipe));
    WriterOptions options;
    options.preset = "ultrafast";
    const std::string copy_name = std::string("copy-") + name;
    ASSERT_TRUE(CopyClip(folder / name, folder / copy_name, options));
    for (const std::string& file : {std::string(name), copy_name}) {
      const Result<Clip> clip = ReadClip(folder / file);
      ASSERT_TRUE(clip) << clip.error().message;
      EXPECT_EQ(clip->info.sample_aspect_ratio, (Rational{4, 3})) << file;
      EXPECT_EQ(clip->info.rotation_degrees, file.ends_with("mp4") ? 90.0 : 0.0)
          << file << ": Matroska has no place for a turn";
      EXPECT_EQ(clip->info.color, recipe.description.color) << file;
      EXPECT_EQ(clip->info.layout, recipe.description.layout) << file;
      EXPECT_EQ(testing::Inspect(folder / file).metadata["title"], "A walk") << file;
    }
  }
}

struct HdrCase {
  const char* codec;
  const char* encoder;
  // A bare stream: only what the encoder writes is left. (FFmpeg 5's H.264 decoder does not read
  // this back, so there it says nothing.)
  const char* raw_file;
};

TEST(VideoWriter, KeepsHdrMetadataInContainerAndStream) {
  const TemporaryFolder folder;
  for (const HdrCase& test :
       {HdrCase{"h264", "libx264", "copy.mov"}, HdrCase{"hevc", "libx265", "copy.hevc"},
        HdrCase{"av1", "libsvtav1", "copy.obu"}}) {
    if (!HasEncoder(test.encoder)) {
      continue;
    }
    SCOPED_TRACE(test.codec);
    ClipRecipe recipe = SmallRecipe();
    recipe.options.codec = test.codec;
    recipe.description.layout = Yuv420Layout(10);
    recipe.description.color = {"tv", "bt2020", "smpte2084", "bt2020nc", "left"};
    recipe.options.overwrite = true;
    ASSERT_TRUE(MakeClip(folder / "plain.mp4", recipe));
    EXPECT_FALSE(ReadClip(folder / "plain.mp4")->info.has_hdr_metadata);
    testing::RemuxRecipe hdr;
    hdr.with_hdr = true;
    testing::Remux(folder / "plain.mp4", folder / "hdr.mp4", hdr);
    WriterOptions options;
    options.codec = test.codec;
    options.preset = "ultrafast";
    options.overwrite = true;
    for (const char* name : {"copy.mp4", "copy.mkv", test.raw_file}) {
      ASSERT_EQ(CopyClip(folder / "hdr.mp4", folder / name, options), 12) << name;
      const Result<Clip> copy = ReadClip(folder / name);
      ASSERT_TRUE(copy) << copy.error().message;
      EXPECT_EQ(copy->frames.size(), 12U) << name;
      EXPECT_TRUE(copy->info.has_hdr_metadata) << name;
      EXPECT_EQ(copy->info.color, recipe.description.color) << name;
      EXPECT_EQ(copy->info.layout.bit_depth, 10) << name;
    }
  }
}

TEST(VideoWriter, PackedAndSemiPlanarInputIsConverted) {
  const TemporaryFolder folder;
  ClipRecipe recipe = SmallRecipe();
  recipe.description.layout = RgbaLayout();
  const testing::Warnings warnings = CollectWarnings();
  recipe.options.logger = warnings.logger;
  recipe.options.codec = "mpeg4";
  ASSERT_TRUE(MakeClip(folder / "rgba.mp4", recipe));
  EXPECT_THAT(*warnings.texts, ElementsAre(HasSubstr("does not take the pixel format rgba")));
  const Result<Clip> clip = ReadClip(folder / "rgba.mp4");
  ASSERT_TRUE(clip);
  EXPECT_EQ(clip->info.layout.num_planes, 3);
  EXPECT_FALSE(clip->info.layout.full_range);

  recipe.description.layout = Yuv420Layout();
  recipe.description.layout.num_planes = 2;
  recipe.description.layout.channels = {1, 2, 1, 1};
  recipe.options.codec = "ffv1";
  ASSERT_TRUE(MakeClip(folder / "nv12.mkv", recipe));
  const Result<Clip> nv12 = ReadClip(folder / "nv12.mkv");
  ASSERT_TRUE(nv12);
  const Frame expected = TestPicture(recipe.description.layout, 96, 72, 3);
  const Frame& got = nv12->frames[3].frame;
  for (int x = 0; x < 48; ++x) {
    EXPECT_EQ(got.planes[1].data[x], expected.planes[1].data[2 * x]);
    EXPECT_EQ(got.planes[2].data[x], expected.planes[1].data[2 * x + 1]);
  }
}

TEST(VideoWriter, PixelFormatOptionConverts) {
  const TemporaryFolder folder;
  ClipRecipe recipe = SmallRecipe();
  recipe.options.codec = "ffv1";
  recipe.options.pix_fmt = "yuv444p16le";
  ASSERT_TRUE(MakeClip(folder / "a.mkv", recipe));
  EXPECT_EQ(ReadClip(folder / "a.mkv")->info.pixel_format, "yuv444p16le");
  recipe.options.codec = "mpeg4";
  const Status refused = MakeClip(folder / "b.mkv", recipe);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(refused.error().message, HasSubstr("yuv444p16le"));
  recipe.options.pix_fmt = "yuv9000";
  EXPECT_FALSE(MakeClip(folder / "c.mkv", recipe));
}

TEST(VideoWriter, TinySizes) {
  const TemporaryFolder folder;
  for (const auto& [width, height] :
       {std::pair(1, 1), std::pair(2, 2), std::pair(1, 17), std::pair(17, 13), std::pair(3, 1)}) {
    ClipRecipe recipe = SmallRecipe();
    recipe.description.width = width;
    recipe.description.height = height;
    recipe.frames = 3;
    recipe.options.codec = "ffv1";
    recipe.options.overwrite = true;
    const Status made = MakeClip(folder / "a.mkv", recipe);
    ASSERT_TRUE(made) << width << "x" << height << ": " << made.error().message;
    const Result<Clip> clip = ReadClip(folder / "a.mkv");
    ASSERT_TRUE(clip) << clip.error().message;
    EXPECT_EQ(clip->frames.size(), 3U);
    // H.264 cannot halve an odd size: it gets full chroma.
    recipe.options.codec = "";
    const Status h264 = MakeClip(folder / "a.mp4", recipe);
    ASSERT_TRUE(h264) << width << "x" << height << ": " << h264.error().message;
    const Result<Clip> odd = ReadClip(folder / "a.mp4");
    ASSERT_TRUE(odd) << odd.error().message;
    EXPECT_EQ(odd->frames.size(), 3U);
    EXPECT_EQ(odd->info.width, width);
    EXPECT_EQ(odd->info.height, height);
  }
}

TEST(VideoWriter, OneFrameAndNoFrame) {
  const TemporaryFolder folder;
  ClipRecipe recipe = SmallRecipe();
  recipe.frames = 1;
  ASSERT_TRUE(MakeClip(folder / "one.mp4", recipe));
  EXPECT_EQ(ReadClip(folder / "one.mp4")->frames.size(), 1U);
  recipe.frames = 0;
  ASSERT_TRUE(MakeClip(folder / "none.mp4", recipe));
  EXPECT_FALSE(ReadClip(folder / "none.mp4"));
}

TEST(VideoWriter, FallsBackToMpeg4InAviAndSaysWhatItDoes) {
  const TemporaryFolder folder;
  ClipRecipe recipe = SmallRecipe();
  recipe.options.codec = "mpeg4";
  ASSERT_TRUE(MakeClip(folder / "a.avi", recipe));
  EXPECT_EQ(ReadClip(folder / "a.avi")->frames.size(), 12U);
}

// Through a pipe: written in a streamable form, read without a second look.
TEST(VideoWriter, PipesWorkBothWays) {
  const TemporaryFolder folder;
  const std::string fifo = (folder / "pipe").string();
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  for (const char* format : {"matroska", "mp4", "nut"}) {
    ClipRecipe recipe = SmallRecipe();
    recipe.options.format = format;
    Status made;
    std::thread writer([&] { made = MakeClip(fifo, recipe); });
    const Result<Clip> clip = ReadClip(fifo);
    writer.join();
    ASSERT_TRUE(made) << format << ": " << made.error().message;
    ASSERT_TRUE(clip) << format << ": " << clip.error().message;
    ASSERT_EQ(clip->frames.size(), 12U) << format;
    for (std::size_t i = 0; i < clip->frames.size(); ++i) {
      EXPECT_NEAR(clip->frames[i].time_s, static_cast<double>(i) / 30.0, 6e-4) << format;
    }
  }
}

}  // namespace
}  // namespace rsstab::media
