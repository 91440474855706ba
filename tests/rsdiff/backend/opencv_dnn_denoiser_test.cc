// SPDX-License-Identifier: Apache-2.0
#include "rsdiff/backend/opencv_dnn_denoiser.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <string>

#include "igf/base/whole_file.h"
#include "rsdiff/backend/load_denoiser.h"
#include "rsdiff/time_embedding.h"
#include "tests/support/test_paths.h"

namespace rsstab::rsdiff {
namespace {

namespace fs = std::filesystem;
using rsstab::testing::TemporaryFolder;
using ::testing::HasSubstr;

constexpr int kBands = 24;
constexpr int kFeatures = 2;
constexpr int kTime = 4;
constexpr Shape kCondition{73, kBands, 16};
constexpr double kFloat = 1e-5;  // float32 sums of a few dozen numbers

ModelInfo TinyModel() {
  return *ReadModelFile(rsstab::testing::SourceFile("tests/rsdiff/data/tiny_model"));
}

Tensor Condition(double phase) {
  Tensor condition(1, kCondition);
  for (std::size_t i = 0; i < condition.values.size(); ++i) {
    condition.values[i] = static_cast<float>(std::sin(0.37 * static_cast<double>(i) + phase));
  }
  return condition;
}

Tensor States(int batch) {
  Tensor states(batch, {3, kBands, 1});
  for (std::size_t i = 0; i < states.values.size(); ++i) {
    states.values[i] = static_cast<float>(std::cos(0.81 * static_cast<double>(i)));
  }
  return states;
}

// The closed form in data/make_tiny_model.py.
double Feature(const Tensor& condition, int f, int band) {
  double sum = 0.0;
  for (int c = 0; c < kCondition.channels; ++c) {
    const double weight = std::sin(0.7 * (f * kCondition.channels + c)) / kCondition.channels;
    for (int column = 0; column < kCondition.columns; ++column) {
      const int index = (c * kBands + band) * kCondition.columns + column;
      sum += weight * condition.values[static_cast<std::size_t>(index)] / kCondition.columns;
    }
  }
  return sum;
}

double Expected(const Tensor& states, int item, int axis, int band, int t,
                const Tensor* condition) {
  const std::vector<float> time = TimeEmbedding(t, 1000, kTime);
  const int inside = 3 + kTime + kFeatures;
  const auto weight = [&](int i) { return std::sin(1.0 + 0.3 * (axis * inside + i)) / 4.0; };
  double sum = 0.0;
  for (int c = 0; c < 3; ++c) {
    sum += weight(c) * states.Item(item)[static_cast<std::size_t>(c * kBands + band)];
  }
  for (int k = 0; k < kTime; ++k) {
    sum += weight(3 + k) * time[static_cast<std::size_t>(k)];
  }
  for (int f = 0; condition != nullptr && f < kFeatures; ++f) {
    sum += weight(3 + kTime + f) * Feature(*condition, f, band);
  }
  return sum;
}

void ExpectPrediction(const Tensor& prediction, const Tensor& states, int t,
                      const Tensor* condition) {
  ASSERT_EQ(prediction.batch, states.batch);
  ASSERT_EQ(prediction.shape, states.shape);
  for (int item = 0; item < states.batch; ++item) {
    for (int axis = 0; axis < 3; ++axis) {
      for (int band = 0; band < kBands; ++band) {
        EXPECT_NEAR(prediction.Item(item)[static_cast<std::size_t>(axis * kBands + band)],
                    Expected(states, item, axis, band, t, condition), kFloat)
            << item << " " << axis << " " << band;
      }
    }
  }
}

// cos and sin of t / T * pi/2 * 2^k.
TEST(TimeEmbedding, HasItsClosedForm) {
  const std::vector<float> embedding = TimeEmbedding(250, 1000, 6);
  const double eighth = std::atan(1.0) / 2.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double phase = eighth * static_cast<double>(1U << k);
    EXPECT_NEAR(embedding[k], std::cos(phase), 1e-7);
    EXPECT_NEAR(embedding[3 + k], std::sin(phase), 1e-7);
  }
}

// Batches below, at and above the exported sizes 1 and 4: in pieces, the last one padded.
TEST(OpenCvDnnDenoiser, ComputesTheNetworkForAnyBatch) {
  const auto denoiser = *LoadOpenCvDnnDenoiser(TinyModel(), {});
  EXPECT_EQ(denoiser->StateShape(), (Shape{3, kBands, 1}));
  EXPECT_EQ(denoiser->ConditionShape(), kCondition);
  const Tensor condition = Condition(0.0);
  ASSERT_TRUE(denoiser->Encode(condition));
  for (const int batch : {1, 3, 4, 6, 9}) {
    const Tensor states = States(batch);
    for (const int t : {0, 620, 999}) {
      ExpectPrediction(*denoiser->Predict(states, t, Conditioning::kWithImage), states, t,
                       &condition);
      ExpectPrediction(*denoiser->Predict(states, t, Conditioning::kWithoutImage), states, t,
                       nullptr);
    }
  }
}

TEST(OpenCvDnnDenoiser, ForgetsTheImageBefore) {
  const auto denoiser = *LoadOpenCvDnnDenoiser(TinyModel(), {});
  const Tensor states = States(2);
  for (const double phase : {0.0, 1.0, 2.0}) {
    const Tensor condition = Condition(phase);
    ASSERT_TRUE(denoiser->Encode(condition));
    ExpectPrediction(*denoiser->Predict(states, 5, Conditioning::kWithImage), states, 5,
                     &condition);
  }
}

TEST(OpenCvDnnDenoiser, RefusesOtherShapes) {
  const auto denoiser = *LoadOpenCvDnnDenoiser(TinyModel(), {});
  EXPECT_FALSE(denoiser->Encode(Tensor(1, {73, 24, 15})));
  EXPECT_FALSE(denoiser->Encode(Tensor(2, kCondition)));
  EXPECT_FALSE(denoiser->Predict(Tensor(1, {3, 12, 1}), 0, Conditioning::kWithImage));
  EXPECT_FALSE(denoiser->Predict(Tensor(0, {3, kBands, 1}), 0, Conditioning::kWithImage));
}

TEST(OpenCvDnnDenoiser, NamesTheDevicesThereAre) {
  const auto denoiser = LoadOpenCvDnnDenoiser(TinyModel(), {.device = "abacus"});
  ASSERT_FALSE(denoiser);
  EXPECT_EQ(denoiser.error().code, ErrorCode::kUnsupported);
  EXPECT_THAT(denoiser.error().message, HasSubstr("\"abacus\""));
  EXPECT_THAT(denoiser.error().message, HasSubstr("cpu"));
}

TEST(OpenCvDnnDenoiser, RefusesNetworksThatDoNotFitTheModelFile) {
  ::testing::internal::CaptureStderr();
  ModelInfo other_condition = TinyModel();
  other_condition.condition.columns = 12;
  ModelInfo other_bands = TinyModel();
  other_bands.motion.rows = 20;
  ModelInfo other_time = TinyModel();
  other_time.time_embedding_size = 6;
  ModelInfo swapped = TinyModel();
  std::swap(swapped.encoder, swapped.denoisers[0]);
  swapped.denoisers[0].batch = 1;
  for (const ModelInfo& model : {other_condition, other_bands, other_time, swapped}) {
    const auto denoiser = LoadOpenCvDnnDenoiser(model, {});
    ASSERT_FALSE(denoiser);
    EXPECT_EQ(denoiser.error().code, ErrorCode::kCorruptData) << denoiser.error().message;
    EXPECT_THAT(denoiser.error().message, HasSubstr("model.json"));
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");  // libraries do not print
}

// Bytes with the right checksum that are no network, or half of one.
TEST(OpenCvDnnDenoiser, RefusesBytesThatAreNoNetwork) {
  const TemporaryFolder folder;
  const std::string whole = *ReadWeights(TinyModel().encoder);
  for (const std::string& bytes : {std::string("not a network"), whole.substr(0, whole.size() / 2),
                                   std::string(2000, '\xff')}) {
    ModelInfo model = TinyModel();
    model.encoder.path = folder / "encoder.onnx";
    model.encoder.sha256 = *Sha256(bytes);
    ASSERT_TRUE(WriteWholeFile(model.encoder.path.string(), bytes));
    const auto denoiser = LoadOpenCvDnnDenoiser(model, {});
    ASSERT_FALSE(denoiser);
    EXPECT_EQ(denoiser.error().code, ErrorCode::kCorruptData) << denoiser.error().message;
  }
}

TEST(LoadDenoiser, TakesTheLibraryThatTheModelNames) {
  EXPECT_TRUE(LoadDenoiser(TinyModel()));
  ModelInfo model = TinyModel();
  model.library = NetworkLibrary::kTorch;
  model.network.path = "nowhere.pt";
  const auto denoiser = LoadDenoiser(model);
  ASSERT_FALSE(denoiser);
#ifndef RSSTAB_WITH_TORCH
  EXPECT_EQ(denoiser.error().code, ErrorCode::kUnsupported);
  EXPECT_THAT(denoiser.error().message, HasSubstr("RSSTAB_WITH_TORCH"));
#endif
}

}  // namespace
}  // namespace rsstab::rsdiff
