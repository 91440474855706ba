// SPDX-License-Identifier: Apache-2.0
#include "rsdiff/seeded_noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace rsstab::rsdiff {
namespace {

constexpr Shape kState{3, 24, 1};

TEST(SeededNoise, IsTheSameForTheSameSeedAndNoOther) {
  Tensor a(2, kState);
  Tensor b(2, kState);
  SeededNoise(7, 2).Fill(a);
  SeededNoise(7, 2).Fill(b);
  EXPECT_EQ(a.values, b.values);
  SeededNoise(8, 2).Fill(b);
  EXPECT_NE(a.values, b.values);
}

// Written down once: any platform must give these bits.
TEST(SeededNoise, GivesTheWrittenNumbers) {
  Tensor state(3, {1, 2, 1});
  SeededNoise noise(2024, 3);
  noise.Fill(state);
  constexpr double kUnit = 0x1.0p-20;
  EXPECT_EQ(state.values[0], static_cast<float>(-298555.0 * kUnit));
  EXPECT_EQ(state.values[1], static_cast<float>(88868.0 * kUnit));
  EXPECT_EQ(state.values[4], static_cast<float>(2018245.0 * kUnit));
  EXPECT_EQ(state.values[5], static_cast<float>(1149963.0 * kUnit));
}

TEST(SeededNoise, ComesInPairsOfOppositeSign) {
  Tensor states(4, kState);
  SeededNoise noise(5, 4);
  for (int round = 0; round < 2; ++round) {
    noise.Fill(states);
    for (std::size_t i = 0; i < kState.Count(); ++i) {
      EXPECT_EQ(states.Item(0)[i], -states.Item(1)[i]);
      EXPECT_EQ(states.Item(2)[i], -states.Item(3)[i]);
    }
    EXPECT_NE(states.Item(0)[0], states.Item(2)[0]);
  }
}

TEST(SeededNoise, AnItemDoesNotDependOnTheOthers) {
  Tensor one(1, kState);
  Tensor many(5, kState);
  SeededNoise alone(3, 1);
  SeededNoise together(3, 5);
  for (int round = 0; round < 3; ++round) {
    alone.Fill(one);
    together.Fill(many);
    EXPECT_TRUE(std::ranges::equal(std::as_const(one).Item(0), std::as_const(many).Item(0)));
    EXPECT_FALSE(std::ranges::equal(std::as_const(one).Item(0), std::as_const(many).Item(1)));
  }
}

TEST(SeededNoise, IsGaussian) {
  const int count = 100000;
  Tensor tensor(1, {1, count, 1});
  SeededNoise(1, 1).Fill(tensor);
  double sum = 0.0;
  double squares = 0.0;
  double fourth = 0.0;
  for (const float value : tensor.values) {
    const auto v = static_cast<double>(value);
    sum += v;
    squares += v * v;
    fourth += v * v * v * v;
  }
  // Four standard errors: 1, sqrt(2) and sqrt(96) over sqrt(n).
  const double error = 4.0 / std::sqrt(count);
  EXPECT_NEAR(sum / count, 0.0, error);
  EXPECT_NEAR(squares / count, 1.0, std::sqrt(2.0) * error);
  EXPECT_NEAR(fourth / count, 3.0, std::sqrt(96.0) * error);
}

}  // namespace
}  // namespace rsstab::rsdiff
