// SPDX-License-Identifier: Apache-2.0
#include "cli/images/image_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/test_paths.h"

namespace rsstab::images {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class ImageListTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_ / "trip" / "more.jpg");
    std::filesystem::create_directory(folder_ / "empty");
    for (const char* name :
         {"b.jpg", "a.PNG", "notes.txt", ".hidden.jpg", "more.jpg/c.jpg", "odd[1].jpg"}) {
      std::ofstream(Path(name)) << "x";
    }
  }
  [[nodiscard]] std::string Path(const std::string& name) const {
    return (folder_ / "trip" / name).string();
  }
  rsstab::testing::TemporaryFolder folder_;
};

TEST_F(ImageListTest, OneFileIsOneFileBeItThereOrNot) {
  const ImageList list = ListImages({"no/such.jpg"});
  EXPECT_THAT(list.paths, ElementsAre("no/such.jpg"));
  EXPECT_THAT(list.problems, IsEmpty());
  EXPECT_FALSE(list.is_plural);
}

TEST_F(ImageListTest, FolderStandsForItsPictures) {
  const ImageList list = ListImages({folder_ / "trip"});
  EXPECT_THAT(list.paths, ElementsAre(Path("a.PNG"), Path("b.jpg"), Path("odd[1].jpg")));
  EXPECT_TRUE(list.is_plural);
}

TEST_F(ImageListTest, PatternsAreExpandedHere) {
  const ImageList list = ListImages({Path("?.[jP]*")});
  EXPECT_THAT(list.paths, ElementsAre(Path("a.PNG"), Path("b.jpg")));
  EXPECT_TRUE(list.is_plural);
}

TEST_F(ImageListTest, NameThatLooksLikeAPatternIsAName) {
  const ImageList list = ListImages({Path("odd[1].jpg")});
  EXPECT_THAT(list.paths, ElementsAre(Path("odd[1].jpg")));
  EXPECT_FALSE(list.is_plural);
}

TEST_F(ImageListTest, EachPictureComesOnceInTheOrderOfTheArguments) {
  const ImageList list = ListImages({Path("b.jpg"), folder_ / "trip", Path("*.jpg")});
  EXPECT_THAT(list.paths, ElementsAre(Path("b.jpg"), Path("a.PNG"), Path("odd[1].jpg")));
}

TEST_F(ImageListTest, WhatNamesNothingIsTold) {
  const ImageList list = ListImages({folder_ / "empty", Path("*.tif"), Path("b.jpg")});
  EXPECT_THAT(list.paths, ElementsAre(Path("b.jpg")));
  ASSERT_EQ(list.problems.size(), 2U);
  EXPECT_THAT(list.problems[0].message, HasSubstr("empty"));
  EXPECT_THAT(list.problems[1].message, HasSubstr("*.tif"));
}

}  // namespace
}  // namespace rsstab::images
