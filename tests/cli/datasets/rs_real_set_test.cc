// SPDX-License-Identifier: Apache-2.0
#include "cli/datasets/rs_real_set.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "cli/images/npz_file.h"
#include "igf/base/whole_file.h"
#include "tests/evaluation/test_photos.h"
#include "tests/support/test_paths.h"

namespace rsstab::datasets {
namespace {

using images::NpzArray;
using rsstab::testing::LevelAt;
using rsstab::testing::TemporaryFolder;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr std::size_t kWidth = 8;
constexpr std::size_t kHeight = 6;

// A sample as published: three channels that differ, a field that differs in x and y.
void WriteSample(const std::filesystem::path& path, bool with_pictures = true) {
  std::filesystem::create_directories(path.parent_path());
  std::vector<std::uint8_t> rs(kHeight * kWidth * 3);
  std::vector<std::uint8_t> gs(rs.size());
  for (std::size_t i = 0; i < rs.size(); ++i) {
    rs[i] = static_cast<std::uint8_t>(20 + i);
    gs[i] = static_cast<std::uint8_t>(40 + i);
  }
  std::vector<float> flow(2 * kHeight * kWidth, 1.0F);
  std::fill(flow.begin() + kHeight * kWidth, flow.end(), -0.5F);
  std::vector<NpzArray> arrays = {{"out_flow", {2, kHeight, kWidth}, flow}};
  if (with_pictures) {
    arrays.push_back({"condition", {kHeight, kWidth, 3}, rs});
    arrays.push_back({"gs", {kHeight, kWidth, 3}, gs});
  }
  ASSERT_TRUE(images::WriteNpz(path.string(), arrays));
}

TEST(RsRealSet, ReadsThePublishedLayout) {
  const TemporaryFolder folder;
  WriteSample(folder / "RS_Real/train/day/walk/0007.npz");
  WriteSample(folder / "RS_Real/test/npz/0001.npz");
  WriteSample(folder / "RS_Real/test/npz/0002.npz");
  const auto all = OpenRsReal(folder.path(), "all");
  ASSERT_TRUE(all) << all.error().message;
  EXPECT_EQ((*all)->Clips().size(), 3U);
  const auto test = OpenRsReal(folder / "RS_Real", "test");
  ASSERT_TRUE(test);
  ASSERT_EQ((*test)->Clips().size(), 2U);
  EXPECT_EQ((*test)->Clips()[1].name, "test/npz/0002");
  const auto sample = (*all)->Load("train/day/walk/0007");
  ASSERT_TRUE(sample) << sample.error().message;
  EXPECT_EQ(sample->split, "train");
  EXPECT_EQ(sample->reference_row, 0.0);
  EXPECT_EQ(sample->rs.width, static_cast<int>(kWidth));
  EXPECT_EQ(LevelAt(sample->rs, 2, 1, 0), 20 + 3 * (8 + 2));
  EXPECT_EQ(LevelAt(sample->rs, 2, 1, 2), 22 + 3 * (8 + 2));
  EXPECT_EQ(LevelAt(sample->gs, 0, 0, 1), 41);
  EXPECT_EQ(sample->truth[0], Eigen::Vector2f(1.0F, -0.5F));
  EXPECT_EQ(sample->valid[0], 0);  // from above the frame
  EXPECT_EQ(sample->valid[kWidth], 1);
  EXPECT_EQ(sample->valid[2 * kWidth - 1], 0);  // from the right of it
  EXPECT_FALSE(sample->camera.has_value());
  EXPECT_FALSE(sample->gyro.has_value());
  EXPECT_THAT(OpenRsReal(folder / "RS_Real/test/npz", "train")->get()->Clips()[0].name, "0001");
  EXPECT_EQ(OpenRsReal(folder / "nothing", "all").error().code, ErrorCode::kNotFound);
}

TEST(RsRealSet, PicturesMayComeFromTheJpeg) {
  const TemporaryFolder folder;
  WriteSample(folder / "test/npz/0001.npz", false);
  const auto set = OpenRsReal(folder.path(), "all");
  ASSERT_TRUE(set);
  EXPECT_THAT((*set)->Load("test/npz/0001").error().message, HasSubstr("test/jpg/0001.jpg"));
  std::filesystem::create_directories(folder / "test/jpg");
  cv::Mat both(kHeight, 2 * kWidth, CV_8UC3, cv::Scalar(90, 90, 90));
  both.colRange(0, kWidth).setTo(cv::Scalar(160, 160, 160));
  cv::imwrite((folder / "test/jpg/0001.jpg").string(), both);
  const auto sample = (*set)->Load("test/npz/0001");
  ASSERT_TRUE(sample) << sample.error().message;
  EXPECT_EQ(sample->rs.width, static_cast<int>(kWidth));
  EXPECT_NEAR(LevelAt(sample->rs, 3, 3), 160, 3);
  EXPECT_NEAR(LevelAt(sample->gs, 3, 3), 90, 3);
}

TEST(RsRealSet, FoldersOfSequencesAreClipsInTheirOrder) {
  const TemporaryFolder folder;
  for (const char* name : {"9", "10", "1"}) {
    WriteSample(folder / "test/npz/seq_1" / (std::string(name) + ".npz"));
  }
  WriteSample(folder / "test/npz/other/1.npz");
  WriteSample(folder / "test/npz/other/2.npz");
  const auto set = OpenRsReal(folder.path(), "all");
  ASSERT_TRUE(set);
  ASSERT_EQ((*set)->Clips().size(), 3U);
  EXPECT_EQ((*set)->Clips()[2].name, "test/npz/seq_1");
  EXPECT_THAT((*set)->Clips()[2].pictures,
              ElementsAre("test/npz/seq_1/1", "test/npz/seq_1/9", "test/npz/seq_1/10"));
}

TEST(RsRealSet, SideFilesAreRead) {
  const TemporaryFolder folder;
  WriteSample(folder / "test/npz/1.npz");
  ASSERT_TRUE(WriteWholeFile((folder / "test/npz/1.json").string(),
                             R"({"camera": {"width": 8, "height": 6, "fx": 9, "readout_s": 0.02},
                                 "frame_interval_s": 0.04, "strength": "weak", "source": "a.jpg"})"));
  std::string log = "t,gx,gy,gz\n";
  for (int i = 0; i < 20; ++i) {
    log += std::to_string(-0.01 + 0.001 * i) + ",0.1,0.2,0.3\n";
  }
  ASSERT_TRUE(WriteWholeFile((folder / "test/npz/1.gyro.csv").string(), log));
  const auto set = OpenRsReal(folder.path(), "all");
  ASSERT_TRUE(set);
  const auto sample = (*set)->Load("test/npz/1");
  ASSERT_TRUE(sample) << sample.error().message;
  EXPECT_EQ(sample->camera->fx, 9.0);
  EXPECT_EQ(sample->camera->readout_s, 0.02);
  EXPECT_EQ(sample->frame_interval_s, 0.04);
  EXPECT_EQ(sample->strength, "weak");
  EXPECT_EQ(sample->source, "a.jpg");
  EXPECT_EQ(sample->gyro->samples().size(), 20U);
  ASSERT_TRUE(WriteWholeFile((folder / "test/npz/1.json").string(), "{\"camera\": 3}"));
  EXPECT_THAT((*set)->Load("test/npz/1").error().message, HasSubstr("1.json"));
}

TEST(RsRealSet, DamageNamesTheFile) {
  const TemporaryFolder folder;
  WriteSample(folder / "test/npz/1.npz");
  const std::string path = (folder / "test/npz/1.npz").string();
  const std::vector<std::uint8_t> grey(12, 1);
  const auto set = OpenRsReal(folder.path(), "all");
  ASSERT_TRUE(set);
  ASSERT_TRUE(images::WriteNpz(path, std::vector<NpzArray>{{"condition", {3, 4}, grey}}));
  EXPECT_THAT((*set)->Load("test/npz/1").error().message, HasSubstr("1.npz"));
  ASSERT_TRUE(WriteWholeFile(path, "no zip"));
  EXPECT_THAT((*set)->Load("test/npz/1").error().message, HasSubstr("1.npz"));
}

}  // namespace
}  // namespace rsstab::datasets
