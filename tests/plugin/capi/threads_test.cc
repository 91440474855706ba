// SPDX-License-Identifier: Apache-2.0
// Many instances: side by side, and one after the other.
#include <gtest/gtest.h>

#include <thread>

#include "tests/plugin/capi/capi_test_support.h"
#include "tests/support/test_paths.h"

namespace rsstab::testing {
namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 90;
constexpr int kFrames = 16;
constexpr int kInstances = 8;
constexpr int kCycles = 200;

// All frames of a live run, one after the other; "" after a failure.
std::string RunLive(const std::vector<Frame>& clip) {
  const OptionsHandle options = MakeOptions({{"rs", "off"}, {"threads", "2"}, {"lookahead", "4"}});
  const rsstab_video video = MakeVideo(kWidth, kHeight, RSSTAB_PIXEL_GRAY8);
  rsstab_instance* made = nullptr;
  if (rsstab_create_live(options.get(), &video, &made) != RSSTAB_OK) {
    return "";
  }
  const InstanceHandle instance(made);
  const Frame output = *AllocateFrame(GrayLayout(), kWidth, kHeight);
  const rsstab_buffer buffer = ToBuffer(output);
  std::string bytes;
  const auto pull = [&] {
    while (rsstab_pull(made, &buffer, nullptr, nullptr) == RSSTAB_OK) {
      bytes += Bytes(output);
    }
  };
  for (std::size_t t = 0; t < clip.size(); ++t) {
    const rsstab_picture picture = ToPicture(clip[t]);
    if (rsstab_push(made, &picture, static_cast<std::int64_t>(t), nullptr, nullptr) != RSSTAB_OK) {
      return "";
    }
    pull();
  }
  if (rsstab_flush(made) != RSSTAB_OK) {
    return "";
  }
  pull();
  return bytes;
}

std::vector<Frame> PaintClip() {
  std::vector<Frame> clip;
  for (int t = 0; t < kFrames; ++t) {
    clip.push_back(PaintShaky(GrayLayout(), kWidth, kHeight, t));
  }
  return clip;
}

TEST(CapiThreads, EightInstancesSideBySideGiveWhatOneGives) {
  const std::vector<Frame> clip = PaintClip();
  const std::string alone = RunLive(clip);
  ASSERT_EQ(alone.size(), static_cast<std::size_t>(kWidth * kHeight * kFrames));
  std::vector<std::string> results(kInstances);
  std::vector<std::thread> threads;
  for (std::string& result : results) {
    threads.emplace_back([&] { result = RunLive(clip); });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  for (const std::string& result : results) {
    EXPECT_EQ(result, alone);
  }
}

TEST(CapiThreads, TwoHundredInstancesOneAfterTheOther) {
  const TemporaryFolder folder;
  const std::string path = (folder / "clip.rsstab").string();
  const rsstab_video video = MakeVideo(kWidth, kHeight, RSSTAB_PIXEL_GRAY8);
  Analyze(video, GrayLayout(), 3, path);
  const OptionsHandle options = MakeOptions({{"rs", "off"}, {"threads", "2"}, {"lookahead", "4"}});
  const Frame frame = PaintShaky(GrayLayout(), kWidth, kHeight, 0);
  const Frame output = *AllocateFrame(GrayLayout(), kWidth, kHeight);
  const rsstab_picture picture = ToPicture(frame);
  const rsstab_buffer buffer = ToBuffer(output);
  for (int i = 0; i < kCycles; ++i) {
    rsstab_instance* live = nullptr;
    ASSERT_EQ(rsstab_create_live(options.get(), &video, &live), RSSTAB_OK);
    ASSERT_EQ(rsstab_push(live, &picture, 0, nullptr, nullptr), RSSTAB_OK);
    rsstab_instance* apply = nullptr;
    ASSERT_EQ(rsstab_create_apply(options.get(), &video, path.c_str(), &apply), RSSTAB_OK);
    ASSERT_EQ(rsstab_render(apply, &picture, 0, &buffer), RSSTAB_OK);
    rsstab_destroy(live);
    rsstab_destroy(apply);
  }
}

}  // namespace
}  // namespace rsstab::testing
