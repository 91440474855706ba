// SPDX-License-Identifier: Apache-2.0
#include "evaluation/synthetic_protocol.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <stdexcept>

#include "evaluation/score_summary.h"
#include "evaluation/synthetic_sample.h"
#include "igf/base/whole_file.h"
#include "stabilizer/metrics/field_metrics.h"
#include "tests/evaluation/test_methods.h"
#include "tests/evaluation/test_photos.h"
#include "tests/support/test_paths.h"

namespace rsstab::evaluation {
namespace {

using rsstab::testing::MakePhoto;
using rsstab::testing::ToldMethod;
using rsstab::testing::Waves;
using rsstab::testing::WritePhoto;
using ::testing::HasSubstr;

Result<MethodSet> TruthAndZero() {
  MethodSet set;
  set.methods.push_back(std::make_unique<NoCorrection>());
  set.methods.push_back(std::make_unique<ToldMethod>("zero", 0.0));
  set.methods.push_back(std::make_unique<ToldMethod>("truth", 1.0));
  set.sampler = std::make_unique<ToldMethod>("sampler", 1.0, 16, 0.01);
  set.skew = std::make_unique<ToldMethod>("skew", 1.0);
  return set;
}

class SyntheticProtocolTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new rsstab::testing::TemporaryFolder();
    for (int i = 0; i < 3; ++i) {
      WritePhoto(*folder_ / ("photo" + std::to_string(i) + ".png"),
                 MakePhoto(200, 150, [i](int x, int y) { return Waves(x, y, i); }));
    }
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  static std::vector<std::filesystem::path> Photos(int count) {
    auto photos = ListPhotos(folder_->path()).value();
    photos.resize(static_cast<std::size_t>(count));
    return photos;
  }

