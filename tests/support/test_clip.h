// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_TESTS_SUPPORT_TEST_CLIP_H_
#define RSSTAB_TESTS_SUPPORT_TEST_CLIP_H_

#include <filesystem>
#include <string>

#include "igf/base/frame.h"

namespace rsstab::testing {

// A small clip with something to track: a soft random pattern that shakes by a few pixels.
struct TestClip {
  int width = 160;
  int height = 120;
  int frames = 12;
  PixelLayout layout = Yuv420Layout();
  std::string codec = "mpeg4";  // quick, in every libavcodec
  double shake_px = 3.0;
};

// Frame `index` of the clip.
[[nodiscard]] Frame MakeTestFrame(const TestClip& clip, int index);

// Writes the clip; the ending chooses the container. Throws std::runtime_error.
void WriteTestClip(const std::filesystem::path& path, const TestClip& clip = {});

}  // namespace rsstab::testing

#endif  // RSSTAB_TESTS_SUPPORT_TEST_CLIP_H_
