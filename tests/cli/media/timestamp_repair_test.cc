// SPDX-License-Identifier: Apache-2.0
#include "cli/media/timestamp_repair.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <limits>
#include <optional>
#include <random>
#include <vector>

namespace rsstab::media {
namespace {

using Stamp = std::optional<std::int64_t>;
using ::testing::ElementsAre;
using ::testing::ElementsAreArray;

// Runs packets (file order) and decoded frames (shown order) through plan and repair; also checks
// what holds always: one time per frame, strictly increasing, decided within the look-ahead.
std::vector<std::int64_t> Repair(const std::vector<Stamp>& packets,
                                 const std::vector<Stamp>& frames, double fallback_period = 10.0) {
  std::vector<TimestampPlan::Packet> scanned;
  for (const Stamp& pts : packets) {
    scanned.push_back({pts, std::nullopt});
  }
  TimestampRepair repair(TimestampPlan(scanned, fallback_period), fallback_period);
  std::vector<std::int64_t> times;
  std::size_t pushed = 0;
  for (const Stamp& stamp : frames) {
    repair.Push(stamp);
    ++pushed;
    while (const Stamp time = repair.Pop()) {
      times.push_back(*time);
    }
    EXPECT_LE(pushed - times.size(), TimestampRepair::kLookAhead);
  }
  repair.Finish();
  while (const Stamp time = repair.Pop()) {
    times.push_back(*time);
  }
  EXPECT_EQ(times.size(), frames.size());
  EXPECT_TRUE(std::adjacent_find(times.begin(), times.end(), std::greater_equal<>()) ==
              times.end());
  return times;
}

std::vector<Stamp> Steady(int count, std::int64_t period, std::int64_t start = 0) {
  std::vector<Stamp> stamps;
  for (int k = 0; k < count; ++k) {
    stamps.emplace_back(start + k * period);
  }
  return stamps;
}

std::vector<std::int64_t> Values(const std::vector<Stamp>& stamps) {
  std::vector<std::int64_t> values;
  for (const Stamp& stamp : stamps) {
    values.push_back(stamp.value());
  }
  return values;
}

TEST(TimestampRepair, KeepsVariableFrameRateExactly) {
  const std::vector<Stamp> frames = {0, 33, 67, 500, 501, 540, 2000, 90000, 90033, 90066, 90100};
  EXPECT_THAT(Repair(frames, frames), ElementsAreArray(Values(frames)));
}

TEST(TimestampRepair, KeepsDroppedFramesOfAConstantRate) {
  std::vector<Stamp> frames = Steady(60, 3000);
  frames.erase(frames.begin() + 58);  // a gap of two periods before the last frame is no damage
  frames.erase(frames.begin() + 20, frames.begin() + 23);
  EXPECT_THAT(Repair(frames, frames), ElementsAreArray(Values(frames)));
}

TEST(TimestampRepair, KeepsTimesOfReorderedPackets) {
  // Decoding order of a stream with B-frames; the decoder shows them sorted.
  const std::vector<Stamp> packets = {0, 40, 20, 10, 30, 80, 60, 50, 70};
  std::vector<Stamp> frames = packets;
  std::sort(frames.begin(), frames.end());
  EXPECT_THAT(Repair(packets, frames), ElementsAreArray(Values(frames)));
}

// The kind of damage that some phone clips have after being re-encoded: repeats and backward steps
// in the first frames, then a constant rate on another line, and a wrong last stamp.
TEST(TimestampRepair, PutsDamagedStampsOfAConstantRateOnItsLine) {
  std::vector<Stamp> packets = {0,     9000,  9000,  11999, 23999, 21001, 21750,
                                33000, 27000, 30000, 41999, 36000, 39000};
  std::vector<Stamp> frames = {0,     9000,  11999, 9000,  21001, 21750, 23999,
                               27000, 30000, 33000, 36000, 39000, 41999};
  for (int k = 15; k < 150; ++k) {
    packets.emplace_back(k * 3000);
    frames.emplace_back(k * 3000);
  }
  packets.emplace_back(150 * 3000 + 2999);
  frames.emplace_back(150 * 3000 + 2999);
  const std::vector<std::int64_t> times = Repair(packets, frames, 3000.0);
  for (std::size_t k = 0; k < times.size(); ++k) {
    const auto truth = static_cast<std::int64_t>(k + 2) * 3000;
    EXPECT_LE(std::abs(times[k] - truth), 1) << "frame " << k;
  }
  EXPECT_EQ(times[6], 23999) << "a good stamp is kept to the tick";
}

TEST(TimestampRepair, FillsMissingAndRepeatedStampsOfVariableRate) {
  const std::vector<Stamp> frames = {0, 100, 100, 230, 290, std::nullopt, 500, 560};
  EXPECT_THAT(Repair(frames, frames), ElementsAre(0, 100, 165, 230, 290, 395, 500, 560));
}

TEST(TimestampRepair, UndoesSwappedStamps) {
  const std::vector<Stamp> frames = {0, 10, 30, 20, 40, 50, 60, 70, 80, 90};
  EXPECT_THAT(Repair(frames, frames), ElementsAre(0, 10, 20, 30, 40, 50, 60, 70, 80, 90));
}

TEST(TimestampRepair, FramesLostInDecodingLeaveAGap) {
  const std::vector<Stamp> packets = Steady(40, 10);
  std::vector<Stamp> frames = packets;
  frames.erase(frames.begin() + 10);
  frames.erase(frames.begin(), frames.begin() + 2);
  EXPECT_THAT(Repair(packets, frames), ElementsAreArray(Values(frames)));
}

TEST(TimestampRepair, AbsurdFirstAndLastStampsAreReplaced) {
  std::vector<Stamp> frames = Steady(40, 10);
  frames.front() = -4'000'000'000;
  frames.back() = 9'000'000'000;
  EXPECT_THAT(Repair(frames, frames), ElementsAreArray(Values(Steady(40, 10))));
}

TEST(TimestampRepair, OneWildStampInTheMiddleDisturbsNoOther) {
  std::vector<Stamp> frames = Steady(60, 10);
  frames[30] = 9'000'000'000;
  EXPECT_THAT(Repair(frames, frames), ElementsAreArray(Values(Steady(60, 10))));
}

TEST(TimestampRepair, NoStampsAtAllMeansTheNominalRate) {
  const std::vector<Stamp> frames(5);
  EXPECT_THAT(Repair(frames, frames, 40.0), ElementsAre(0, 40, 80, 120, 160));
}

TEST(TimestampRepair, DecodingTimesServeWhereThereAreNoOthers) {
  std::vector<TimestampPlan::Packet> packets;
  for (const std::int64_t dts : {0, 10, 20, 35, 45}) {
    packets.push_back({std::nullopt, dts});
  }
  TimestampRepair repair(TimestampPlan(packets, 10.0), 10.0);
  for (const std::int64_t expected : {0, 10, 20, 35, 45}) {
    repair.Push(std::nullopt);
    EXPECT_EQ(repair.Pop(), expected);
  }
}

TEST(TimestampRepair, DecodingTimesFillGapsLeftByDesign) {
  // B-frames in a container that leaves out some times of the others, as MPEG program streams do.
  std::vector<TimestampPlan::Packet> packets;
  for (int group = 0; group < 10; ++group) {
    const std::int64_t dts = 30 * group;
    const Stamp reference = group % 2 == 0 ? Stamp(dts + 40) : Stamp();
    packets.push_back({reference, dts + 10});
    packets.push_back({dts + 20, dts + 20});
    packets.push_back({dts + 30, dts + 30});
  }
  const TimestampPlan plan(packets, 10.0);
  EXPECT_FALSE(plan.is_damaged());
  EXPECT_TRUE(plan.is_constant_rate());
  TimestampRepair repair(plan, 10.0);
  std::vector<std::int64_t> times;
  for (int group = 0; group < 10; ++group) {
    const std::int64_t dts = 30 * group;
    repair.Push(dts + 20);
    repair.Push(dts + 30);
    repair.Push(group % 2 == 0 ? Stamp(dts + 40) : Stamp());
  }
  repair.Finish();
  while (const Stamp time = repair.Pop()) {
    times.push_back(*time);
  }
  EXPECT_THAT(times, ElementsAreArray(Values(Steady(30, 10, 20))));
}

TEST(TimestampRepair, AllStampsEqual) {
  const std::vector<Stamp> frames(12, 700);
  EXPECT_THAT(Repair(frames, frames, 5.0),
              ElementsAre(700, 705, 710, 715, 720, 725, 730, 735, 740, 745, 750, 755));
}

TEST(TimestampRepair, ExtremeStampsDoNotOverflow) {
  constexpr std::int64_t kMin = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();
  const std::vector<Stamp> frames = {kMin, kMax, 0, kMax, kMin + 1, 10, 20, kMax - 1};
  Repair(frames, frames);
  Repair({kMin}, {kMax});
  Repair({}, {kMin, kMax, 5, 5, 4});
}

TEST(TimestampRepair, MoreFramesThanPacketsStayInOrder) {
  const std::vector<Stamp> packets = Steady(10, 10);
  std::vector<Stamp> frames = Steady(10, 10);
  frames.insert(frames.begin() + 5, std::nullopt);
  frames.emplace_back(std::nullopt);
  const std::vector<std::int64_t> times = Repair(packets, frames);
  EXPECT_EQ(times[4], 40);
  EXPECT_EQ(times[10], 90) << "a surplus frame moves none of the others";
}

// Any mixture of damage: the checks inside Repair() must hold.
TEST(TimestampRepair, SurvivesRandomDamage) {
  std::mt19937 random(7);
  const auto below = [&random](std::uint32_t limit) { return static_cast<int>(random() % limit); };
  for (int run = 0; run < 2000; ++run) {
    std::vector<Stamp> packets = Steady(1 + below(60), 1 + below(40));
    for (Stamp& stamp : packets) {
      if (below(8) == 0) {
        stamp = below(2) == 0 ? Stamp() : Stamp(below(500));
      }
    }
    std::vector<Stamp> frames;
    for (const Stamp& stamp : packets) {
      const int fate = below(20);
      if (fate != 0) {
        frames.push_back(fate == 1 ? Stamp() : stamp);
      }
      if (fate == 2) {
        frames.push_back(stamp);
      }
      if (fate == 3 && frames.size() > 1) {
        std::swap(frames.back(), frames[frames.size() - 2]);
      }
    }
    Repair(packets, frames, 1.0 + below(50));
  }
}

TEST(TimestampRepair, WithoutAPlanKeepsWhatIncreases) {
  const std::vector<Stamp> frames = {5, 15, 15, 12, 45, std::nullopt, 70};
  EXPECT_THAT(Repair({}, frames), ElementsAre(5, 15, 25, 35, 45, 55, 70));
}

TEST(TimestampPlan, TellsConstantFromVariableRate) {
  const auto plan = [](const std::vector<Stamp>& stamps) {
    std::vector<TimestampPlan::Packet> packets;
    for (const Stamp& pts : stamps) {
      packets.push_back({pts, std::nullopt});
    }
    return TimestampPlan(packets, 1.0);
  };
  EXPECT_TRUE(plan(Steady(50, 3003)).is_constant_rate());
  EXPECT_FALSE(plan(Steady(50, 3003)).is_damaged());
  std::vector<Stamp> rounded;  // 29.97 frames per second in milliseconds
  for (int k = 0; k < 50; ++k) {
    rounded.emplace_back((k * 1001 + 15) / 30);
  }
  EXPECT_TRUE(plan(rounded).is_constant_rate());
  std::vector<Stamp> variable = Steady(50, 3003);
  variable[20] = *variable[20] + 900;
  EXPECT_FALSE(plan(variable).is_constant_rate());
  EXPECT_FALSE(plan(variable).is_damaged());
}

}  // namespace
}  // namespace rsstab::media
