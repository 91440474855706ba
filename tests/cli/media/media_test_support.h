// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_TESTS_CLI_MEDIA_MEDIA_TEST_SUPPORT_H_
#define RSSTAB_TESTS_CLI_MEDIA_MEDIA_TEST_SUPPORT_H_

// Tiny clips to test media I/O with.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/media/video_reader.h"
#include "cli/media/video_writer.h"
#include "igf/base/frame.h"
#include "igf/base/log.h"
#include "tests/cli/media/raw_media.h"

namespace rsstab::media::testing {

// A smooth picture with a bright square that moves with `index`; every plane and channel differs.
[[nodiscard]] Frame TestPicture(const PixelLayout& layout, int width, int height, int index);

// Planar YUV with the given shifts and "left" siting.
[[nodiscard]] PixelLayout PlanarYuv(int bit_depth, int shift_x, int shift_y);

// Largest difference of two frames of one layout over all samples.
[[nodiscard]] int LargestDifference(const Frame& a, const Frame& b);
// PSNR in dB over all samples; 200 for equal frames.
[[nodiscard]] double Psnr(const Frame& a, const Frame& b);

struct ClipRecipe {
  VideoDescription description;
  int frames = 12;
  std::vector<std::int64_t> times;  // ticks; empty: constant rate
  WriterOptions options;
};
// 96x72 yuv420p, 30 frames per second, fastest settings.
[[nodiscard]] ClipRecipe SmallRecipe();
// Writes TestPicture(0), TestPicture(1), ...
[[nodiscard]] Status MakeClip(const std::filesystem::path& path, const ClipRecipe& recipe);

struct Clip {
  VideoInfo info;
  std::vector<VideoFrame> frames;
  [[nodiscard]] std::vector<std::int64_t> Times() const;  // pts
};
[[nodiscard]] Result<Clip> ReadClip(const std::filesystem::path& path,
                                    const Logger& logger = nullptr);

// Reads `source` and writes all its frames to `target`. Returns the number of frames.
[[nodiscard]] Result<std::int64_t> CopyClip(const std::filesystem::path& source,
                                            const std::filesystem::path& target,
                                            const WriterOptions& options);

// A logger that keeps its warnings.
struct Warnings {
  Logger logger;
  std::shared_ptr<std::vector<std::string>> texts;
};
[[nodiscard]] Warnings CollectWarnings();

[[nodiscard]] std::vector<std::string> FilesIn(const std::filesystem::path& folder);

}  // namespace rsstab::media::testing

#endif  // RSSTAB_TESTS_CLI_MEDIA_MEDIA_TEST_SUPPORT_H_
