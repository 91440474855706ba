// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_MEDIA_FRAME_CONVERTER_H_
#define RSSTAB_CLI_MEDIA_FRAME_CONVERTER_H_

// Change of pixel format, colour range or size by swscale (includes libav).

#include "cli/media/av_handles.h"
#include "igf/base/result.h"

namespace rsstab::media {

// Keeps one swscale context for as long as the pictures stay alike. Not thread safe.
class FrameConverter {
 public:
  struct Target {
    AVPixelFormat format = AV_PIX_FMT_NONE;
    int width = 0;  // pixels
    int height = 0;
    bool full_range = false;  // of YUV and gray
  };

  explicit FrameConverter(const Target& target) : target_(target) {}

  // A new picture with the content of `source`, timestamps and side data included. The YUV matrix
  // is the source's own; not said: BT.709 for pictures of at least 720 rows, else BT.601.
  // Errors: kUnsupported when swscale cannot do it, kIo when out of memory.
  [[nodiscard]] Result<AvFramePtr> Convert(const AVFrame& source);

  [[nodiscard]] const Target& target() const { return target_; }

 private:
  Target target_;
  SwsContextPtr context_;
  int source_width_ = 0;
  int source_height_ = 0;
  int source_format_ = AV_PIX_FMT_NONE;
  bool source_full_range_ = false;
  int matrix_ = 0;
};

}  // namespace rsstab::media

#endif  // RSSTAB_CLI_MEDIA_FRAME_CONVERTER_H_
