// SPDX-License-Identifier: Apache-2.0
#include "cli/datasets/pair_set.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "cli/images/flo_file.h"
#include "tests/evaluation/test_photos.h"
#include "tests/support/test_paths.h"

namespace rsstab::datasets {
namespace {

using rsstab::testing::MakePhoto;
using rsstab::testing::TemporaryFolder;
using rsstab::testing::Waves;
using rsstab::testing::WritePhoto;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr int kWidth = 64;
constexpr int kHeight = 48;

void WritePicture(const std::filesystem::path& path, int width = kWidth) {
  std::filesystem::create_directories(path.parent_path());
  WritePhoto(path, MakePhoto(width, kHeight, [](int x, int y) { return Waves(x, y); }));
}

std::vector<std::string> NamesOf(const evaluation::PictureSet& set) {
  std::vector<std::string> names;
  for (const auto& clip : set.Clips()) {
    names.insert(names.end(), clip.pictures.begin(), clip.pictures.end());
  }
  return names;
}

TEST(PairSet, UnderstandsTheDemoNames) {
  const TemporaryFolder folder;
  EXPECT_EQ(OpenPairs(folder.path(), false).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(OpenPairs(folder / "missing", false).error().code, ErrorCode::kNotFound);
  for (const char* name : {"Fastec/seq_03", "Carla/seq_01"}) {
    for (const char* file : {"rs_0.png", "rs_1.png", "gs_1.png"}) {
      WritePicture(folder / name / file);
    }
  }
  WritePicture(folder / "Carla/seq_02/rs_1.png");  // no truth
  const auto set = OpenPairs(folder.path(), true);
  ASSERT_TRUE(set) << set.error().message;
  EXPECT_THAT(NamesOf(**set), ElementsAre("Carla/seq_01", "Fastec/seq_03"));
  const auto pair = (*set)->Load("Fastec/seq_03");
  ASSERT_TRUE(pair) << pair.error().message;
  EXPECT_EQ(pair->reference_row, (kHeight - 1) / 2.0);  // the names say so
  EXPECT_TRUE(pair->previous.has_value());
  EXPECT_TRUE(pair->truth.empty());
}

TEST(PairSet, UnderstandsTheWholeSetsNames) {
  const TemporaryFolder folder;
  for (const char* file : {"000_rolling.png", "000_global_middle.png", "001_rolling.png",
                           "001_global_middle.png", "001_global_first.png"}) {
    WritePicture(folder / "train/7" / file);
  }
  WritePicture(folder / "train/8/000_rolling.png");
  WritePicture(folder / "train/8/000_global_first.png");
  const auto set = OpenPairs(folder.path(), false);
  ASSERT_TRUE(set) << set.error().message;
  ASSERT_EQ((*set)->Clips().size(), 2U);
  EXPECT_THAT((*set)->Clips()[0].pictures, ElementsAre("train/7/000", "train/7/001"));
  EXPECT_EQ((*set)->Load("train/7/001")->reference_row, (kHeight - 1) / 2.0);
  EXPECT_EQ((*set)->Load("train/8/000")->reference_row, 0.0);
}

TEST(PairSet, PlainFoldersMayHoldFields) {
  const TemporaryFolder folder;
  WritePicture(folder / "Building/rs/a.png");
  WritePicture(folder / "Building/gs/a.png");
  WritePicture(folder / "Homo/b_rs.png");
  WritePicture(folder / "Homo/b_gs.png");
  MotionField field(kWidth, kHeight, 2, 2);
  for (Eigen::Vector2f& d : field.vertices()) {
    d = {2.0F, -1.0F};
  }
  std::filesystem::create_directories(folder / "Building/flow");
  for (const char* name : {"Building/flow/a.flo", "Homo/b.flo"}) {
    std::ofstream file(folder / name, std::ios::binary);
    images::WriteFlo(field, file);
  }
  const auto set = OpenPairs(folder.path(), true);
  ASSERT_TRUE(set) << set.error().message;
  EXPECT_THAT(NamesOf(**set), ElementsAre("Building/a", "Homo/b"));
  for (const char* name : {"Building/a", "Homo/b"}) {
    const auto pair = (*set)->Load(name);
    ASSERT_TRUE(pair) << pair.error().message;
    EXPECT_EQ(pair->reference_row, 0.0);
    ASSERT_EQ(pair->truth.size(), static_cast<std::size_t>(kWidth * kHeight));
    EXPECT_EQ(pair->truth[100], Eigen::Vector2f(2.0F, -1.0F));
  }
  std::ofstream(folder / "Homo/b.flo") << "PIEH and no more";
  EXPECT_THAT((*set)->Load("Homo/b").error().message, HasSubstr("b.flo"));
}

TEST(PairSet, TwoSizesAreNoPair) {
  const TemporaryFolder folder;
  WritePicture(folder / "a_rs.png", kWidth + 2);
  WritePicture(folder / "a_gs.png");
  const auto set = OpenPairs(folder.path(), false);
  ASSERT_TRUE(set);
  const auto pair = (*set)->Load("a");
  ASSERT_FALSE(pair);
  EXPECT_EQ(pair.error().code, ErrorCode::kCorruptData);
  EXPECT_THAT(pair.error().message, HasSubstr("66x48"));
}

}  // namespace
}  // namespace rsstab::datasets