  static rsstab::testing::TemporaryFolder* folder_;
};

rsstab::testing::TemporaryFolder* SyntheticProtocolTest::folder_ = nullptr;

constexpr double kRounding_px = 1e-9;  // K K^-1 is not quite the identity

TEST_F(SyntheticProtocolTest, TheTruthScoresFullAndZeroLikeNoCorrection) {
  const auto records = RunSyntheticProtocol(Photos(1), {}, TruthAndZero);
  ASSERT_TRUE(records) << records.error().message;
  ASSERT_EQ(records->samples.size(), 5U);
  for (const SampleRecord& sample : records->samples) {
    const MethodScore& none = sample.methods[0];
    const MethodScore& zero = sample.methods[1];
    const MethodScore& truth = sample.methods[2];
    EXPECT_NEAR(zero.epe_px, none.epe_px, kRounding_px);
    EXPECT_NEAR(zero.horizontal_px, none.horizontal_px, kRounding_px);
    EXPECT_EQ(zero.psnr_db, none.psnr_db);
    EXPECT_EQ(zero.ssim, none.ssim);
    EXPECT_EQ(truth.epe_px, 0.0);
    if (sample.motion_class == MotionClass::kStill) {
      EXPECT_NEAR(none.epe_px, 0.0, kRounding_px);
      continue;
    }
    EXPECT_GT(none.epe_px, 5.9);
    // Noise of 2 levels is 42 dB; resampling halves it or so, and loses a little sharpness.
    EXPECT_GT(truth.psnr_db, 40.0) << MotionClassName(sample.motion_class);
    EXPECT_GT(truth.psnr_db, none.psnr_db + 8.0);
    EXPECT_GT(truth.ssim, none.ssim);
    EXPECT_GT(truth.valid_share, 0.9);
  }
}

TEST_F(SyntheticProtocolTest, SpreadIsJudgedPerAxis) {
  SyntheticOptions options;
  const auto records = RunSyntheticProtocol(Photos(2), options, TruthAndZero);
  ASSERT_TRUE(records) << records.error().message;
  for (const SampleRecord& sample : records->samples) {
    ASSERT_TRUE(sample.coverage);
    for (const Coverage& axis : *sample.coverage) {
      EXPECT_EQ(axis.total, 20);
      EXPECT_EQ(axis.Share(), 1.0);  // spread about the truth itself
    }
  }
}

TEST_F(SyntheticProtocolTest, FiguresDoNotDependOnTheNumberOfJobs) {
  SyntheticOptions options;
  options.linearity_photos = 1;
  options.structured = {"photo1.png"};
  const auto alone = RunSyntheticProtocol(Photos(3), options, TruthAndZero);
  options.jobs = 3;
  const auto together = RunSyntheticProtocol(Photos(3), options, TruthAndZero);
  ASSERT_TRUE(alone && together);
  ASSERT_EQ(alone->samples.size(), together->samples.size());
  for (std::size_t i = 0; i < alone->samples.size(); ++i) {
    const SampleRecord& a = alone->samples[i];
    const SampleRecord& b = together->samples[i];
    EXPECT_EQ(a.photo, b.photo);
    EXPECT_EQ(a.structured, a.photo == "photo1.png");
    EXPECT_EQ(a.focal_widths, b.focal_widths);
    for (std::size_t m = 0; m < a.methods.size(); ++m) {
      EXPECT_EQ(a.methods[m].epe_px, b.methods[m].epe_px);
      EXPECT_EQ(a.methods[m].psnr_db, b.methods[m].psnr_db);
      EXPECT_EQ(a.methods[m].ssim, b.methods[m].ssim);
    }
  }
  ASSERT_EQ(alone->skews.size(), 1U);
  ASSERT_EQ(together->skews.size(), 1U);
  for (std::size_t k = 0; k < alone->skews[0].size(); ++k) {
    EXPECT_EQ(alone->skews[0][k].predicted_px, together->skews[0][k].predicted_px);
  }
}

TEST_F(SyntheticProtocolTest, AMotionDoesNotDependOnTheOtherPhotos) {
  const auto all = RunSyntheticProtocol(Photos(2), {}, TruthAndZero);
  const std::vector<std::filesystem::path> second = {Photos(2)[1]};
  const auto alone = RunSyntheticProtocol(second, {}, TruthAndZero);
  ASSERT_TRUE(all && alone);
  EXPECT_EQ(all->samples[5].methods[0].epe_px, alone->samples[0].methods[0].epe_px);
}

TEST_F(SyntheticProtocolTest, BrokenPhotosAreNamedAndLeftOut) {
  const rsstab::testing::TemporaryFolder folder;
  ASSERT_TRUE(WriteWholeFile((folder / "a_broken.jpg").string(), "no picture"));
  std::filesystem::copy(Photos(1)[0], folder / "b_good.png");
  const auto photos = ListPhotos(folder.path()).value();
  ASSERT_EQ(photos.size(), 2U);
  const auto records = RunSyntheticProtocol(photos, {}, TruthAndZero);
  ASSERT_TRUE(records) << records.error().message;
  EXPECT_EQ(records->samples.size(), 5U);
  ASSERT_EQ(records->failures.size(), 1U);
  EXPECT_EQ(records->failures[0].first, "a_broken.jpg");
  EXPECT_THAT(records->failures[0].second.message, HasSubstr("a_broken.jpg"));

  const std::vector<std::filesystem::path> broken = {folder / "a_broken.jpg"};
  const auto none_left = RunSyntheticProtocol(broken, {}, TruthAndZero);
  ASSERT_FALSE(none_left);
  EXPECT_EQ(none_left.error().code, ErrorCode::kCorruptData);
}

TEST_F(SyntheticProtocolTest, AnInspectionIsOfTheSamePicture) {
  const auto photos = Photos(1);
  const auto records = RunSyntheticProtocol(photos, {}, TruthAndZero);
  ASSERT_TRUE(records) << records.error().message;
  MethodSet methods = TruthAndZero().value();
  const auto inspection = InspectSyntheticSample(photos[0], MotionClass::kOscillation,
                                                 SyntheticOptions().seed, methods);
  ASSERT_TRUE(inspection) << inspection.error().message;
  ASSERT_EQ(inspection->answers.size(), 3U);
  const auto oscillation = std::find_if(
      records->samples.begin(), records->samples.end(),
      [](const SampleRecord& r) { return r.motion_class == MotionClass::kOscillation; });
  const LabelledPicture& picture = inspection->picture;
  for (std::size_t m = 0; m < 3; ++m) {
    const auto error = stabilizer::CompareFields(PixelDisplacements(inspection->answers[m].field),
                                                 picture.truth, picture.valid);
    ASSERT_TRUE(error);
    EXPECT_EQ(error->length, oscillation->methods[m].epe_px);
  }
}

// Does not find its way in any picture.
class UnsureMethod final : public MotionMethod {
 public:
  [[nodiscard]] std::string Name() const override { return "unsure"; }
  [[nodiscard]] Result<MethodAnswer> Estimate(const MethodInput& /*input*/) override {
    return Fail(ErrorCode::kUntrustworthy, "there are no lines");
  }
};

TEST_F(SyntheticProtocolTest, WhereAMethodDoesNotTellThePictureStaysAndIsCounted) {
  const auto records = RunSyntheticProtocol(Photos(1), {}, []() -> Result<MethodSet> {
    MethodSet set;
    set.methods.push_back(std::make_unique<NoCorrection>());
    set.methods.push_back(std::make_unique<UnsureMethod>());
    return set;
  });
  ASSERT_TRUE(records) << records.error().message;
  for (const SampleRecord& sample : records->samples) {
    EXPECT_TRUE(sample.methods[1].declined);
    EXPECT_EQ(sample.methods[1].epe_px, sample.methods[0].epe_px);
  }
  const auto groups = SummariseSamples(records->samples, 1);
  EXPECT_EQ(groups[0].methods[0].declined, 0U);
  EXPECT_EQ(groups[0].methods[1].declined, groups[0].pictures);
}

TEST_F(SyntheticProtocolTest, StopsWhenAsked) {
  std::int64_t seen = 0;
  const auto records =
      RunSyntheticProtocol(Photos(3), {}, TruthAndZero, [&](std::int64_t done, std::int64_t items) {
        seen = done;
        EXPECT_EQ(items, 3);
        return false;
      });
  ASSERT_FALSE(records);
  EXPECT_EQ(records.error().code, ErrorCode::kCancelled);
  EXPECT_EQ(seen, 1);
}

TEST(ForEachItem, WhatIsThrownEndsItsItemOnly) {
  std::vector<int> done(4, 0);
  std::vector<std::string> errors(4);
  const Status status = ForEachItem(
      4, 2, TruthAndZero,
      [&](int index, MethodSet&) -> Status {
        if (index == 1) {
          throw std::runtime_error("too much");
        }
        done[static_cast<std::size_t>(index)] = 1;
        return {};
      },
      [&](int index, const Error& error) {
        errors[static_cast<std::size_t>(index)] = error.message;
      });
  EXPECT_TRUE(status);
  EXPECT_EQ(done, (std::vector<int>{1, 0, 1, 1}));
  EXPECT_EQ(errors[1], "too much");
}

TEST(ForEachItem, WithoutMethodsThereIsNoWork) {
  const Status status = ForEachItem(
      4, 2, []() -> Result<MethodSet> { return Fail(ErrorCode::kNotFound, "no model"); },
      [](int, MethodSet&) -> Status {
        ADD_FAILURE();
        return {};
      },
      [](int, const Error&) {});
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace rsstab::evaluation
