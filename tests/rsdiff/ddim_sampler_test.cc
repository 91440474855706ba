// SPDX-License-Identifier: Apache-2.0
#include "rsdiff/ddim_sampler.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "tests/support/gaussian_denoiser.h"

namespace rsstab::rsdiff {
namespace {

using rsstab::testing::GaussianDenoiser;

constexpr Shape kState{3, 4, 1};
constexpr Shape kCondition{1, 2, 2};
constexpr double kMean = 0.2;
constexpr double kDeviation = 0.1;
constexpr double kNoClip = std::numeric_limits<double>::infinity();
constexpr double kFloat = 2e-6;  // float32 states over a few steps

NoiseSchedule Cosine(int steps) { return *NoiseSchedule::Create(ScheduleKind::kCosine, steps); }
NoiseSchedule Linear() { return *NoiseSchedule::Create(ScheduleKind::kLinear, 1000); }

GaussianDenoiser Gaussian(const NoiseSchedule& schedule, Objective objective) {
  return {schedule, objective, kState, kCondition, {kMean}, kDeviation};
}

Tensor Noise(int batch, std::uint64_t seed = 5) {
  Tensor states(batch, kState);
  SeededNoise(seed, batch).Fill(states);
  return states;
}

// A network that answers what it is told to.
class ScriptedDenoiser final : public Denoiser {
 public:
  using Answer = std::function<float(float x, int t, bool with_image)>;
  explicit ScriptedDenoiser(Answer answer) : answer_(std::move(answer)) {}
  [[nodiscard]] Shape StateShape() const override { return kState; }
  [[nodiscard]] Shape ConditionShape() const override { return kCondition; }
  [[nodiscard]] Status Encode(const Tensor& condition) override {
    (void)condition;
    return {};
  }
  [[nodiscard]] Result<Tensor> Predict(const Tensor& states, int t,
                                       Conditioning conditioning) override {
    Tensor prediction = states;
    for (float& value : prediction.values) {
      value = answer_(value, t, conditioning == Conditioning::kWithImage);
    }
    return prediction;
  }

