// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_MEDIA_VIDEO_WRITER_H_
#define RSSTAB_CLI_MEDIA_VIDEO_WRITER_H_

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/media/video_info.h"
#include "cli/media/video_reader.h"
#include "cli/media/writer_options.h"
#include "igf/base/frame.h"
#include "igf/base/result.h"

namespace rsstab::media {

// A clip that has no source file, see VideoWriter::Create().
struct VideoDescription {
  int width = 0;  // pixels, 1..kMaxPictureSide
  int height = 0;
  PixelLayout layout;
  Rational frame_rate{30, 1};
  // Unit of VideoFrame::pts, seconds; num 0: one tick per frame.
  Rational time_base{0, 1};
  Rational sample_aspect_ratio{1, 1};
  double rotation_degrees = 0.0;  // as in VideoInfo; multiples of 90 play everywhere
  ColorTags color;  // names as in VideoInfo; range and siting follow `layout` where empty
  KeyValueList metadata;
};

// Encodes frames and muxes them with the untouched other streams of the source.
//
// The output is written beside the target under a hidden temporary name and renamed by Finish(); a
// writer destroyed without Finish() removes it. "-" (standard output), pipes and devices are
// written directly, in a streamable form of the container.
//
// Frame times, duration, HDR side data come from Frame::origin; the written presentation times
// equal the (repaired) source times wherever the container can express them.
//
// Not thread safe; encodes with threads of its own. Frames are shared with the encoder, not
// copied: do not write to them after Write().
class VideoWriter {
 public:
  // A writer for frames that stem from `source`: takes over its picture size, layout, time base,
  // colour tags, sample aspect ratio, rotation, HDR side data, metadata and chapters, and copies
  // its other streams as `source` demuxes them. Call before source.Read(); read `source` to its end
  // to copy all of them. `source` may be destroyed at any time after.
  // Streams the container cannot carry are left out with a warning that names them.
  // Errors: kInvalidArgument (file exists and overwrite is off, input is output, unknown option),
  // kNotFound (folder or encoder), kUnsupported (container and codec do not go together), kIo.
  [[nodiscard]] static Result<std::unique_ptr<VideoWriter>> Open(const std::string& path,
                                                                 VideoReader& source,
                                                                 const WriterOptions& options);
  // A writer for frames made by the program. Errors as above.
  [[nodiscard]] static Result<std::unique_ptr<VideoWriter>> Create(
      const std::string& path, const VideoDescription& description, const WriterOptions& options);
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  // Appends a frame; its pts must be greater than the one before. Size and layout must be the
  // source's (or the description's). After an error only destruction makes sense.
  // Errors: kInvalidArgument (size, layout, time), kIo (disk full, ...).
  [[nodiscard]] Status Write(const VideoFrame& frame);
  // The same with the time in frame.origin, or, for a frame without one, one frame period after the
  // last.
  [[nodiscard]] Status Write(const Frame& frame);

  // Flushes the encoder, completes the file and gives it its name. Once.
  // Errors: kIo; the temporary file is then removed.
  [[nodiscard]] Status Finish();

  // What was chosen in the end, for the log: for example "libx264" and "yuv420p".
  [[nodiscard]] const std::string& encoder_name() const;
  [[nodiscard]] const std::string& pixel_format() const;
  [[nodiscard]] std::int64_t frames_written() const;

 private:
  struct Impl;
  explicit VideoWriter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rsstab::media

#endif  // RSSTAB_CLI_MEDIA_VIDEO_WRITER_H_
