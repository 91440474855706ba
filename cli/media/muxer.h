// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_MEDIA_MUXER_H_
#define RSSTAB_CLI_MEDIA_MUXER_H_

// One video stream that we encode and any number of copied streams into one container (includes
// libav).

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/media/av_handles.h"
#include "cli/media/output_file.h"
#include "cli/media/source_access.h"
#include "cli/media/video_info.h"
#include "cli/media/writer_options.h"
#include "igf/base/log.h"
#include "igf/base/result.h"

namespace rsstab::media {

// What the video stream is, apart from what the encoder says.
struct MuxerVideo {
  const AVCodecContext* encoder = nullptr;
  Rational time_base;   // of the packets given to WriteVideo()
  Rational frame_rate;  // mean
  bool has_variable_rate = false;
  bool starts_before_zero = false;
  double rotation_degrees = 0.0;  // without a source
  KeyValueList metadata;          // of the file, without a source
};

// Packets must come in the order of their streams; between streams they are interleaved here, in
// memory bounded by libav's interleaving limit of 10 s. Not thread safe.
class Muxer {
 public:
  // Writes the header to `file`, which must outlive the muxer, as must `logger`. `source` may be
  // null. A stream that the container does not take is left out with one warning for all.
  // Errors: kUnsupported (codec and container), kInvalidArgument (unknown muxer option), kIo.
  [[nodiscard]] static Result<std::unique_ptr<Muxer>> Open(
      OutputFile& file, const AVOutputFormat& format, const MuxerVideo& video,
      const SourceAccess* source, const WriterOptions& options, const Logger& logger);
  ~Muxer();
  Muxer(const Muxer&) = delete;
  Muxer& operator=(const Muxer&) = delete;

  // Whether WriteCopied() takes packets of this stream of the source.
  [[nodiscard]] bool Copies(int source_stream) const {
    const auto index = static_cast<std::size_t>(source_stream);
    return index < copied_.size() && copied_[index].has_value();
  }

  // Errors: kIo.
  [[nodiscard]] Status WriteVideo(AVPacket& packet);
  // A packet as the source demuxed it; of a stream that is not copied: ignored.
  [[nodiscard]] Status WriteCopied(AVPacket& packet);
  // Completes the container; the file is then to be committed.
  [[nodiscard]] Status Finish();

 private:
  // How a source stream is copied.
  struct Copied {
    int output_index = 0;
    AVRational source_time_base{1, 1};
    std::optional<std::int64_t> last_dts;  // output ticks
  };
  // Which kinds of copied streams to try.
  enum class Scope { kAll, kNoData, kAudioOnly, kNone };

  Muxer(OutputFile& file, const Logger& logger) : file_(file), logger_(logger) {}

  // 0 or an AVERROR; leaves the names of streams left out in left_out_.
  [[nodiscard]] int Start(const AVOutputFormat& format, const MuxerVideo& video,
                          const SourceAccess* source, const WriterOptions& options, Scope scope,
                          std::string& unknown_option);
  [[nodiscard]] int AddVideo(const MuxerVideo& video, const SourceAccess* source);
  [[nodiscard]] int AddCopied(const AVStream& source);
  [[nodiscard]] int CopyChapters(const AVFormatContext& input);
  [[nodiscard]] int Write(AVPacket& packet);
  [[nodiscard]] Error WriteError(int code) const;

  OutputFile& file_;
  const Logger& logger_;
  AvOutputPtr output_;
  AVIOContext* io_ = nullptr;
  int video_index_ = 0;
  AVRational video_time_base_{1, 1};
  std::int64_t source_start_ = 0;  // taken from all times, AV_TIME_BASE units
  // Into Matroska, libav would shift all streams, picture included, when sound begins before zero
  // with samples that only start up its decoder. A block can hold such a time, so nothing is moved.
  bool keeps_zero_ = false;
  std::vector<std::optional<Copied>> copied_;  // by source stream
  std::vector<std::string> left_out_;
  std::optional<std::int64_t> last_video_dts_;
  std::int64_t moved_packets_ = 0;
};

}  // namespace rsstab::media

#endif  // RSSTAB_CLI_MEDIA_MUXER_H_
