// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_RS_SOURCE_SELECTION_H_
#define RSSTAB_STABILIZER_PIPELINE_RS_SOURCE_SELECTION_H_

#include <optional>
#include <span>

#include "igf/base/log.h"
#include "igf/base/point_tracks.h"
#include "igf/base/result.h"
#include "stabilizer/clip_calibration.h"
#include "stabilizer/pipeline/clip_geometry.h"
#include "stabilizer/pipeline/readout_from_pictures.h"
#include "stabilizer/pipeline/rs_inputs.h"
#include "stabilizer/pipeline/rs_selection.h"
#include "stabilizer/pipeline/stabilize_options.h"

namespace rsstab::pipeline {

// What the pictures of the clip told, once they were all seen.
struct ClipEvidence {
  std::span<const PointTracks> tracks;  // of consecutive frames; may be thinned out
  std::optional<stabilizer::ClipCalibration> calibration;
  std::optional<PictureReadout> pictures;  // when they were asked and answered
};

// True when the choice can only be made once the clip was seen (a gyro log must be brought into
// step with the picture, the readout time must be found).
[[nodiscard]] bool NeedsTracks(const StabilizeOptions& options, const RsInputs& inputs);

// True when single pictures of the clip should be asked for its readout time.
[[nodiscard]] bool NeedsPictures(const StabilizeOptions& options, const RsInputs& inputs);

// Asks the single-image model that `options` name. Errors: those of rsdiff::FindModel,
// rsdiff::SingleImageEstimator::Load and ReadoutPictures::Ask.
[[nodiscard]] Result<PictureReadout> AskPictures(const StabilizeOptions& options,
                                                 const ReadoutPictures& pictures,
                                                 double frame_interval_s);

// Chooses the rolling-shutter source, and says why. `evidence` is needed when NeedsTracks();
// without a calibration the tracks' own motion is not used. With kAuto an untrustworthy gyro means
// a warning and that the tracks are asked; with kGyro it is an error: kNotFound without a log,
// kUntrustworthy when it does not fit. With kDiffusion: the errors of rsdiff::FindModel and
// rsdiff::SingleImageEstimator::Load.
[[nodiscard]] Result<RsSelection> SelectRsSource(const StabilizeOptions& options,
                                                 const ClipGeometry& clip, const RsInputs& inputs,
                                                 const ClipEvidence& evidence,
                                                 const Logger& logger);

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_RS_SOURCE_SELECTION_H_
