// SPDX-License-Identifier: Apache-2.0
#include "cli/pages/picture_exhibits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/pages/evaluation_tables.h"

namespace rsstab::cli {
namespace {

using evaluation::MethodFigures;
using evaluation::PictureRecord;
using ::testing::HasSubstr;

// Untouched pictures are 4 px wrong; "gyro" leaves 0.1 px; "diffusion" leaves `errors`.
PictureReport Report(const std::vector<double>& errors) {
  PictureReport report;
  report.protocol = "rs-real";
  for (std::size_t i = 0; i < errors.size(); ++i) {
    PictureRecord record;
    record.name = record.clip = "picture " + std::to_string(i);
    for (const auto& [name, error] : std::vector<std::pair<std::string, double>>{
             {"none", 4.0}, {"gyro", 0.1}, {"diffusion", errors[i]}}) {
      MethodFigures figures;
      figures.method = name;
      figures.epe_px = error;
      figures.psnr_db = 30.0 - error;
      figures.moved_px = name == "none" ? 0.0 : 1.0;
      record.methods.push_back(figures);
    }
    report.records.push_back(record);
  }
  report.groups = evaluation::SummarisePictures(report.records, 1);
  return report;
}

TEST(ShownMethod, PrefersWhatEstimates) {
  EXPECT_EQ(ShownMethod(Report({3.0, 2.0})), 2U);
  PictureReport told_only = Report({3.0, 2.0});
  for (PictureRecord& record : told_only.records) {
    record.methods.pop_back();
  }
  told_only.groups = evaluation::SummarisePictures(told_only.records, 1);
  EXPECT_EQ(ShownMethod(told_only), 1U);
}

TEST(ChoosePictures, ShowsMostAverageAndLeastGain) {
  const auto chosen = ChoosePictures(Report({3.0, 0.5, 5.0, 2.0, 3.5}), 2);
  ASSERT_EQ(chosen.size(), 3U);
  EXPECT_EQ(chosen[0].record, 1U);  // gains 3.5 px
  EXPECT_EQ(chosen[1].record, 0U);  // 1 px: the median
  EXPECT_EQ(chosen[2].record, 2U);  // loses 1 px: failures are shown, too
}

TEST(ChoosePictures, FewPictures) {
  EXPECT_EQ(ChoosePictures(Report({3.0}), 2).size(), 1U);
  EXPECT_EQ(ChoosePictures(Report({3.0, 2.0}), 2).size(), 2U);
}

TEST(FigureTables, MarkTheBestOfEachColumn) {
  const auto tables = FigureTables(Report({3.0, 2.0}));
  ASSERT_FALSE(tables.empty());
  const report::Table& table = tables.front();
  const auto column = static_cast<std::size_t>(
      std::find(table.headings.begin(), table.headings.end(), "EPE, px") - table.headings.begin());
  ASSERT_LT(column, table.headings.size());
  ASSERT_EQ(table.rows.size(), 3U);
  EXPECT_EQ(table.rows[1][0].text, "gyro");
  EXPECT_EQ(table.rows[1][column].text, "0.10");
  EXPECT_TRUE(table.rows[1][column].best);
  EXPECT_FALSE(table.rows[2][column].best);
}

TEST(FigureTables, LeaveOutWhatCouldNotBeAsked) {
  PictureReport report = Report({3.0, 2.0});
  for (PictureRecord& record : report.records) {
    record.methods[2] = MethodFigures();
    record.methods[2].method = "rotation-spline";
  }
  report.groups = evaluation::SummarisePictures(report.records, 1);
  EXPECT_EQ(FigureTables(report).front().rows.size(), 2U);
  EXPECT_THAT(NotAskedText(report), HasSubstr(": rotation-spline."));
  EXPECT_EQ(NotAskedText(Report({3.0})), "");
}

TEST(ErrorCharts, AreCumulative) {
  const auto charts = ErrorCharts(Report({3.0, 1.0}));
  ASSERT_EQ(charts.size(), 1U);
  const auto& points = charts[0].series.at(2).points;
  ASSERT_EQ(points.size(), 4U);
  EXPECT_EQ(points[0], Eigen::Vector2d(0, 0));
  EXPECT_EQ(points[1], Eigen::Vector2d(1, 50));
  EXPECT_EQ(points[2], Eigen::Vector2d(3, 100));
  EXPECT_EQ(points[3], Eigen::Vector2d(4, 100));  // as far as the worst method
}

}  // namespace
}  // namespace rsstab::cli
