// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/motion_stage.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <random>

#include "igf/base/homography.h"
#include "igf/base/rotation.h"
#include "stabilizer/normalized_coordinates.h"

namespace rsstab::pipeline {
namespace {

constexpr int kWidth = 640;
constexpr int kHeight = 360;
constexpr int kFrames = 60;

// Frame n is skewed by this many px per row: every frame another way.
double Skew(std::int64_t frame) { return 0.02 * std::sin(2.4 * static_cast<double>(frame)); }

// A source that knows the skew.
class SkewSource final : public RsMotionSource {
 public:
  std::string Name() const override { return "skew"; }
  bool NeedsImage() const override { return false; }
  Result<RsMotion> EstimateMotion(const FrameContext& frame) override {
    if (frame.index == unknown_frame) {
      return Fail(ErrorCode::kUntrustworthy, "a gap in the log");
    }
    RsMotion motion;
    motion.field = MotionField(kWidth, kHeight, 2, 33);
    for (int r = 0; r < 33; ++r) {
      for (int c = 0; c < 2; ++c) {
        const double rows = motion.field.VertexPosition(c, r).y() - motion.field.reference_row();
        motion.field.At(c, r) = {static_cast<float>(Skew(frame.index) * rows), 0.0F};
      }
    }
    return motion;
  }

