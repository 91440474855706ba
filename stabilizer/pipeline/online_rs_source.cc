// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/online_rs_source.h"

#include <utility>

#include "stabilizer/pipeline/camera_knowledge.h"
#include "stabilizer/rs_motion_fusion.h"

namespace rsstab::pipeline {
namespace {

// Frames left to the smoother: with fewer it leaves more shake than the readout motion is worth.
constexpr int kSmootherShare = 15;

// What the clip would be asked for, as far as it was given; empty when the readout time is not.
std::optional<stabilizer::ClipCalibration> GivenCalibration(const StabilizeOptions& options,
                                                            const ClipGeometry& clip,
                                                            const RsInputs& inputs) {
  const stabilizer::ClipCalibrationOptions given = CalibrationOptions(options, clip, inputs);
  if (!given.readout_s) {
    return std::nullopt;
  }
  stabilizer::ClipCalibration calibration;
  calibration.verdict = stabilizer::ShutterVerdict::kGiven;
  calibration.readout_s = {*given.readout_s, 0.0, true};
  if (given.focal) {
    calibration.focal = {*given.focal, 0.0, true};
  }
  return calibration;
}

}  // namespace

int MinFusedLookahead() { return stabilizer::kFusionDelayFrames + kSmootherShare; }

Result<RsSelection> SelectOnlineRsSource(const OnlineOptions& options, const ClipGeometry& clip,
                                         RsInputs inputs, const Logger& logger) {
  const StabilizeOptions& wanted = options.stabilize;
  if (inputs.gyro && !wanted.gyro_offset_s) {
    if (wanted.rs == RsChoice::kGyro) {
      return Fail(ErrorCode::kUnsupported,
                  "live, the gyro log {} cannot be brought into step with a clip that is not known "
                  "yet: give --gyro-offset (`rs-stabilize analyze` finds it)",
                  inputs.gyro_origin);
    }
    logger->warn("the gyro log {} is not used: live mode needs --gyro-offset", inputs.gyro_origin);
    inputs.gyro.reset();
  }
  ClipEvidence evidence;
  evidence.calibration = GivenCalibration(wanted, clip, inputs);
  const bool can_fuse = evidence.calibration && options.lookahead_frames >= MinFusedLookahead();
  if (!can_fuse && (wanted.rs == RsChoice::kFused || wanted.rs == RsChoice::kTracks)) {
    return Fail(ErrorCode::kUnsupported,
                "live, --rs fused and tracks need the readout time (--readout, or a camera file "
                "with it) and a --lookahead of {} or more",
                MinFusedLookahead());
  }
  if (!can_fuse) {
    evidence.calibration.reset();
  }
  return SelectRsSource(wanted, clip, inputs, evidence, logger);
}

}  // namespace rsstab::pipeline
