// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_GPMF_PARSER_H_
#define RSSTAB_IGF_GPMF_PARSER_H_

#include <cstdint>
#include <span>
#include <vector>

#include "igf/base/result.h"
#include "igf/gyro_recording.h"

namespace rsstab::igf {

// One packet of a GoPro telemetry track (`gpmd`), not owned.
struct GpmfPayload {
  std::span<const std::uint8_t> bytes;
  double start_s = 0.0;  // as the container times it, video clock
  // As the container claims; 0 where it does not. Only looked at when there is one payload.
  double duration_s = 0.0;
};

// Nominal length of a payload, taken where no container tells.
inline constexpr double kGpmfNominalPayload_s = 1.001;

// Splits payloads that lie one after the other in a file (".raw", without container) and times them
// nominally. A payload ends where a device appears for the second time. The views point into
// `bytes`. Empty when no device (DEVC) is found.
[[nodiscard]] std::vector<GpmfPayload> SplitGpmfPayloads(std::span<const std::uint8_t> bytes);

// The camera's gyro (GYRO) from GPMF payloads in time order; no demuxing here.
//
// Device: the camera, which GoPro numbers 1 (DVID); where no device has that number, the first with
// a gyro. A drone or a paired sensor in the same payload is passed over.
// Scale: SCAL, one or one per channel, rad/s (deg/s where SIUN says so).
// Axes: options.camera_from_sensor; else MTRX with ORIO; else ORIN; else the order that GoPro
// publishes for the device where its streams state a wrong one (HERO6, Fusion); else the order in
// the stream's name, "(z,x,y)"; else Z, X, Y, with a note. See imu_axes.h.
// Time: samples are counted, over lost payloads (which leave a gap) by TSMP where the payload times
// agree that something is missing; an even clock is fitted to the microsecond stamps (STMP) where
// every payload has one, else to the payloads' start times; see sample_clock.h. Durations never
// enter the fit, as a last payload may claim a second and hold a few samples. STMP has an arbitrary
// origin, so it is moved to agree with the start times (median). The result is in the video's clock
// to within the packets' jitter, a few 10 ms. Readout: median of SROT (ms), taken as top to bottom.
//
// Damage is survived where something usable is left, and noted: bytes that are no item are skipped
// up to the next DEVC, a value cut off by the end of its payload keeps its whole rows, unreadable
// leading samples are dropped. Errors (kCorruptData, with the payload's number): no gyro, a gyro
// without scale, no timing, and whatever GyroLog::Create refuses.
[[nodiscard]] Result<GyroRecording> ParseGpmf(std::span<const GpmfPayload> payloads,
                                              const GyroParseOptions& options = {});

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_GPMF_PARSER_H_