  std::int64_t unknown_frame = -1;
};

// Recorded = corrected + G(corrected); this skew moves no row, so G at the recorded row is the
// same.
Eigen::Vector2f Recorded(const Eigen::Vector2d& corrected, std::int64_t frame) {
  return Eigen::Vector2d(corrected.x() + Skew(frame) * (corrected.y() - (kHeight - 1) / 2.0),
                         corrected.y())
      .cast<float>();
}

std::vector<stabilizer::FrameAnalysis> AnalyzeSkewed(RsSelection& selection) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> x(10.0, kWidth - 10.0);
  std::uniform_real_distribution<double> y(10.0, kHeight - 10.0);
  auto stage = MotionStage::Create({}, {kWidth, kHeight, 30.0}, &selection, SilentLogger());
  EXPECT_TRUE(stage);
  std::vector<stabilizer::FrameAnalysis> result;
  for (int n = 0; n < kFrames; ++n) {
    FrameObservation o;
    o.pts = n;
    o.time_s = n / 30.0;
    o.tracks.width = kWidth;
    o.tracks.height = kHeight;
    if (n > 0) {
      for (int k = 0; k < 200; ++k) {
        const Eigen::Vector2d p(x(random), y(random));
        o.tracks.matches.push_back(
            {Recorded(p, n - 1), Recorded(p + Eigen::Vector2d(1.0, 0.0), n)});
      }
      o.attempted_points = 200;
    }
    EXPECT_TRUE((*stage)->Push(o));
    for (auto& f : (*stage)->TakeReady()) {
      result.push_back(std::move(f));
    }
  }
  EXPECT_TRUE((*stage)->Finish());
  for (auto& f : (*stage)->TakeReady()) {
    result.push_back(std::move(f));
  }
  EXPECT_EQ(result.size(), static_cast<std::size_t>(kFrames));
  return result;
}

double LargestShear(const std::vector<stabilizer::FrameAnalysis>& frames) {
  double largest = 0.0;
  for (const auto& f : frames) {
    largest = std::max(largest, 1.0 - AffineAnisotropy(f.rectified_from_output));
  }
  return largest;
}

// With the skew taken out of the tracks the camera pans steadily. With the wrong sign, or with one
// frame's field used for the other, twice the skew or more is left and the path tries to undo it.
TEST(MotionStage, TakesTheReadoutMotionOutOfTheTracks) {
  RsSelection selection;
  selection.source = std::make_unique<SkewSource>();
  const auto frames = AnalyzeSkewed(selection);
  for (const auto& f : frames) {
    EXPECT_LT((f.rectified_from_output - Eigen::Matrix3d::Identity()).norm(), 2e-3);
    EXPECT_EQ(f.rs_field.rows(), 33);
  }
  EXPECT_LT(LargestShear(frames), 1e-3);
  RsSelection without;
  EXPECT_GT(LargestShear(AnalyzeSkewed(without)), 3e-3);
}

TEST(MotionStage, AFrameTheSourceCannotTellIsLeftAsItIs) {
  RsSelection selection;
  auto source = std::make_unique<SkewSource>();
  source->unknown_frame = 30;
  selection.source = std::move(source);
  const auto frames = AnalyzeSkewed(selection);
  EXPECT_EQ(frames[30].rs_field.columns(), 0);
  EXPECT_EQ(frames[31].rs_field.rows(), 33);
}

std::vector<stabilizer::FrameAnalysis> Analyze(
    RsSelection& selection, const std::function<PointTracks(int)>& tracks_of_frame) {
  auto stage = MotionStage::Create({}, {kWidth, kHeight, 30.0}, &selection, SilentLogger());
  EXPECT_TRUE(stage);
  for (int n = 0; n < kFrames; ++n) {
    FrameObservation o;
    o.pts = n;
    o.time_s = n / 30.0;
    o.tracks = tracks_of_frame(n);
    o.tracks.width = kWidth;
    o.tracks.height = kHeight;
    o.attempted_points = static_cast<int>(o.tracks.matches.size());
    EXPECT_TRUE((*stage)->Push(o));
  }
  EXPECT_TRUE((*stage)->Finish());
  auto frames = (*stage)->TakeReady();
  EXPECT_EQ(frames.size(), static_cast<std::size_t>(kFrames));
  return frames;
}

// A camera that nods and shakes its head, known without any picture.
double ShakeRad(double time_s) { return 0.01 * std::sin(2.4 * 30.0 * time_s); }

class ShakingHead final : public RsMotionSource {
 public:
  std::string Name() const override { return "gyro"; }
  bool NeedsImage() const override { return false; }
  Result<RsMotion> EstimateMotion(const FrameContext&) override { return RsMotion(); }
  std::optional<Eigen::Quaterniond> CameraFromWorld(double time_s) const override {
    const double angle = ShakeRad(time_s);
    return ExpSo3(Eigen::Vector3d(0.5 * angle, angle, 0.0)).inverse();
  }
};

// In a dark clip the log alone has to steady the picture; taken the wrong way round it would double
// the shake.
TEST(MotionStage, FollowsTheSensorWhereThereAreNoTracks) {
  RsSelection selection;
  selection.source = std::make_unique<ShakingHead>();
  selection.rotation_is_known = true;
  selection.camera = Camera::Pinhole(kWidth, kHeight, 500.0);
  const auto frames = Analyze(selection, [](int) { return PointTracks(); });
  const ShakingHead head;
  double largest_in = 0.0;
  double largest_out = 0.0;
  for (std::size_t n = 20; n < 40; ++n) {  // away from the ends
    const auto shown = [&](std::size_t frame) -> std::array<Eigen::Vector2d, 2> {
      const Eigen::Vector3d ahead =
          *head.CameraFromWorld(static_cast<double>(frame) / 30.0) * Eigen::Vector3d::UnitZ();
      const Eigen::Vector2d recorded =
          stabilizer::ToNormalized((selection.camera->K() * ahead).hnormalized(), kWidth, kHeight);
      return {recorded, Project(frames[frame].rectified_from_output.inverse(), recorded)};
    };
    largest_in = std::max(largest_in, (shown(n)[0] - shown(n - 1)[0]).norm());
    largest_out = std::max(largest_out, (shown(n)[1] - shown(n - 1)[1]).norm());
  }
  EXPECT_GT(largest_in * kWidth, 8.0);
  EXPECT_LT(largest_out * kWidth, 0.5);
}

// Frames of one world may be compared, and turn against each other as the source says: to the other
// side would be a turn of twice the shake.
TEST(MotionStage, NotesWhereTheCameraLooked) {
  class Interrupted final : public RsMotionSource {
   public:
    std::string Name() const override { return "gyro"; }
    bool NeedsImage() const override { return false; }
    Result<RsMotion> EstimateMotion(const FrameContext&) override { return RsMotion(); }
    std::optional<Eigen::Quaterniond> CameraFromWorld(double time_s) const override {
      return std::abs(time_s - 0.5) < 0.01 ? std::nullopt : head.CameraFromWorld(time_s);
    }
    std::optional<Eigen::Quaterniond> TurnBetween(double from_s, double to_s) const override {
      const bool over_the_gap = from_s < 1.0 && to_s >= 1.0;
      return over_the_gap ? std::nullopt : RsMotionSource::TurnBetween(from_s, to_s);
    }
    ShakingHead head;
  };
  RsSelection selection;
  selection.source = std::make_unique<Interrupted>();
  const auto frames = Analyze(selection, [](int) { return PointTracks(); });
  const ShakingHead head;
  for (std::size_t n = 0; n < frames.size(); ++n) {
    ASSERT_EQ(frames[n].orientation.has_value(), n != 15) << n;
    if (n == 15) {
      continue;
    }
    EXPECT_EQ(frames[n].orientation->world, n < 15 ? 0U : n < 30 ? 1U : 2U) << n;
    const auto truth = head.CameraFromWorld(static_cast<double>(n) / 30.0);
    EXPECT_LT(frames[n].orientation->camera_from_world.angularDistance(*truth), 1e-12) << n;
  }
  RsSelection unknown;
  EXPECT_FALSE(Analyze(unknown, [](int) { return PointTracks(); }).front().orientation);
}

// The same source, but it answers for a frame only when it has been shown `kDelay` more.
class LateSkewSource final : public RsMotionSource {
 public:
  std::string Name() const override { return "late"; }
  bool NeedsImage() const override { return false; }
  void Observe(const PointTracks& tracks, double time_s) override {
    EXPECT_EQ(tracks.matches.empty(), observed_ == 0);
    EXPECT_DOUBLE_EQ(time_s, static_cast<double>(observed_) / 30.0);
    ++observed_;
  }
  void FinishObserving() override { finished_ = true; }
  std::int64_t NumAnswerable() const override {
    return finished_ ? observed_ : std::max<std::int64_t>(observed_ - kDelay, 0);
  }
  Result<RsMotion> EstimateMotion(const FrameContext& frame) override {
    EXPECT_EQ(frame.index, asked_++);
    EXPECT_LT(frame.index, NumAnswerable());
    EXPECT_DOUBLE_EQ(frame.time_s, static_cast<double>(frame.index) / 30.0);
    return skew_.EstimateMotion(frame);
  }

