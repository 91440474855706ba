// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_TESTS_CLI_MEDIA_MEDIA_TEST_SUPPORT_H_
#define RSSTAB_TESTS_CLI_MEDIA_MEDIA_TEST_SUPPORT_H_

// Tiny clips to test media I/O with, and a look into files that does not go through the code under
// test.

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/media/video_reader.h"
#include "cli/media/video_writer.h"
#include "igf/base/frame.h"
#include "igf/base/log.h"

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

// What a file holds according to libav alone.
struct PacketContent {
  double pts_s = 0.0;
  double duration_s = 0.0;
  std::vector<std::uint8_t> bytes;
};
struct StreamContent {
  std::string type;   // "video", "audio", "subtitle", "attachment", "data"
  std::string codec;  // libav's name
  std::string tag;    // four letters
  std::map<std::string, std::string> metadata;
  std::vector<PacketContent> packets;  // empty packets left out
  std::vector<std::uint8_t> extradata;
};
struct FileContent {
  std::vector<StreamContent> streams;
  std::map<std::string, std::string> metadata;
  std::vector<std::pair<double, std::string>> chapters;  // start in s, title
  std::vector<const StreamContent*> OfType(const std::string& type) const;
};
[[nodiscard]] FileContent Inspect(const std::filesystem::path& path);

// A file made of an existing clip's video packets and whatever else is wanted.
struct RemuxRecipe {
  bool with_audio = false;       // made-up AAC packets, 44100 Hz
  std::int64_t audio_start = 0;  // of the first one, samples
  std::string subtitle_codec;    // "subrip", "mov_text", ...; empty: none
  bool with_attachment = false;
  bool with_data = false;  // a "gpmd" track, one packet a second (MP4 only)
  bool with_chapters = false;
  std::map<std::string, std::string> metadata;
  std::optional<double> rotation_degrees;  // counter-clockwise
  bool with_hdr = false;                   // mastering display and content light level
  // Presentation times of the video packets in ticks of 1/90000 s (file order); empty: as they are.
  std::vector<std::int64_t> video_times;
  // Bytes of the video packet with this number are overwritten with garbage.
  std::vector<int> garbled_packets;
};
void Remux(const std::filesystem::path& source, const std::filesystem::path& target,
           const RemuxRecipe& recipe);

[[nodiscard]] bool HasEncoder(const std::string& name);
[[nodiscard]] std::vector<std::string> FilesIn(const std::filesystem::path& folder);

}  // namespace rsstab::media::testing

#endif  // RSSTAB_TESTS_CLI_MEDIA_MEDIA_TEST_SUPPORT_H_
