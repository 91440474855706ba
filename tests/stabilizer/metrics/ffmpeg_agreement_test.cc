// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <vector>

#include "igf/base/frame.h"
#include "igf/base/seeded_random.h"
#include "stabilizer/metrics/image_metrics.h"
#include "tests/support/run_program.h"
#include "tests/support/test_paths.h"

namespace rsstab::stabilizer {
namespace {

constexpr const char* kFfmpeg = "/usr/bin/ffmpeg";
constexpr int kWidth = 320;
constexpr int kHeight = 240;
constexpr double kPsnr_db = 0.05;
constexpr double kSsim = 0.005;
// Gaussian windows of 11x11 (Wang et al. 2004) are not FFmpeg's plain ones of 8x8.
constexpr double kOtherWindows = 0.02;

// Smooth structure, and whatever a distortion adds.
Frame MakePicture(double shift, double noise) {
  Frame picture = AllocateFrame(GrayLayout(), kWidth, kHeight).value();
  SeededRandom random(5);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double level = 128.0 + 45.0 * std::sin(0.11 * (x + shift) + 0.04 * y) +
                           40.0 * std::sin(0.09 * y - 0.05 * (x + shift)) + noise * random.Normal();
      picture.planes[0].data[y * picture.planes[0].stride + x] =
          static_cast<std::uint8_t>(std::clamp(level + 0.5, 0.0, 255.0));
    }
  }
  return picture;
}

void WriteRaw(const std::filesystem::path& path, const Frame& picture) {
  std::ofstream file(path, std::ios::binary);
  for (int y = 0; y < kHeight; ++y) {
    file.write(reinterpret_cast<const char*>(picture.planes[0].data + y * picture.planes[0].stride),
               kWidth);
  }
}

// What one of FFmpeg's filters prints behind `label`; NaN where it does not run.
double AskFfmpeg(const std::filesystem::path& a, const std::filesystem::path& b,
                 const std::string& filter, const std::string& label) {
  const std::string size = std::to_string(kWidth) + "x" + std::to_string(kHeight);
  std::vector<std::string> arguments = {"-hide_banner"};
  for (const auto& path : {a, b}) {
    for (const std::string& word :
         {std::string("-f"), std::string("rawvideo"), std::string("-pix_fmt"), std::string("gray"),
          std::string("-s"), size, std::string("-i"), path.string()}) {
      arguments.push_back(word);
    }
  }
  for (const std::string& word :
       {std::string("-lavfi"), filter, std::string("-f"), std::string("null"), std::string("-")}) {
    arguments.push_back(word);
  }
  const auto run = rsstab::testing::RunProgram(kFfmpeg, arguments);
  std::smatch found;
  return std::regex_search(run.error, found, std::regex(label + ":([0-9.]+)")) ? std::stod(found[1])
                                                                               : std::nan("");
}

TEST(FfmpegAgreement, PsnrAndSsimAreTheFilters) {
  if (!std::filesystem::exists(kFfmpeg)) {
    GTEST_SKIP() << "no ffmpeg is installed";
  }
  const rsstab::testing::TemporaryFolder folder;
  const Frame reference = MakePicture(0.0, 0.0);
  WriteRaw(folder / "a.raw", reference);
  struct Case {
    double shift;
    double noise;
  };
  for (const Case& distortion : {Case{0.5, 0.0}, Case{3.0, 0.0}, Case{0.0, 2.0}, Case{1.0, 1.0}}) {
    const Frame other = MakePicture(distortion.shift, distortion.noise);
    WriteRaw(folder / "b.raw", other);
    const double psnr = AskFfmpeg(folder / "a.raw", folder / "b.raw", "psnr", "average");
    const double ssim = AskFfmpeg(folder / "a.raw", folder / "b.raw", "ssim", "All");
    EXPECT_NEAR(Psnr(reference.View(), other.View()).value(), psnr, kPsnr_db)
        << distortion.shift << " " << distortion.noise;
    EXPECT_NEAR(BlockSsim(reference.View(), other.View()).value(), ssim, kSsim)
        << distortion.shift << " " << distortion.noise;
    EXPECT_NEAR(Ssim(reference.View(), other.View()).value(), ssim, kOtherWindows)
        << distortion.shift << " " << distortion.noise;
  }
}

}  // namespace
}  // namespace rsstab::stabilizer
