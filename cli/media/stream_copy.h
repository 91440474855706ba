// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_MEDIA_STREAM_COPY_H_
#define RSSTAB_CLI_MEDIA_STREAM_COPY_H_

// Which streams a container takes, and how their descriptions are carried over (includes libav).

#include <string>

#include "cli/media/av_handles.h"

namespace rsstab::media {

// Whether packets of a stream like this can be written to `format` untouched. True may still turn
// out wrong when the header is written.
[[nodiscard]] bool ContainerTakes(const AVOutputFormat& format, const AVStream& stream);

// For warnings: "audio stream 1 (pcm_s16le)".
[[nodiscard]] std::string StreamName(const AVStream& stream);

// Describes `target` as `source`, for untouched packets. 0 or an AVERROR.
[[nodiscard]] int CopyDescription(const AVOutputFormat& format, const AVStream& source,
                                  AVStream& target);

// Side data of the video stream that holds for the steadied pictures: display matrix, HDR10,
// stereo and spherical layout. 0 or an AVERROR.
[[nodiscard]] int CopyVideoSideData(const AVStream& source, const AVFrame* first_frame_properties,
                                    AVStream& target);

// Metadata without what the container or the encoder writes by itself.
[[nodiscard]] int CopyMetadata(const AVDictionary* source, AVDictionary** target);

// Whether some key is not one of the few that every container has a place for.
[[nodiscard]] bool HasSpecialMetadata(const AVDictionary* metadata);

}  // namespace rsstab::media

#endif  // RSSTAB_CLI_MEDIA_STREAM_COPY_H_
