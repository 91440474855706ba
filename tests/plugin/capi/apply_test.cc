// SPDX-License-Identifier: Apache-2.0
// Frames by an analysis file: found by time and picture, in any order, in any format.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/plugin/capi/capi_test_support.h"
#include "tests/support/test_paths.h"

namespace rsstab::testing {
namespace {

using ::testing::HasSubstr;

constexpr int kWidth = 160;
constexpr int kHeight = 96;
constexpr int kFrames = 24;

class CapiApply : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    path_ = (*folder_ / "clip.rsstab").string();
    Analyze(MakeVideo(kWidth, kHeight, RSSTAB_PIXEL_YUV420P), Yuv420Layout(), kFrames, path_);
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static InstanceHandle Open(const rsstab_video& video) {
    const OptionsHandle options = MakeOptions({{"threads", "1"}});
    rsstab_instance* made = nullptr;
    EXPECT_EQ(rsstab_create_apply(options.get(), &video, path_.c_str(), &made), RSSTAB_OK)
        << rsstab_options_error(options.get());
    return InstanceHandle(made);
  }

  // The steady frame of picture `t` shown at `pts`; empty unless `expected`.
  static std::string Render(rsstab_instance* instance, const PixelLayout& layout, int t,
                            std::int64_t pts, rsstab_status expected = RSSTAB_OK,
                            int width = kWidth, int height = kHeight) {
    const Frame input = PaintShaky(layout, width, height, t);
    const Frame output = *AllocateFrame(layout, width, height);
    const rsstab_picture picture = ToPicture(input);
    const rsstab_buffer buffer = ToBuffer(output);
    const rsstab_status status = rsstab_render(instance, &picture, pts, &buffer);
    EXPECT_EQ(status, expected) << rsstab_error(instance);
    if (status == RSSTAB_UNCHANGED) {
      EXPECT_EQ(Bytes(output), Bytes(input));
    }
    return status == expected ? Bytes(output) : std::string();
  }

  static std::vector<std::string> RenderInOrder() {
    const InstanceHandle instance = Open(MakeVideo(kWidth, kHeight, RSSTAB_PIXEL_YUV420P));
    std::vector<std::string> frames;
    for (int t = 0; t < kFrames; ++t) {
      frames.push_back(Render(instance.get(), Yuv420Layout(), t, t));
    }
    return frames;
  }

  static std::unique_ptr<TemporaryFolder> folder_;
  static std::string path_;
};

std::unique_ptr<TemporaryFolder> CapiApply::folder_;
std::string CapiApply::path_;

TEST_F(CapiApply, AnyOrderGivesTheSameFrames) {
  const auto in_order = RenderInOrder();
  EXPECT_NE(in_order[5], Bytes(PaintShaky(Yuv420Layout(), kWidth, kHeight, 5)));
  const InstanceHandle instance = Open(MakeVideo(kWidth, kHeight, RSSTAB_PIXEL_YUV420P));
  for (const int t : {23, 3, 3, 17, 0, 1, 22, 2}) {
    EXPECT_EQ(Render(instance.get(), Yuv420Layout(), t, t), in_order[static_cast<std::size_t>(t)]);
  }
}

TEST_F(CapiApply, PushAndPullGiveWhatRenderGives) {
  const auto in_order = RenderInOrder();
  const InstanceHandle instance = Open(MakeVideo(kWidth, kHeight, RSSTAB_PIXEL_YUV420P));
  const Frame output = *AllocateFrame(Yuv420Layout(), kWidth, kHeight);
  const rsstab_buffer buffer = ToBuffer(output);
  int released = 0;
  for (int t = 0; t < 4; ++t) {
    EXPECT_EQ(rsstab_peek(instance.get(), nullptr, nullptr), RSSTAB_AGAIN);
    const Frame input = PaintShaky(Yuv420Layout(), kWidth, kHeight, t);
    const rsstab_picture picture = ToPicture(input);
    ASSERT_EQ(rsstab_push(instance.get(), &picture, t, &released,
                          [](void* data) { ++*static_cast<int*>(data); }),
              RSSTAB_OK);
    std::int64_t pts = -1;
    void* data = nullptr;
    EXPECT_EQ(rsstab_peek(instance.get(), &pts, &data), RSSTAB_OK);
    EXPECT_EQ(pts, t);
    EXPECT_EQ(data, &released);
    EXPECT_EQ(released, t);
    ASSERT_EQ(rsstab_pull(instance.get(), &buffer, &pts, nullptr), RSSTAB_OK);
    EXPECT_EQ(released, t + 1);
    EXPECT_EQ(Bytes(output), in_order[static_cast<std::size_t>(t)]);
  }
  ASSERT_EQ(rsstab_flush(instance.get()), RSSTAB_OK);
  EXPECT_EQ(rsstab_pull(instance.get(), &buffer, nullptr, nullptr), RSSTAB_END);
}

TEST_F(CapiApply, FindsFramesInAnotherTimeBase) {
  const auto in_order = RenderInOrder();
  rsstab_video video = MakeVideo(kWidth, kHeight, RSSTAB_PIXEL_YUV420P);
  video.time_base_den = 1000;  // Matroska's milliseconds
  const InstanceHandle instance = Open(video);
  for (int t = 0; t < kFrames; ++t) {
    EXPECT_EQ(Render(instance.get(), Yuv420Layout(), t, 40 * t + (t % 3 - 1)),
              in_order[static_cast<std::size_t>(t)]);
  }
  // Frames doubled in between show the earlier picture again.
  EXPECT_EQ(Render(instance.get(), Yuv420Layout(), 7, 40 * 7 + 20), in_order[7]);
}

TEST_F(CapiApply, FindsFramesOfAClipThatWasCutAtItsStart) {
  const auto in_order = RenderInOrder();
  const InstanceHandle instance = Open(MakeVideo(kWidth, kHeight, RSSTAB_PIXEL_YUV420P));
  for (int t = 0; t < 8; ++t) {
    EXPECT_EQ(Render(instance.get(), Yuv420Layout(), t + 10, t),
              in_order[static_cast<std::size_t>(t + 10)]);
  }
}

TEST_F(CapiApply, LeavesUnknownFramesAlone) {
  const InstanceHandle instance = Open(MakeVideo(kWidth, kHeight, RSSTAB_PIXEL_GRAY8));
  const Frame white = *AllocateFrame(GrayLayout(), kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      white.planes[0].data[y * white.planes[0].stride + x] = static_cast<std::uint8_t>(2 * y);
    }
  }
  const Frame output = *AllocateFrame(GrayLayout(), kWidth, kHeight);
  const rsstab_picture picture = ToPicture(white);
  const rsstab_buffer buffer = ToBuffer(output);
  EXPECT_EQ(rsstab_render(instance.get(), &picture, 3, &buffer), RSSTAB_UNCHANGED);
  EXPECT_THAT(rsstab_error(instance.get()), HasSubstr("does not look like"));
  EXPECT_EQ(Bytes(output), Bytes(white));
  EXPECT_EQ(rsstab_render(instance.get(), &picture, 3000, &buffer), RSSTAB_UNCHANGED);
  EXPECT_THAT(rsstab_error(instance.get()), HasSubstr("knows no frame"));
}

