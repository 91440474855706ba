// SPDX-License-Identifier: Apache-2.0
// The plugin as a host sees it: its entry points, called as frei0r.h allows.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <thread>

#include "plugin/frei0r/parameters.h"
#include "tests/plugin/frei0r/plugin_library.h"
#include "tests/support/run_program.h"
#include "tests/support/test_paths.h"

namespace rsstab::frei0r::testing {
namespace {

using rsstab::testing::TemporaryFolder;

// So that no environment of the caller's decides what a test sees.
class PluginTest : public ::testing::Test {
 protected:
  void SetUp() override { unsetenv("RSSTAB_ANALYSIS"); }
  void TearDown() override { unsetenv("RSSTAB_ANALYSIS"); }
  PluginLibrary plugin_;
};

TEST_F(PluginTest, DescribesItself) {
  f0r_plugin_info_t info{};
  plugin_.get_plugin_info(&info);
  EXPECT_EQ(info.plugin_type, F0R_PLUGIN_TYPE_FILTER);
  EXPECT_EQ(info.color_model, F0R_COLOR_MODEL_RGBA8888);
  EXPECT_EQ(info.frei0r_version, 1);
  EXPECT_EQ(info.num_params, 6);
  const std::array<std::pair<const char*, int>, 6> expected = {
      {{"Analysis file", F0R_PARAM_STRING},
       {"Rolling shutter", F0R_PARAM_STRING},
       {"Smoothness", F0R_PARAM_DOUBLE},
       {"Crop", F0R_PARAM_DOUBLE},
       {"Zoom", F0R_PARAM_DOUBLE},
       {"Look-ahead", F0R_PARAM_DOUBLE}}};
  for (int i = 0; i < info.num_params; ++i) {
    f0r_param_info_t param{};
    plugin_.get_param_info(&param, i);
    EXPECT_STREQ(param.name, expected[static_cast<std::size_t>(i)].first);
    EXPECT_EQ(param.type, expected[static_cast<std::size_t>(i)].second);
    EXPECT_NE(param.explanation, nullptr);
  }
}

TEST_F(PluginTest, InitialisesAsOftenAsAHostLikes) {
  for (int i = 0; i < 3; ++i) {
    EXPECT_GE(plugin_.init(), 0);
  }
  auto* const instance = plugin_.construct(64, 48);
  plugin_.deinit();  // MLT does so before it destroys its instances
  plugin_.destruct(instance);
}

TEST_F(PluginTest, KeepsParameters) {
  PluginInstance instance(plugin_, 64, 48);
  EXPECT_EQ(instance.GetText(0), "");
  EXPECT_EQ(instance.GetText(1), "auto");
  EXPECT_EQ(instance.GetNumber(2), 0.1);
  EXPECT_EQ(instance.GetNumber(3), 0.8);
  EXPECT_EQ(instance.GetNumber(4), 0.0);
  EXPECT_EQ(instance.GetNumber(5), 0.0);
  instance.SetText(0, "/some/where:else|x");
  instance.SetText(1, "off");
  EXPECT_EQ(instance.GetText(0), "/some/where:else|x");
  EXPECT_EQ(instance.GetText(1), "off");
  for (int i = 2; i < 6; ++i) {
    instance.SetNumber(i, 0.25);
    EXPECT_EQ(instance.GetNumber(i), 0.25);
    instance.SetNumber(i, 4.0);
    EXPECT_EQ(instance.GetNumber(i), 1.0);
    instance.SetNumber(i, -std::numeric_limits<double>::infinity());
    EXPECT_EQ(instance.GetNumber(i), 0.0);
  }
}

TEST_F(PluginTest, ParametersThatDoNotExistAreLeftAlone) {
  PluginInstance instance(plugin_, 64, 48);
  for (const int index : {-1, 6, 1000}) {
    instance.SetNumber(index, 1.0);
    EXPECT_TRUE(std::isnan(instance.GetNumber(index)));
    f0r_param_info_t untouched{};
    plugin_.get_param_info(&untouched, index);
    EXPECT_EQ(untouched.name, nullptr);
  }
}

TEST_F(PluginTest, RefusesSizesThatAreNone) {
  EXPECT_EQ(plugin_.construct(0, 48), nullptr);
  EXPECT_EQ(plugin_.construct(64, 0), nullptr);
  EXPECT_EQ(plugin_.construct(1U << 20U, 48), nullptr);
}

TEST_F(PluginTest, TakesAnySizeLive) {
  const std::array<std::pair<int, int>, 7> sizes = {
      {{8, 8}, {1, 1}, {2, 300}, {37, 23}, {333, 1}, {854, 480}, {1920, 1080}}};
  for (const auto& [width, height] : sizes) {
    SCOPED_TRACE(std::to_string(width) + "x" + std::to_string(height));
    PluginInstance instance(plugin_, static_cast<unsigned>(width), static_cast<unsigned>(height));
    for (int i = 0; i < 3; ++i) {
      const Pixels in = ShakyPicture(width, height, i);
      EXPECT_EQ(instance.Update(i / 25.0, in).size(), in.size());
    }
  }
}

TEST_F(PluginTest, ComesAndGoesManyTimes) {
  const Pixels in = ShakyPicture(64, 48, 0);
  for (int i = 0; i < 200; ++i) {
    PluginInstance instance(plugin_, 64, 48);
    if (i % 10 == 0) {
      EXPECT_EQ(instance.Update(0.0, in).size(), in.size());
    }
  }
}

TEST_F(PluginTest, AMissingFilePassesThroughAndSaysSoOnce) {
  PluginInstance instance(plugin_, 37, 23);
  instance.SetText(kAnalysisFile, "/nowhere/clip.rsstab");
  ::testing::internal::CaptureStderr();
  for (int i = 0; i < 5; ++i) {
    const Pixels in = ShakyPicture(37, 23, i);
    instance.SetText(kAnalysisFile, "/nowhere/clip.rsstab");  // MLT sets it for each frame
    EXPECT_TRUE(instance.Update(i / 25.0, in) == in);
  }
  const std::string said = ::testing::internal::GetCapturedStderr();
  EXPECT_THAT(said, ::testing::HasSubstr("/nowhere/clip.rsstab"));
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
}

TEST_F(PluginTest, ChangingTheParameterTriesAgain) {
  const TemporaryFolder folder;
  PluginInstance instance(plugin_, 160, 120);
  instance.SetText(kAnalysisFile, "/nowhere/first.rsstab");
  const Pixels in = ShakyPicture(160, 120, 3);
  ::testing::internal::CaptureStderr();
  EXPECT_TRUE(instance.Update(0.12, in) == in);
  AnalyseShakyClip(folder / "clip.rsstab", 160, 120, 12, 25.0);
  instance.SetText(kAnalysisFile, folder / "clip.rsstab");
  EXPECT_FALSE(instance.Update(0.12, in) == in);
  instance.SetText(kAnalysisFile, "/nowhere/else.rsstab");
  EXPECT_TRUE(instance.Update(0.12, in) == in);
  EXPECT_THAT(
      ::testing::internal::GetCapturedStderr(),
      ::testing::AllOf(::testing::HasSubstr("first.rsstab"), ::testing::HasSubstr("else.rsstab")));
}

TEST_F(PluginTest, AnUnknownRollingShutterSourcePassesThrough) {
  PluginInstance instance(plugin_, 64, 48);
  instance.SetText(kRollingShutter, "guess");
  const Pixels in = ShakyPicture(64, 48, 0);
  ::testing::internal::CaptureStderr();
  EXPECT_TRUE(instance.Update(0.0, in) == in);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), ::testing::HasSubstr("guess"));
}

