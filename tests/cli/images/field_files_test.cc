// SPDX-License-Identifier: Apache-2.0
#include "cli/images/field_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>

#include "cli/images/npz_file.h"
#include "tests/cli/images/npz_reader.h"
#include "tests/support/test_paths.h"

namespace rsstab::images {
namespace {

using ::testing::HasSubstr;

constexpr int kWidth = 37;
constexpr int kHeight = 22;

std::string ReadBytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

// Every vertex its own displacement.
MotionField UnevenField() {
  MotionField field(kWidth, kHeight, 3, 5);
  int i = 0;
  for (Eigen::Vector2f& displacement : field.vertices()) {
    displacement = {static_cast<float>(i) - 7.25F, 0.5F * static_cast<float>(i * i) - 11.0F};
    ++i;
  }
  return field;
}

std::vector<float> UnevenSpread(const MotionField& field) {
  std::vector<float> spread;
  for (std::size_t i = 0; i < field.vertices().size(); ++i) {
    spread.push_back(0.25F * static_cast<float>(i));
  }
  return spread;
}

class FieldFilesTest : public ::testing::Test {
 protected:
  rsstab::testing::TemporaryFolder folder_;
  FieldFiles files_{folder_.path(), "photo"};
  WorkerPool workers_{2};
};

TEST_F(FieldFilesTest, AreNamedAfterThePicture) {
  EXPECT_EQ(files_.flo, folder_ / "photo.flo");
  EXPECT_EQ(files_.npz, folder_ / "photo.npz");
  EXPECT_EQ(files_.picture, folder_ / "photo-field.png");
}

TEST_F(FieldFilesTest, FloHoldsTheDisplacementOfEachPixel) {
  const MotionField field = UnevenField();
  ASSERT_TRUE(WriteFieldFiles(files_, field, UnevenSpread(field), workers_));
  const std::string bytes = ReadBytes(files_.flo);
  ASSERT_EQ(bytes.size(), 12U + 8U * kWidth * kHeight);
  float magic = 0.0F;
  std::int32_t size[2];
  std::memcpy(&magic, bytes.data(), 4);
  std::memcpy(size, bytes.data() + 4, 8);
  EXPECT_EQ(magic, 202021.25F);  // what readers of the format look for
  EXPECT_EQ(size[0], kWidth);
  EXPECT_EQ(size[1], kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      float uv[2];
      std::memcpy(uv, bytes.data() + 12 + 8 * (y * kWidth + x), 8);
      const Eigen::Vector2d expected = field.Sample({x, y});
      ASSERT_FLOAT_EQ(uv[0], static_cast<float>(expected.x()));
      ASSERT_FLOAT_EQ(uv[1], static_cast<float>(expected.y()));
    }
  }
}

TEST_F(FieldFilesTest, NpzHoldsFieldAndSpread) {
  const MotionField field = UnevenField();
  ASSERT_TRUE(WriteFieldFiles(files_, field, UnevenSpread(field), workers_));
  const auto arrays = rsstab::testing::ReadNpz(ReadBytes(files_.npz));
  ASSERT_EQ(arrays.size(), 2U);
  const auto& dense = arrays.at("field.npy");
  const auto& spread = arrays.at("spread.npy");
  EXPECT_THAT(dense.header, HasSubstr("'descr': '<f4'"));
  EXPECT_THAT(dense.header, HasSubstr("'fortran_order': False"));
  EXPECT_THAT(dense.header, HasSubstr("'shape': (2, 22, 37)"));
  EXPECT_THAT(spread.header, HasSubstr("'shape': (22, 37)"));
  constexpr std::size_t kPixels = std::size_t{kWidth} * kHeight;
  ASSERT_EQ(dense.values.size(), 2 * kPixels);
  ASSERT_EQ(spread.values.size(), kPixels);
  const Eigen::Vector2d sample = field.Sample({30, 5});
  EXPECT_FLOAT_EQ(dense.values[5 * kWidth + 30], static_cast<float>(sample.x()));
  EXPECT_FLOAT_EQ(dense.values[kPixels + 5 * kWidth + 30], static_cast<float>(sample.y()));
  EXPECT_FLOAT_EQ(spread.values.front(), 0.0F);
  EXPECT_FLOAT_EQ(spread.values.back(), 0.25F * 14);  // the last of 15 vertices
}

TEST_F(FieldFilesTest, SpreadOfOneSampleIsInfiniteEverywhere) {
  const MotionField field = UnevenField();
  const std::vector<float> unknown(field.vertices().size(), std::numeric_limits<float>::infinity());
  ASSERT_TRUE(WriteFieldFiles(files_, field, unknown, workers_));
  const auto arrays = rsstab::testing::ReadNpz(ReadBytes(files_.npz));
  for (const float value : arrays.at("spread.npy").values) {
    ASSERT_TRUE(std::isinf(value));
  }
}

TEST_F(FieldFilesTest, SameFieldSameBytes) {
  const MotionField field = UnevenField();
  const FieldFiles again(folder_.path(), "again");
  WorkerPool one(1);
  ASSERT_TRUE(WriteFieldFiles(files_, field, UnevenSpread(field), workers_));
  ASSERT_TRUE(WriteFieldFiles(again, field, UnevenSpread(field), one));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(ReadBytes(files_.All()[i]), ReadBytes(again.All()[i]));
  }
}

TEST_F(FieldFilesTest, FailuresNameTheFileAndLeaveNothing) {
  const MotionField field = UnevenField();
  const Status few = WriteFieldFiles(files_, field, std::vector<float>(3), workers_);
  ASSERT_FALSE(few);
  EXPECT_EQ(few.error().code, ErrorCode::kInvalidArgument);
  const FieldFiles nowhere(folder_.path() / "no" / "such", "photo");
  const Status lost = WriteFieldFiles(nowhere, field, UnevenSpread(field), workers_);
  ASSERT_FALSE(lost);
  EXPECT_THAT(lost.error().message, HasSubstr("no/such/photo.flo"));
  const std::vector<float> values(4);
  const Status npz = WriteNpz(nowhere.npz, std::vector<NpzArray>{{"field", {4}, values}});
  ASSERT_FALSE(npz);
  EXPECT_THAT(npz.error().message, HasSubstr("no/such/photo.npz"));
  EXPECT_FALSE(WriteNpz(folder_ / "x.npz", std::vector<NpzArray>{{"field", {5}, values}}));
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

}  // namespace
}  // namespace rsstab::images
