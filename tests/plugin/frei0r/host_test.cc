// SPDX-License-Identifier: Apache-2.0
#include "plugin/frei0r/host.h"

#include <gtest/gtest.h>

namespace rsstab::frei0r {
namespace {

constexpr std::uint32_t Version(std::uint32_t major, std::uint32_t minor) {
  return major << 16 | minor << 8 | 100;
}

TEST(Host, FollowsTheHeaderWhenItIsNoFFmpeg) {
  const HostTraits host = TraitsOf(std::nullopt, false);
  EXPECT_EQ(host.time_unit, TimeUnit::kSeconds);
  EXPECT_EQ(RowBytes(host, 854), 854 * 4);
}

TEST(Host, FFmpeg51PadsRowsAndCountsMilliseconds) {
  const HostTraits host = TraitsOf(Version(8, 44), false);
  EXPECT_EQ(host.time_unit, TimeUnit::kMilliseconds);
  EXPECT_EQ(RowBytes(host, 854), 864 * 4);
  EXPECT_EQ(RowBytes(host, 1080), 1088 * 4);
  EXPECT_EQ(RowBytes(host, 1920), 1920 * 4);
}

TEST(Host, FFmpeg71PacksRowsAndCountsMilliseconds) {
  const HostTraits host = TraitsOf(Version(10, 4), false);
  EXPECT_EQ(host.time_unit, TimeUnit::kMilliseconds);
  EXPECT_EQ(RowBytes(host, 854), 854 * 4);
}

TEST(Host, NewerAndStaticFFmpegHaveToBeWatched) {
  EXPECT_EQ(TraitsOf(Version(11, 14), false).time_unit, TimeUnit::kUnknown);
  EXPECT_EQ(TraitsOf(std::nullopt, true).time_unit, TimeUnit::kUnknown);
}

TEST(Host, KnowsThatThisProgramIsOne) {
  EXPECT_EQ(TraitsOfCaller(reinterpret_cast<const void*>(&TraitsOf)).time_unit, TimeUnit::kUnknown);
}

TEST(Host, TakesAnUnknownCallerAtItsWord) {
  EXPECT_EQ(TraitsOfCaller(nullptr).time_unit, TimeUnit::kSeconds);
}

}  // namespace
}  // namespace rsstab::frei0r
