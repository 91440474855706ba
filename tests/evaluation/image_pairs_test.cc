// SPDX-License-Identifier: Apache-2.0
#include "evaluation/image_pairs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "tests/evaluation/test_photos.h"
#include "tests/support/test_paths.h"

namespace rsstab::evaluation {
namespace {

using rsstab::testing::MakePhoto;
using rsstab::testing::Waves;
using rsstab::testing::WritePhoto;
using ::testing::HasSubstr;

constexpr int kShift_px = 4;

// Says that everything lies `shift` pixels farther right in the recorded picture.
class ShiftMethod final : public MotionMethod {
 public:
  [[nodiscard]] std::string Name() const override { return "shift"; }
  [[nodiscard]] Result<MethodAnswer> Estimate(const MethodInput& input) override {
    EXPECT_EQ(input.motion, nullptr);  // nobody knows it here
    MethodAnswer answer{MotionField(input.rs.width, input.rs.height, 2, 2), {}};
    for (Eigen::Vector2f& d : answer.field.vertices()) {
      d.x() = kShift_px;
    }
    return answer;
  }
};

Result<MethodSet> Methods() {
  MethodSet set;
  set.methods.push_back(std::make_unique<NoCorrection>());
  set.methods.push_back(std::make_unique<ShiftMethod>());
  return set;
}

// A pair whose rolling-shutter picture is the other one, shifted.
void WritePair(const std::filesystem::path& folder, int width = 160) {
  std::filesystem::create_directories(folder);
  WritePhoto(folder / "gs_1.png", MakePhoto(160, 120, [](int x, int y) { return Waves(x, y); }));
  WritePhoto(folder / "rs_1.png",
             MakePhoto(width, 120, [](int x, int y) { return Waves(x - kShift_px, y); }));
}

TEST(ImagePairs, AreFoundInFoldersBelow) {
  const rsstab::testing::TemporaryFolder folder;
  EXPECT_EQ(FindImagePairs(folder.path()).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(FindImagePairs(folder / "missing").error().code, ErrorCode::kNotFound);
  WritePair(folder / "Fastec/seq_03");
  WritePair(folder / "Carla/seq_01");
  std::filesystem::create_directories(folder / "empty");
  const auto pairs = FindImagePairs(folder.path());
  ASSERT_TRUE(pairs);
  ASSERT_EQ(pairs->size(), 2U);
  EXPECT_EQ((*pairs)[0].name, "Carla/seq_01");
  EXPECT_EQ((*pairs)[1].name, "Fastec/seq_03");
  EXPECT_EQ(FindImagePairs(folder / "Carla/seq_01")->size(), 1U);
}

TEST(ImagePairs, AreJudgedBeforeAndAfter) {
  const rsstab::testing::TemporaryFolder folder;
  WritePair(folder / "one");
  const auto records = RunImagePairs(FindImagePairs(folder.path()).value(), {}, Methods);
  ASSERT_TRUE(records) << records.error().message;
  ASSERT_EQ(records->pairs.size(), 1U);
  const PairScore& none = records->pairs[0].methods[0];
  const PairScore& shift = records->pairs[0].methods[1];
  EXPECT_EQ(none.psnr_db, none.untouched_psnr_db);
  EXPECT_EQ(none.valid_share, 1.0);
  EXPECT_EQ(none.moved_px, 0.0);
  EXPECT_GT(shift.psnr_db, 50.0);  // the same pixels again
  EXPECT_LT(shift.untouched_psnr_db, 25.0);
  EXPECT_GT(shift.ssim, 0.99);
  EXPECT_NEAR(shift.valid_share, 1.0 - kShift_px / 160.0, 1e-9);
  EXPECT_NEAR(shift.moved_px, kShift_px, 1e-6);
}

TEST(ImagePairs, OfTwoSizesAreLeftOut) {
  const rsstab::testing::TemporaryFolder folder;
  WritePair(folder / "bad", 162);
  WritePair(folder / "good");
  const auto records =
      RunImagePairs(FindImagePairs(folder.path()).value(), {.seed = 1, .jobs = 2}, Methods);
  ASSERT_TRUE(records);
  EXPECT_EQ(records->pairs.size(), 1U);
  ASSERT_EQ(records->failures.size(), 1U);
  EXPECT_EQ(records->failures[0].first, "bad");
  EXPECT_THAT(records->failures[0].second.message, HasSubstr("162x120"));
  const auto only_bad = RunImagePairs(FindImagePairs(folder / "bad").value(), {}, Methods);
  ASSERT_FALSE(only_bad);
  EXPECT_EQ(only_bad.error().code, ErrorCode::kCorruptData);
}

}  // namespace
}  // namespace rsstab::evaluation
