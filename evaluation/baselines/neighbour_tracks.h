// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_EVALUATION_BASELINES_NEIGHBOUR_TRACKS_H_
#define RSSTAB_EVALUATION_BASELINES_NEIGHBOUR_TRACKS_H_

#include <vector>

#include "evaluation/motion_method.h"
#include "igf/base/point_tracks.h"
#include "igf/base/result.h"

namespace rsstab::evaluation {

// Points followed from the frame before to the picture and from there to the frame after, as far as
// there are such frames, in order of time. Times are in frame intervals: the picture's middle row
// at 0, the frame before at -1, the frame after at 1. In pixels of the reduced picture that motion
// analysis looks at; PointTracks says its size.
// Errors: kUnsupported for a picture without neighbours; kUntrustworthy when too few points could
// be followed (`least` in each pair); those of the tracker.
[[nodiscard]] Result<std::vector<PointTracks>> TrackNeighbours(const MethodInput& input,
                                                               std::size_t least);

}  // namespace rsstab::evaluation

#endif  // RSSTAB_EVALUATION_BASELINES_NEIGHBOUR_TRACKS_H_
