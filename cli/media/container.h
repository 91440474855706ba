// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_MEDIA_CONTAINER_H_
#define RSSTAB_CLI_MEDIA_CONTAINER_H_

// Which container an output is, and what kind it is of (includes libav).

#include <string>

#include "cli/media/av_handles.h"
#include "igf/base/result.h"

namespace rsstab::media {

// libav's muxer for an output. Errors: kUnsupported when name or extension say nothing.
[[nodiscard]] Result<const AVOutputFormat*> ChooseContainer(const std::string& path,
                                                            const std::string& format);

// Whether frame n is shown after n periods, whatever its time: such a file has the period as its
// tick, and no place for frames in another order than that of their display.
[[nodiscard]] bool HoldsConstantRateOnly(const AVOutputFormat& format);

// MP4 and its relatives.
[[nodiscard]] bool IsMp4Like(const AVOutputFormat& format);
// Matroska and WebM.
[[nodiscard]] bool IsMatroska(const AVOutputFormat& format);

}  // namespace rsstab::media

#endif  // RSSTAB_CLI_MEDIA_CONTAINER_H_