// 160x120 at an NTSC rate, 30 frames, analysed once.
class TwoPass : public PluginTest {
 protected:
  static constexpr int kWidth = 160;
  static constexpr int kHeight = 120;
  static constexpr int kFrames = 30;
  static constexpr double kRate = 30000.0 / 1001.0;

  void SetUp() override {
    PluginTest::SetUp();
    path_ = folder_ / "clip.rsstab";
    AnalyseShakyClip(path_, kWidth, kHeight, kFrames, kRate);
    PluginInstance instance(plugin_, kWidth, kHeight);
    instance.SetText(kAnalysisFile, path_);
    for (int i = 0; i < kFrames; ++i) {
      in_.push_back(ShakyPicture(kWidth, kHeight, i));
      expected_.push_back(instance.Update(i / kRate, in_.back()));
      ASSERT_FALSE(expected_.back() == in_.back());
    }
  }

  const Pixels& In(int i) const { return in_[static_cast<std::size_t>(i)]; }
  const Pixels& Expected(int i) const { return expected_[static_cast<std::size_t>(i)]; }

  TemporaryFolder folder_;
  std::string path_;
  std::vector<Pixels> in_;
  std::vector<Pixels> expected_;
};

TEST_F(TwoPass, FramesMayComeInAnyOrderAndAgain) {
  PluginInstance instance(plugin_, kWidth, kHeight);
  instance.SetText(kAnalysisFile, path_);
  for (const int i : {0, 1, 2, 20, 20, 20, 29, 3, 2, 0, 15}) {
    EXPECT_TRUE(instance.Update(i / kRate, In(i)) == Expected(i)) << i;
  }
}

TEST_F(TwoPass, TheVariableNamesTheFileToo) {
  setenv("RSSTAB_ANALYSIS", path_.c_str(), 1);
  PluginInstance instance(plugin_, kWidth, kHeight);
  EXPECT_TRUE(instance.Update(7 / kRate, In(7)) == Expected(7));
}