TEST_F(CapiApply, TellsTheTimesOfTheFile) {
  rsstab_video video = MakeVideo(kWidth, kHeight, RSSTAB_PIXEL_YUV420P);
  video.time_base_den = 1000;
  const InstanceHandle instance = Open(video);
  std::int64_t pts = 0;
  ASSERT_EQ(rsstab_frame_time(instance.get(), 7, &pts), RSSTAB_OK);
  EXPECT_EQ(pts, 280);
  EXPECT_EQ(rsstab_frame_time(instance.get(), kFrames, &pts), RSSTAB_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(rsstab_frame_time(instance.get(), -1, &pts), RSSTAB_ERROR_INVALID_ARGUMENT);
}

struct FormatCase {
  rsstab_pixel_format format;
  PixelLayout layout;
};

std::vector<FormatCase> Formats() {
  PixelLayout yuv422 = Yuv420Layout();
  yuv422.chroma_shift_y = 0;
  yuv422.chroma_offset_y = 0.0;
  PixelLayout nv12 = Yuv420Layout();
  nv12.num_planes = 2;
  nv12.channels[1] = 2;
  PixelLayout rgb = RgbaLayout();
  rgb.channels[0] = 3;
  return {{RSSTAB_PIXEL_YUV420P10, Yuv420Layout(10)},
          {RSSTAB_PIXEL_YUV422P, yuv422},
          {RSSTAB_PIXEL_NV12, nv12},
          {RSSTAB_PIXEL_GRAY8, GrayLayout()},
          {RSSTAB_PIXEL_GRAY10, GrayLayout(10)},
          {RSSTAB_PIXEL_RGBA, RgbaLayout()},
          {RSSTAB_PIXEL_BGRA, RgbaLayout()},
          {RSSTAB_PIXEL_RGB24, rgb}};
}

TEST_F(CapiApply, MovesEveryFormatAlike) {
  // The luma (first) plane of 8-bit formats is the same picture, whatever follows.
  const InstanceHandle gray = Open(MakeVideo(kWidth, kHeight, RSSTAB_PIXEL_GRAY8));
  const std::string expected = Render(gray.get(), GrayLayout(), 6, 6);
  for (const auto& [format, layout] : Formats()) {
    const InstanceHandle instance = Open(MakeVideo(kWidth, kHeight, format));
    const std::string bytes = Render(instance.get(), layout, 6, 6);
    if (layout.bit_depth == 8 && layout.channels[0] == 1) {
      EXPECT_EQ(bytes.substr(0, expected.size()), expected) << format;
    }
    EXPECT_NE(bytes, Bytes(PaintShaky(layout, kWidth, kHeight, 6))) << format;
  }
}

TEST_F(CapiApply, WorksBottomUp) {
  const InstanceHandle instance = Open(MakeVideo(kWidth, kHeight, RSSTAB_PIXEL_GRAY8));
  const std::string expected = Render(instance.get(), GrayLayout(), 4, 4);
  const Frame input = PaintShaky(GrayLayout(), kWidth, kHeight, 4);
  std::vector<std::uint8_t> flipped(kWidth * kHeight);
  for (int y = 0; y < kHeight; ++y) {
    std::copy_n(input.planes[0].data + y * input.planes[0].stride, kWidth,
                flipped.begin() + (kHeight - 1 - y) * kWidth);
  }
  const Frame output = *AllocateFrame(GrayLayout(), kWidth, kHeight);
  const rsstab_picture picture = {
      {flipped.data() + (kHeight - 1) * kWidth, nullptr, nullptr, nullptr}, {-kWidth, 0, 0, 0}};
  const rsstab_buffer buffer = ToBuffer(output);
  ASSERT_EQ(rsstab_render(instance.get(), &picture, 4, &buffer), RSSTAB_OK);
  EXPECT_EQ(Bytes(output), expected);
}

TEST_F(CapiApply, TakesAPreviewSize) {
  // The same motion at half the size: the renderer's identity frames stay, others move by half.
  const InstanceHandle instance = Open(MakeVideo(kWidth / 2, kHeight / 2, RSSTAB_PIXEL_GRAY8));
  const Frame full = PaintShaky(GrayLayout(), kWidth, kHeight, 9);
  const Frame half = *AllocateFrame(GrayLayout(), kWidth / 2, kHeight / 2);
  for (int y = 0; y < half.height; ++y) {
    for (int x = 0; x < half.width; ++x) {
      int sum = 2;
      for (const int i : {0, 1}) {
        for (const int j : {0, 1}) {
          sum += full.planes[0].data[(2 * y + i) * full.planes[0].stride + 2 * x + j];
        }
      }
      half.planes[0].data[y * half.planes[0].stride + x] = static_cast<std::uint8_t>(sum / 4);
    }
  }
  const Frame output = *AllocateFrame(GrayLayout(), kWidth / 2, kHeight / 2);
  const rsstab_picture picture = ToPicture(half);
  const rsstab_buffer buffer = ToBuffer(output);
  ASSERT_EQ(rsstab_render(instance.get(), &picture, 9, &buffer), RSSTAB_OK)
      << rsstab_error(instance.get());
  const InstanceHandle large = Open(MakeVideo(kWidth, kHeight, RSSTAB_PIXEL_GRAY8));
  const std::string expected = Render(large.get(), GrayLayout(), 9, 9);
  double difference = 0.0;
  for (int y = 0; y < half.height; ++y) {
    for (int x = 0; x < half.width; ++x) {
      double mean = 0.0;
      for (const int i : {0, 1}) {
        for (const int j : {0, 1}) {
          mean += 0.25 * static_cast<std::uint8_t>(
                             expected[static_cast<std::size_t>((2 * y + i) * kWidth + 2 * x + j)]);
        }
      }
      difference += std::abs(mean - output.planes[0].data[y * output.planes[0].stride + x]);
    }
  }
  // Two resamplings of a picture whose finest waves are 9 px long differ by a level or two; a shift
  // by a pixel makes ten.
  EXPECT_LT(difference / (half.width * half.height), 3.0);
}

TEST_F(CapiApply, RefusesWrongAndMissingFiles) {
  const OptionsHandle options = MakeOptions({});
  rsstab_video video = MakeVideo(kWidth, kHeight, RSSTAB_PIXEL_GRAY8);
  rsstab_instance* made = nullptr;
  EXPECT_EQ(rsstab_create_apply(options.get(), &video, "/no/such/file", &made),
            RSSTAB_ERROR_NOT_FOUND);
  EXPECT_EQ(made, nullptr);
  const std::string text = (*folder_ / "text").string();
  std::ofstream(text) << "not an analysis";
  EXPECT_EQ(rsstab_create_apply(options.get(), &video, text.c_str(), &made),
            RSSTAB_ERROR_CORRUPT_DATA);
  const std::string cut = (*folder_ / "cut").string();
  std::filesystem::copy_file(path_, cut, std::filesystem::copy_options::overwrite_existing);
  std::filesystem::resize_file(cut, std::filesystem::file_size(cut) - 100);
  EXPECT_EQ(rsstab_create_apply(options.get(), &video, cut.c_str(), &made),
            RSSTAB_ERROR_CORRUPT_DATA);
  EXPECT_THAT(rsstab_options_error(options.get()), HasSubstr("analyze"));
  video = MakeVideo(kWidth, kWidth, RSSTAB_PIXEL_GRAY8);  // another shape
  EXPECT_EQ(rsstab_create_apply(options.get(), &video, path_.c_str(), &made),
            RSSTAB_ERROR_INVALID_ARGUMENT);
}

}  // namespace
}  // namespace rsstab::testing
