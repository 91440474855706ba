// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/path_smoother.h"

#include <gtest/gtest.h>

#include <functional>
#include <numbers>

#include "igf/base/homography.h"
#include "igf/base/rotation.h"
#include "stabilizer/normalized_coordinates.h"

namespace rsstab::stabilizer {
namespace {

constexpr double kPx = 1.0 / kReferenceWidthPx;

PathSmootherOptions Options() {
  PathSmootherOptions options;
  options.frames_per_second = 30.0;
  options.smoothness_s = 1.0;
  return options;
}

Eigen::Matrix3d Shift(double x, double y) {
  Eigen::Matrix3d m = Eigen::Matrix3d::Identity();
  m(0, 2) = x;
  m(1, 2) = y;
  return m;
}

// A clip whose picture content sits at `position(t)` (normalised) in frame t.
std::vector<FrameMotion> Shifting(int frames, const std::function<Eigen::Vector2d(int)>& position) {
  std::vector<FrameMotion> motions(static_cast<std::size_t>(frames));
  motions[0].path_begins = true;
  for (int t = 1; t < frames; ++t) {
    const Eigen::Vector2d step = position(t) - position(t - 1);
    motions[static_cast<std::size_t>(t)].to_from = Shift(step.x(), step.y());
    motions[static_cast<std::size_t>(t)].rung = MotionRung::kHomography;
  }
  return motions;
}

std::vector<PathUpdate> Smooth(const PathSmootherOptions& options,
                               const std::vector<FrameMotion>& motions) {
  auto smoother = MakeCeresPathSmoother(options);
  EXPECT_TRUE(smoother);
  std::vector<PathUpdate> updates;
  const auto take = [&] {
    for (PathUpdate& u : (*smoother)->TakeReady()) {
      updates.push_back(std::move(u));
    }
  };
  for (const FrameMotion& m : motions) {
    EXPECT_TRUE((*smoother)->Push(m));
    take();
  }
  EXPECT_TRUE((*smoother)->Finish());
  take();
  EXPECT_EQ(updates.size(), motions.size());
  return updates;
}

// Where the output shows the content that was at the origin in the first rectified frame, px.
std::vector<Eigen::Vector2d> OutputTrack(const std::vector<FrameMotion>& motions,
                                         const std::vector<PathUpdate>& updates) {
  std::vector<Eigen::Vector2d> track;
  Eigen::Vector2d p = Eigen::Vector2d::Zero();
  for (std::size_t t = 0; t < motions.size(); ++t) {
    p = t == 0 ? p : Project(motions[t].to_from, p);
    track.push_back(Project(updates[t].rectified_from_output.inverse(), p) * kReferenceWidthPx);
  }
  return track;
}

double RmsAcceleration(const std::vector<Eigen::Vector2d>& track, std::size_t margin = 0) {
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t t = margin + 2; t + margin < track.size(); ++t, ++count) {
    sum += (track[t] - 2.0 * track[t - 1] + track[t - 2]).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(count));
}

TEST(PathSmoother, ASteadyPanIsLeftAlone) {
  const auto motions = Shifting(200, [](int t) { return Eigen::Vector2d(2.0 * kPx * t, 0.0); });
  for (const PathUpdate& u : Smooth(Options(), motions)) {
    EXPECT_LT(Project(u.rectified_from_output, {0.0, 0.0}).norm(), 0.05 * kPx);
  }
}

TEST(PathSmoother, TakesShakeOutAndKeepsSlowMotion) {
  const double pi = std::numbers::pi;
  // 3 Hz shake of 8 px on a slow drift of 60 px over 20 s.
  const auto motions = Shifting(600, [&](int t) {
    const double s = t / 30.0;
    return Eigen::Vector2d(8.0 * kPx * std::sin(2.0 * pi * 3.0 * s),
                           60.0 * kPx * std::sin(2.0 * pi * 0.05 * s));
  });
  const auto updates = Smooth(Options(), motions);
  const auto track = OutputTrack(motions, updates);
  double slow_error = 0.0;
  double fast = 0.0;
  for (std::size_t t = 60; t + 60 < track.size(); ++t) {
    const double s = static_cast<double>(t) / 30.0;
    slow_error =
        std::max(slow_error, std::abs(track[t].y() - 60.0 * std::sin(2.0 * pi * 0.05 * s)));
    fast = std::max(fast, std::abs(track[t].x()));
  }
  // The smoother's response at 0.05 Hz is 0.984: 0.95 px of 60.
  EXPECT_LT(slow_error, 1.2);
  // 1 / (1 + (3 Hz / 0.4 Hz)^4 + (3 / 0.4)^6) of 8 px is below 0.001 px; the ends of the clip ring.
  EXPECT_LT(fast, 0.15);
}

TEST(PathSmoother, AnUpdateIsACameraTurnWhereTurnsAreKnown) {
  PathSmootherOptions options = Options();
  options.rotation_known = true;
  options.adaptive_zoom = false;
  options.focal_ratio = 0.9;
  const Eigen::Vector3d k(0.9, 0.9, 1.0);
  std::vector<FrameMotion> motions(150);
  motions[0].path_begins = true;
  const auto orientation = [](int t) {
    return ExpSo3(Eigen::Vector3d(0.02 * std::sin(1.3 * t), 0.03 * std::cos(0.9 * t),
                                  0.04 * std::sin(0.7 * t)));
  };
  for (int t = 1; t < 150; ++t) {
    motions[static_cast<std::size_t>(t)].to_from =
        RotationHomography(k.asDiagonal(), orientation(t), orientation(t - 1));
  }
  for (const PathUpdate& u : Smooth(options, motions)) {
    const Eigen::Matrix3d turn =
        k.cwiseInverse().asDiagonal() * u.rectified_from_output * k.asDiagonal();
    const Eigen::Matrix3d scaled = turn / std::cbrt(turn.determinant());
    EXPECT_LT((scaled * scaled.transpose() - Eigen::Matrix3d::Identity()).norm(), 2e-4);
  }
}

TEST(PathSmoother, KeepsTheCropWindowInsideThePicture) {
  // Sways by 140 px every 3 s: more than the window leaves room for.
  const auto motions = Shifting(300, [](int t) {
    return Eigen::Vector2d(140.0 * kPx * std::sin(2.0 * std::numbers::pi * t / 90.0), 0.0);
  });
  PathSmootherOptions options = Options();
  options.smoothness_s = 5.0;
  options.min_crop_ratio = 0.8;
  options.adaptive_zoom = false;
  for (const PathUpdate& u : Smooth(options, motions)) {
    const double edge = Project(u.rectified_from_output, {0.4, 0.0}).x();
    EXPECT_LT(edge, 0.5 + 2.0 * kPx);
    EXPECT_GT(Project(u.rectified_from_output, {-0.4, 0.0}).x(), -0.5 - 2.0 * kPx);
  }
}

TEST(PathSmoother, ATightCropMakesThePathFollowInsteadOfBendingThePicture) {
  // Strides of 45 px and jolts of 6 px: at these crop ratios most of it has to stay.
  const auto motions = Shifting(75, [](int t) {
    return Eigen::Vector2d(30.0 * kPx * std::sin(0.21 * t) + 6.0 * kPx * std::sin(1.3 * t),
                           45.0 * kPx * std::sin(0.37 * t) + 6.0 * kPx * std::cos(1.7 * t));
  });
  constexpr double kMinAnisotropy = 0.949;  // the limit of 0.95, less rounding
  constexpr double kZoomSlack = 0.04;       // the zoom may go 0.03 beyond what the window needs
  for (const bool adaptive_zoom : {true, false}) {
    for (const double crop_ratio : {1.0, 0.95}) {
      PathSmootherOptions options = Options();
      options.min_crop_ratio = crop_ratio;
      options.adaptive_zoom = adaptive_zoom;
      for (const PathUpdate& u : Smooth(options, motions)) {
        const Eigen::Matrix3d& update = u.rectified_from_output;
        EXPECT_GT(AffineAnisotropy(update), kMinAnisotropy) << crop_ratio;
        const double zoom = std::sqrt(update.topLeftCorner<2, 2>().determinant()) / update(2, 2);
        EXPECT_GT(zoom, crop_ratio - kZoomSlack) << crop_ratio;
        EXPECT_LT(zoom, 1.0 + kZoomSlack) << crop_ratio;
      }
    }
  }
}

TEST(PathSmoother, ZoomsInWhereBordersWouldShowAndOnlyThere) {
  // Still for 10 s but for a shaky second in the middle.
  const auto motions = Shifting(300, [](int t) {
    const double envelope = std::exp(-std::pow((t - 150.0) / 15.0, 2.0));
    return Eigen::Vector2d(25.0 * kPx * envelope * std::sin(1.1 * t), 0.0);
  });
  const auto updates = Smooth(Options(), motions);
  const auto zoom = [&](std::size_t t) {
    const Eigen::Matrix3d& u = updates[t].rectified_from_output;
    return std::sqrt(u.topLeftCorner<2, 2>().determinant()) / u(2, 2);
  };
  EXPECT_LT(zoom(150), 0.97);
  EXPECT_GT(zoom(150), 0.80);
  EXPECT_GT(zoom(20), 0.995);
  EXPECT_GT(zoom(280), 0.995);
  for (std::size_t t = 1; t < updates.size(); ++t) {
    EXPECT_LT(std::abs(zoom(t) - zoom(t - 1)), 0.006) << t;
  }
  // What is left for the crop planner is a few pixels.
  for (const PathUpdate& u : updates) {
    EXPECT_LT(Project(u.rectified_from_output, {0.5, 0.0}).x(), 0.5 + 4.0 * kPx);
  }
}

TEST(PathSmoother, TripodStandsStill) {
  PathSmootherOptions options = Options();
  options.tripod = true;
  const auto motions = Shifting(240, [](int t) {
    return Eigen::Vector2d(10.0 * kPx * std::sin(0.2 * t), 6.0 * kPx * std::cos(0.05 * t));
  });
  const auto track = OutputTrack(motions, Smooth(options, motions));
  for (const Eigen::Vector2d& p : track) {
    // The pull to the camera's own path, 10 px away at times, gives a little.
    EXPECT_LT((p - track.front()).norm(), 0.8);
  }
}

TEST(PathSmoother, ZeroSmoothnessChangesNothing) {
  PathSmootherOptions options = Options();
  options.smoothness_s = 0.0;
  const auto motions = Shifting(50, [](int t) { return Eigen::Vector2d(t % 2 * 5.0 * kPx, 0.0); });
  for (const PathUpdate& u : Smooth(options, motions)) {
    EXPECT_EQ(u.rectified_from_output, Eigen::Matrix3d::Identity());
    EXPECT_TRUE(u.mesh_update.empty());
  }
}

TEST(PathSmoother, WindowsJoinWithoutASeam) {
  // Irregular shake over many windows: the acceleration at no frame may stand out.
  const auto motions = Shifting(900, [](int t) {
    return Eigen::Vector2d(6.0 * kPx * std::sin(1.7 * t) + 9.0 * kPx * std::sin(0.31 * t + 1.0),
                           5.0 * kPx * std::cos(2.1 * t) + 30.0 * kPx * std::sin(0.013 * t));
  });
  const auto track = OutputTrack(motions, Smooth(Options(), motions));
  EXPECT_LT(RmsAcceleration(track, 10), 0.08);
  for (std::size_t t = 12; t + 10 < track.size(); ++t) {
    EXPECT_LT((track[t] - 2.0 * track[t - 1] + track[t - 2]).norm(), 0.4) << t;
  }
}

TEST(PathSmoother, ACutEndsAPath) {
  auto motions = Shifting(200, [](int t) { return Eigen::Vector2d(kPx * t, 0.0); });
  for (std::size_t t = 100; t < 200; ++t) {
    motions[t].to_from = Shift(0.0, -3.0 * kPx);
  }
  motions[100].to_from = Eigen::Matrix3d::Identity();
  motions[100].path_begins = true;
  const auto updates = Smooth(Options(), motions);
  EXPECT_TRUE(updates[100].path_begins);
  // Both sides are steady pans of their own; without the cut the corner would be rounded off.
  for (const PathUpdate& u : updates) {
    EXPECT_LT(Project(u.rectified_from_output, {0.0, 0.0}).norm(), 0.05 * kPx);
  }
}

TEST(PathSmoother, SmoothsLocalMotionToo) {
  PathSmootherOptions options = Options();
  const std::size_t vertices =
      static_cast<std::size_t>((options.mesh_columns + 1) * (options.mesh_rows + 1));
  auto motions = Shifting(120, [](int) { return Eigen::Vector2d(0.0, 0.0); });
  // The right half jumps to and fro by 2 px.
  for (std::size_t t = 1; t < motions.size(); ++t) {
    motions[t].local.assign(vertices, Eigen::Vector2d::Zero());
    for (std::size_t v = 0; v < vertices; ++v) {
      if (v % 17 > 8) {
        motions[t].local[v] = {(t % 2 == 0 ? 2.0 : -2.0) * kPx, 0.0};
      }
    }
  }
  const auto updates = Smooth(options, motions);
  const std::size_t right = 8 * 17 + 13;
  const std::size_t left = 8 * 17 + 3;
  ASSERT_EQ(updates[60].mesh_update.size(), vertices);
  // The content of odd frames lies 2 px to the left: the update looks for it there.
  const double swing = updates[60].mesh_update[right].x() - updates[61].mesh_update[right].x();
  EXPECT_NEAR(swing / kPx, 2.0, 0.6);
  EXPECT_LT(std::abs(updates[60].mesh_update[left].x() - updates[61].mesh_update[left].x()) / kPx,
            0.5);
}

TEST(PathSmoother, LocalMotionThatEndsLeavesNoStep) {
  // The picture bends steadily until frame 87, then freezes: what the smooth path is behind by has
  // to fade, also where a window holds no local motion at all.
  PathSmootherOptions options = Options();
  const auto num_vertices =
      static_cast<std::size_t>((options.mesh_columns + 1) * (options.mesh_rows + 1));
  std::vector<FrameMotion> motions(250);
  motions[0].path_begins = true;
  for (std::size_t t = 1; t <= 87; ++t) {
    motions[t].local.assign(num_vertices, Eigen::Vector2d(0.4 * kPx, 0.0));
  }
  const auto updates = Smooth(options, motions);
  const auto bend = [&](std::size_t t) {
    return updates[t].mesh_update.empty() ? 0.0 : updates[t].mesh_update.front().x();
  };
  double largest = 0.0;
  for (std::size_t t = 1; t < updates.size(); ++t) {
    largest = std::max(largest, std::abs(bend(t)));
    // The recorded motion is 0.4 px a frame, and what fades after it at most a quarter of that.
    EXPECT_LT(std::abs(bend(t) - bend(t - 1)), (t <= 105 ? 0.4 : 0.1) * kPx) << t;
  }
  EXPECT_GT(largest, 0.5 * kPx);
}

TEST(PathSmoother, OneFrameAndNoneAreFine) {
  auto smoother = MakeCeresPathSmoother(Options());
  ASSERT_TRUE(smoother);
  EXPECT_TRUE((*smoother)->Finish());
  EXPECT_TRUE((*smoother)->TakeReady().empty());
  EXPECT_EQ(Smooth(Options(), Shifting(1, [](int) { return Eigen::Vector2d(0.0, 0.0); })).size(),
            1U);
  EXPECT_EQ(Smooth(Options(), Shifting(2, [](int) { return Eigen::Vector2d(0.0, 0.0); })).size(),
            2U);
}

TEST(PathSmoother, RefusesImpossibleOptions) {
  PathSmootherOptions options = Options();
  options.min_crop_ratio = 0.0;
  EXPECT_FALSE(MakeCeresPathSmoother(options));
}

}  // namespace
}  // namespace rsstab::stabilizer
