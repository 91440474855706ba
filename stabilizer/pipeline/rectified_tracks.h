// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_RECTIFIED_TRACKS_H_
#define RSSTAB_STABILIZER_PIPELINE_RECTIFIED_TRACKS_H_

#include <optional>
#include <vector>

#include "igf/base/camera.h"
#include "igf/base/motion_field.h"
#include "igf/base/point_tracks.h"
#include "stabilizer/global_motion.h"
#include "stabilizer/pipeline/clip_geometry.h"

namespace rsstab::pipeline {

// Takes rolling shutter and lens out of `tracks` (of any size): where both ends lie in the
// corrected pictures, normalised. `from_field`, `to_field`: readout motion of the earlier and the
// later frame, of the clip's size; empty = none. `camera`: of the clip's size; only a lens with
// distortion enters. Matches for which the lens has no ray are left out.
[[nodiscard]] std::vector<stabilizer::RectifiedMatch> RectifyTracks(
    const PointTracks& tracks, const MotionField& from_field, const MotionField& to_field,
    const std::optional<Camera>& camera, const ClipGeometry& clip);

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_RECTIFIED_TRACKS_H_
