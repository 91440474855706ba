// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/scene_cut.h"

#include <gtest/gtest.h>

namespace rsstab::stabilizer {
namespace {

TEST(SceneCut, NeedsBothLostPointsAndAnotherPicture) {
  EXPECT_TRUE(IsSceneCut({40.0, 300, 10}));
  EXPECT_FALSE(IsSceneCut({3.0, 300, 10}));    // a whip pan blurs the points away
  EXPECT_FALSE(IsSceneCut({60.0, 300, 250}));  // a flash
  EXPECT_FALSE(IsSceneCut({1.0, 300, 290}));
}

TEST(SceneCut, WithoutPointsOnlyTheLookCounts) {
  EXPECT_FALSE(IsSceneCut({0.0, 0, 0}));  // black stays black
  EXPECT_TRUE(IsSceneCut({90.0, 0, 0}));  // black to a bright scene
}

}  // namespace
}  // namespace rsstab::stabilizer
