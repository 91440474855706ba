// SPDX-License-Identifier: Apache-2.0
// Pass 1 and pass 2 together, on pictures made in memory.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "igf/base/homography.h"
#include "stabilizer/analysis_file.h"
#include "stabilizer/normalized_coordinates.h"
#include "stabilizer/pipeline/analyzer.h"
#include "stabilizer/pipeline/renderer.h"
#include "tests/support/random_scene.h"
#include "tests/support/test_paths.h"

namespace rsstab::pipeline {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 180;
constexpr int kFrames = 75;
constexpr std::int64_t kTicks = 40;

// Content position in frame t: shake of some 4 px on a slow drift.
Eigen::Vector2d Shift(int t) {
  return {4.0 * std::sin(1.9 * t) + 0.2 * t, 3.0 * std::sin(2.3 * t + 1.0)};
}

Frame Picture(const testing::WaveScene& scene, const Eigen::Vector2d& shift) {
  Frame frame = *AllocateFrame(Yuv420Layout(), kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    std::uint8_t* row = frame.planes[0].data + y * frame.planes[0].stride;
    for (int x = 0; x < kWidth; ++x) {
      row[x] = static_cast<std::uint8_t>(
          std::clamp(scene.At(Eigen::Vector2d(x, y) - shift), 40.0, 250.0));
    }
  }
  for (const std::size_t p : {1U, 2U}) {
    for (int y = 0; y < frame.planes[p].height; ++y) {
      std::memset(frame.planes[p].data + y * frame.planes[p].stride, 90,
                  static_cast<std::size_t>(frame.planes[p].width));
    }
  }
  return frame;
}

std::vector<Frame> ShakyClip() {
  const testing::WaveScene scene(11);
  std::vector<Frame> clip;
  for (int t = 0; t < kFrames; ++t) {
    clip.push_back(Picture(scene, Shift(t)));
  }
  return clip;
}

StabilizeOptions Options() {
  StabilizeOptions options;
  options.rs = RsChoice::kOff;
  options.num_threads = 2;
  return options;
}

Result<stabilizer::ClipAnalysis> Analyze(const std::vector<Frame>& clip,
                                         const StabilizeOptions& options, const std::string& path) {
  auto analyzer =
      Analyzer::Create(options, {kWidth, kHeight, 25.0}, RsInputs{}, path, SilentLogger());
  if (!analyzer) {
    return Propagate(analyzer.error());
  }
  for (std::size_t t = 0; t < clip.size(); ++t) {
    const Status ok = (*analyzer)->PushFrame(clip[t].View(), kTicks * static_cast<std::int64_t>(t),
                                             0.04 * static_cast<double>(t));
    if (!ok) {
      return Propagate(ok.error());
    }
  }
  return (*analyzer)->Finish();
}

Result<std::vector<Frame>> RenderAll(const std::vector<Frame>& clip,
                                     const StabilizeOptions& options, const std::string& path) {
  auto renderer = Renderer::Create(options, path, kWidth, kHeight, SilentLogger());
  if (!renderer) {
    return Propagate(renderer.error());
  }
  std::vector<Frame> output;
  for (std::size_t t = 0; t < clip.size(); ++t) {
    auto frame = (*renderer)->Render(clip[t], kTicks * static_cast<std::int64_t>(t));
    if (!frame) {
      return Propagate(frame.error());
    }
    output.push_back(std::move(*frame));
  }
  if (Status ok = (*renderer)->Finish(); !ok) {
    return Propagate(ok.error());
  }
  return output;
}

std::string LumaBytes(const Frame& frame) {
  std::string bytes;
  for (int y = 0; y < frame.height; ++y) {
    bytes.append(reinterpret_cast<const char*>(frame.planes[0].data + y * frame.planes[0].stride),
                 static_cast<std::size_t>(frame.width));
  }
  return bytes;
}

TEST(TwoPass, TheOutputNoLongerShakes) {
  const testing::TemporaryFolder folder;
  const std::string path = (folder / "a.rsstab").string();
  ASSERT_TRUE(Analyze(ShakyClip(), Options(), path));
  auto reader = stabilizer::AnalysisReader::Open(path);
  ASSERT_TRUE(reader);
  std::vector<Eigen::Vector2d> shown;  // where the output shows the scene's origin, px
  for (int t = 0; t < kFrames; ++t) {
    const auto frame = (*reader)->Next();
    ASSERT_TRUE(frame && *frame);
    const Eigen::Vector2d recorded =
        stabilizer::ToNormalized(Shift(t) + Eigen::Vector2d(160.0, 90.0), kWidth, kHeight);
    shown.push_back(Project((*frame)->rectified_from_output.inverse(), recorded) * kWidth);
  }
  double input = 0.0;
  double output = 0.0;
  for (int t = 2; t < kFrames; ++t) {
    const auto i = static_cast<std::size_t>(t);
    input += (Shift(t) - 2.0 * Shift(t - 1) + Shift(t - 2)).squaredNorm();
    output += (shown[i] - 2.0 * shown[i - 1] + shown[i - 2]).squaredNorm();
  }
  // Input 11 px RMS; what is left is the tracker's noise, 0.05 px a frame.
  EXPECT_GT(std::sqrt(input / (kFrames - 2)), 8.0);
  EXPECT_LT(std::sqrt(output / (kFrames - 2)), 0.25);
}

TEST(TwoPass, NoOutputPixelIsEmpty) {
  const testing::TemporaryFolder folder;
  const std::string path = (folder / "a.rsstab").string();
  const auto clip = ShakyClip();
  for (const char* zoom : {"adaptive", "fixed", "1.02"}) {
    StabilizeOptions options = Options();
    for (const auto& option : StabilizeOptionTable()) {
      if (option.name == "zoom") {
        ASSERT_TRUE(option.set(options, zoom));
      }
    }
    const auto analysis = Analyze(clip, options, path);
    ASSERT_TRUE(analysis) << analysis.error().message;
    const auto output = RenderAll(clip, options, path);
    ASSERT_TRUE(output) << output.error().message;
    for (const Frame& frame : *output) {
      // The scene is never darker than 40; black is 16. Bicubic may undershoot a little.
      for (const char c : LumaBytes(frame)) {
        ASSERT_GT(static_cast<int>(static_cast<unsigned char>(c)), 25) << zoom;
      }
    }
  }
}

TEST(TwoPass, FixedZoomIsTheSameInEveryFrame) {
  const testing::TemporaryFolder folder;
  const std::string path = (folder / "a.rsstab").string();
  StabilizeOptions options = Options();
  options.zoom = ZoomMode::kFixed;
  const auto analysis = Analyze(ShakyClip(), options, path);
  ASSERT_TRUE(analysis);
  EXPECT_TRUE(analysis->fixed_zoom);
  auto reader = stabilizer::AnalysisReader::Open(path);
  for (int t = 0; t < kFrames; ++t) {
    const auto frame = (*reader)->Next();
    ASSERT_TRUE(frame && *frame);
    const double area = (*frame)->rectified_from_output.topLeftCorner<2, 2>().determinant() /
                        std::pow((*frame)->rectified_from_output(2, 2), 2.0);
    EXPECT_NEAR(std::sqrt(area), 1.0, 0.01);  // crop alone zooms, and it is one for the clip
  }
}

TEST(TwoPass, SameBytesForAnyNumberOfThreads) {
  const testing::TemporaryFolder folder;
  const auto clip = ShakyClip();
  std::vector<std::string> results;
  for (const int threads : {1, 3}) {
    StabilizeOptions options = Options();
    options.num_threads = threads;
    const std::string path = (folder / "a.rsstab").string();
    ASSERT_TRUE(Analyze(clip, options, path));
    const auto output = RenderAll(clip, options, path);
    ASSERT_TRUE(output);
    std::string bytes;
    for (const Frame& frame : *output) {
      bytes += LumaBytes(frame);
    }
    results.push_back(std::move(bytes));
  }
  EXPECT_TRUE(results[0] == results[1]);
}

TEST(TwoPass, AnotherClipIsRefused) {
  const testing::TemporaryFolder folder;
  const std::string path = (folder / "a.rsstab").string();
  auto clip = ShakyClip();
  ASSERT_TRUE(Analyze(clip, Options(), path));

  EXPECT_THAT(Renderer::Create(Options(), path, 640, 360, SilentLogger()).error().message,
              ::testing::HasSubstr("320x180"));

  auto renderer = Renderer::Create(Options(), path, kWidth, kHeight, SilentLogger());
  ASSERT_TRUE(renderer);
  EXPECT_THAT((*renderer)->Render(clip[0], 7).error().message, ::testing::HasSubstr("re-timed"));

  renderer = Renderer::Create(Options(), path, kWidth, kHeight, SilentLogger());
  const Frame other = Picture(testing::WaveScene(99), {0.0, 0.0});
  EXPECT_THAT((*renderer)->Render(other, 0).error().message,
              ::testing::HasSubstr("does not look like"));

  auto shorter = clip;
  shorter.pop_back();
  EXPECT_THAT(RenderAll(shorter, Options(), path).error().message,
              ::testing::HasSubstr("ends after"));
  auto longer = clip;
  longer.push_back(clip.back());
  EXPECT_THAT(RenderAll(longer, Options(), path).error().message, ::testing::HasSubstr("goes on"));
}

TEST(TwoPass, BlackAndFrozenClipsHoldStill) {
  const testing::TemporaryFolder folder;
  const std::string path = (folder / "a.rsstab").string();
  Frame black = Picture(testing::WaveScene(1), {0.0, 0.0});
  for (int y = 0; y < kHeight; ++y) {
    std::memset(black.planes[0].data + y * black.planes[0].stride, 16, kWidth);
  }
  const Frame picture = Picture(testing::WaveScene(2), {0.0, 0.0});
  for (const Frame& still : {black, picture}) {
    const std::vector<Frame> clip(20, still);
    ASSERT_TRUE(Analyze(clip, Options(), path));
    const auto output = RenderAll(clip, Options(), path);
    ASSERT_TRUE(output);
    for (const Frame& frame : *output) {
      EXPECT_TRUE(LumaBytes(frame) == LumaBytes(still));
    }
  }
}

TEST(TwoPass, OneFrameIsEnoughAndNoneIsAnError) {
  const testing::TemporaryFolder folder;
  const std::string path = (folder / "a.rsstab").string();
  const std::vector<Frame> one(1, Picture(testing::WaveScene(1), {0.0, 0.0}));
  EXPECT_TRUE(Analyze(one, Options(), path));
  EXPECT_TRUE(RenderAll(one, Options(), path));
  EXPECT_EQ(Analyze({}, Options(), path).error().code, ErrorCode::kCorruptData);
}

}  // namespace
}  // namespace rsstab::pipeline
