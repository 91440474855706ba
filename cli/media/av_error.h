// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_MEDIA_AV_ERROR_H_
#define RSSTAB_CLI_MEDIA_AV_ERROR_H_

#include <string>

#include "igf/base/result.h"

namespace rsstab::media {

// libav's own words for an AVERROR, without a full stop.
[[nodiscard]] std::string AvErrorText(int averror);

// AVERROR -> Error: "<doing>: <libav's words>" with the code that fits (disk full and permissions
// kIo, missing files and codecs kNotFound, invalid data kCorruptData, ...). `doing` says what was
// tried on what, for example "writing /tmp/out.mp4".
[[nodiscard]] Error AvError(int averror, const std::string& doing);
[[nodiscard]] inline tl::unexpected<Error> AvFail(int averror, const std::string& doing) {
  return tl::unexpected<Error>(AvError(averror, doing));
}

}  // namespace rsstab::media

#endif  // RSSTAB_CLI_MEDIA_AV_ERROR_H_
