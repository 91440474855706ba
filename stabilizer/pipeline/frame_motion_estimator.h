// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_FRAME_MOTION_ESTIMATOR_H_
#define RSSTAB_STABILIZER_PIPELINE_FRAME_MOTION_ESTIMATOR_H_

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "igf/base/log.h"
#include "igf/base/motion_field.h"
#include "stabilizer/camera_path.h"
#include "stabilizer/luma_proxy.h"
#include "stabilizer/mesh_grid.h"
#include "stabilizer/mesh_motion.h"
#include "stabilizer/pipeline/clip_geometry.h"
#include "stabilizer/pipeline/frame_observation.h"
#include "stabilizer/pipeline/rs_selection.h"

namespace rsstab::pipeline {

// Global and local motion from each frame to the next, once rolling shutter and lens are out of the
// tracks; finds the scene cuts on the way. In order, not thread safe.
class FrameMotionEstimator {
 public:
  // `selection` must outlive it.
  FrameMotionEstimator(const ClipGeometry& clip, const RsSelection* selection,
                       const stabilizer::MeshGrid& mesh, Logger logger);

  // Motion of the next frame, once the selection's source has answered for it. `field`: its readout
  // motion, of full size; empty = none.
  [[nodiscard]] stabilizer::FrameMotion Push(const FrameObservation& observation,
                                             const MotionField& field);

 private:
  [[nodiscard]] stabilizer::FrameMotion FromPrevious(const FrameObservation& observation,
                                                     const MotionField& field);
  // What the RS source knows of the turn between two frames, normalised; empty when nothing.
  [[nodiscard]] std::optional<Eigen::Matrix3d> PredictedMotion(double from_s, double to_s) const;

  ClipGeometry clip_;
  const RsSelection* selection_;
  Logger logger_;
  stabilizer::MeshMotionSolver mesh_solver_;
  std::int64_t num_frames_ = 0;
  // Of the frame before.
  MotionField previous_field_;
  double previous_time_s_ = 0.0;
  stabilizer::LumaFingerprint previous_fingerprint_{};
};

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_FRAME_MOTION_ESTIMATOR_H_
