// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_MEDIA_VIDEO_ENCODER_H_
#define RSSTAB_CLI_MEDIA_VIDEO_ENCODER_H_

// Pictures in, packets with exact timestamps out (includes libav).

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "cli/media/av_handles.h"
#include "cli/media/frame_converter.h"
#include "cli/media/pixel_format.h"
#include "cli/media/writer_options.h"
#include "igf/base/result.h"

namespace rsstab::media {

// What pictures will come.
struct EncoderInput {
  int width = 0;
  int height = 0;
  AVPixelFormat format = AV_PIX_FMT_NONE;
  bool full_range = false;
  Rational frame_rate;
  Rational time_base;
  Rational sample_aspect_ratio{1, 1};
  AvColor color;
  const AVFrame* first_frame_properties = nullptr;  // HDR10 side data; null: none
  bool needs_global_header = false;                 // the container keeps codec headers apart
  bool needs_display_order = false;                 // the container cannot hold B-frames
};

// One encoder. It sees frames as numbered 0, 1, 2, ... at constant rate, and the packets get the
// true times afterwards: every encoder then sees an ordinary clip (x264 sizes its buffers by the
// time base, MPEG-4 cannot express 1/90000 s), and times come out exactly as they went in, B-frames
// and variable rate included.
class VideoEncoder {
 public:
  // Chooses and opens the encoder. `logger` must outlive the object. Errors as
  // VideoWriter::Open().
  [[nodiscard]] static Result<std::unique_ptr<VideoEncoder>> Open(const EncoderInput& input,
                                                                  const WriterOptions& options,
                                                                  const std::string& codec,
                                                                  const Logger* logger);

  // `picture` in the input format; pts in input ticks, above the one before; duration 0: not known.
  [[nodiscard]] Status Send(AvFramePtr picture, std::int64_t pts, std::int64_t duration);
  // No more pictures.
  [[nodiscard]] Status Flush();
  // The next packet (input ticks), null when more pictures are needed or, after Flush(), at the
  // end.
  [[nodiscard]] Result<AvPacketPtr> Receive();

  [[nodiscard]] const AVCodecContext& context() const { return *context_; }
  [[nodiscard]] std::string name() const { return context_->codec->name; }
  [[nodiscard]] AVPixelFormat format() const { return context_->pix_fmt; }

 private:
  struct Timing {
    std::int64_t pts = 0;
    std::int64_t duration = 0;
  };

  VideoEncoder() = default;
  [[nodiscard]] std::int64_t TimeOf(std::int64_t index) const;
  void Retime(AVPacket& packet);

  AvCodecContextPtr context_;
  std::unique_ptr<FrameConverter> converter_;
  bool input_is_full_range_ = false;
  AVColorSpace input_matrix_ = AVCOL_SPC_UNSPECIFIED;
  // Times of the frames [first_kept_, next_index_) that the encoder may still refer to.
  std::deque<Timing> timings_;
  std::int64_t first_kept_ = 0;
  std::int64_t next_index_ = 0;
  std::int64_t period_ = 1;  // ticks per frame, rounded
  std::optional<std::int64_t> last_dts_;
};

}  // namespace rsstab::media

#endif  // RSSTAB_CLI_MEDIA_VIDEO_ENCODER_H_
