// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_MEDIA_FRAME_BRIDGE_H_
#define RSSTAB_CLI_MEDIA_FRAME_BRIDGE_H_

// AVFrame <-> Frame without copying samples (includes libav).

#include <cstdint>

#include "cli/media/av_handles.h"
#include "igf/base/frame.h"
#include "igf/base/result.h"

namespace rsstab::media {

// What Frame::origin points to for frames of this module.
struct FrameOrigin {
  std::int64_t pts = 0;       // ticks of the clip's time base, repaired
  std::int64_t duration = 0;  // ticks; 0: not known
  AvFramePtr properties;      // side data only, no samples; null: none
};

// The origin of a frame, null for frames made elsewhere.
[[nodiscard]] const FrameOrigin* OriginOf(const Frame& frame);
void SetOrigin(Frame& frame, FrameOrigin origin);

// A Frame that shares the buffers of `picture`, which lies like `layout`. Takes `picture` over.
[[nodiscard]] Frame WrapPicture(AvFramePtr picture, const PixelLayout& layout);

// An AVFrame that shares the samples of `frame`, marked read-only, in `format`, which must lie like
// frame.layout. Carries the side data of the frame's origin that describes the light of the scene
// or belongs to the instant (HDR10, HDR10+, captions, time code), nothing about the old coding.
// Errors: kIo when out of memory.
[[nodiscard]] Result<AvFramePtr> SharePicture(const Frame& frame, AVPixelFormat format);

// The properties a FrameOrigin keeps of a decoded picture; null if there are none.
[[nodiscard]] AvFramePtr KeptProperties(const AVFrame& picture);

// Adds what the container says about the light of the scene (HDR10) and the picture does not.
// `properties` may be null and may stay so.
[[nodiscard]] AvFramePtr WithContainerHdr(AvFramePtr properties, const AVStream& stream);

}  // namespace rsstab::media

#endif  // RSSTAB_CLI_MEDIA_FRAME_BRIDGE_H_
