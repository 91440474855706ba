// SPDX-License-Identifier: Apache-2.0
// Live mode of the plugin: one frame per frame, whatever the host does.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "plugin/frei0r/parameters.h"
#include "tests/plugin/frei0r/plugin_library.h"

namespace rsstab::frei0r::testing {
namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 120;
constexpr double kRate = 30.0;

class LiveTest : public ::testing::Test {
 protected:
  void SetUp() override { unsetenv("RSSTAB_ANALYSIS"); }

  static Pixels In(int i) { return ShakyPicture(kWidth, kHeight, i); }
  // Frames 0 to `count` - 1 of a fresh instance, at `rate`.
  std::vector<Pixels> Play(int count, double lookahead, double rate = kRate) const {
    PluginInstance instance(plugin_, kWidth, kHeight);
    instance.SetNumber(kLookahead, lookahead);
    std::vector<Pixels> out;
    for (int i = 0; i < count; ++i) {
      out.push_back(instance.Update(i / rate, In(i)));
    }
    return out;
  }

  PluginLibrary plugin_;
};

TEST_F(LiveTest, WithoutLookAheadEveryFrameIsItsOwn) {
  const std::vector<Pixels> out = Play(12, 0.0);
  for (std::size_t i = 1; i < out.size(); ++i) {
    EXPECT_FALSE(out[i] == out[i - 1]) << i;
    EXPECT_FALSE(out[i] == In(static_cast<int>(i))) << i;
  }
}

TEST_F(LiveTest, LookAheadRepeatsTheFirstFrameAndThenComesLate) {
  constexpr int kDelay = 5;
  const std::vector<Pixels> out = Play(12, kDelay / 100.0);
  for (std::size_t i = 0; i < kDelay; ++i) {
    EXPECT_TRUE(out[i] == In(0)) << i;
  }
  for (std::size_t i = kDelay + 1; i < out.size(); ++i) {
    EXPECT_FALSE(out[i] == out[i - 1]) << i;
  }
}

TEST_F(LiveTest, AFrameAskedForAgainIsTheSame) {
  const std::vector<Pixels> expected = Play(8, 0.0);
  PluginInstance instance(plugin_, kWidth, kHeight);
  for (int i = 0; i < 8; ++i) {
    for (int again = 0; again <= i % 3; ++again) {
      EXPECT_TRUE(instance.Update(i / kRate, In(i)) == expected[static_cast<std::size_t>(i)]) << i;
    }
  }
}

TEST_F(LiveTest, RewindingBeginsAnew) {
  for (const double lookahead : {0.0, 0.03}) {
    const std::vector<Pixels> expected = Play(6, lookahead);
    PluginInstance instance(plugin_, kWidth, kHeight);
    instance.SetNumber(kLookahead, lookahead);
    for (const int length : {9, 1, 2, 6}) {
      for (int i = 0; i < length; ++i) {
        const Pixels out = instance.Update(i / kRate, In(i));
        if (i < 6) {
          EXPECT_TRUE(out == expected[static_cast<std::size_t>(i)]) << i << " of " << length;
        }
      }
    }
  }
}

TEST_F(LiveTest, SeekingForwardBeginsAnew) {
  PluginInstance instance(plugin_, kWidth, kHeight);
  for (int i = 0; i < 5; ++i) {
    static_cast<void>(instance.Update(i / kRate, In(i)));
  }
  const std::vector<Pixels> expected = Play(5, 0.0);
  for (int i = 0; i < 5; ++i) {
    EXPECT_TRUE(instance.Update(60.0 + i / kRate, In(i)) == expected[static_cast<std::size_t>(i)])
        << i;
  }
}

TEST_F(LiveTest, FramesWithoutTimesCountAsThirtyPerSecond) {
  const std::vector<Pixels> expected = Play(8, 0.0);
  PluginInstance instance(plugin_, kWidth, kHeight);
  for (int i = 0; i < 8; ++i) {
    EXPECT_TRUE(instance.Update(-3.0775318e+20, In(i)) == expected[static_cast<std::size_t>(i)])
        << i;
  }
}

TEST_F(LiveTest, TheRateIsFoundFromTheTimes) {
  // Half the frames for the same time constant: another path.
  const std::vector<Pixels> slow = Play(10, 0.0, 15.0);
  const std::vector<Pixels> fast = Play(10, 0.0, 30.0);
  EXPECT_FALSE(slow.back() == fast.back());
}

TEST_F(LiveTest, SmoothnessChangesWhileItRuns) {
  PluginInstance calm(plugin_, kWidth, kHeight);
  PluginInstance changed(plugin_, kWidth, kHeight);
  for (int i = 0; i < 12; ++i) {
    if (i == 6) {
      changed.SetNumber(kSmoothness, 0.0);
    }
    const bool same = calm.Update(i / kRate, In(i)) == changed.Update(i / kRate, In(i));
    if (i < 6) {
      EXPECT_TRUE(same) << i;
    } else if (i > 7) {
      EXPECT_FALSE(same) << i;
    }
  }
}

TEST_F(LiveTest, AnotherLookAheadBeginsAnew) {
  const std::vector<Pixels> expected = Play(6, 0.02);
  PluginInstance instance(plugin_, kWidth, kHeight);
  for (int i = 0; i < 4; ++i) {
    static_cast<void>(instance.Update(i / kRate, In(i + 20)));
  }
  instance.SetNumber(kLookahead, 0.02);
  for (int i = 0; i < 6; ++i) {
    EXPECT_TRUE(instance.Update(i / kRate, In(i)) == expected[static_cast<std::size_t>(i)]) << i;
  }
}

}  // namespace
}  // namespace rsstab::frei0r::testing
