// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/rs_motion_fusion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "tests/stabilizer/shaky_camera.h"

namespace rsstab::stabilizer {
namespace {

using igf::MotionPreset;
using testing::kFocal;
using testing::kFrameS;
using testing::kWidth;
using testing::RegularTimes;
using testing::RootMeanSquare;
using testing::ShakyCamera;

constexpr double kReadout = 0.025;
// px at 640 px width; what a walk leaves of 2 px (rs_motion_window_test).
constexpr double kTolerance = 0.2;

RsMotionModel WalkModel(const ShakyCamera& camera) {
  RsMotionModel model = camera.Model();
  model.jerk_weight = 0.1;
  return model;
}

struct Fused {
  std::vector<FusedFrame> frames;
  std::size_t longest_wait = 0;  // frames pushed and not decided
  std::size_t most_knots = 0;    // of one frame's spline
};

// pairs[i] leads to the frame at times_s[i]; the first is empty.
Fused Fuse(const RsMotionModel& model, const std::vector<double>& times_s,
           const std::vector<FramePairCells>& pairs) {
  RsMotionFusion fusion(model);
  Fused fused;
  const auto take = [&] {
    for (FusedFrame& frame : fusion.TakeReady()) {
      fused.most_knots =
          std::max(fused.most_knots, frame.spline ? frame.spline->knots().size() : 0);
      fused.frames.push_back(std::move(frame));
    }
  };
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    fusion.Push(times_s[i], pairs[i]);
    take();
    fused.longest_wait = std::max(fused.longest_wait, i + 1 - fused.frames.size());
  }
  fusion.Finish();
  take();
  EXPECT_EQ(fused.frames.size(), times_s.size());
  return fused;
}

std::vector<FramePairCells> WithFirst(std::vector<FramePairCells> pairs) {
  pairs.insert(pairs.begin(), FramePairCells{});
  return pairs;
}

double FrameError(const ShakyCamera& camera, const FusedFrame& frame) {
  EXPECT_TRUE(frame.spline.has_value());
  if (!frame.spline) {
    return 0.0;
  }
  return camera.RowError(
      [&](double t) {
        const auto r = frame.spline->CameraFromWorld(t);
        EXPECT_TRUE(r.has_value()) << t;
        return r.value_or(Eigen::Quaterniond::Identity());
      },
      frame.time_s);
}

double RmsError(const ShakyCamera& camera, const std::vector<FusedFrame>& frames) {
  std::vector<double> errors;
  for (const FusedFrame& frame : frames) {
    errors.push_back(FrameError(camera, frame));
  }
  return RootMeanSquare(errors);
}

// px at 640 px width: how far the turn from one frame's middle row to the next is from the truth,
// the largest of all neighbours.
double LargestJump(const ShakyCamera& camera, const std::vector<FusedFrame>& frames) {
  double largest = 0.0;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const FusedFrame& a = frames[i - 1];
    const FusedFrame& b = frames[i];
    if (a.part != b.part || !a.spline || !b.spline) {
      continue;
    }
    const Eigen::Quaterniond turn =
        *b.spline->CameraFromWorld(b.time_s) * a.spline->CameraFromWorld(a.time_s)->conjugate();
    const Eigen::Quaterniond true_turn = *camera.truth.CameraFromWorld(b.time_s) *
                                         camera.truth.CameraFromWorld(a.time_s)->conjugate();
    largest = std::max(largest, turn.angularDistance(true_turn) * kFocal * kWidth);
  }
  return largest;
}

TEST(RsMotionFusion, WindowsJoinWithoutAJump) {
  const ShakyCamera camera(MotionPreset::kWalking, kReadout, 8.0);
  const RsMotionModel model = WalkModel(camera);
  const auto times_s = RegularTimes(200);
  const auto pairs = WithFirst(camera.Pairs(times_s));
  const Fused fused = Fuse(model, times_s, pairs);
  EXPECT_LT(RmsError(camera, fused.frames), kTolerance);
  EXPECT_LT(LargestJump(camera, fused.frames), 0.5);
  EXPECT_EQ(fused.frames.back().part, fused.frames.front().part);

  // All at once.
  SplineStretch stretch;
  const std::span<const FramePairCells> all = std::span(pairs).subspan(1);
  ExtendStretch(model, all, stretch);
  RsMotionWindow batch(model, all, std::move(stretch), 1, {});
  ASSERT_TRUE(batch.Solve(10));
  const SplineStretch solved = batch.Stretch();
  igf::So3Spline spline(solved.start_s, solved.interval_s);
  for (const Eigen::Quaterniond& knot : solved.knots) {
    spline.Append(knot);
  }
  double largest = 0.0;
  for (const FusedFrame& frame : fused.frames) {
    for (const double share : {-0.5, -0.25, 0.25, 0.5}) {
      const double t = frame.time_s + share * kReadout;
      const Eigen::Quaterniond row = *frame.spline->CameraFromWorld(t) *
                                     frame.spline->CameraFromWorld(frame.time_s)->conjugate();
      const Eigen::Quaterniond batch_row =
          *spline.CameraFromWorld(t) * spline.CameraFromWorld(frame.time_s)->conjugate();
      largest = std::max(largest, row.angularDistance(batch_row) * kFocal * kWidth);
    }
  }
  // A tenth of what rolling shutter does to a visible degree.
  EXPECT_LT(largest, 0.05);
}

