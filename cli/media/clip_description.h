// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_MEDIA_CLIP_DESCRIPTION_H_
#define RSSTAB_CLI_MEDIA_CLIP_DESCRIPTION_H_

// What container, stream and first picture together say about a clip (includes libav).

#include "cli/media/av_handles.h"
#include "cli/media/pixel_format.h"
#include "cli/media/timestamp_plan.h"
#include "cli/media/video_info.h"

namespace rsstab::media {

struct ClipDescription {
  VideoInfo info;                          // all but the path
  AVPixelFormat format = AV_PIX_FMT_NONE;  // frames are delivered in this one
  AvColor color;
  AvFramePtr properties;  // HDR side data of picture or container; null: none
};

// Frames per second that libav guesses, for where the timestamps do not tell.
[[nodiscard]] double GuessedRate(AVFormatContext& input, int stream);

// `first` is the first decoded picture of `stream`; `plan` comes from a scan of the file, null if
// there was none; nominal_period: expected ticks per frame.
[[nodiscard]] ClipDescription DescribeClip(AVFormatContext& input, const AVStream& stream,
                                           const AVFrame& first, const TimestampPlan* plan,
                                           double nominal_period);

}  // namespace rsstab::media

#endif  // RSSTAB_CLI_MEDIA_CLIP_DESCRIPTION_H_