TEST_F(TwoPass, TimesMayBeRoundedAndMilliseconds) {
  PluginInstance rounded(plugin_, kWidth, kHeight);
  rounded.SetText(kAnalysisFile, path_);
  PluginInstance milliseconds(plugin_, kWidth, kHeight);
  milliseconds.SetText(kAnalysisFile, path_);
  for (int i = 0; i < kFrames; ++i) {
    EXPECT_TRUE(rounded.Update(std::round(1000.0 * i / kRate) / 1000.0, In(i)) == Expected(i)) << i;
    const Pixels out = milliseconds.Update(1000.0 * i / kRate, In(i));
    if (i != 1) {  // 33 s could still be a gap
      EXPECT_TRUE(out == Expected(i)) << i;
    }
  }
}

TEST_F(TwoPass, FramesWithoutTimesAreCounted) {
  PluginInstance instance(plugin_, kWidth, kHeight);
  instance.SetText(kAnalysisFile, path_);
  for (int i = 0; i < kFrames; ++i) {
    EXPECT_TRUE(instance.Update(-3.0775318e+20, In(i)) == Expected(i)) << i;
  }
  ::testing::internal::CaptureStderr();
  EXPECT_TRUE(instance.Update(-3.0775318e+20, In(0)) == In(0));
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), ::testing::HasSubstr("30"));
}

TEST_F(TwoPass, AClipCutAtItsStartIsRecognised) {
  PluginInstance instance(plugin_, kWidth, kHeight);
  instance.SetText(kAnalysisFile, path_);
  for (int i = 11; i < kFrames; ++i) {
    EXPECT_TRUE(instance.Update((i - 11) / kRate, In(i)) == Expected(i)) << i;
  }
}

TEST_F(TwoPass, AnotherFrameRateShowsEachFrameByItsOwnRecord) {
  for (const double rate : {24.0, 25.0, 50.0, 59.94}) {
    PluginInstance instance(plugin_, kWidth, kHeight);
    instance.SetText(kAnalysisFile, path_);
    for (int i = 0; i / rate < (kFrames - 1) / kRate; ++i) {
      const int shown = static_cast<int>(std::lround(i / rate * kRate));
      EXPECT_TRUE(instance.Update(i / rate, In(shown)) == Expected(shown)) << rate << ' ' << i;
    }
  }
}

TEST_F(TwoPass, TheOtherParametersWereDecidedByTheAnalysis) {
  PluginInstance instance(plugin_, kWidth, kHeight);
  instance.SetText(kAnalysisFile, path_);
  for (int i = 0; i < 6; ++i) {
    instance.SetNumber(2 + i % 4, 0.1 * i);
    EXPECT_TRUE(instance.Update(i / kRate, In(i)) == Expected(i)) << i;
  }
}

TEST_F(TwoPass, SeveralInstancesWorkAtOnce) {
  constexpr int kThreads = 4;
  std::array<std::vector<Pixels>, kThreads> results;
  std::vector<std::thread> threads;
  for (std::vector<Pixels>& result : results) {
    threads.emplace_back([&] {
      PluginInstance instance(plugin_, kWidth, kHeight);
      instance.SetText(kAnalysisFile, path_);
      for (int i = 0; i < kFrames; ++i) {
        result.push_back(instance.Update(i / kRate, In(i)));
      }
    });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  for (const std::vector<Pixels>& result : results) {
    EXPECT_TRUE(result == expected_);
  }
}

TEST_F(TwoPass, AnotherClipsFilePassesThroughAndSaysSoOnce) {
  PluginInstance instance(plugin_, 64, 64);  // another shape
  instance.SetText(kAnalysisFile, path_);
  ::testing::internal::CaptureStderr();
  for (int i = 0; i < 3; ++i) {
    const Pixels in = ShakyPicture(64, 64, i);
    EXPECT_TRUE(instance.Update(i / kRate, in) == in);
  }
  const std::string said = ::testing::internal::GetCapturedStderr();
  EXPECT_THAT(said, ::testing::HasSubstr("160x120"));
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
}

TEST(PluginFile, ExportsItsEntryPointsOnly) {
  const std::string nm = RSSTAB_NM;
  if (nm.empty()) {
    GTEST_SKIP() << "nm was not found when the tests were configured";
  }
  const auto run = rsstab::testing::RunProgram(
      nm, {"--dynamic", "--defined-only", "--format=just-symbols", RSSTAB_FREI0R_PLUGIN});
  ASSERT_EQ(run.exit_code, 0) << run.error;
  std::istringstream lines(run.output);
  std::vector<std::string> symbols;
  for (std::string line; std::getline(lines, line);) {
    symbols.push_back(line);
  }
  EXPECT_THAT(symbols, ::testing::UnorderedElementsAre(
                           "f0r_init", "f0r_deinit", "f0r_get_plugin_info", "f0r_get_param_info",
                           "f0r_construct", "f0r_destruct", "f0r_set_param_value",
                           "f0r_get_param_value", "f0r_update"));
}

}  // namespace
}  // namespace rsstab::frei0r::testing
