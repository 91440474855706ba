// SPDX-License-Identifier: Apache-2.0
#include "cli/images/npz_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "cli/images/npz_file.h"
#include "igf/base/whole_file.h"
#include "tests/support/run_program.h"
#include "tests/support/test_paths.h"

namespace rsstab::images {
namespace {

using rsstab::testing::TemporaryFolder;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// A .npy file of version 1.
std::string Npy(const std::string& type, const std::string& order, const std::string& shape,
                const std::string& data) {
  const std::string header =
      "{'descr': '" + type + "', 'fortran_order': " + order + ", 'shape': " + shape + ", }\n";
  std::string file("\x93NUMPY\x01\x00", 8);
  file += static_cast<char>(header.size());
  file += '\0';
  return file + header + data;
}

TEST(NpzReader, ReadsWhatTheWriterWrote) {
  const TemporaryFolder folder;
  const std::string path = (folder / "a.npz").string();
  const std::vector<float> floats = {1.5F, -2.0F, 3e-9F, 4.0F, 5.0F, 6.0F};
  const std::vector<std::uint8_t> bytes = {0, 127, 255};
  ASSERT_TRUE(
      WriteNpz(path, std::vector<NpzArray>{{"flow", {2, 3}, floats}, {"grey", {3}, bytes}}));
  const auto arrays = ReadNpz(path);
  ASSERT_TRUE(arrays) << arrays.error().message;
  EXPECT_EQ(ToFloats(arrays->at("flow")).value(), floats);
  EXPECT_THAT(arrays->at("flow").shape, ElementsAre(2, 3));
  EXPECT_EQ(arrays->at("grey").bytes, bytes);
  EXPECT_EQ(arrays->at("grey").kind, 'u');
}

TEST(NpzReader, FortranOrderBecomesC) {
  const auto array = ParseNpy(Npy("|u1", "True", "(2, 3)", {0, 3, 1, 4, 2, 5}));
  ASSERT_TRUE(array) << array.error().message;
  EXPECT_THAT(array->bytes, ElementsAre(0, 1, 2, 3, 4, 5));
}

TEST(NpzReader, NumbersOfAllSizesBecomeFloats) {
  EXPECT_THAT(ToFloats(ParseNpy(Npy("<f2", "False", "(1,)", {0x00, 0x3e})).value()).value(),
              ElementsAre(1.5F));
  EXPECT_THAT(ToFloats(ParseNpy(Npy("<i2", "False", "(1,)", {'\xfe', '\xff'})).value()).value(),
              ElementsAre(-2.0F));
  EXPECT_THAT(
      ToFloats(ParseNpy(Npy("<f8", "False", "()", {0, 0, 0, 0, 0, 0, '\xf8', '\x3f'})).value())
          .value(),
      ElementsAre(1.5F));
}

TEST(NpzReader, DamageIsRefused) {
  EXPECT_FALSE(ParseNpy("nothing"));
  EXPECT_FALSE(ParseNpy(Npy("<f4", "False", "(2,)", "1234")));
  EXPECT_FALSE(ParseNpy(Npy("<f4", "False", "(99999999999, 99999999999)", "1234")));
  EXPECT_FALSE(ParseNpy(Npy("<f4", "False", "2", "1234")));
  EXPECT_EQ(ParseNpy(Npy(">f4", "False", "(1,)", "1234")).error().code, ErrorCode::kUnsupported);
  EXPECT_EQ(ParseNpy(Npy("|O", "False", "(1,)", "1234")).error().code, ErrorCode::kUnsupported);
  EXPECT_FALSE(ParseNpy(Npy("<f4", "False", "(1,)", "1234").substr(0, 30)));

  const TemporaryFolder folder;
  const std::string path = (folder / "a.npz").string();
  EXPECT_EQ(ReadNpz(path).error().code, ErrorCode::kNotFound);
  ASSERT_TRUE(WriteWholeFile(path, "PK no zip"));
  EXPECT_THAT(ReadNpz(path).error().message, HasSubstr("a.npz"));
  const std::vector<std::uint8_t> bytes(1000, 7);
  ASSERT_TRUE(WriteNpz(path, std::vector<NpzArray>{{"grey", {1000}, bytes}}));
  std::string file = ReadWholeFile(path, 1U << 20U).value();
  file[file.size() / 2] = 8;  // one of the values
  ASSERT_TRUE(WriteWholeFile(path, file));
  EXPECT_EQ(ReadNpz(path).error().code, ErrorCode::kCorruptData);  // the checksum
}

// The format's own program, where it is installed.
TEST(NpzReader, ReadsWhatNumPyCompressed) {
  const TemporaryFolder folder;
  const std::string path = (folder / "numpy.npz").string();
  const auto run = rsstab::testing::RunProgram(
      "/usr/bin/python3",
      {"-c",
       "import sys, numpy as np\n"
       "np.savez_compressed(sys.argv[1], condition=np.arange(24, dtype=np.uint8).reshape(2, 4, 3),"
       " out_flow=np.linspace(-1, 1, 16).reshape(2, 2, 4).T)",
       path});
  if (run.exit_code != 0) {
    GTEST_SKIP() << "no NumPy: " << run.error;
  }
  const auto arrays = ReadNpz(path);
  ASSERT_TRUE(arrays) << arrays.error().message;
  std::vector<std::uint8_t> expected(24);
  std::iota(expected.begin(), expected.end(), std::uint8_t{0});
  EXPECT_EQ(arrays->at("condition").bytes, expected);
  EXPECT_THAT(arrays->at("condition").shape, ElementsAre(2, 4, 3));
  const auto flow = ToFloats(arrays->at("out_flow")).value();
  EXPECT_THAT(arrays->at("out_flow").shape, ElementsAre(4, 2, 2));
  // Transposed: element (3, 1, 0) is (0, 1, 3) of the original, its seventh value counted from 0.
  EXPECT_NEAR(flow[3 * 4 + 1 * 2 + 0], -1.0 + 2.0 * 7.0 / 15.0, 1e-6);
}

}  // namespace
}  // namespace rsstab::images
