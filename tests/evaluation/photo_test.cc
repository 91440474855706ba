// SPDX-License-Identifier: Apache-2.0
#include "evaluation/photo.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "igf/base/whole_file.h"
#include "tests/evaluation/test_photos.h"
#include "tests/support/test_paths.h"

namespace rsstab::evaluation {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(Photo, IsReadAsRgb) {
  const rsstab::testing::TemporaryFolder folder;
  const std::string path = (folder / "red.png").string();
  // OpenCV writes blue, green, red, alpha.
  cv::imwrite(path, cv::Mat(20, 30, CV_8UC4, cv::Scalar(10, 20, 200, 255)));
  const auto photo = LoadPhoto(path);
  ASSERT_TRUE(photo) << photo.error().message;
  EXPECT_EQ(photo->width, 30);
  EXPECT_EQ(photo->height, 20);
  EXPECT_EQ(rsstab::testing::LevelAt(*photo, 7, 5, 0), 200);
  EXPECT_EQ(rsstab::testing::LevelAt(*photo, 7, 5, 2), 10);
}

TEST(Photo, WhatIsNoPictureIsNamed) {
  const rsstab::testing::TemporaryFolder folder;
  const std::string path = (folder / "text.jpg").string();
  ASSERT_TRUE(WriteWholeFile(path, "hello"));
  EXPECT_EQ(LoadPhoto(path).error().code, ErrorCode::kCorruptData);
  EXPECT_THAT(LoadPhoto(path).error().message, HasSubstr("text.jpg"));
  EXPECT_EQ(LoadPhoto(folder / "missing.jpg").error().code, ErrorCode::kNotFound);
}

TEST(Photo, FoldersAreListedByName) {
  const rsstab::testing::TemporaryFolder folder;
  EXPECT_EQ(ListPhotos(folder.path()).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(ListPhotos(folder / "missing").error().code, ErrorCode::kNotFound);
  for (const char* name : {"b.JPG", "a.png", "notes.txt"}) {
    ASSERT_TRUE(WriteWholeFile((folder / name).string(), "x"));
  }
  std::filesystem::create_directory(folder / "c.png");
  EXPECT_THAT(ListPhotos(folder.path()).value(), ElementsAre(folder / "a.png", folder / "b.JPG"));
}

TEST(Photo, ListsNameTheFirstColumn) {
  const rsstab::testing::TemporaryFolder folder;
  const std::string path = (folder / "val.csv").string();
  ASSERT_TRUE(WriteWholeFile(path, "file,source\r\na.jpg,streets/one\r\nb.jpg,animals\r\n\r\n"));
  EXPECT_THAT(ReadPhotoList(path, "streets").value(), ElementsAre("a.jpg"));
  EXPECT_THAT(ReadPhotoList(path).value(), ElementsAre("a.jpg", "b.jpg", "file"));
  EXPECT_EQ(ReadPhotoList(path, "cars").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(ReadPhotoList(folder / "missing.csv").error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace rsstab::evaluation
