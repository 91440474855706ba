// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_TESTS_CLI_MEDIA_RAW_MEDIA_H_
#define RSSTAB_TESTS_CLI_MEDIA_RAW_MEDIA_H_

// Files looked into and put together with libav alone, not with the code under test. Throws
// std::runtime_error when libav refuses.

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace rsstab::media::testing {

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
  // What its packets hold; empty: 64 random bytes each, to the end of the clip.
  std::vector<std::vector<std::uint8_t>> data_packets;
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
}  // namespace rsstab::media::testing

#endif  // RSSTAB_TESTS_CLI_MEDIA_RAW_MEDIA_H_
