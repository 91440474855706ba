// SPDX-License-Identifier: Apache-2.0
// libtorch beside OpenCV, Ceres and FFmpeg in one program: the `correct` command with a network of
// the reference kind.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <string>

#include "tests/end_to_end/program.h"
#include "tests/rsdiff/reference_models.h"
#include "tests/support/random_scene.h"
#include "tests/support/test_paths.h"

namespace rsstab::testing {
namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 120;

TEST(TorchCorrect, AReferenceNetworkCorrectsAPictureTheSameWayTwice) {
  const std::filesystem::path model = ReferenceModel("small");
  if (model.empty()) {
    GTEST_SKIP() << "the models are made by the ctest rsdiff/reference_models";
  }
  const TemporaryFolder folder;
  const WaveScene scene(5);
  cv::Mat picture(kHeight, kWidth, CV_8UC3);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const auto level = static_cast<unsigned char>(scene.At(Eigen::Vector2d(x, y)));
      picture.at<cv::Vec3b>(y, x) = {level, level, level};
    }
  }
  const std::string input = folder / "in.png";
  cv::imwrite(input, picture);
  std::vector<std::string> files;
  for (const char* name : {"first", "second"}) {
    const std::string fields = folder / name;
    RunOrFail({"correct", input, "-o", fields + ".png", "--field", fields, "--model",
               model.string(), "--samples", "2", "--seed", "3"});
    files.push_back(ReadText(fields + "/in.flo"));
  }
  // 12 bytes of header, two floats for every pixel.
  EXPECT_EQ(files[0].size(), 12U + 8U * kWidth * kHeight);
  EXPECT_EQ(files[0], files[1]);
}

}  // namespace
}  // namespace rsstab::testing
