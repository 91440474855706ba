// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <vector>

#include "stabilizer/path_window_detail.h"

namespace rsstab::stabilizer {
namespace {

constexpr double kFramesPerSecond = 30.0;

FrameMotion Moving(double widths_per_second) {
  FrameMotion motion;
  motion.to_from(0, 2) = widths_per_second / kFramesPerSecond;
  return motion;
}

PathWindow Filled(int frames, double widths_per_second) {
  PathWindow window(kFramesPerSecond);
  for (int t = 0; t < frames; ++t) {
    window.Append(Moving(widths_per_second), {Eigen::Vector2d(0.5, -1.0)});
  }
  return window;
}

TEST(PathWindow, LocalStepsAddUpToAPath) {
  const PathWindow window = Filled(3, 0.0);
  EXPECT_TRUE(window[0].motion.path_begins);
  EXPECT_FALSE(window[1].motion.path_begins);
  EXPECT_EQ(window[2].local_path[0], Eigen::Vector2d(1.5, -3.0));
  EXPECT_EQ(window[2].local_smooth[0], window[2].local_path[0]);
}

TEST(PathWindow, FewDecidedFramesStay) {
  PathWindow window = Filled(20, 0.0);
  window.MarkDecided(12);
  EXPECT_EQ(window.num_open(), 8U);
  EXPECT_EQ(window.first_open(), 3U);  // the jerk term leans on three
  EXPECT_EQ(window.size(), 11U);
  window.Clear();
  EXPECT_EQ(window.size(), 0U);
}

TEST(PathWindow, GuessesGoOnAsTheCameraDidAndComeToRest) {
  PathWindow window = Filled(60, 0.3);
  window.Guess(90);
  EXPECT_EQ(window.num_open(), 60U);
  const double step = 0.3 / kFramesPerSecond;
  EXPECT_NEAR(window[60].motion.to_from(0, 2), step, 0.1 * step);
  EXPECT_GT(window[60].motion.to_from(0, 2), window[70].motion.to_from(0, 2));
  EXPECT_LT(window[149].motion.to_from(0, 2), 0.01 * step);
}

TEST(PathWindow, WhatAGuessWasSolvedToIsWhereItsFrameBegins) {
  PathWindow window = Filled(10, 0.0);
  window.Guess(2);
  window[10].theta[0] = 0.25;
  window[11].theta[0] = 0.5;
  window.DropGuesses();
  EXPECT_EQ(window.size(), 10U);
  window.Append(Moving(0.0), {Eigen::Vector2d::Zero()});
  window.Append(Moving(0.0), {Eigen::Vector2d::Zero()});
  EXPECT_EQ(window[10].theta[0], 0.25);
  EXPECT_EQ(window[11].theta[0], 0.5);
}

TEST(PathWindow, AFastPanRelaxesAndNothingElseDoes) {
  PathWindow slow = Filled(60, 0.02);
  slow.UpdatePanWeights();
  EXPECT_GT(slow[30].pan_weight, 0.99);
  PathWindow fast = Filled(60, 1.0);
  fast.UpdatePanWeights();
  EXPECT_LT(fast[30].pan_weight, 0.01);
  // A term over several frames is as weak as the weakest of them.
  slow[29].relaxation = 0.25;
  EXPECT_NEAR(slow.TemporalWeight(2.0, 30, 2), 1.0, 0.01);
  EXPECT_NEAR(slow.TemporalWeight(2.0, 33, 2), 2.0, 0.01);
}

}  // namespace
}  // namespace rsstab::stabilizer
