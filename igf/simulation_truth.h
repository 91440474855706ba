// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_SIMULATION_TRUTH_H_
#define RSSTAB_IGF_SIMULATION_TRUTH_H_

#include <string>
#include <vector>

#include "igf/base/camera.h"
#include "igf/base/result.h"
#include "igf/orientation_track.h"

namespace rsstab::igf {

// What a simulated clip was made from: enough to state where any row of any frame looked.
struct SimulationTruth {
  Camera camera;  // readout_s is set
  double exposure_s = 0.0;
  double gyro_offset_s = 0.0;         // t_video = t_gyro + offset
  std::vector<double> frame_times_s;  // of the middle rows, video clock
  OrientationTrack orientation;       // SLERP between its samples is exact
};

// JSON text:
//   "format": "rs-stabilize truth", "version": 1,
//   "camera": a camera JSON, see camera_profile_reader.h; readout_s is always there,
//   "exposure_s", "gyro_offset_s": numbers,
//   "frames": [{"index", "time_s", "world_from_camera": [x, y, z, w]}, ..]  (of the middle row)
//   "orientation": {"times_s": [..], "world_from_camera": [[x, y, z, w], ..]}
// Row v of a frame looks where `orientation`, joined by SLERP, is at
// time_s + readout_s ((v + 0.5) / height - 0.5). Quaternions are unit, Hamilton.
// The track's own samples are written, digit for digit, those from the last one at or before the
// first row of the first frame to the first one after the last row of the last frame, and
// `margin_s` more on both sides where there is more.
// Errors: kInvalidArgument when there is no frame or the track does not cover all of them.
[[nodiscard]] Result<std::string> FormatSimulationTruth(const SimulationTruth& truth,
                                                        double margin_s = 0.25);

// Reads that text. Errors: kCorruptData naming what is missing or wrong.
[[nodiscard]] Result<SimulationTruth> ParseSimulationTruth(const std::string& text);

// The same from a file. Every error names it. Errors: kNotFound, kIo, and the above.
[[nodiscard]] Result<SimulationTruth> ReadSimulationTruth(const std::string& path);

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_SIMULATION_TRUTH_H_
