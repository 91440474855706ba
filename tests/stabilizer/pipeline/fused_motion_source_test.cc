// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/fused_motion_source.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "igf/base/homography.h"
#include "igf/intra_gyro_field.h"
#include "tests/stabilizer/shaky_camera.h"

namespace rsstab::pipeline {
namespace {

using stabilizer::testing::kFrameS;
using stabilizer::testing::RegularTimes;
using stabilizer::testing::ShakyCamera;
using stabilizer::testing::TestCamera;

constexpr double kReadout = 0.025;
// px; see rs_motion_fusion_test. The field reaches 4 px.
constexpr double kTolerance = 0.3;

ShakyCamera Walk() { return {igf::MotionPreset::kWalking, kReadout}; }

std::unique_ptr<FusedMotionSource> MakeSource(const ShakyCamera& camera) {
  auto source = FusedMotionSource::Create("fused", TestCamera(), false, camera.Model());
  EXPECT_TRUE(source.has_value());
  return std::move(*source);
}

double LargestDifference(const MotionField& a, const MotionField& b) {
  double largest = 0.0;
  for (int row = 0; row < a.rows(); ++row) {
    for (int column = 0; column < a.columns(); ++column) {
      const Eigen::Vector2d x = a.VertexPosition(column, row);
      largest = std::max(largest, (a.Sample(x) - b.Sample(x)).norm());
    }
  }
  return largest;
}

TEST(FusedMotionSource, FieldsAreThoseOfTheTrueMotion) {
  const ShakyCamera camera = Walk();
  const auto source = MakeSource(camera);
  EXPECT_EQ(source->Name(), "fused");
  EXPECT_FALSE(source->NeedsImage());
  const auto times_s = RegularTimes(70);
  const auto tracks = camera.Tracks(times_s);
  std::int64_t next = 0;
  double error_sq = 0.0;
  double turned_over_sq = 0.0;
  double field_sq = 0.0;
  const auto answer = [&] {
    for (; next < source->NumAnswerable(); ++next) {
      const double t = times_s[static_cast<std::size_t>(next)];
      const auto motion = source->EstimateMotion({next, t, nullptr});
      ASSERT_TRUE(motion.has_value()) << motion.error().message;
      const MotionField truth =
          igf::ComputeIntraGyroField(TestCamera(), camera.truth, t, kReadout).value();
      EXPECT_EQ(motion->field.reference_row(), truth.reference_row());
      MotionField reversed = truth;
      for (auto& v : reversed.vertices()) {
        v = -v;
      }
      const MotionField none(truth.width(), truth.height(), truth.columns(), truth.rows());
      const auto add = [&](double& sum, const MotionField& other) {
        const double d = LargestDifference(motion->field, other);
        sum += d * d;
      };
      add(error_sq, truth);
      add(turned_over_sq, reversed);
      add(field_sq, none);
    }
  };
  source->Observe({}, times_s[0]);
  EXPECT_EQ(source->NumAnswerable(), 0);
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    source->Observe(tracks[i], times_s[i + 1]);
    answer();
  }
  EXPECT_GT(next, 0);   // some before the end,
  EXPECT_LT(next, 70);  // but not those that need what follows
  source->FinishObserving();
  answer();
  EXPECT_EQ(next, 70);
  EXPECT_LT(std::sqrt(error_sq / 70.0), kTolerance);
  EXPECT_GT(std::sqrt(field_sq / 70.0), 4.0 * kTolerance);
  EXPECT_GT(turned_over_sq, field_sq);
}

TEST(FusedMotionSource, OrientationsOfNeighboursGiveTheTurnBetweenThem) {
  const ShakyCamera camera = Walk();
  const auto source = MakeSource(camera);
  const auto times_s = RegularTimes(20);
  const auto tracks = camera.Tracks(times_s);
  source->Observe({}, times_s[0]);
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    source->Observe(i == 9 ? PointTracks{} : tracks[i], times_s[i + 1]);
  }
  source->FinishObserving();
  EXPECT_FALSE(source->CameraFromWorld(times_s[0]).has_value());  // no frame asked for yet
  for (std::int64_t i = 0; i < 20; ++i) {
    const double t = times_s[static_cast<std::size_t>(i)];
    ASSERT_TRUE(source->EstimateMotion({i, t, nullptr}));
    ASSERT_TRUE(source->CameraFromWorld(t));
    if (i == 0) {
      continue;
    }
    const double before = times_s[static_cast<std::size_t>(i - 1)];
    const auto earlier = source->CameraFromWorld(before);
    ASSERT_EQ(earlier.has_value(), i != 10) << i;  // a cut before frame 10
    if (earlier) {
      const Eigen::Quaterniond turn = *source->CameraFromWorld(t) * earlier->conjugate();
      const Eigen::Quaterniond true_turn =
          *camera.truth.CameraFromWorld(t) * camera.truth.CameraFromWorld(before)->conjugate();
      EXPECT_LT(turn.angularDistance(true_turn) * TestCamera().fx, 0.5) << i;
    }
  }
}

TEST(FusedMotionSource, WhatCannotBeAnsweredIsSaid) {
  const ShakyCamera camera = Walk();
  const auto source = MakeSource(camera);
  const auto early = source->EstimateMotion({0, 0.0, nullptr});
  ASSERT_FALSE(early);
  EXPECT_EQ(early.error().code, ErrorCode::kInvalidArgument);
  source->Observe({}, 0.0);
  source->FinishObserving();
  const auto alone = source->EstimateMotion({0, 0.0, nullptr});
  ASSERT_FALSE(alone);
  EXPECT_EQ(alone.error().code, ErrorCode::kUntrustworthy);
  EXPECT_FALSE(source->CameraFromWorld(0.0).has_value());
}

TEST(FusedMotionSource, AGlobalShutterHasNoField) {
  const ShakyCamera camera(igf::MotionPreset::kWalking, 0.0);
  const auto source = MakeSource(camera);
  const auto times_s = RegularTimes(5);
  source->Observe({}, times_s[0]);
  for (const PointTracks& tracks : camera.Tracks(times_s)) {
    source->Observe(tracks, tracks.to_time_s);
  }
  source->FinishObserving();
  const auto motion = source->EstimateMotion({0, 0.0, nullptr});
  ASSERT_TRUE(motion);
  EXPECT_EQ(motion->field.columns(), 0);
}

TEST(FusedMotionSource, RefusesImpossibleModels) {
  stabilizer::RsMotionModel model;
  EXPECT_FALSE(FusedMotionSource::Create("fused", {}, false, model));
  model.focal = 0.0;
  EXPECT_FALSE(FusedMotionSource::Create("fused", TestCamera(), false, model));
  model.focal = 1.0;
  model.frame_interval_s = 0.0;
  EXPECT_FALSE(FusedMotionSource::Create("fused", TestCamera(), false, model));
}

}  // namespace
}  // namespace rsstab::pipeline
