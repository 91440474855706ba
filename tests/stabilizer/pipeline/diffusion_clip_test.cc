// SPDX-License-Identifier: Apache-2.0
// --rs diffusion through pass 1: the pictures reach the model, its motion the analysis file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "stabilizer/analysis_file.h"
#include "stabilizer/pipeline/analyzer.h"
#include "tests/support/random_scene.h"
#include "tests/support/skew_model.h"
#include "tests/support/test_paths.h"

namespace rsstab::pipeline {
namespace {

using ::testing::HasSubstr;

constexpr int kWidth = 320;
constexpr int kHeight = 240;
constexpr int kFrames = 8;

Frame Picture(const testing::WaveScene& scene, int t) {
  Frame frame = *AllocateFrame(Yuv420Layout(), kWidth, kHeight);
  for (std::size_t p = 0; p < 3; ++p) {
    const MutablePlaneView& plane = frame.planes[p];
    for (int y = 0; y < plane.height; ++y) {
      for (int x = 0; x < plane.width; ++x) {
        const double level = p == 0 ? scene.At(Eigen::Vector2d(x + 0.5 * t, y)) : 128.0;
        plane.data[y * plane.stride + x] =
            static_cast<std::uint8_t>(std::lround(std::clamp(level, 20.0, 230.0)));
      }
    }
  }
  return frame;
}

StabilizeOptions Options() {
  StabilizeOptions options;
  options.rs = RsChoice::kDiffusion;
  options.model = testing::SkewModel().string();
  options.samples = 2;
  return options;
}

Result<stabilizer::ClipAnalysis> Analyze(const StabilizeOptions& options, const std::string& path) {
  auto analyzer =
      Analyzer::Create(options, {kWidth, kHeight, 25.0}, RsInputs{}, path, SilentLogger());
  if (!analyzer) {
    return Propagate(analyzer.error());
  }
  const testing::WaveScene scene(11);
  for (int t = 0; t < kFrames; ++t) {
    if (const Status ok = (*analyzer)->PushFrame(Picture(scene, t).View(), 40 * t, 0.04 * t); !ok) {
      return Propagate(ok.error());
    }
  }
  return (*analyzer)->Finish();
}

TEST(DiffusionClip, EveryFrameGetsTheFieldOfItsPicture) {
  const testing::TemporaryFolder folder;
  StabilizeOptions options = Options();
  options.focal_px = 400.0;
  options.rs_strength = 0.5;
  const auto clip = Analyze(options, folder / "analysis");
  ASSERT_TRUE(clip) << clip.error().message;
  EXPECT_EQ(clip->rs_source, "diffusion");
  EXPECT_THAT(clip->rs_reason, HasSubstr("model skew"));
  auto reader = stabilizer::AnalysisReader::Open(folder / "analysis");
  ASSERT_TRUE(reader);
  for (int t = 0; t < kFrames; ++t) {
    const auto frame = (*reader)->Next();
    ASSERT_TRUE(frame && *frame);
    const MotionField& field = (*frame)->rs_field;
    ASSERT_EQ(field.width(), kWidth);
    ASSERT_EQ(field.height(), kHeight);
    // Twice the field is the whole motion: the corrected pixel x lies at x + G(x).
    for (const Eigen::Vector2d& x : {Eigen::Vector2d(40, 30), Eigen::Vector2d(250, 200)}) {
      const Eigen::Vector2d recorded = x + 2.0 * field.Sample(x);
      const Eigen::Vector2d back = testing::UnskewedFromRecorded(recorded, kWidth, kHeight, 400.0);
      EXPECT_LT((back - x).norm(), 0.02) << t;  // the field is bilinear between its vertices
    }
  }
}

TEST(DiffusionClip, RefusalsSayWhatIsMissing) {
  const testing::TemporaryFolder folder;
  StabilizeOptions options = Options();
  options.model = folder / "no-such-model.json";
  const auto missing = Analyze(options, folder / "analysis");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(missing.error().message, HasSubstr("no-such-model.json"));
  EXPECT_FALSE(std::filesystem::exists(folder / "analysis"));
  options = Options();
  options.gyro_file = "log.csv";
  const Status both = Validate(options);
  ASSERT_FALSE(both);
  EXPECT_THAT(both.error().message, HasSubstr("--gyro log.csv"));
}

}  // namespace
}  // namespace rsstab::pipeline
