// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_MEDIA_TELEMETRY_TRACK_H_
#define RSSTAB_CLI_MEDIA_TELEMETRY_TRACK_H_

#include <cstdint>
#include <string>
#include <vector>

#include "igf/base/result.h"

namespace rsstab::media {

// One packet of a data track, its bytes untouched.
struct TelemetryPayload {
  std::vector<std::uint8_t> bytes;
  double start_s = 0.0;  // container clock, the one of VideoFrame::time_s
  // As the track claims; the last one of a GoPro track claims a full second however little it
  // holds. 0: not known.
  double duration_s = 0.0;
};

// All payloads of the first data track of the given four-letter kind, in file order, for example
// "gpmd" (GoPro). Any thread.
// Errors: kNotFound (no such file or track), kCorruptData (not a media file), kIo.
[[nodiscard]] Result<std::vector<TelemetryPayload>> ReadTelemetry(const std::string& path,
                                                                  const std::string& kind);

}  // namespace rsstab::media

#endif  // RSSTAB_CLI_MEDIA_TELEMETRY_TRACK_H_
