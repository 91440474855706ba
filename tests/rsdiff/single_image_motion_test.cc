// SPDX-License-Identifier: Apache-2.0
#include "rsdiff/single_image_motion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "rsdiff/dense_field.h"
#include "rsdiff/orientation_planes.h"
#include "tests/support/gaussian_denoiser.h"
#include "tests/support/test_paths.h"

namespace rsstab::rsdiff {
namespace {

using rsstab::testing::GaussianDenoiser;

constexpr int kBands = 24;
constexpr double kDeviation = 0.1;  // network units
const Eigen::Vector3d kScale(0.04, 0.05, 0.08);

Frame Picture(int width, int height, const PixelLayout& layout = GrayLayout()) {
  Frame frame = *AllocateFrame(layout, width, height);
  for (int p = 0; p < layout.num_planes; ++p) {
    const MutablePlaneView& plane = frame.planes[static_cast<std::size_t>(p)];
    std::memset(plane.data, 99, static_cast<std::size_t>(plane.stride * plane.height));
  }
  return frame;
}

// A curve in network units, zero at the middle row.
std::vector<double> MeanState() {
  std::vector<double> state;
  for (int c = 0; c < 3; ++c) {
    for (int b = 0; b < kBands; ++b) {
      const double s = (b + 0.5) / kBands - 0.5;
      state.push_back((0.5 - 0.2 * c) * std::sin(4.0 * s));
    }
  }
  return state;
}

ModelInfo CurveModel() {
  ModelInfo model;
  model.file = "curve.json";
  model.condition_kind = ConditionKind::kOrientationPlanes;
  model.condition = kOrientationShape;
  model.motion_kind = MotionKind::kRotationCurve;
  model.motion = {3, kBands, 1};
  model.curve_scale = kScale;
  model.sampling.steps = 1000;
  return model;
}

std::unique_ptr<Denoiser> PerfectDenoiser(const ModelInfo& model, std::vector<double> mean,
                                          double deviation) {
  return std::make_unique<GaussianDenoiser>(
      *NoiseSchedule::Create(model.schedule, model.diffusion_steps), model.objective, model.motion,
      model.condition, std::move(mean), deviation);
}

SingleImageEstimator CurveEstimator(double deviation = kDeviation) {
  const ModelInfo model = CurveModel();
  return *SingleImageEstimator::Create(model, PerfectDenoiser(model, MeanState(), deviation));
}

RotationCurve TrueCurve() {
  std::vector<float> state;
  for (const double value : MeanState()) {
    state.push_back(static_cast<float>(value));
  }
  return CurveFromState(state, kScale);
}

// A network that is sure: every sample is the truth, at any size and aspect.
TEST(SingleImageEstimator, GivesTheFieldOfTheCurve) {
  SingleImageEstimator estimator = CurveEstimator(0.0);
  for (const auto& [width, height] :
       {std::pair{800, 600}, std::pair{1080, 1920}, std::pair{97, 33}}) {
    const Frame picture = Picture(width, height);
    const auto motion = estimator.Estimate(picture.View());
    ASSERT_TRUE(motion) << motion.error().message;
    const MotionField expected =
        *FieldFromCurve(TrueCurve(), Camera::Pinhole(width, height, width));
    EXPECT_GT(expected.MaxLength(), 0.01 * width);
    EXPECT_EQ(motion->field.width(), width);
    EXPECT_EQ(motion->field.height(), height);
    EXPECT_EQ(motion->field.reference_row(), (height - 1) / 2.0);
    for (std::size_t v = 0; v < expected.vertices().size(); ++v) {
      EXPECT_LT((motion->field.vertices()[v] - expected.vertices()[v]).norm(), 1e-3F);
    }
    EXPECT_LT(motion->spread_px, 1e-3);
    EXPECT_EQ(motion->curves.size(), 8U);
  }
}

TEST(SingleImageEstimator, UsesTheFocalLength) {
  SingleImageEstimator estimator = CurveEstimator(0.0);
  const Frame picture = Picture(800, 600);
  const MotionField wide = estimator.Estimate(picture.View(), {}, 400.0)->field;
  const MotionField expected = *FieldFromCurve(TrueCurve(), Camera::Pinhole(800, 600, 400.0));
  const MotionField tele = estimator.Estimate(picture.View(), {}, 1600.0)->field;
  EXPECT_LT((wide.At(0, 0) - expected.At(0, 0)).norm(), 1e-3F);
  EXPECT_GT((wide.At(0, 0) - tele.At(0, 0)).norm(), 0.2F);
}

// Gaussian samples: mean and spread are the distribution's.
TEST(SingleImageEstimator, TellsMeanAndSpread) {
  SingleImageEstimator estimator = CurveEstimator();
  const Frame picture = Picture(600, 400);
  SamplingOptions options;
  options.samples = 400;
  const SingleImageMotion motion = *estimator.Estimate(picture.View(), options);
  const RotationCurve truth = TrueCurve();
  ASSERT_EQ(motion.curve_mean.size(), static_cast<std::size_t>(kBands));
  for (std::size_t b = 0; b < kBands; ++b) {
    for (int c = 0; c < 3; ++c) {
      // Bands are independent, and the middle, (p11 + p12) / 2 with weights 9/16 and -1/16 twice,
      // is taken off: variance 1 + 164/256, less 2 * 9/16 for the two bands beside it, plus 2/16
      // next.
      const double twice = b == 11 || b == 12   ? 2.0 * 9.0 / 16.0
                           : b == 10 || b == 13 ? -2.0 / 16.0
                                                : 0.0;
      const double deviation = kScale[c] * kDeviation * std::sqrt(1.0 + 164.0 / 256.0 - twice);
      // Four standard errors of 200 pairs, and 2% that noise that the last step cannot tell from
      // data takes.
      EXPECT_NEAR(motion.curve_mean[b][c], truth[b][c], 0.2 * deviation) << b;
      EXPECT_NEAR(motion.curve_deviation[b][c] / deviation, 1.0, 4.0 / std::sqrt(400.0) + 0.02)
          << b;
    }
  }
  double squares = 0.0;
  for (const float spread : motion.vertex_spread_px) {
    squares += static_cast<double>(spread) * static_cast<double>(spread);
  }
  const auto vertices = static_cast<double>(motion.vertex_spread_px.size());
  EXPECT_EQ(motion.vertex_spread_px.size(), motion.field.vertices().size());
  EXPECT_NEAR(motion.spread_px, std::sqrt(squares / vertices), 1e-4);
  // About the deviation of a and b in px, with the roll's part added.
  EXPECT_GT(motion.spread_px, std::hypot(0.04, 0.05) * kDeviation * 400.0);
  EXPECT_LT(motion.spread_px, 3.0 * std::hypot(0.04, 0.05) * kDeviation * 400.0);
}

// What the model file says of its sampler widens the samples about the same mean.
TEST(SingleImageEstimator, SpreadsSamplesAsTheModelSays) {
  constexpr double kSpreadScale = 1.75;
  ModelInfo model = CurveModel();
  model.sampling.steps = 4;
  model.spread_scale = kSpreadScale;
  SingleImageEstimator wide =
      *SingleImageEstimator::Create(model, PerfectDenoiser(model, MeanState(), kDeviation));
  model.spread_scale = 1.0;
  SingleImageEstimator plain =
      *SingleImageEstimator::Create(model, PerfectDenoiser(model, MeanState(), kDeviation));
  const Frame picture = Picture(160, 120);
  const auto a = wide.Estimate(picture.View());
  const auto b = plain.Estimate(picture.View());
  ASSERT_TRUE(a && b);
  EXPECT_LT((a->curve_mean.front() - b->curve_mean.front()).norm(), 1e-6);
  EXPECT_LT((a->curve_deviation.front() - kSpreadScale * b->curve_deviation.front()).norm(), 1e-6);
  EXPECT_GT(b->curve_deviation.front().minCoeff(), 0.0);
}

TEST(SingleImageEstimator, OneSampleSaysNothingOfItsError) {
  SingleImageEstimator estimator = CurveEstimator();
  SamplingOptions options;
  options.samples = 1;
  const SingleImageMotion motion = *estimator.Estimate(Picture(64, 48).View(), options);
  EXPECT_TRUE(std::isinf(motion.spread_px));
  EXPECT_TRUE(std::isinf(motion.vertex_spread_px.front()));
  EXPECT_TRUE(std::isinf(motion.curve_deviation.front().x()));
  EXPECT_TRUE(std::isfinite(motion.field.MaxLength()));
}

TEST(SingleImageEstimator, IsDeterminedByTheSeed) {
  SingleImageEstimator estimator = CurveEstimator();
  const Frame picture = Picture(320, 240);
  SamplingOptions options;
  options.steps = 4;
  options.eta = 1.0;
  options.samples = 3;
  const SingleImageMotion first = *estimator.Estimate(picture.View(), options);
  const SingleImageMotion again = *estimator.Estimate(picture.View(), options);
  EXPECT_EQ(std::memcmp(first.field.vertices().data(), again.field.vertices().data(),
                        first.field.vertices().size_bytes()),
            0);
  EXPECT_EQ(first.spread_px, again.spread_px);
  options.samples = 5;
  const SingleImageMotion more = *estimator.Estimate(picture.View(), options);
  EXPECT_EQ(more.curves[2], first.curves[2]);
  options.seed = 1;
  EXPECT_NE(estimator.Estimate(picture.View(), options)->curves[2], first.curves[2]);
}

TEST(SingleImageEstimator, TakesStepsEtaAndGuidanceFromTheModelUnlessGiven) {
  const ModelInfo model = CurveModel();
  SingleImageEstimator estimator = CurveEstimator();
  const Frame picture = Picture(64, 48);
  SamplingOptions given;
  given.steps = model.sampling.steps;
  given.eta = model.sampling.eta;
  given.guidance = model.sampling.guidance;
  EXPECT_EQ(estimator.Estimate(picture.View(), given)->curves,
            estimator.Estimate(picture.View())->curves);
  for (const int changed : {0, 1, 2}) {
    SamplingOptions other = given;
    other.steps = changed == 0 ? 2 : other.steps;
    other.eta = changed == 1 ? 1.0 : other.eta;
    other.guidance = changed == 2 ? 0.0 : other.guidance;
    EXPECT_NE(estimator.Estimate(picture.View(), other)->curves,
              estimator.Estimate(picture.View())->curves)
        << changed;
  }
}

// Dense fields whose zero is the first row are restated for the middle one.
TEST(SingleImageEstimator, RestatesDenseFields) {
  ModelInfo model = CurveModel();
  model.condition_kind = ConditionKind::kRgb;
  model.condition = {3, 64, 64};
  model.motion_kind = MotionKind::kDenseField;
  model.motion = {2, 64, 64};
  model.sampling.steps = 4;
  const Camera camera = Camera::Pinhole(800, 600, 800.0);
  const auto from_middle = RowRotationsFromCurve(TrueCurve(), camera, 257);
  std::vector<Eigen::Quaterniond> from_first;
  for (const Eigen::Quaterniond& rotation : from_middle) {
    from_first.push_back(rotation * from_middle.front().conjugate());
  }
  const MotionField expected =
      *ComputeReadoutField(camera, *ReadoutMotion::Create(camera, from_middle));
  for (const ReferenceRow reference : {ReferenceRow::kMiddle, ReferenceRow::kFirst}) {
    model.reference_row = reference;
    const bool is_middle = reference == ReferenceRow::kMiddle;
    const MotionField labels = *ComputeReadoutField(
        camera, *ReadoutMotion::Create(camera, is_middle ? from_middle : from_first), {65, 257});
    const std::vector<float> state = DenseStateFromField(labels, model.motion);
    auto estimator = *SingleImageEstimator::Create(
        model, PerfectDenoiser(model, std::vector<double>(state.begin(), state.end()), 0.0));
    const auto motion = estimator.Estimate(Picture(800, 600, Yuv420Layout()).View());
    ASSERT_TRUE(motion) << motion.error().message;
    EXPECT_EQ(motion->field.reference_row(), 299.5);
    EXPECT_TRUE(motion->curves.empty());
    EXPECT_TRUE(motion->curve_mean.empty());
    for (int row = 6; row < 59; ++row) {
      for (int column = 2; column < 15; ++column) {
        EXPECT_LT((motion->field.At(column, row) - expected.At(column, row)).norm(), 0.05F)
            << column << "," << row;
      }
    }
  }
}

TEST(SingleImageEstimator, TakesTheSmallestPictures) {
  SingleImageEstimator estimator = CurveEstimator();
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{1, 50}, std::pair{31, 2}}) {
    for (const PixelLayout& layout : {Yuv420Layout(), RgbaLayout(), GrayLayout(10)}) {
      const auto motion = estimator.Estimate(Picture(width, height, layout).View(), {.steps = 2});
      ASSERT_TRUE(motion) << motion.error().message;
      EXPECT_TRUE(std::isfinite(motion->spread_px));
      EXPECT_TRUE(std::isfinite(motion->field.MaxLength()));
    }
  }
}

