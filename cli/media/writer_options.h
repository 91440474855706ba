// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_MEDIA_WRITER_OPTIONS_H_
#define RSSTAB_CLI_MEDIA_WRITER_OPTIONS_H_

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "igf/base/log.h"

namespace rsstab::media {

using KeyValueList = std::vector<std::pair<std::string, std::string>>;

// How a clip is encoded and put into its file.
struct WriterOptions {
  // "h264", "hevc", "vp9", "av1", "mpeg4", "mjpeg", "ffv1", "prores", or the name of an encoder
  // of libavcodec. Empty: what fits the container, H.264 where it can (then MPEG-4, with a warning,
  // if this libavcodec has no H.264 encoder; VP9 in WebM).
  std::string codec;
  // Constant quality on the scale of x264 and x265, 0 (lossless) to 51; a quantiser of the same
  // meaning is used where an encoder has none. Empty: 18 for H.264, similar elsewhere.
  std::optional<double> crf;
  std::string preset;   // "ultrafast" .. "veryslow" (or the encoder's own word); empty: "medium"
  std::string pix_fmt;  // libav's name, for example "yuv420p10le"; empty: the source's
  KeyValueList encoder_options;  // handed to the encoder as they are; unknown keys are an error
  KeyValueList muxer_options;    // handed to the container writer as they are
  // Container by libav's short name ("mp4", "matroska", ...); empty: by the file's extension,
  // Matroska for "-".
  std::string format;
  int num_threads = 0;     // of the encoder; 0 = one per core
  bool overwrite = false;  // allow an existing file to be replaced
  bool copy_streams =
      true;       // audio, subtitles, attachments, data tracks and chapters of the source
  Logger logger;  // null = silent
};

}  // namespace rsstab::media

#endif  // RSSTAB_CLI_MEDIA_WRITER_OPTIONS_H_
