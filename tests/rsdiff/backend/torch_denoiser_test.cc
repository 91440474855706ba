// SPDX-License-Identifier: Apache-2.0
#include "rsdiff/backend/torch_denoiser.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "rsdiff/backend/load_denoiser.h"
#include "tests/rsdiff/reference_models.h"
#include "tests/support/test_paths.h"

namespace rsstab::rsdiff {
namespace {

namespace fs = std::filesystem;
using rsstab::testing::Answers;
using rsstab::testing::LargestDifference;
using rsstab::testing::ReferenceModel;
using rsstab::testing::TemporaryFolder;
using ::testing::HasSubstr;

constexpr int kTime = 421;
constexpr Shape kState{2, 16, 16};
constexpr Shape kCondition{3, 16, 16};
constexpr BackendOptions kCpu{.device = "cpu", .num_threads = 1};
// The same library on both sides, but perhaps with another number of threads.
constexpr double kRounding = 2e-5;

class TorchDenoiserTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = ReferenceModel("small");
    if (folder_.empty()) {
      GTEST_SKIP() << "the models are made by the ctest rsdiff/reference_models";
    }
    answers_ = Answers(folder_);
    auto denoiser = LoadDenoiser(Info(), kCpu);
    ASSERT_TRUE(denoiser) << denoiser.error().message;
    denoiser_ = std::move(*denoiser);
  }

  [[nodiscard]] ModelInfo Info() const { return *ReadModelFile(folder_); }
  [[nodiscard]] Tensor Condition() { return answers_.Get("condition", kCondition); }
  [[nodiscard]] Tensor States() { return answers_.Get("x", kState); }

  fs::path folder_;
  Answers answers_;
  std::unique_ptr<Denoiser> denoiser_;
};

TEST_F(TorchDenoiserTest, ComputesWhatPyTorchDoes) {
  ASSERT_EQ(denoiser_->StateShape(), kState);
  ASSERT_EQ(denoiser_->ConditionShape(), kCondition);
  ASSERT_TRUE(denoiser_->Encode(Condition()));
  for (const auto& [name, conditioning] :
       {std::pair{"with_image", Conditioning::kWithImage},
        std::pair{"without_image", Conditioning::kWithoutImage}}) {
    const auto prediction = denoiser_->Predict(States(), kTime, conditioning);
    ASSERT_TRUE(prediction) << prediction.error().message;
    EXPECT_LT(LargestDifference(*prediction, answers_.Get(name, kState)), kRounding) << name;
  }
}

TEST_F(TorchDenoiserTest, ASampleDoesNotDependOnTheOthers) {
  ASSERT_TRUE(denoiser_->Encode(Condition()));
  const auto together = *denoiser_->Predict(States(), kTime, Conditioning::kWithImage);
  const Tensor states = States();
  for (int i = 0; i < states.batch; ++i) {
    Tensor one(1, kState);
    std::ranges::copy(states.Item(i), one.values.begin());
    const auto alone = *denoiser_->Predict(one, kTime, Conditioning::kWithImage);
    Tensor expected(1, kState);
    std::ranges::copy(together.Item(i), expected.values.begin());
    EXPECT_LT(LargestDifference(alone, expected), kRounding);
  }
}

TEST_F(TorchDenoiserTest, EveryImageCounts) {
  ASSERT_TRUE(denoiser_->Encode(Condition()));
  const auto first = *denoiser_->Predict(States(), kTime, Conditioning::kWithImage);
  ASSERT_TRUE(denoiser_->Encode(Tensor(1, kCondition)));
  const auto grey = *denoiser_->Predict(States(), kTime, Conditioning::kWithImage);
  EXPECT_GT(LargestDifference(first, grey), 100 * kRounding);
}

TEST_F(TorchDenoiserTest, RefusesWhatDoesNotFit) {
  EXPECT_EQ(denoiser_->Predict(States(), kTime, Conditioning::kWithImage).error().code,
            ErrorCode::kInvalidArgument);
  EXPECT_EQ(denoiser_->Encode(Tensor(2, kCondition)).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(denoiser_->Encode(Tensor(1, kState)).error().code, ErrorCode::kInvalidArgument);
  ASSERT_TRUE(denoiser_->Encode(Condition()));
  for (const int t : {-1, 1000}) {
    EXPECT_EQ(denoiser_->Predict(States(), t, Conditioning::kWithImage).error().code,
              ErrorCode::kInvalidArgument);
  }
  for (const Tensor& states : {Tensor(0, kState), Tensor(1, kCondition)}) {
    EXPECT_EQ(denoiser_->Predict(states, kTime, Conditioning::kWithImage).error().code,
              ErrorCode::kInvalidArgument);
  }
}

TEST_F(TorchDenoiserTest, RefusesDevicesThatItDoesNotHave) {
  const auto denoiser = LoadDenoiser(Info(), {.device = "abacus"});
  ASSERT_FALSE(denoiser);
  EXPECT_EQ(denoiser.error().code, ErrorCode::kUnsupported);
  EXPECT_THAT(denoiser.error().message, HasSubstr("cpu"));
}

TEST_F(TorchDenoiserTest, RefusesWeightsThatAreDamagedOrNoNetwork) {
  const TemporaryFolder folder;
  ModelInfo info = Info();
  info.network.path = folder / "network.pt";
  std::ofstream(info.network.path) << "no network";
  const auto damaged = LoadDenoiser(info, kCpu);
  ASSERT_FALSE(damaged);
  EXPECT_THAT(damaged.error().message, HasSubstr("SHA-256"));
  info.network.sha256 = *Sha256("no network");
  const auto foreign = LoadDenoiser(info, kCpu);
  ASSERT_FALSE(foreign);
  EXPECT_EQ(foreign.error().code, ErrorCode::kCorruptData);
  EXPECT_THAT(foreign.error().message, HasSubstr("not a network"));
  info.network.path = folder / "absent.pt";
  EXPECT_EQ(LoadDenoiser(info, kCpu).error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace rsstab::rsdiff
