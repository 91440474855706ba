// SPDX-License-Identifier: Apache-2.0
// Frames in, steady frames out, some frames later.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/plugin/capi/capi_test_support.h"

namespace rsstab::testing {
namespace {

constexpr int kWidth = 161;  // odd on purpose
constexpr int kHeight = 97;

struct LiveRun {
  std::vector<std::int64_t> times;
  std::vector<std::size_t> inside;  // frames inside when each came out
  std::vector<std::string> frames;
  int released = 0;
};

// Every frame is handed over, and released by the run's end.
LiveRun RunLive(int lookahead, int frames, int width = kWidth, int height = kHeight,
                rsstab_pixel_format format = RSSTAB_PIXEL_YUV420P,
                const PixelLayout& layout = Yuv420Layout(),
                const OptionList& rolling_shutter = {{"rs", "off"}}) {
  LiveRun run;
  OptionList values = rolling_shutter;
  values.emplace_back("threads", "1");
  values.emplace_back("lookahead", std::to_string(lookahead));
  const OptionsHandle options = MakeOptions(values);
  const rsstab_video video = MakeVideo(width, height, format);
  rsstab_instance* made = nullptr;
  EXPECT_EQ(rsstab_create_live(options.get(), &video, &made), RSSTAB_OK)
      << rsstab_options_error(options.get());
  const InstanceHandle instance(made);
  EXPECT_EQ(rsstab_delay(made), lookahead);
  const Frame output = *AllocateFrame(layout, width, height);
  const rsstab_buffer buffer = ToBuffer(output);
  std::vector<Frame> alive;
  std::size_t pushed = 0;
  const auto pull = [&](rsstab_status end) {
    std::int64_t pts = 0;
    rsstab_status status = RSSTAB_OK;
    while ((status = rsstab_pull(made, &buffer, &pts, nullptr)) == RSSTAB_OK) {
      run.times.push_back(pts);
      run.inside.push_back(pushed - run.times.size());
      run.frames.push_back(Bytes(output));
    }
    EXPECT_EQ(status, end) << rsstab_error(made);
  };
  for (int t = 0; t < frames; ++t) {
    alive.push_back(PaintShaky(layout, width, height, t));
    const rsstab_picture picture = ToPicture(alive.back());
    EXPECT_EQ(rsstab_push(made, &picture, 100 + 3 * t, &run.released,
                          [](void* data) { ++*static_cast<int*>(data); }),
              RSSTAB_OK)
        << rsstab_error(made);
    ++pushed;
    pull(RSSTAB_AGAIN);
  }
  EXPECT_EQ(rsstab_flush(made), RSSTAB_OK);
  EXPECT_EQ(rsstab_flush(made), RSSTAB_ERROR_BAD_STATE);
  pull(RSSTAB_END);
  return run;
}

TEST(CapiLive, EveryFrameComesOutInOrderAfterTheLookahead) {
  constexpr int kFrames = 40;
  for (const int lookahead : {0, 1, 5, 12, 60}) {
    const LiveRun run = RunLive(lookahead, kFrames);
    ASSERT_EQ(run.times.size(), static_cast<std::size_t>(kFrames)) << lookahead;
    EXPECT_EQ(run.released, kFrames);
    for (int t = 0; t < kFrames; ++t) {
      const auto i = static_cast<std::size_t>(t);
      EXPECT_EQ(run.times[i], 100 + 3 * t);
      const int expected = std::min(lookahead, kFrames - 1 - t);
      EXPECT_EQ(run.inside[i], static_cast<std::size_t>(expected)) << lookahead << " " << t;
    }
  }
}

TEST(CapiLive, ReadoutMotionFromTracksKeepsTheDelay) {
  constexpr int kFrames = 70;
  const LiveRun run = RunLive(60, kFrames, kWidth, kHeight, RSSTAB_PIXEL_GRAY8, GrayLayout(),
                              {{"rs", "tracks"}, {"readout", "15"}});
  ASSERT_EQ(run.times.size(), static_cast<std::size_t>(kFrames));
  for (int t = 0; t < kFrames; ++t) {
    const auto i = static_cast<std::size_t>(t);
    EXPECT_EQ(run.times[i], 100 + 3 * t);
    EXPECT_EQ(run.inside[i], static_cast<std::size_t>(std::min(60, kFrames - 1 - t)));
  }
}

TEST(CapiLive, SaysWhatReadoutMotionFromTracksNeeds) {
  const rsstab_video video = MakeVideo(kWidth, kHeight, RSSTAB_PIXEL_GRAY8);
  for (const OptionList& values :
       {OptionList{{"rs", "tracks"}, {"lookahead", "60"}},
        OptionList{{"rs", "fused"}, {"readout", "15"}, {"lookahead", "20"}}}) {
    const OptionsHandle options = MakeOptions(values);
    rsstab_instance* made = nullptr;
    EXPECT_EQ(rsstab_create_live(options.get(), &video, &made), RSSTAB_ERROR_UNSUPPORTED);
    EXPECT_THAT(rsstab_options_error(options.get()), ::testing::HasSubstr("--lookahead"));
  }
}

TEST(CapiLive, TheSameFramesGiveTheSameBytes) {
  EXPECT_EQ(RunLive(6, 20).frames, RunLive(6, 20).frames);
}

TEST(CapiLive, TakesSmallAndOddSizes) {
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 3}, {17, 33}, {64, 5}}) {
    EXPECT_EQ(RunLive(3, 8, width, height).frames.size(), 8U) << width << "x" << height;
    EXPECT_EQ(RunLive(0, 3, width, height, RSSTAB_PIXEL_RGBA, RgbaLayout()).frames.size(), 3U);
  }
}