TEST(SingleImageEstimator, RefusesWhatMakesNoSense) {
  SingleImageEstimator estimator = CurveEstimator();
  const Frame picture = Picture(64, 48);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto code = [&](const SamplingOptions& options, std::optional<double> focal_px = {}) {
    const auto motion = estimator.Estimate(picture.View(), options, focal_px);
    return motion ? ErrorCode::kInternal : motion.error().code;
  };
  EXPECT_EQ(code({.steps = -1}), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code({.steps = 1001}), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code({.samples = 0}), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code({.samples = 1025}), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code({.guidance = nan}), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code({.eta = 1.5}), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code({}, 0.0), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code({}, nan), ErrorCode::kInvalidArgument);
  EXPECT_FALSE(estimator.Estimate(FrameView{}));
  EXPECT_FALSE(estimator.Estimate(picture.View(), {}, {}, {1, 1}));
}

TEST(SingleImageEstimator, RefusesADenoiserOfAnotherShape) {
  ModelInfo model = CurveModel();
  auto denoiser = PerfectDenoiser(model, MeanState(), kDeviation);
  model.motion.rows = 12;
  EXPECT_FALSE(SingleImageEstimator::Create(model, std::move(denoiser)));
  EXPECT_FALSE(SingleImageEstimator::Create(model, nullptr));
}

TEST(SingleImageEstimator, LoadsAModelFromDisk) {
  auto estimator =
      SingleImageEstimator::Load(rsstab::testing::SourceFile("tests/rsdiff/data/tiny_model"));
  ASSERT_TRUE(estimator) << estimator.error().message;
  EXPECT_EQ(estimator->model().name, "tiny");
  const auto motion = estimator->Estimate(Picture(640, 480).View());
  ASSERT_TRUE(motion) << motion.error().message;
  EXPECT_EQ(motion->curves.size(), 8U);
  EXPECT_GT(motion->spread_px, 0.0);
  const auto missing = SingleImageEstimator::Load("no/such/model");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace rsstab::rsdiff
