// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_MEDIA_HDR_METADATA_H_
#define RSSTAB_CLI_MEDIA_HDR_METADATA_H_

// HDR10 static metadata in the words of the encoders, which do not take it from frames (includes
// libav).

#include <string>

#include "cli/media/av_handles.h"

namespace rsstab::media {

// Mastering display and content light level of `properties` (null: none) as an option string for
// `encoder` ("libx264", "libx265", "libsvtav1"): "key=value:key=value". Empty when there is nothing
// to say or the encoder has no such option.
[[nodiscard]] std::string HdrParameters(const std::string& encoder, const AVFrame* properties);

}  // namespace rsstab::media

#endif  // RSSTAB_CLI_MEDIA_HDR_METADATA_H_
