// SPDX-License-Identifier: Apache-2.0
#include "cli/progress_reporter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

namespace rsstab::cli {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;

// A reporter with a clock and a screen of our own.
struct Fixture {
  double now_s = 100.0;
  std::string text;
  ProgressReporter reporter;

  explicit Fixture(ProgressStyle style, int columns = 80)
      : reporter({style, columns, [this](std::string_view t) { text += t; },
                  [this] { return now_s; }}) {}
};

TEST(ProgressReporter, BarTellsRateAndTimeLeftOfBothPasses) {
  Fixture f(ProgressStyle::kBar);
  f.reporter.BeginPass(1, 2, "analyze", 100);
  f.now_s += 5.0;
  f.reporter.Update(50);
  EXPECT_THAT(f.text, HasSubstr("[1/2] analyze"));
  EXPECT_THAT(f.text, HasSubstr("50/100  10.0 fps"));
  EXPECT_THAT(f.text, EndsWith("ETA 0:15"));  // 50 frames left here, 100 in the next pass
  EXPECT_THAT(f.text, HasSubstr("[=====")) << "half of it is filled";
}

TEST(ProgressReporter, BarFitsNarrowTerminalsAndIsErased) {
  for (const int columns : {5, 20, 40, 200}) {
    Fixture f(ProgressStyle::kBar, columns);
    f.reporter.BeginPass(2, 2, "render", 1000);
    f.now_s += 10.0;
    f.text.clear();
    f.reporter.Update(999);
    const std::size_t bar = f.text.size() - f.text.rfind('\r') - 1;
    EXPECT_LT(bar, static_cast<std::size_t>(columns));
    f.reporter.EndPass();
    EXPECT_THAT(f.text, EndsWith("\r" + std::string(bar, ' ') + "\r"));
  }
}

TEST(ProgressReporter, LogLinesStandAboveTheBar) {
  Fixture f(ProgressStyle::kBar);
  f.reporter.BeginPass(1, 1, "render", 10);
  const std::string bar = f.text;
  f.text.clear();
  f.reporter.WriteLine("a message\n");
  EXPECT_EQ(f.text, "\r" + std::string(bar.size(), ' ') + "\ra message\n" + bar);
}

TEST(ProgressReporter, PlainLinesAreFew) {
  Fixture f(ProgressStyle::kPlain);
  f.reporter.BeginPass(1, 1, "render", 1000);
  for (int frame = 1; frame <= 1000; ++frame) {
    f.now_s += 0.05;
    f.reporter.Update(frame);
  }
  f.reporter.EndPass();
  EXPECT_EQ(std::count(f.text.begin(), f.text.end(), '\n'), 10);
  EXPECT_THAT(f.text, HasSubstr("500 of 1000 frames (50 %), 20.0 fps, ETA 0:25\n"));
  EXPECT_THAT(f.text, EndsWith("1000 of 1000 frames (100 %), 20.0 fps\n"));
}

TEST(ProgressReporter, JsonIsOneObjectALine) {
  Fixture f(ProgressStyle::kJson);
  f.reporter.BeginPass(1, 2, "analyze", 0);
  f.now_s += 2.0;
  f.reporter.Update(30);
  f.reporter.EndPass();
  std::istringstream lines(f.text);
  std::vector<nlohmann::json> objects;
  for (std::string line; std::getline(lines, line);) {
    objects.push_back(nlohmann::json::parse(line));
  }
  ASSERT_EQ(objects.size(), 3U);
  EXPECT_TRUE(objects[1]["frames"].is_null()) << "unknown length";
  EXPECT_TRUE(objects[1]["eta_s"].is_null());
  EXPECT_EQ(objects[1]["frames_done"], 30);
  EXPECT_EQ(objects[1]["fps"], 15.0);
  EXPECT_EQ(objects[2]["event"], "pass_done");
  EXPECT_EQ(objects[2]["frames"], 30);
}

TEST(ProgressReporter, NoneIsSilent) {
  Fixture f(ProgressStyle::kNone);
  f.reporter.BeginPass(1, 1, "render", 10);
  f.now_s += 60.0;
  f.reporter.Update(10);
  f.reporter.EndPass();
  EXPECT_EQ(f.text, "");
}

}  // namespace
}  // namespace rsstab::cli