 private:
  static constexpr std::int64_t kDelay = 25;
  SkewSource skew_;
  std::int64_t observed_ = 0;
  std::int64_t asked_ = 0;
  bool finished_ = false;
};

TEST(MotionStage, ASourceThatAnswersLateGivesTheSameFrames) {
  RsSelection at_once;
  at_once.source = std::make_unique<SkewSource>();
  RsSelection late;
  late.source = std::make_unique<LateSkewSource>();
  const auto expected = AnalyzeSkewed(at_once);
  const auto frames = AnalyzeSkewed(late);
  ASSERT_EQ(frames.size(), expected.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].pts, expected[i].pts);
    EXPECT_EQ(frames[i].rectified_from_output, expected[i].rectified_from_output);
    EXPECT_EQ(frames[i].rs_field.rows(), expected[i].rs_field.rows());
    EXPECT_EQ(frames[i].crop_ratio, expected[i].crop_ratio);
  }
}

TEST(MotionStage, RefusesImpossibleClips) {
  RsSelection selection;
  EXPECT_FALSE(MotionStage::Create({}, {0, 360, 30.0}, &selection, SilentLogger()));
  EXPECT_FALSE(MotionStage::Create({}, {640, 360, 0.0}, &selection, SilentLogger()));
}

}  // namespace
}  // namespace rsstab::pipeline
