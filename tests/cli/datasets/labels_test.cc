// SPDX-License-Identifier: Apache-2.0
#include "cli/datasets/labels.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/evaluation/test_photos.h"

namespace rsstab::datasets {
namespace {

using rsstab::testing::MakePhoto;

constexpr int kWidth = 12;
constexpr int kHeight = 10;

std::size_t At(int x, int y) { return static_cast<std::size_t>(y * kWidth + x); }

TEST(Labels, OnlyBlackThatReachesTheBorderIsAnEdge) {
  // Two black columns on the left, and a black spot in the middle.
  const Frame picture = MakePhoto(
      kWidth, kHeight, [](int x, int y) { return x < 2 || (x == 7 && y == 5) ? 1.0 : 100.0; });
  const auto outside = OutsideBlackEdges(picture.View(), kExactBlack).value();
  EXPECT_EQ(outside[At(0, 3)], 0);
  EXPECT_EQ(outside[At(1, 3)], 0);
  EXPECT_EQ(outside[At(2, 3)], 0);  // beside it: mixed
  EXPECT_EQ(outside[At(3, 3)], 1);
  EXPECT_EQ(outside[At(7, 5)], 1);  // a dark thing, not an edge
  EXPECT_EQ(outside[At(11, 0)], 1);
  const Frame bright = MakePhoto(kWidth, kHeight, [](int, int) { return 9.0; });
  const auto all = OutsideBlackEdges(bright.View(), kExactBlack).value();
  EXPECT_EQ(std::count(all.begin(), all.end(), 1), kWidth * kHeight);
  const auto none = OutsideBlackEdges(bright.View(), kJpegBlack).value();
  EXPECT_EQ(std::count(none.begin(), none.end(), 1), 0);
}

images::NpyArray FieldOf(float x, float y) {
  images::NpyArray field;
  field.shape = {2, kHeight, kWidth};
  std::vector<float> values(2 * kWidth * kHeight, x);
  std::fill(values.begin() + kWidth * kHeight, values.end(), y);
  const auto* begin = reinterpret_cast<const std::uint8_t*>(values.data());
  field.bytes.assign(begin, begin + values.size() * sizeof(float));
  return field;
}

TEST(Labels, TruthIsXThenYAndOutsideIsInvalid) {
  evaluation::LabelledPicture picture;
  picture.rs = MakePhoto(kWidth, kHeight, [](int x, int) { return x == 11 ? 0.0 : 100.0; });
  picture.gs = MakePhoto(kWidth, kHeight, [](int, int) { return 100.0; });
  ASSERT_TRUE(SetTruth(FieldOf(3.0F, -2.0F), picture));
  EXPECT_EQ(picture.truth[At(4, 4)], Eigen::Vector2f(3.0F, -2.0F));
  EXPECT_EQ(picture.valid[At(0, 1)], 0);  // from row -1
  EXPECT_EQ(picture.valid[At(0, 2)], 1);
  EXPECT_EQ(picture.valid[At(8, 5)], 1);
  EXPECT_EQ(picture.valid[At(9, 5)], 0);  // from column 12
  ASSERT_TRUE(LeaveOutBlackEdges(kExactBlack, kExactBlack, picture));
  EXPECT_EQ(picture.valid[At(8, 5)], 0);  // from the black column 11
  EXPECT_EQ(picture.valid[At(7, 5)], 0);  // and from beside it
  EXPECT_EQ(picture.valid[At(6, 5)], 1);

  images::NpyArray wrong = FieldOf(0.0F, 0.0F);
  wrong.shape = {2, kWidth, kHeight};
  EXPECT_EQ(SetTruth(wrong, picture).error().code, ErrorCode::kCorruptData);
}

}  // namespace
}  // namespace rsstab::datasets
