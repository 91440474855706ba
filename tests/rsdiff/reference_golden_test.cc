// SPDX-License-Identifier: Apache-2.0
// The reference network, converted from a checkpoint, and the sampler against what the published
// implementation computes with the same weights.
#include <gtest/gtest.h>

#include <iostream>
#include <memory>
#include <string>

#include "rsdiff/backend/load_denoiser.h"
#include "rsdiff/ddim_sampler.h"
#include "tests/rsdiff/reference_models.h"

namespace rsstab::rsdiff {
namespace {

using rsstab::testing::Answers;
using rsstab::testing::LargestDifference;
using rsstab::testing::ReferenceModel;

constexpr Shape kState{2, 64, 64};
constexpr Shape kCondition{3, 64, 64};
// As asked for. On the kernels that made the answers (see cmake/RsstabReferenceTests.cmake) nothing
// differs at all; these weights turn another order of summation into a few 1e-4.
constexpr double kTolerance = 1e-3;
// Above it, the kernels are others, and eight steps of a network that amplifies rounding
// ten-thousandfold cannot be compared.
constexpr double kSameKernels = 1e-6;
constexpr float kPixelsPerUnit = 63.0F;  // W - 1 = H - 1
constexpr int kSteps = 8;

class ReferenceGolden : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    const std::filesystem::path folder = ReferenceModel("published");
    if (folder.empty()) {
      return;
    }
    answers_ = Answers(folder);
    const auto info = ReadModelFile(folder);
    ASSERT_TRUE(info) << info.error().message;
    auto denoiser = LoadDenoiser(*info, {.device = "cpu"});
    ASSERT_TRUE(denoiser) << denoiser.error().message;
    denoiser_ = std::move(*denoiser);
    Tensor condition = answers_.Get("image01", kCondition);
    for (float& value : condition.values) {
      value = 2.0F * value - 1.0F;
    }
    const Status encoded = denoiser_->Encode(condition);
    ASSERT_TRUE(encoded) << encoded.error().message;
    sampler_ = std::make_unique<DdimSampler>(
        *NoiseSchedule::Create(info->schedule, info->diffusion_steps), info->objective);
  }
  static void TearDownTestSuite() { denoiser_.reset(); }
  void SetUp() override {
    if (denoiser_ == nullptr) {
      GTEST_SKIP() << "no golden.npz in the development data, or no PyTorch";
    }
  }

  static double Deviation(const std::string& name, const Result<Tensor>& found) {
    if (!found) {
      ADD_FAILURE() << name << ": " << found.error().message;
      return 0.0;
    }
    const double deviation = LargestDifference(*found, answers_.Get(name, kState));
    std::cout << name << ": largest deviation " << deviation << "\n";
    return deviation;
  }
  static Result<Tensor> Predict(int t, const DdimOptions& options = {}) {
    return sampler_->PredictGuided(*denoiser_, options, answers_.Get("x", kState), t);
  }

  static inline Answers answers_;
  static inline std::unique_ptr<Denoiser> denoiser_;
  static inline std::unique_ptr<DdimSampler> sampler_;
};

TEST_F(ReferenceGolden, OutputsAtFourTimes) {
  for (const int t : {0, 125, 500, 999}) {
    const std::string name = "unet_t" + std::to_string(t);
    EXPECT_LT(Deviation(name, Predict(t)), kTolerance) << name;
  }
}

TEST_F(ReferenceGolden, GuidedOutput) {
  DdimOptions options;
  options.guidance = 2.0;
  options.guidance_rescale = 0.7;
  EXPECT_LT(Deviation("cfg2_phi07_t500", Predict(500, options)), kTolerance);
}

TEST_F(ReferenceGolden, SampledField) {
  if (const double deviation = Deviation("unet_t999", Predict(999)); deviation > kSameKernels) {
    GTEST_SKIP() << "this processor or BLAS sums in another order (" << deviation
                 << " off at t = 999), which eight steps amplify";
  }
  DdimOptions options;
  options.steps = kSteps;
  SeededNoise unused(1, 1);
  auto field = sampler_->Sample(*denoiser_, options, answers_.Get("x", kState), unused);
  if (field) {
    for (float& value : field->values) {
      value *= kPixelsPerUnit;
    }
  }
  EXPECT_LT(Deviation("ddim8_eta0_flow_px", field), kTolerance);
}

}  // namespace
}  // namespace rsstab::rsdiff