TEST(RsMotionFusion, MemoryIsThatOfAWindow) {
  const ShakyCamera camera(MotionPreset::kHandheld, kReadout, 1.0);
  const auto one_pair = camera.Pairs(RegularTimes(2)).front();
  const auto times_s = RegularTimes(400);
  std::vector<FramePairCells> pairs(times_s.size(), one_pair);
  pairs.front() = {};
  const Fused fused = Fuse(WalkModel(camera), times_s, pairs);
  EXPECT_LE(fused.longest_wait, 60U);
  EXPECT_LE(fused.most_knots, 4U + 3U * kKnotsPerFrame);
}

// Every frame at the times of `times_s`, with tracks from the one before among those that are kept.
TEST(RsMotionFusion, ARepeatedFrameMovesAsTheOneItRepeats) {
  const ShakyCamera camera(MotionPreset::kWalking, kReadout);
  // Every 7th picture is the one before; tracks lead from picture to picture.
  std::vector<double> shown_s;
  std::vector<double> content_s;
  std::vector<FramePairCells> pairs;
  for (int i = 0; i < 84; ++i) {
    const bool repeats = i % 7 == 6;
    shown_s.push_back(i * kFrameS);
    content_s.push_back(repeats ? content_s.back() : shown_s.back());
  }
  const auto all = camera.Pairs(content_s);
  pairs.push_back({});
  for (std::size_t i = 0; i < all.size(); ++i) {
    FramePairCells pair = all[i];
    if (content_s[i] == content_s[i + 1]) {
      for (TrackCell& cell : pair.cells) {
        cell.to = cell.from;
      }
    }
    pair.from_time_s = shown_s[i];
    pair.to_time_s = shown_s[i + 1];
    pairs.push_back(std::move(pair));
  }
  const Fused fused = Fuse(WalkModel(camera), shown_s, pairs);
  for (std::size_t i = 0; i < shown_s.size(); ++i) {
    EXPECT_EQ(fused.frames[i].time_s, content_s[i]) << i;
  }
  EXPECT_LT(RmsError(camera, fused.frames), kTolerance);
}

TEST(RsMotionFusion, AMissingFrameIsAGapInTime) {
  const ShakyCamera camera(MotionPreset::kWalking, kReadout);
  std::vector<double> times_s;
  for (int i = 0; i < 90; ++i) {
    if (i % 9 != 8) {
      times_s.push_back(i * kFrameS);
    }
  }
  const Fused fused = Fuse(WalkModel(camera), times_s, WithFirst(camera.Pairs(times_s)));
  EXPECT_LT(RmsError(camera, fused.frames), 1.5 * kTolerance);
  EXPECT_EQ(fused.frames.front().part, fused.frames.back().part);
}

// A recorder that drops frames and hides it: the picture moves twice as far in one step. Nobody can
// tell what the camera did there; the frames around must not do worse than uncorrected ones.
TEST(RsMotionFusion, AHiddenGapDoesNoHarm) {
  const ShakyCamera camera(MotionPreset::kWalking, kReadout);
  std::vector<double> content_s;
  for (int i = 0; i < 90; ++i) {
    if (i % 9 != 8) {
      content_s.push_back(i * kFrameS);
    }
  }
  auto pairs = WithFirst(camera.Pairs(content_s));
  const auto told_s = RegularTimes(static_cast<int>(content_s.size()));
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    pairs[i].from_time_s = told_s[i - 1];
    pairs[i].to_time_s = told_s[i];
  }
  Fused fused = Fuse(WalkModel(camera), told_s, pairs);
  std::vector<double> errors;
  std::vector<double> motion;
  for (std::size_t i = 0; i < fused.frames.size(); ++i) {
    const double shift_s = told_s[i] - content_s[i];
    const double middle_s = content_s[i];
    ASSERT_TRUE(fused.frames[i].spline);
    errors.push_back(camera.RowError(
        [&](double t) { return *fused.frames[i].spline->CameraFromWorld(t + shift_s); }, middle_s));
    motion.push_back(camera.RowMotion(middle_s));
  }
  EXPECT_LT(RootMeanSquare(errors), 0.5 * RootMeanSquare(motion));
}

TEST(RsMotionFusion, ACutBeginsAnotherPart) {
  const ShakyCamera camera(MotionPreset::kWalking, kReadout);
  const auto times_s = RegularTimes(60);
  auto pairs = WithFirst(camera.Pairs(times_s));
  pairs[30].cells.clear();
  const Fused fused = Fuse(WalkModel(camera), times_s, pairs);
  EXPECT_EQ(fused.frames[29].part, fused.frames[0].part);
  EXPECT_NE(fused.frames[30].part, fused.frames[29].part);
  EXPECT_EQ(fused.frames[59].part, fused.frames[30].part);
  EXPECT_LT(RmsError(camera, fused.frames), 1.5 * kTolerance);
}

