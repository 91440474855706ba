// SPDX-License-Identifier: Apache-2.0
#include "cli/pages/clip_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "cli/pages/clip_charts.h"
#include "igf/base/readout_motion.h"
#include "igf/base/rotation.h"

namespace rsstab::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kWidth = 1280;
constexpr int kHeight = 720;
constexpr double kFocal = 4000.0;
constexpr double kToReference = 640.0 / kWidth;

// The field of a camera that turned by `rotation` while a frame was read out.
MotionField FieldOf(const Eigen::Vector3d& rotation) {
  const Camera camera = Camera::Pinhole(kWidth, kHeight, kFocal);
  std::vector<Eigen::Quaterniond> rows;
  for (int i = 0; i < 33; ++i) {
    // camera_from_world turns against the camera.
    rows.push_back(ExpSo3<double>(-(i / 32.0 - 0.5) * rotation));
  }
  return *ComputeReadoutField(camera, *ReadoutMotion::Create(camera, rows));
}

// The displacement grows with (x/f)^2 towards the borders: 2.6 % there, 0.9 % on average.
constexpr double kPerspective = 0.02;

TEST(DescribeField, TellsWhichWayTheCameraTurned) {
  constexpr double kTurn = 0.01;
  const double shift = kTurn * kFocal * kToReference;
  // To the right (a positive turn about y): the picture moves left, so later rows see things
  // further left.
  const RsMoment yaw = DescribeField(FieldOf({0, kTurn, 0}), 1.5, 0.9);
  EXPECT_NEAR(yaw.sideways_px, -shift, kPerspective * shift);
  EXPECT_NEAR(yaw.upright_px, 0.0, kPerspective * shift);
  EXPECT_EQ(yaw.time_s, 1.5);
  EXPECT_EQ(yaw.kept_ratio, 0.9);
  // Upwards (a positive turn about x): later rows see things further down.
  const RsMoment pitch = DescribeField(FieldOf({kTurn, 0, 0}), 0, 1);
  EXPECT_NEAR(pitch.upright_px, shift, kPerspective * shift);
  // Clockwise: later rows see things turned back.
  const RsMoment roll = DescribeField(FieldOf({0, 0, kTurn}), 0, 1);
  EXPECT_NEAR(roll.turn_deg, -kTurn * 180.0 / M_PI, kPerspective * kTurn * 180.0 / M_PI);
}

TEST(DescribeField, NoFieldIsNoMotion) {
  const RsMoment moment = DescribeField(MotionField(), 0, 1);
  EXPECT_EQ(moment.sideways_px, 0.0);
  EXPECT_EQ(moment.turn_deg, 0.0);
}

ClipPage Page() {
  ClipPage page;
  page.kind = "test";
  const char* const evil = "<script>alert(1)</script>.mp4";
  page.figures.input.path = evil;
  page.figures.output.path = evil;
  page.figures.input.frames_per_second = page.figures.output.frames_per_second = 30.0;
  page.figures.input.poses = page.figures.output.poses = {{}, {{3, 4}, 0.1, 1.1}};
  page.figures.input.metrics.shake = 4.0;
  page.figures.output.metrics.shake = 0.5;
  page.facts = {{"Input", evil}};
  page.command = evil;
  page.stages = {{"look", 1.0}, {"render", 2.0}};
  return page;
}

TEST(MakeClipPage, HoldsWhatIsThereAndLeavesOutTheRest) {
  const auto html = MakeClipPage(Page());
  ASSERT_TRUE(html) << html.error().message;
  EXPECT_THAT(*html, HasSubstr("Camera path"));
  EXPECT_THAT(*html, HasSubstr("<span class=\"was\">4.00</span>"));
  EXPECT_THAT(*html, HasSubstr("render"));
  EXPECT_THAT(*html, Not(HasSubstr("Before and after")));
  EXPECT_THAT(*html, Not(HasSubstr("Against the truth")));
  EXPECT_THAT(*html, Not(HasSubstr("Motion within the frames")));
  EXPECT_THAT(*html, Not(HasSubstr("crop ratio")));  // nobody measured it
}

