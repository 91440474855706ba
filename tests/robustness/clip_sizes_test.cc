// SPDX-License-Identifier: Apache-2.0
#include "tests/robustness/damage.h"

namespace rsstab::testing {
namespace {

using ClipSizes = Damage;

struct Size {
  int width;
  int height;
};

constexpr Size kOddSizes[] = {{1, 1}, {2, 1}, {1, 2}, {3, 3}, {5, 17}, {16, 1}, {17, 13}};

TEST_F(ClipSizes, TinyAndOddWithLosslessVideo) {
  for (const PixelLayout& layout : {Yuv420Layout(), Yuv420Layout(10)}) {
    for (const Size& size : kOddSizes) {
      SCOPED_TRACE(std::to_string(size.width) + "x" + std::to_string(size.height) + " at " +
                   std::to_string(layout.bit_depth) + " bit");
      TestClip clip;
      clip.width = size.width;
      clip.height = size.height;
      clip.frames = 4;
      clip.layout = layout;
      clip.codec = "ffv1";
      WriteTestClip(Path("odd.mkv"), clip);
      ExpectSuccess({"odd.mkv", "-o", "out.mkv", "--overwrite", "--codec", "ffv1"}, "out.mkv",
                    clip.frames);
    }
  }
}

TEST_F(ClipSizes, OddSizesWithTheDefaultEncoder) {
  for (const Size& size : {Size{17, 13}, Size{65, 49}, Size{3, 3}}) {
    SCOPED_TRACE(std::to_string(size.width) + "x" + std::to_string(size.height));
    TestClip clip;
    clip.width = size.width;
    clip.height = size.height;
    clip.frames = 4;
    clip.codec = "ffv1";
    WriteTestClip(Path("odd.mkv"), clip);
    ExpectSuccess({"odd.mkv", "-o", "out.mp4", "--overwrite"}, "out.mp4", clip.frames);
  }
}

TEST_F(ClipSizes, MeshFinerThanThePicture) {
  TestClip clip;
  clip.width = 33;
  clip.height = 17;
  clip.codec = "ffv1";
  WriteTestClip(Path("small.mkv"), clip);
  ExpectSuccess({"small.mkv", "-o", "out.mkv", "--mesh", "64x64", "--codec", "ffv1"}, "out.mkv",
                clip.frames);
}

TEST_F(ClipSizes, VeryWideAndVeryTall) {
  for (const Size& size : {Size{1600, 4}, Size{4, 1600}}) {
    TestClip clip;
    clip.width = size.width;
    clip.height = size.height;
    clip.frames = 4;
    clip.codec = "ffv1";
    WriteTestClip(Path("strip.mkv"), clip);
    ExpectSuccess({"strip.mkv", "-o", "out.mkv", "--overwrite", "--codec", "ffv1"}, "out.mkv",
                  clip.frames);
  }
}

}  // namespace
}  // namespace rsstab::testing
