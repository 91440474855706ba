// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_GYRO_SELECTION_H_
#define RSSTAB_STABILIZER_PIPELINE_GYRO_SELECTION_H_

#include <span>

#include "igf/base/point_tracks.h"
#include "igf/base/result.h"
#include "igf/gyro_video_sync.h"
#include "stabilizer/clip_calibration.h"
#include "stabilizer/pipeline/camera_knowledge.h"
#include "stabilizer/pipeline/rs_inputs.h"
#include "stabilizer/pipeline/rs_selection.h"
#include "stabilizer/pipeline/stabilize_options.h"

namespace rsstab::pipeline {

// Brings the log of `inputs` (which must be there) into step with the picture. With a given offset
// the fit finds what else is unknown, and may fail without harm; with RsChoice::kAuto it moves the
// offset by up to 20 ms where the tracks leave no doubt, otherwise the offset is kept.
// Errors: those of igf::SynchronizeGyro, naming the log.
[[nodiscard]] Result<igf::GyroSyncResult> BringIntoStep(const StabilizeOptions& options,
                                                        const CameraKnowledge& known,
                                                        const RsInputs& inputs,
                                                        std::span<const PointTracks> tracks);

// What a log in step with the picture says about the camera, in the form of the tracks' word.
[[nodiscard]] stabilizer::ClipCalibration CalibrationOf(const igf::GyroSyncResult& sync,
                                                        const CameraKnowledge& known);

// The log of `inputs` as the source. Errors: those of BringIntoStep; kUntrustworthy when log and
// clip do not meet; those of igf::GyroMotionSource.
[[nodiscard]] Result<RsSelection> SelectGyro(const StabilizeOptions& options, CameraKnowledge known,
                                             const RsInputs& inputs,
                                             std::span<const PointTracks> tracks);

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_GYRO_SELECTION_H_
