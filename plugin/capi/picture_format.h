// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_PLUGIN_CAPI_PICTURE_FORMAT_H_
#define RSSTAB_PLUGIN_CAPI_PICTURE_FORMAT_H_

#include "igf/base/frame.h"
#include "igf/base/result.h"
#include "plugin/capi/rsstab.h"

namespace rsstab::capi {

// A clip as the host described it, checked and in the library's terms.
struct VideoFormat {
  PixelLayout layout;
  int width = 0;
  int height = 0;
  double seconds_per_tick = 0.0;
  double frames_per_second = 0.0;
};

// Errors: kInvalidArgument naming the field; kUnsupported for an unknown pixel format.
[[nodiscard]] Result<VideoFormat> ToVideoFormat(const rsstab_video& video);

// The caller's memory as a picture to read. Errors: kInvalidArgument for a missing plane or a
// stride shorter than a row.
[[nodiscard]] Result<FrameView> ToFrameView(const rsstab_picture& picture,
                                            const VideoFormat& format);

// The same to write to; the frame owns nothing.
[[nodiscard]] Result<Frame> ToFrame(const rsstab_buffer& buffer, const VideoFormat& format);

// Copies the samples of a picture into one of the same layout and size.
void CopySamples(const FrameView& source, Frame& destination);

}  // namespace rsstab::capi

#endif  // RSSTAB_PLUGIN_CAPI_PICTURE_FORMAT_H_
