// SPDX-License-Identifier: Apache-2.0
#include "cli/pages/clip_showcase.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "cli/commands/simulate.h"
#include "tests/support/test_paths.h"

namespace rsstab::cli {
namespace {

using rsstab::testing::TemporaryFolder;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

CompareReport::Clip Measured(std::vector<float> residuals) {
  CompareReport::Clip clip;
  clip.truth.emplace();
  clip.truth->frame_residual = std::move(residuals);
  return clip;
}

TEST(ChooseFrame, TakesTheOneFurthestFromTheTruth) {
  const ChosenFrame frame = ChooseFrame(Measured({0.5F, kNan, 2.25F, 1.0F}));
  EXPECT_EQ(frame.index, 2);
  EXPECT_THAT(frame.reason, HasSubstr("2.25 px"));
}

TEST(ChooseFrame, WithoutATruthTakesTheGreatestChangeOfMotion) {
  CompareReport::Clip clip;
  for (const double x : {0.0, 10.0, 20.0, 30.0, 43.0, 56.0}) {  // a fast pan that gets faster
    clip.poses.emplace_back();
    clip.poses.back().position = {x, 0.0};
  }
  const ChosenFrame frame = ChooseFrame(clip);
  EXPECT_EQ(frame.index, 4);
  EXPECT_THAT(frame.reason, HasSubstr("3.0 px"));
  // A truth that nothing could be compared with is none.
  clip.truth.emplace();
  clip.truth->frame_residual = {kNan, kNan, kNan};
  EXPECT_EQ(ChooseFrame(clip).index, 4);
}

TEST(ChooseFrame, TakesTheFirstOfAClipThatStandsStill) {
  EXPECT_EQ(ChooseFrame({}).index, 0);
  EXPECT_EQ(ChooseFrame(Measured({})).index, 0);
}

class ClipShowcaseTest : public ::testing::Test {
 protected:
  void SetUp() override {
    SimulateOptions options;
    options.output = (folder_ / "clip").string();
    options.motion = igf::MotionPreset::kVibration;
    options.readout_s = 0.03;
    options.width = 320;
    options.height = 180;
    options.duration_s = 4 / options.fps;
    const Status status = RunSimulate(options, SilentLogger());
    ASSERT_TRUE(status) << status.error().message;
  }
  [[nodiscard]] std::string File(const char* name) const {
    return (folder_ / "clip" / name).string();
  }

  TemporaryFolder folder_;
  const CompareReport::Clip measured_ = Measured({0.1F, 0.2F, 1.5F});
  const Camera camera_ = Camera::Pinhole(320, 180, 277.0);
};

TEST_F(ClipShowcaseTest, ShowsMethodsTruthAndMaps) {
  auto showcase = ClipShowcase::Create(measured_, File("gs.mp4"), camera_);
  ASSERT_TRUE(showcase) << showcase.error().message;
  ASSERT_TRUE(showcase->Add("input", File("rs.mp4"), measured_));
  ASSERT_TRUE(showcase->Add("perfect", File("gs.mp4"), {}));
  EXPECT_EQ(showcase->frame().index, 2);
  ASSERT_EQ(showcase->pictures().size(), 2U);
  ASSERT_EQ(showcase->maps().size(), 2U);
  EXPECT_EQ(showcase->maps()[0].note, "1.50 px");
  EXPECT_EQ(showcase->maps()[1].note, "");
  EXPECT_EQ(showcase->pictures()[0].width, 320);
  // Nothing differs from the truth in the truth, and a black picture takes little room.
  EXPECT_LT(showcase->maps()[1].uri.size(), showcase->maps()[0].uri.size() / 2);

  report::HtmlPage html("test", "test", "");
  ASSERT_TRUE(showcase->Show(html));
  const std::string page = html.Finish("");
  EXPECT_THAT(page, HasSubstr("<b>truth</b>"));
  EXPECT_THAT(page, HasSubstr("key of the colours"));
}

TEST_F(ClipShowcaseTest, WithoutATruthThereAreNoMaps) {
  auto showcase = ClipShowcase::Create(measured_, "", std::nullopt);
  ASSERT_TRUE(showcase);
  ASSERT_TRUE(showcase->Add("input", File("rs.mp4"), measured_));
  EXPECT_EQ(showcase->pictures().size(), 1U);
  EXPECT_TRUE(showcase->maps().empty());
  report::HtmlPage html("test", "test", "");
  ASSERT_TRUE(showcase->Show(html));
  EXPECT_THAT(html.Finish(""), Not(HasSubstr("truth")));
}

TEST_F(ClipShowcaseTest, AClipThatEndsBeforeIsAnError) {
  auto showcase = ClipShowcase::Create(Measured({0, 0, 0, 0, 0, 0, 1}), "", std::nullopt);
  ASSERT_TRUE(showcase);
  const Status added = showcase->Add("short", File("rs.mp4"), {});
  ASSERT_FALSE(added);
  EXPECT_THAT(added.error().message, HasSubstr("ends before frame 6"));
  EXPECT_FALSE(ClipShowcase::Create(measured_, File("nowhere.mp4"), camera_));
}

}  // namespace
}  // namespace rsstab::cli
