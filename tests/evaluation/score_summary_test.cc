// SPDX-License-Identifier: Apache-2.0
#include "evaluation/score_summary.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rsstab::evaluation {
namespace {

constexpr double kExact = 1e-12;

SampleRecord Record(std::size_t photo, MotionClass motion_class, bool structured, double before,
                    double after) {
  SampleRecord record;
  record.photo = "photo";
  record.photo_index = photo;
  record.motion_class = motion_class;
  record.structured = structured;
  MethodScore none;
  none.method = "none";
  none.epe_px = before;
  none.horizontal_px = before / 2.0;
  none.vertical_px = 0.5;
  none.psnr_db = 20.0;
  MethodScore method = none;
  method.method = "method";
  method.epe_px = after;
  method.horizontal_px = after / 4.0;
  method.psnr_db = 25.0;
  record.methods = {none, method};
  record.coverage = AxisCoverage{Coverage{1, 2}, Coverage{2, 2}, Coverage{0, 2}};
  return record;
}

std::vector<SampleRecord> Records() {
  return {Record(0, MotionClass::kSkewTwist, true, 8.0, 4.0),
          Record(0, MotionClass::kStretch, true, 6.0, 7.0),
          Record(0, MotionClass::kStill, true, 0.0, 0.5),
          Record(1, MotionClass::kSkewTwist, false, 10.0, 8.0),
          Record(1, MotionClass::kStretch, false, 6.0, 5.0),
          Record(1, MotionClass::kStill, false, 0.0, 1.5)};
}

const GroupSummary* Find(const std::vector<GroupSummary>& groups, const std::string& motion,
                         bool structured) {
  for (const GroupSummary& group : groups) {
    if (group.motion == motion && group.structured_only == structured) {
      return &group;
    }
  }
  return nullptr;
}

TEST(ScoreSummary, GroupsAreByClassAndPhotos) {
  const auto groups = SummariseSamples(Records(), 1);
  ASSERT_EQ(groups.size(), 8U);
  EXPECT_EQ(Find(groups, "skew-twist", false)->pictures, 2U);
  EXPECT_EQ(Find(groups, "skew-twist", true)->pictures, 1U);
  EXPECT_EQ(Find(groups, "all", false)->pictures, 4U);  // still frames stay apart
  EXPECT_EQ(Find(groups, "still", false)->pictures, 2U);
  EXPECT_EQ(Find(groups, "oscillation", false), nullptr);
}

TEST(ScoreSummary, FiguresAreMeansAndTheirRatios) {
  const auto groups = SummariseSamples(Records(), 1);
  const MethodSummary& none = Find(groups, "skew-twist", false)->methods[0];
  const MethodSummary& method = Find(groups, "skew-twist", false)->methods[1];
  EXPECT_NEAR(method.epe_px, 6.0, kExact);
  EXPECT_NEAR(method.epe_median_px, 6.0, kExact);
  EXPECT_NEAR(method.epe_p90_px, 7.6, kExact);
  EXPECT_NEAR(method.epe_ratio, 12.0 / 18.0, kExact);
  EXPECT_NEAR(method.horizontal_ratio, 1.0 / 3.0, kExact);
  EXPECT_TRUE(std::isnan(method.vertical_ratio));  // half a pixel of it
  EXPECT_NEAR(method.difference_px, -3.0, kExact);
  EXPECT_NEAR(method.difference_interval.low, -4.0, kExact);
  EXPECT_NEAR(method.difference_interval.high, -2.0, kExact);
  EXPECT_NEAR(method.psnr_db, 25.0, kExact);
  EXPECT_EQ(none.difference_px, 0.0);
  EXPECT_EQ(none.epe_ratio, 1.0);
  EXPECT_TRUE(std::isnan(Find(groups, "still", false)->methods[1].epe_ratio));
}

TEST(ScoreSummary, CoverageIsCountedTogether) {
  const auto groups = SummariseSamples(Records(), 1);
  const AxisCoverage& coverage = *Find(groups, "all", false)->coverage;
  EXPECT_EQ(coverage[0].total, 8);
  EXPECT_NEAR(coverage[0].Share(), 0.5, kExact);
  EXPECT_NEAR(coverage[1].Share(), 1.0, kExact);
  EXPECT_NEAR(coverage[2].Share(), 0.0, kExact);
}

}  // namespace
}  // namespace rsstab::evaluation
