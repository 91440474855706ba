// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_MEDIA_VIDEO_READER_H_
#define RSSTAB_CLI_MEDIA_VIDEO_READER_H_

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "cli/media/video_info.h"
#include "igf/base/frame.h"
#include "igf/base/log.h"
#include "igf/base/result.h"

namespace rsstab::media {

// One decoded picture with its place in the clip.
struct VideoFrame {
  // Shares the decoder's buffer: treat the samples as const. `frame.origin` carries timestamp,
  // duration and HDR side data; hand it on to a picture rendered from this one and
  // VideoWriter::Write() gives that picture the same time.
  Frame frame;
  std::int64_t index = 0;  // 0, 1, 2, ... in presentation order, without gaps
  // Presentation time in VideoInfo::time_base ticks, repaired where the file's own was damaged:
  // strictly increasing.
  std::int64_t pts = 0;
  double time_s = 0.0;  // the same in seconds, container clock (the one of TelemetryPayload)
};

struct ReaderOptions {
  int num_threads = 0;  // of the decoder; 0 = one per core
  Logger logger;        // null = silent
};

// Demuxes and decodes the best video stream of a file. Reads in order only; memory stays bounded
// by a few frames plus 8 bytes for each frame of the clip (the timestamp plan).
//
// Timestamps. Regular files are scanned once without decoding (demux only) when opened, so that a
// plan for damaged stamps can be made from all of them: see timestamp_repair.h. Pipes are repaired
// as they come.
//
// Damage. Packets that cannot be decoded are concealed or skipped, counted, and told in one
// warning at the end; a file that ends early delivers what it has, with a warning.
//
// Not thread safe; may be used from a different thread than a VideoWriter attached to it.
class VideoReader {
 public:
  // Opens `path` ("-" = standard input) and decodes its first frame. Errors: kNotFound (no such
  // file, no video stream, no decoder), kIo, kCorruptData (not a video, nothing decodes),
  // kUnsupported (a side above kMaxPictureSide).
  [[nodiscard]] static Result<std::unique_ptr<VideoReader>> Open(const std::string& path,
                                                                 const ReaderOptions& options);
  ~VideoReader();
  VideoReader(const VideoReader&) = delete;
  VideoReader& operator=(const VideoReader&) = delete;

  // Constant from Open() on.
  [[nodiscard]] const VideoInfo& info() const;

  // The next frame, std::nullopt at the end (and from then on). A change of picture size or pixel
  // format within the clip is converted to info()'s, with a warning.
  // Errors: kIo when the machine is out of memory; damaged input never is one here.
  [[nodiscard]] Result<std::optional<VideoFrame>> Read();

  // For this module only.
  struct Impl;
  [[nodiscard]] Impl& impl() { return *impl_; }

 private:
  explicit VideoReader(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rsstab::media

#endif  // RSSTAB_CLI_MEDIA_VIDEO_READER_H_
