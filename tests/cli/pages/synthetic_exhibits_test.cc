// SPDX-License-Identifier: Apache-2.0
#include "cli/pages/synthetic_exhibits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "cli/pages/evaluation_page.h"
#include "tests/evaluation/test_methods.h"
#include "tests/evaluation/test_photos.h"
#include "tests/support/test_paths.h"

namespace rsstab::cli {
namespace {

using evaluation::MethodScore;
using evaluation::MotionClass;
using evaluation::SampleRecord;
using rsstab::testing::MakePhoto;
using rsstab::testing::TemporaryFolder;
using rsstab::testing::ToldMethod;
using rsstab::testing::Waves;
using rsstab::testing::WritePhoto;
using ::testing::HasSubstr;

// Moving pictures are 8 px wrong as recorded; "mean" leaves `moving`, and moves still ones by
// `still`.
SyntheticReport Report(const std::vector<double>& moving, const std::vector<double>& still) {
  SyntheticReport report;
  const auto add = [&](MotionClass motion_class, double before, double after) {
    SampleRecord record;
    record.photo = "photo";
    record.motion_class = motion_class;
    for (const auto& [name, error] :
         std::vector<std::pair<std::string, double>>{{"none", before}, {"mean", after}}) {
      MethodScore score;
      score.method = name;
      score.epe_px = error;
      record.methods.push_back(score);
    }
    report.samples.push_back(record);
  };
  for (const double error : moving) {
    add(MotionClass::kMixed, 8.0, error);
  }
  for (const double error : still) {
    add(MotionClass::kStill, 0.0, error);
  }
  report.groups = evaluation::SummariseSamples(report.samples, 1);
  return report;
}

TEST(SyntheticExhibits, MovingPicturesByGainAndTheWorstStillOne) {
  const SyntheticReport report = Report({7.0, 3.0, 9.0}, {0.2, 2.0, 1.0});
  EXPECT_EQ(ShownMethod(report), 1U);
  const auto chosen = ChoosePictures(report, 1);
  ASSERT_EQ(chosen.size(), 4U);
  EXPECT_EQ(chosen[0].record, 1U);  // gains 5 px
  EXPECT_EQ(chosen[1].record, 0U);
  EXPECT_EQ(chosen[2].record, 2U);  // loses 1 px
  EXPECT_EQ(chosen[3].record, 4U);
}

TEST(SyntheticExhibits, StillPicturesThatStayAreNotShown) {
  EXPECT_EQ(ChoosePictures(Report({7.0}, {0.2}), 1).size(), 1U);
}

TEST(SyntheticExhibits, ThePageShowsWhatTheMethodsMakeOfThem) {
  const TemporaryFolder folder;
  WritePhoto(folder / "a.png", MakePhoto(160, 120, [](int x, int y) { return Waves(x, y); }));
  const auto factory = []() -> Result<evaluation::MethodSet> {
    evaluation::MethodSet set;
    set.methods.push_back(std::make_unique<evaluation::NoCorrection>());
    set.methods.push_back(std::make_unique<ToldMethod>("half", 0.5));
    return set;
  };
  EvaluateOptions options;
  options.photos = folder.path().string();
  options.jobs = 1;
  options.linearity_photos = 0;
  const auto report = EvaluateSynthetic(options, factory, SilentLogger());
  ASSERT_TRUE(report) << report.error().message;
  const auto page = MakeEvaluationPage(*report, options, factory, {});
  ASSERT_TRUE(page) << page.error().message;
  EXPECT_THAT(*page, HasSubstr("where half gains most"));
  EXPECT_THAT(*page, HasSubstr("As recorded, and corrected by half"));
  EXPECT_THAT(*page, HasSubstr("Corrected by half, and the truth"));
  EXPECT_THAT(*page, HasSubstr("data:image/webp"));
}

}  // namespace
}  // namespace rsstab::cli
