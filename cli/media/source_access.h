// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_MEDIA_SOURCE_ACCESS_H_
#define RSSTAB_CLI_MEDIA_SOURCE_ACCESS_H_

// What a VideoWriter needs of the VideoReader it follows (includes libav).

#include <memory>
#include <string>

#include "cli/media/av_handles.h"
#include "cli/media/packet_queue.h"
#include "cli/media/pixel_format.h"
#include "cli/media/video_reader.h"

namespace rsstab::media {

struct SourceAccess {
  AVFormatContext* input = nullptr;  // owned by the reader
  int video_stream = 0;
  std::string path;                                 // as given to VideoReader::Open()
  AVPixelFormat format = AV_PIX_FMT_NONE;           // of the delivered frames
  AvColor color;                                    // of the delivered frames
  const AVFrame* first_frame_properties = nullptr;  // side data, null if none; owned by the reader
  std::shared_ptr<PacketQueue> packets;
  bool has_started = false;  // Read() was called: packets may be gone
};

// Valid until the next call of `reader`. Announces that somebody takes the packets: they are kept
// from now on until PacketQueue::Close().
[[nodiscard]] SourceAccess AccessSource(VideoReader& reader);

}  // namespace rsstab::media

#endif  // RSSTAB_CLI_MEDIA_SOURCE_ACCESS_H_
