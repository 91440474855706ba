// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/frame_motion_estimator.h"

#include <utility>
#include <vector>

#include "igf/base/rotation.h"
#include "stabilizer/global_motion.h"
#include "stabilizer/normalized_coordinates.h"
#include "stabilizer/pipeline/rectified_tracks.h"
#include "stabilizer/scene_cut.h"

namespace rsstab::pipeline {

using stabilizer::MotionRung;

FrameMotionEstimator::FrameMotionEstimator(const ClipGeometry& clip, const RsSelection* selection,
                                           const stabilizer::MeshGrid& mesh, Logger logger)
    : clip_(clip), selection_(selection), logger_(std::move(logger)), mesh_solver_(mesh) {}

stabilizer::FrameMotion FrameMotionEstimator::Push(const FrameObservation& observation,
                                                   const MotionField& field) {
  stabilizer::FrameMotion motion;
  if (num_frames_ == 0) {
    motion.path_begins = true;
  } else {
    motion = FromPrevious(observation, field);
  }
  previous_field_ = field;
  previous_time_s_ = observation.time_s;
  previous_fingerprint_ = observation.fingerprint;
  ++num_frames_;
  return motion;
}

std::optional<Eigen::Matrix3d> FrameMotionEstimator::PredictedMotion(double from_s,
                                                                     double to_s) const {
  if (!selection_->rotation_is_known || !selection_->camera) {
    return std::nullopt;
  }
  const auto turn = selection_->source->TurnBetween(from_s, to_s);
  if (!turn) {
    return std::nullopt;
  }
  const Eigen::Matrix3d to_from =
      stabilizer::NormalizedFromPixels(clip_.width, clip_.height) *
      RotationHomography(selection_->camera->K(), *turn, Eigen::Quaterniond::Identity()) *
      stabilizer::PixelsFromNormalized(clip_.width, clip_.height);
  return Eigen::Matrix3d(to_from / to_from(2, 2));
}

stabilizer::FrameMotion FrameMotionEstimator::FromPrevious(const FrameObservation& observation,
                                                           const MotionField& field) {
  const std::vector<stabilizer::RectifiedMatch> matches =
      RectifyTracks(observation.tracks, previous_field_, field, selection_->camera, clip_);
  stabilizer::GlobalMotionOptions global_options;
  const auto predicted = PredictedMotion(previous_time_s_, observation.time_s);
  if (predicted) {
    global_options.predicted = *predicted;
    global_options.finest = MotionRung::kSimilarity;
  }
  const stabilizer::GlobalMotion global = stabilizer::EstimateGlobalMotion(matches, global_options);
  stabilizer::FrameMotion motion;
  const stabilizer::SceneChangeEvidence evidence = {
      stabilizer::FingerprintDistance(observation.fingerprint, previous_fingerprint_),
      observation.attempted_points, global.num_inliers};
  if (stabilizer::IsSceneCut(evidence)) {
    motion.path_begins = true;
    logger_->debug("frame {}: scene cut", num_frames_);
    return motion;
  }
  if (predicted && selection_->only_turns) {
    motion.to_from = *predicted;
    motion.rung = MotionRung::kSimilarity;
    return motion;
  }
  motion.to_from = global.to_from;
  motion.rung = global.rung;
  const bool well_supported = global.rung == global_options.finest;
  if (well_supported) {
    motion.local = mesh_solver_.Solve(matches, global.to_from);
    if (!motion.local.empty()) {
      motion.rung = MotionRung::kMesh;
    }
  }
  return motion;
}

}  // namespace rsstab::pipeline