 private:
  Answer answer_;
};

// What DDIM does to x_t - a_t m when the network is perfect: every step multiplies it by a number
// and, with eta > 0, adds noise.
struct GaussianPath {
  double gain = 1.0;      // of the first noise
  double variance = 0.0;  // added by the fresh noise
};

GaussianPath FollowGaussian(const NoiseSchedule& schedule, int steps, double eta) {
  GaussianPath path;
  for (const auto& [t, next_t] : DdimTimePairs(schedule.steps(), steps)) {
    const double a2 = schedule.Signal(t);
    const double b2 = next_t < 0 ? 1.0 : schedule.Signal(next_t);
    const double of_x0 =
        std::sqrt(a2) * kDeviation * kDeviation / (a2 * kDeviation * kDeviation + 1.0 - a2);
    const double of_noise = (1.0 - std::sqrt(a2) * of_x0) / std::sqrt(1.0 - a2);
    const double sigma2 = eta * eta * (1.0 - a2 / b2) * (1.0 - b2) / (1.0 - a2);
    const double factor = std::sqrt(b2) * of_x0 + std::sqrt(1.0 - b2 - sigma2) * of_noise;
    path.gain *= factor;
    path.variance = factor * factor * path.variance + sigma2;
  }
  return path;
}

TEST(DdimSampler, MovesGaussiansAsItsEquationSays) {
  const NoiseSchedule schedule = Linear();
  for (const Objective objective : {Objective::kX0, Objective::kNoise, Objective::kV}) {
    GaussianDenoiser denoiser = Gaussian(schedule, objective);
    for (const int steps : {1, 2, 8, 1000}) {
      const Tensor start = Noise(4);
      SeededNoise noise(1, 4);
      const Tensor sample =
          *DdimSampler(schedule, objective).Sample(denoiser, {.steps = steps}, start, noise);
      const double a = std::sqrt(schedule.Signal(999));
      const double gain = FollowGaussian(schedule, steps, 0.0).gain;
      for (std::size_t i = 0; i < start.values.size(); ++i) {
        // At t = 999 float32 knows x0 from the noise to 6e-8 / 0.006.
        EXPECT_NEAR(sample.values[i], kMean + gain * (start.values[i] - a * kMean), 5e-5) << steps;
      }
    }
  }
}

// In many small steps without fresh noise that is the probability flow, along which
// (x_t - a_t m) / sqrt(a_t^2 s^2 + 1 - a_t^2) stays constant.
TEST(DdimSampler, ApproachesTheProbabilityFlow) {
  const NoiseSchedule schedule = Linear();
  const double a2 = schedule.Signal(999);
  const double flow = kDeviation / std::sqrt(a2 * kDeviation * kDeviation + 1.0 - a2);
  // The last step returns the posterior mean, which noise of 0.01 draws 1% towards the mean.
  EXPECT_NEAR(FollowGaussian(schedule, 1000, 0.0).gain / flow, 1.0, 0.02);
}

// With fresh noise the samples scatter as the equation says, and nearly as the data do.
TEST(DdimSampler, FreshNoiseKeepsTheDistribution) {
  const NoiseSchedule schedule = Linear();
  for (const double eta : {0.5, 1.0}) {
    GaussianDenoiser denoiser = Gaussian(schedule, Objective::kX0);
    const int batch = 500;
    SeededNoise noise(9, batch);
    Tensor states(batch, kState);
    noise.Fill(states);
    const int steps = 100;
    const Tensor samples = *DdimSampler(schedule, Objective::kX0)
                                .Sample(denoiser, {.steps = steps, .eta = eta}, states, noise);
    double sum = 0.0;
    double squares = 0.0;
    const auto count = static_cast<double>(samples.values.size());
    for (const float v : samples.values) {
      sum += v;
      squares += (v - kMean) * (v - kMean);
    }
    const GaussianPath path = FollowGaussian(schedule, steps, eta);
    const double deviation = std::sqrt(path.gain * path.gain + path.variance);
    // Four standard errors of 6,000 numbers.
    EXPECT_NEAR(sum / count, kMean, 4.0 * deviation / std::sqrt(count)) << eta;
    EXPECT_NEAR(std::sqrt(squares / count) / deviation, 1.0, 4.0 / std::sqrt(2.0 * count)) << eta;
    EXPECT_NEAR(deviation / kDeviation, 1.0, 0.25) << eta;  // a hundred steps are coarse
  }
}

TEST(DdimSampler, ObjectivesAgree) {
  const NoiseSchedule schedule = Cosine(1000);
  Tensor samples[3];
  for (const Objective objective : {Objective::kX0, Objective::kNoise, Objective::kV}) {
    GaussianDenoiser denoiser = Gaussian(schedule, objective);
    SeededNoise noise(4, 3);
    samples[static_cast<int>(objective)] =
        *DdimSampler(schedule, objective)
             .Sample(denoiser,
                     {.steps = 8,
                      .eta = 1.0,
                      .clip_range = objective == Objective::kX0 ? 1.0 : kNoClip},
                     Noise(3), noise);
  }
  for (std::size_t i = 0; i < samples[0].values.size(); ++i) {
    // The cosine schedule ends at a signal of 5e-8: x0 is then known from the noise to float32's
    // 6e-8 / sqrt(5e-8) only, which later steps forget.
    EXPECT_NEAR(samples[1].values[i], samples[0].values[i], 1e-3);
    EXPECT_NEAR(samples[2].values[i], samples[0].values[i], 1e-4);
  }
}

// Two steps written out: x0 is clipped, and the noise is worked out again from the clipped one.
TEST(DdimSampler, ClipsAndDerivesTheNoiseAgain) {
  const NoiseSchedule schedule = Linear();
  ScriptedDenoiser denoiser([](float x, int t, bool) { return t == 999 ? 5.0F : 0.5F * x; });
  const Tensor start = Noise(1);
  SeededNoise noise(1, 1);
  const Tensor sample =
      *DdimSampler(schedule, Objective::kX0).Sample(denoiser, {.steps = 2}, start, noise);
  const double first = schedule.Signal(999);
  const double second = schedule.Signal(499);
  for (std::size_t i = 0; i < start.values.size(); ++i) {
    const double derived = (start.values[i] - std::sqrt(first) * 1.0) / std::sqrt(1.0 - first);
    const double x = std::sqrt(second) * 1.0 + std::sqrt(1.0 - second) * derived;
    EXPECT_NEAR(sample.values[i], std::clamp(0.5 * x, -1.0, 1.0), kFloat);
  }
  const Tensor wider = *DdimSampler(schedule, Objective::kX0)
                            .Sample(denoiser, {.steps = 1, .clip_range = 3.0}, start, noise);
  EXPECT_THAT(wider.values, ::testing::Each(3.0F));
  const Tensor unclipped =
      *DdimSampler(schedule, Objective::kX0)
           .Sample(denoiser, {.steps = 1, .clip_range = kNoClip}, start, noise);
  EXPECT_THAT(unclipped.values, ::testing::Each(5.0F));
}

// eta = 1, two steps: the fresh noise enters with the DDPM deviation.
TEST(DdimSampler, FreshNoiseHasTheStatedSize) {
  const NoiseSchedule schedule = Linear();
  ScriptedDenoiser denoiser([](float x, int t, bool) { return t == 999 ? 0.0F : x; });
  const Tensor start = Noise(1);
  SeededNoise noise(11, 1);
  const Tensor sample =
      *DdimSampler(schedule, Objective::kX0)
           .Sample(denoiser, {.steps = 2, .eta = 1.0, .clip_range = kNoClip}, start, noise);
  Tensor fresh(1, kState);
  SeededNoise(11, 1).Fill(fresh);
  const double a = schedule.Signal(999);
  const double b = schedule.Signal(499);
  const double sigma = std::sqrt((1.0 - a / b) * (1.0 - b) / (1.0 - a));
  for (std::size_t i = 0; i < start.values.size(); ++i) {
    const double expected =
        std::sqrt(1.0 - b - sigma * sigma) * start.values[i] / std::sqrt(1.0 - a) +
        sigma * fresh.values[i];
    EXPECT_NEAR(sample.values[i], expected, kFloat);
  }
}

TEST(DdimSampler, GuidanceExtrapolatesFromTheNullPrediction) {
  const DdimSampler sampler(Linear(), Objective::kX0);
  int null_calls = 0;
  ScriptedDenoiser denoiser([&](float x, int, bool with_image) {
    null_calls += with_image ? 0 : 1;
    return with_image ? 2.0F * x + 1.0F : x;
  });
  const Tensor states = Noise(2);
  const Tensor plain = *sampler.PredictGuided(denoiser, {.guidance = 1.0}, states, 500);
  EXPECT_EQ(null_calls, 0);  // the plain prediction costs one run
  const Tensor none = *sampler.PredictGuided(denoiser, {.guidance = 0.0}, states, 500);
  const Tensor twice = *sampler.PredictGuided(denoiser, {.guidance = 2.0}, states, 500);
  for (std::size_t i = 0; i < states.values.size(); ++i) {
    const double x = states.values[i];
    EXPECT_NEAR(plain.values[i], 2.0 * x + 1.0, kFloat);
    EXPECT_NEAR(none.values[i], x, kFloat);
    EXPECT_NEAR(twice.values[i], 3.0 * x + 2.0, kFloat);
  }
}

// Guided = 3 x + 2, with the image = 2 x + 1: deviations 3 : 2 whatever the sample, so a share of
// 0.7 scales by 0.7 * 2/3 + 0.3.
TEST(DdimSampler, RescaledGuidanceKeepsTheDeviationOfEachSample) {
  const DdimSampler sampler(Linear(), Objective::kX0);
  ScriptedDenoiser denoiser(
      [](float x, int, bool with_image) { return with_image ? 2.0F * x + 1.0F : x; });
  Tensor states = Noise(2);
  for (float& value : states.Item(1)) {
    value *= 10.0F;  // a second sample of another size
  }
  const Tensor guided =
      *sampler.PredictGuided(denoiser, {.guidance = 2.0, .guidance_rescale = 0.7}, states, 500);
  for (std::size_t i = 0; i < states.values.size(); ++i) {
    EXPECT_NEAR(guided.values[i], (0.7 * 2.0 / 3.0 + 0.3) * (3.0 * states.values[i] + 2.0),
                10.0 * kFloat);
  }
}

TEST(DdimSampler, ASampleDoesNotDependOnTheOthers) {
  const NoiseSchedule schedule = Cosine(1000);
  GaussianDenoiser denoiser = Gaussian(schedule, Objective::kX0);
  const DdimSampler sampler(schedule, Objective::kX0);
  const DdimOptions options{.steps = 4, .eta = 1.0};
  SeededNoise alone(6, 1);
  SeededNoise together(6, 7);
  const Tensor one = *sampler.Sample(denoiser, options, Noise(1), alone);
  const Tensor many = *sampler.Sample(denoiser, options, Noise(7), together);
  EXPECT_TRUE(std::ranges::equal(one.Item(0), many.Item(0)));
}

TEST(DdimSampler, RefusesWhatMakesNoSense) {
  const NoiseSchedule schedule = Linear();
  GaussianDenoiser denoiser = Gaussian(schedule, Objective::kX0);
  const DdimSampler sampler(schedule, Objective::kX0);
  SeededNoise noise(1, 1);
  const auto code = [&](const DdimOptions& options, const Tensor& states) {
    const auto sample = sampler.Sample(denoiser, options, states, noise);
    return sample ? ErrorCode::kInternal : sample.error().code;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(code({.steps = 0}, Noise(1)), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code({.steps = 1001}, Noise(1)), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code({.eta = -0.1}, Noise(1)), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code({.eta = nan}, Noise(1)), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code({.guidance = nan}, Noise(1)), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code({.guidance_rescale = 1.1}, Noise(1)), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code({.clip_range = 0.0}, Noise(1)), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code({.clip_range = nan}, Noise(1)), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code({}, Tensor(0, kState)), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code({}, Tensor(1, {3, 5, 1})), ErrorCode::kInvalidArgument);
}

TEST(DdimSampler, NoticesANetworkThatBreaksDown) {
  ScriptedDenoiser denoiser(
      [](float, int, bool) { return std::numeric_limits<float>::quiet_NaN(); });
  SeededNoise noise(1, 1);
  const auto sample = DdimSampler(Linear(), Objective::kX0).Sample(denoiser, {}, Noise(1), noise);
  ASSERT_FALSE(sample);
  EXPECT_EQ(sample.error().code, ErrorCode::kUntrustworthy);
}

}  // namespace
}  // namespace rsstab::rsdiff