TEST(CapiLive, TakesClipsShorterThanTheLookahead) {
  EXPECT_EQ(RunLive(30, 1).frames.size(), 1U);
  EXPECT_EQ(RunLive(30, 0).frames.size(), 0U);
}

// A picture's place against another one, by which of all shifts fits best, px.
double MeanStep(const std::vector<std::string>& frames) {
  constexpr int kReach = 9;
  double sum = 0.0;
  for (std::size_t t = 1; t < frames.size(); ++t) {
    double best = 1e300;
    double step = 0.0;
    for (int dy = -kReach; dy <= kReach; ++dy) {
      for (int dx = -kReach; dx <= kReach; ++dx) {
        double error = 0.0;
        for (int y = 30; y < kHeight - 30; y += 3) {
          for (int x = 30; x < kWidth - 30; x += 3) {
            const auto a =
                static_cast<std::uint8_t>(frames[t - 1][static_cast<std::size_t>(y * kWidth + x)]);
            const auto b = static_cast<std::uint8_t>(
                frames[t][static_cast<std::size_t>((y + dy) * kWidth + x + dx)]);
            error += (a - b) * (a - b);
          }
        }
        if (error < best) {
          best = error;
          step = std::hypot(dx, dy);
        }
      }
    }
    sum += step;
  }
  return sum / static_cast<double>(frames.size() - 1);
}

TEST(CapiLive, TheOutputNoLongerShakesWhateverTheLookahead) {
  constexpr int kFrames = 40;
  std::vector<std::string> input;
  for (int t = 0; t < kFrames; ++t) {
    input.push_back(Bytes(PaintShaky(GrayLayout(), kWidth, kHeight, t)));
  }
  const double before = MeanStep(input);
  ASSERT_GT(before, 4.0);
  for (const int lookahead : {0, 8, 25}) {
    const LiveRun run =
        RunLive(lookahead, kFrames, kWidth, kHeight, RSSTAB_PIXEL_GRAY8, GrayLayout());
    // Causal smoothing leaves more than looking ahead does; whole-pixel steps read 0 or 1.
    EXPECT_LT(MeanStep(run.frames), lookahead == 0 ? 0.5 * before : 0.3 * before) << lookahead;
  }
}

TEST(CapiLive, WantsToBePulledAndBeginsAnewAfterAReset) {
  const OptionsHandle options = MakeOptions({{"rs", "off"}, {"threads", "1"}, {"lookahead", "2"}});
  const rsstab_video video = MakeVideo(kWidth, kHeight, RSSTAB_PIXEL_GRAY8);
  rsstab_instance* made = nullptr;
  ASSERT_EQ(rsstab_create_live(options.get(), &video, &made), RSSTAB_OK);
  const InstanceHandle instance(made);
  const Frame frame = PaintShaky(GrayLayout(), kWidth, kHeight, 0);
  const rsstab_picture picture = ToPicture(frame);
  int released = 0;
  const auto push = [&] {
    return rsstab_push(made, &picture, 0, &released,
                       [](void* data) { ++*static_cast<int*>(data); });
  };
  int accepted = 0;
  rsstab_status status = RSSTAB_OK;
  while ((status = push()) == RSSTAB_OK) {
    ASSERT_LT(++accepted, 20);
  }
  EXPECT_EQ(status, RSSTAB_AGAIN);
  EXPECT_EQ(released, 0);
  ASSERT_EQ(rsstab_reset(made), RSSTAB_OK);
  EXPECT_EQ(released, accepted);
  EXPECT_EQ(rsstab_peek(made, nullptr, nullptr), RSSTAB_AGAIN);
  EXPECT_EQ(push(), RSSTAB_OK);
  ASSERT_EQ(rsstab_flush(made), RSSTAB_OK);
  EXPECT_EQ(push(), RSSTAB_ERROR_BAD_STATE);
  EXPECT_EQ(rsstab_render(made, &picture, 0, nullptr), RSSTAB_ERROR_INVALID_ARGUMENT);
}

TEST(CapiLive, ChangesWhatCanBeChangedOnTheWay) {
  const OptionsHandle options = MakeOptions({{"rs", "off"}, {"threads", "1"}, {"lookahead", "0"}});
  const rsstab_video video = MakeVideo(kWidth, kHeight, RSSTAB_PIXEL_GRAY8);
  rsstab_instance* made = nullptr;
  ASSERT_EQ(rsstab_create_live(options.get(), &video, &made), RSSTAB_OK);
  const InstanceHandle instance(made);
  EXPECT_EQ(rsstab_set(made, "smoothness", "0"), RSSTAB_OK) << rsstab_error(made);
  EXPECT_EQ(rsstab_set(made, "smoothness", "-1"), RSSTAB_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(rsstab_set(made, "lookahead", "3"), RSSTAB_ERROR_UNSUPPORTED);
  EXPECT_EQ(rsstab_set(made, "nonsense", "3"), RSSTAB_ERROR_UNSUPPORTED);
  // Without smoothing and rolling shutter the picture stays what it is.
  const Frame output = *AllocateFrame(GrayLayout(), kWidth, kHeight);
  const rsstab_buffer buffer = ToBuffer(output);
  for (int t = 0; t < 4; ++t) {
    const Frame frame = PaintShaky(GrayLayout(), kWidth, kHeight, t);
    const rsstab_picture picture = ToPicture(frame);
    ASSERT_EQ(rsstab_push(made, &picture, t, nullptr, nullptr), RSSTAB_OK);
    ASSERT_EQ(rsstab_pull(made, &buffer, nullptr, nullptr), RSSTAB_OK);
    EXPECT_EQ(Bytes(output), Bytes(frame)) << t;
  }
}

}  // namespace
}  // namespace rsstab::testing