TEST(RsMotionFusion, FramesWithoutTracksAreNotKnown) {
  const ShakyCamera camera(MotionPreset::kWalking, kReadout);
  const auto times_s = RegularTimes(40);
  auto pairs = WithFirst(camera.Pairs(times_s));
  for (std::size_t i = 15; i < 25; ++i) {
    pairs[i].cells.clear();
  }
  const Fused fused = Fuse(WalkModel(camera), times_s, pairs);
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    // Frame 14 has tracks from before it, frame 24 to the one after it.
    EXPECT_EQ(fused.frames[i].spline.has_value(), i <= 14 || i >= 24) << i;
  }
}

TEST(RsMotionFusion, VeryShortClipsAreAnswered) {
  const ShakyCamera camera(MotionPreset::kWalking, kReadout);
  EXPECT_TRUE(Fuse(WalkModel(camera), {}, {}).frames.empty());
  const Fused one = Fuse(WalkModel(camera), {0.0}, {FramePairCells{}});
  EXPECT_FALSE(one.frames[0].spline.has_value());
  for (const int frames : {2, 3}) {
    const auto times_s = RegularTimes(frames, 1.0);
    const Fused fused = Fuse(WalkModel(camera), times_s, WithFirst(camera.Pairs(times_s)));
    for (const FusedFrame& frame : fused.frames) {
      // The change of velocity within two frames is seen, but not beyond them.
      EXPECT_LT(FrameError(camera, frame), camera.RowMotion(frame.time_s) + kTolerance);
    }
  }
}

TEST(RsMotionFusion, UnevenTimesAreFollowed) {
  const ShakyCamera camera(MotionPreset::kWalking, kReadout);
  std::vector<double> times_s;
  for (int i = 0; i < 80; ++i) {
    times_s.push_back(i * kFrameS + 0.2 * kFrameS * std::sin(1.7 * i));
  }
  const Fused fused = Fuse(WalkModel(camera), times_s, WithFirst(camera.Pairs(times_s)));
  EXPECT_LT(RmsError(camera, fused.frames), kTolerance);
}

// A recorder that stamps its first frames wrongly. Crowded together they are taken to be regular;
// too far apart they move too slowly, which corrects too little.
TEST(RsMotionFusion, DamagedTimestampsSpoilOnlyWhereTheyAre) {
  const ShakyCamera camera(MotionPreset::kWalking, kReadout);
  const auto content_s = RegularTimes(60);
  for (const double pace : {0.05, 3.0}) {
    std::vector<double> told_s = content_s;
    for (std::size_t i = 0; i < 4; ++i) {  // counted back from a good one
      told_s[i] = content_s[4] - pace * static_cast<double>(4 - i) * kFrameS;
    }
    auto pairs = WithFirst(camera.Pairs(content_s));
    for (std::size_t i = 1; i < pairs.size(); ++i) {
      pairs[i].from_time_s = told_s[i - 1];
      pairs[i].to_time_s = told_s[i];
    }
    const Fused fused = Fuse(WalkModel(camera), told_s, pairs);
    std::vector<double> errors;
    for (std::size_t i = 0; i < fused.frames.size(); ++i) {
      const FusedFrame& frame = fused.frames[i];
      ASSERT_TRUE(frame.spline);
      const double offset_s = frame.time_s - content_s[i];
      errors.push_back(camera.RowError(
          [&](double t) { return *frame.spline->CameraFromWorld(t + offset_s); }, content_s[i]));
      EXPECT_LT(errors.back(), camera.RowMotion(content_s[i]) + kTolerance) << i;
    }
    errors.erase(errors.begin(), errors.begin() + (pace < 1.0 ? 0 : 8));
    EXPECT_LT(RootMeanSquare(errors), kTolerance) << pace;
  }
}

TEST(RsMotionFusion, APauseOrAClockThatStopsBeginsAnotherPart) {
  const ShakyCamera camera(MotionPreset::kWalking, kReadout);
  const auto content_s = RegularTimes(30);
  const auto pairs = WithFirst(camera.Pairs(content_s));
  for (const double jump_s : {1e9, 1.0, -kFrameS, -100.0}) {
    std::vector<double> told_s = content_s;
    for (std::size_t i = 15; i < told_s.size(); ++i) {
      told_s[i] += jump_s;
    }
    const Fused fused = Fuse(WalkModel(camera), told_s, pairs);
    EXPECT_EQ(fused.frames[14].part, fused.frames[0].part);
    EXPECT_NE(fused.frames[15].part, fused.frames[14].part);
    EXPECT_EQ(fused.frames[29].part, fused.frames[15].part);
  }
}

}  // namespace
}  // namespace rsstab::stabilizer
