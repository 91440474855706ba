// SPDX-License-Identifier: Apache-2.0
#include "evaluation/rs_field_score.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "igf/intra_gyro_field.h"
#include "igf/motion_presets.h"
#include "stabilizer/analysis_file.h"
#include "tests/support/test_paths.h"

namespace rsstab::evaluation {
namespace {

using rsstab::testing::TemporaryFolder;
using ::testing::HasSubstr;

constexpr int kFrames = 6;
constexpr int kWidth = 320;
constexpr int kHeight = 180;
constexpr double kReadoutS = 0.02;
// Fields are stored as 16-bit fractions, and judged between the vertices of two grids.
constexpr double kTolerancePx = 0.01;

igf::SimulationTruth VibratingCamera(double readout_s) {
  Camera camera = Camera::Pinhole(kWidth, kHeight, 0.9 * kWidth);
  camera.readout_s = readout_s;
  auto orientation = igf::MakePresetOrientation(igf::MotionPreset::kVibration, 3, 1.0);
  igf::SimulationTruth truth{camera, 0.0, 0.0, {}, orientation.value()};
  for (int n = 0; n < kFrames; ++n) {
    truth.frame_times_s.push_back(n / 30.0);
  }
  return truth;
}

// The exact field of a frame, times `share`; none at all for 0.
MotionField FieldOf(const igf::SimulationTruth& truth, int frame, float share) {
  if (share == 0.0F) {
    return {};
  }
  MotionField field =
      igf::ComputeIntraGyroField(truth.camera, truth.orientation,
                                 truth.frame_times_s[static_cast<std::size_t>(frame)],
                                 *truth.camera.readout_s)
          .value();
  for (Eigen::Vector2f& displacement : field.vertices()) {
    displacement *= share;
  }
  return field;
}

std::string WriteAnalysis(const TemporaryFolder& folder, const igf::SimulationTruth& truth,
                          float share, int frames = kFrames) {
  const std::string path = (folder / "analysis").string();
  auto writer = stabilizer::AnalysisWriter::Create(path).value();
  for (int n = 0; n < frames; ++n) {
    stabilizer::FrameAnalysis frame;
    frame.pts = n;
    frame.rs_field = FieldOf(truth, n, share);
    EXPECT_TRUE(writer->Append(frame));
  }
  stabilizer::ClipAnalysis clip;
  clip.width = kWidth;
  clip.height = kHeight;
  clip.frames_per_second = 30.0;
  EXPECT_TRUE(writer->Finish(clip));
  return path;
}

TEST(RsFieldScore, ErrorIsTheShareThatIsMissing) {
  const igf::SimulationTruth truth = VibratingCamera(kReadoutS);
  const TemporaryFolder folder;
  for (const float share : {1.0F, 0.5F, 0.0F, -1.0F}) {
    const auto score = ScoreRsFields(WriteAnalysis(folder, truth, share), &truth);
    ASSERT_TRUE(score) << score.error().message;
    EXPECT_EQ(score->frames, kFrames);
    ASSERT_GT(score->uncorrected_epe_px.value(), 0.5);  // the preset does shake
    EXPECT_NEAR(score->epe_px.value(), (1.0 - share) * *score->uncorrected_epe_px, kTolerancePx)
        << share;
  }
}

TEST(RsFieldScore, SizeOfTheFieldIsStatedAt640Px) {
  const igf::SimulationTruth truth = VibratingCamera(kReadoutS);
  const TemporaryFolder folder;
  double squares = 0.0;
  for (int n = 0; n < kFrames; ++n) {
    const double rms = FieldOf(truth, n, 1.0F).RmsLength() * 640.0 / kWidth;
    squares += rms * rms / kFrames;
  }
  const auto whole = ScoreRsFields(WriteAnalysis(folder, truth, 1.0F), nullptr);
  ASSERT_TRUE(whole);
  EXPECT_NEAR(whole->applied_px, std::sqrt(squares), kTolerancePx);
  EXPECT_FALSE(whole->epe_px);
  EXPECT_FALSE(whole->uncorrected_epe_px);
  EXPECT_EQ(ScoreRsFields(WriteAnalysis(folder, truth, 0.0F), nullptr)->applied_px, 0.0);
}

TEST(RsFieldScore, AGlobalShutterHasNothingToCorrect) {
  const igf::SimulationTruth twin = VibratingCamera(0.0);
  const TemporaryFolder folder;
  const auto untouched = ScoreRsFields(WriteAnalysis(folder, twin, 0.0F), &twin);
  ASSERT_TRUE(untouched);
  EXPECT_EQ(untouched->epe_px.value(), 0.0);
  EXPECT_EQ(untouched->uncorrected_epe_px.value(), 0.0);
  // What is done to it all the same is all error.
  const auto bent = ScoreRsFields(WriteAnalysis(folder, VibratingCamera(kReadoutS), 1.0F), &twin);
  ASSERT_TRUE(bent);
  EXPECT_GT(bent->epe_px.value(), 0.5);
}

TEST(RsFieldScore, TruthOfAnotherClipIsRefused) {
  const igf::SimulationTruth truth = VibratingCamera(kReadoutS);
  const TemporaryFolder folder;
  const auto score = ScoreRsFields(WriteAnalysis(folder, truth, 1.0F, kFrames - 1), &truth);
  ASSERT_FALSE(score);
  EXPECT_EQ(score.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(score.error().message, HasSubstr("5 frames were analysed"));
  EXPECT_FALSE(ScoreRsFields("/nonexistent/analysis", nullptr));
}

}  // namespace
}  // namespace rsstab::evaluation