TEST(MakeClipPage, EscapesNames) {
  const auto html = MakeClipPage(Page());
  ASSERT_TRUE(html);
  EXPECT_THAT(*html, Not(HasSubstr("<script>alert")));
  EXPECT_THAT(*html, HasSubstr("&lt;script&gt;alert(1)&lt;/script&gt;.mp4"));
}

std::vector<RsMoment> Moments() {
  std::vector<RsMoment> moments;
  for (const double skew : {4.0, -8.0, 0.0}) {
    RsMoment moment;
    moment.time_s = static_cast<double>(moments.size());
    moment.sideways_px = skew;
    moments.push_back(moment);
  }
  return moments;
}

// A readout that is longer by a tenth makes every motion within a frame longer by a tenth.
TEST(RsCharts, BandIsAsWideAsTheReadoutIsUncertain) {
  stabilizer::ClipAnalysis analysis;
  analysis.readout_s = -0.02;  // last row first
  analysis.readout_sigma_s = 0.002;
  const auto charts = RsCharts(Moments(), analysis);
  ASSERT_EQ(charts.size(), 4U);
  const auto& band = charts[0].band;
  ASSERT_TRUE(band);
  EXPECT_THAT(band->x, ::testing::ElementsAre(0.0, 1.0, 2.0));
  using ::testing::DoubleNear;
  constexpr double kExact = 1e-12;
  EXPECT_THAT(band->low, ::testing::ElementsAre(DoubleNear(3.6, kExact), DoubleNear(-8.8, kExact),
                                                DoubleNear(0.0, kExact)));
  EXPECT_THAT(band->high, ::testing::ElementsAre(DoubleNear(4.4, kExact), DoubleNear(-7.2, kExact),
                                                 DoubleNear(0.0, kExact)));
  EXPECT_TRUE(charts[1].band && charts[2].band);
  EXPECT_FALSE(charts[3].band);  // what is kept does not follow from it
}

TEST(RsCharts, AReadoutThatIsGivenHasNoBand) {
  stabilizer::ClipAnalysis analysis;
  analysis.readout_s = 0.02;
  EXPECT_FALSE(RsCharts(Moments(), analysis)[0].band);
  // Of single images there is no readout time to be uncertain of.
  analysis.readout_s = 0.0;
  analysis.readout_sigma_s = 0.002;
  EXPECT_FALSE(RsCharts(Moments(), analysis)[0].band);
}

TEST(MakeClipPage, StatesTheReadoutWithItsUncertainty) {
  ClipPage page = Page();
  page.moments = Moments();
  page.analysis.emplace();
  page.analysis->readout_s = 0.0173;
  page.analysis->readout_sigma_s = 0.0007;
  const auto html = MakeClipPage(page);
  ASSERT_TRUE(html);
  EXPECT_THAT(*html, HasSubstr("17.3 \u00b1 0.7 ms, first row to last"));
  EXPECT_THAT(*html, HasSubstr("\u00b1 1 standard deviation of the readout: 0.32 px at most"));
  EXPECT_THAT(*html, HasSubstr("class=\"band\""));
}

TEST(PathCharts, AreInSecondsPixelsDegreesAndPercent) {
  const auto charts = PathCharts(Page().figures);
  ASSERT_EQ(charts.size(), 4U);
  const double values[] = {3.0, 4.0, 0.1 * 180.0 / M_PI, 110.0};
  for (std::size_t i = 0; i < 4; ++i) {
    ASSERT_EQ(charts[i].series.size(), 2U);
    EXPECT_NEAR(charts[i].series[0].points[1].x(), 1.0 / 30.0, 1e-12);
    EXPECT_NEAR(charts[i].series[0].points[1].y(), values[i], 1e-9) << charts[i].title;
  }
}

}  // namespace
}  // namespace rsstab::cli
