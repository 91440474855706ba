// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_MEDIA_VIDEO_INFO_H_
#define RSSTAB_CLI_MEDIA_VIDEO_INFO_H_

#include <cstdint>
#include <string>
#include <vector>

#include "igf/base/frame.h"

namespace rsstab::media {

// Largest picture side this program reads or writes, in pixels; more than any camera's, and small
// enough that a broken header cannot ask for terabytes.
inline constexpr int kMaxPictureSide = 16384;

// A fraction. As a time base: seconds per tick; as a frame rate: frames per second.
struct Rational {
  int num = 0;
  int den = 1;

  [[nodiscard]] double Value() const {
    return den == 0 ? 0.0 : static_cast<double>(num) / static_cast<double>(den);
  }
  friend bool operator==(const Rational&, const Rational&) = default;
};

// How sample values become colours, as libav names it ("bt709", "smpte2084", "tv", ...). Empty:
// not said. The chroma siting and the range are also part of PixelLayout, which is what pixel code
// looks at.
struct ColorTags {
  std::string range;            // "tv" or "pc"
  std::string primaries;        // "bt709", "bt2020", ...
  std::string transfer;         // "bt709", "smpte2084", "arib-std-b67", ...
  std::string matrix;           // "bt709", "bt2020nc", "smpte170m", ...
  std::string chroma_location;  // "left", "center", "topleft", ...

  friend bool operator==(const ColorTags&, const ColorTags&) = default;
};

// What a clip says about itself, as far as this program needs it.
struct VideoInfo {
  std::string path;
  std::string
      container;      // libav's short name of the demuxer, for example "mov,mp4,m4a,3gp,3g2,mj2"
  std::string codec;  // of the video stream, for example "h264"
  std::string pixel_format;  // as stored, for example "yuv420p10le"; `layout` is what is delivered
  int width = 0;             // pixels, before rotation
  int height = 0;
  PixelLayout layout;       // of every delivered frame
  Rational frame_rate;      // mean over the clip, frames per second, after the repair of timestamps
  Rational time_base;       // unit of VideoFrame::pts, seconds
  double start_s = 0.0;     // time of the first frame, container clock
  double duration_s = 0.0;  // of the video stream; 0: not known
  // Exact for healthy seekable files (packets are counted when the file is opened), otherwise
  // estimated from rate and duration; 0: not known.
  std::int64_t frame_count = 0;
  bool variable_frame_rate = false;
  bool timestamps_repaired = false;
  bool interlaced = false;
  // How far a player turns the picture for display, degrees counter-clockwise in (-180, 180]; the
  // delivered frames are not turned.
  double rotation_degrees = 0.0;
  Rational sample_aspect_ratio{1, 1};  // width to height of one sample
  ColorTags color;
  bool has_hdr_metadata = false;  // mastering display or content light level
  int audio_streams = 0;
  int subtitle_streams = 0;
  int attachment_streams = 0;
  int chapters = 0;
  // Four-letter kinds of the data tracks ("gpmd", "tmcd", ...), see ReadTelemetry().
  std::vector<std::string> telemetry_kinds;
};

}  // namespace rsstab::media

#endif  // RSSTAB_CLI_MEDIA_VIDEO_INFO_H_
