// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_SYNC_OFFSET_SEARCH_H_
#define RSSTAB_IGF_SYNC_OFFSET_SEARCH_H_

#include <cstddef>
#include <span>
#include <vector>

#include "igf/orientation_track.h"
#include "igf/sync_pairs.h"

namespace rsstab::igf {

struct OffsetSearchOptions {
  double min_offset_s = -2.0;
  double max_offset_s = 2.0;
  double step_s = 2e-3;                    // a 60 Hz vibration turns round within 8 ms
  std::vector<double> readouts_s = {0.0};  // hypotheses
  std::size_t max_candidates = 8;
};

// A local maximum over the offset.
struct OffsetCandidate {
  double offset_s = 0.0;   // t_video = t_gyro + offset
  double readout_s = 0.0;  // the hypothesis that explained most there
  double explained = 0.0;  // share of the motion's energy, in [0, 1]
};

// Exhaustive search: for every offset and readout hypothesis, which share of the image motion's
// energy the gyro explains, after the best common scale (the focal length may be wrong) and the
// best constant rate (the bias) are taken out. The image motion enters as medians over a few cells
// of each frame, timed by row: a frame's average motion is blind to vibration faster than the
// readout. Motion of pairs that the log does not cover at an offset counts as unexplained, so that
// short overlaps cannot win by chance. Best candidate first.
[[nodiscard]] std::vector<OffsetCandidate> SearchOffsets(std::span<const SyncPair> pairs,
                                                         const OrientationTrack& track,
                                                         const OffsetSearchOptions& options);

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_SYNC_OFFSET_SEARCH_H_
