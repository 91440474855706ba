// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/gyro_selection.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "igf/gyro_integrator.h"
#include "igf/gyro_motion_source.h"

namespace rsstab::pipeline {
namespace {

// A given offset may have been found by another program, or by hand: with RsChoice::kAuto the
// tracks move it by this much if they are this sure.
constexpr double kMaxCorrection_s = 20e-3;
constexpr double kMaxCorrectionSigma_s = 0.5e-3;
// Telemetry tracks lag or lead their video by exposure, readout and packet times.
constexpr double kSharedClockSearchS = 0.25;

// A readout below this bends no picture visibly.
constexpr double kVisibleReadout_s = 1e-3;
constexpr double kSigmasToBelieve = 3.0;
// What all tracks of a clip share does not show in their scatter. Standard deviations; simulated
// vibration (28 ms, 1108.5 px) is read as 27.94 ms and 1103.3 px.
constexpr double kSystematicReadout_s = 1e-4;
constexpr double kSystematicFocalSigma = 0.005;

// A log that tells nothing about the clip is a wrong log or a wrong offset.
Status CheckOverlap(const igf::GyroLog& log, double offset_s, std::span<const PointTracks> tracks) {
  if (tracks.empty()) {
    return {};
  }
  const double clip_begin_s = tracks.front().from_time_s;
  const double clip_end_s = tracks.back().to_time_s;
  const double log_begin_s = log.start_s() + offset_s;
  const double log_end_s = log.end_s() + offset_s;
  if (log_begin_s < clip_end_s && log_end_s > clip_begin_s) {
    return {};
  }
  return Fail(ErrorCode::kUntrustworthy,
              "with the offset of {:.3f} s the log lasts from {:.3f} to {:.3f} s and the clip from "
              "{:.3f} to {:.3f} s, which do not meet: check --gyro-offset",
              offset_s, log_begin_s, log_end_s, clip_begin_s, clip_end_s);
}

// How many of the clip's frames were read out, and reached from the frame before, while the log
// knows the camera.
double CoveredShare(const igf::OrientationTrack& track, double readout_s,
                    std::span<const PointTracks> tracks) {
  if (tracks.empty()) {
    return 1.0;
  }
  const double half_s = 0.5 * std::abs(readout_s);
  const auto covered = std::count_if(tracks.begin(), tracks.end(), [&](const PointTracks& pair) {
    return track.Covers(pair.from_time_s - half_s, pair.to_time_s + half_s);
  });
  return static_cast<double>(covered) / static_cast<double>(tracks.size());
}

}  // namespace

Result<igf::GyroSyncResult> BringIntoStep(const StabilizeOptions& options,
                                          const CameraKnowledge& known, const RsInputs& inputs,
                                          std::span<const PointTracks> tracks) {
  igf::GyroSyncOptions sync;
  sync.focal_is_known = known.focal_is_known;
  if (inputs.gyro_shares_clock) {
    sync.search_s = kSharedClockSearchS;
  }
  sync.lens_is_known = known.lens_is_known;
  const bool may_move = options.rs == RsChoice::kAuto;
  if (options.gyro_offset_s) {
    sync.initial_offset_s = *options.gyro_offset_s;
    sync.search_s = may_move ? kMaxCorrection_s : 0.0;
  }
  auto result = igf::SynchronizeGyro(tracks, *inputs.gyro, known.camera, sync);
  if (!result && !options.gyro_offset_s) {
    return Propagate(std::move(result.error()), inputs.gyro_origin);
  }
  if (!options.gyro_offset_s) {
    return result;
  }
  if (!result) {
    igf::GyroSyncResult given;
    given.readout_s = known.camera.readout_s.value_or(0.0);
    given.readout_is_trusted = known.camera.readout_s.has_value();
    given.confidence = 1.0;
    result = given;
  }
  const double correction_s = result->offset_s - *options.gyro_offset_s;
  const bool is_sure = result->offset_sigma_s > 0.0 &&
                       result->offset_sigma_s < kMaxCorrectionSigma_s &&
                       std::abs(correction_s) > kSigmasToBelieve * result->offset_sigma_s;
  if (!(may_move && is_sure && std::abs(correction_s) <= kMaxCorrection_s)) {
    result->offset_s = *options.gyro_offset_s;
    result->offset_sigma_s = 0.0;
  }
  return result;
}

stabilizer::ClipCalibration CalibrationOf(const igf::GyroSyncResult& sync,
                                          const CameraKnowledge& known) {
  using stabilizer::ShutterVerdict;
  const double width = known.camera.width;
  stabilizer::ClipCalibration calibration;
  calibration.focal = {known.camera.fx / width, 0.0, known.focal_is_known};
  if (!known.focal_is_known && sync.focal_is_trusted) {
    const double focal = sync.camera.fx / width;
    const double sigma =
        std::hypot(sync.focal_ratio_sigma / sync.focal_ratio, kSystematicFocalSigma);
    calibration.focal = {focal, focal * sigma, true};
  }
  if (known.camera.readout_s) {
    calibration.verdict = ShutterVerdict::kGiven;
    calibration.readout_s = {*known.camera.readout_s, 0.0, true};
  } else if (sync.readout_is_trusted) {
    const double sigma_s = std::hypot(sync.readout_sigma_s, kSystematicReadout_s);
    calibration.readout_s = {sync.readout_s, sigma_s, true};
    const double limit_s = std::max(kSigmasToBelieve * sigma_s, kVisibleReadout_s);
    calibration.verdict =
        std::abs(sync.readout_s) > limit_s ? ShutterVerdict::kRolling : ShutterVerdict::kGlobal;
  }
  return calibration;
}

Result<RsSelection> SelectGyro(const StabilizeOptions& options, CameraKnowledge known,
                               const RsInputs& inputs, std::span<const PointTracks> tracks) {
  const auto sync = BringIntoStep(options, known, inputs, tracks);
  if (!sync) {
    return Propagate(sync.error());
  }
  if (Status ok = CheckOverlap(*inputs.gyro, sync->offset_s, tracks); !ok) {
    return Propagate(std::move(ok.error()), inputs.gyro_origin);
  }
  const CameraKnowledge known_before = known;
  const bool readout_given = known.camera.readout_s.has_value();
  // A lens found here bends the field only, which lives in recorded pixels: nobody asked for the
  // clip to be straightened. What follows the path sees a pinhole of the same scale at its centre.
  Camera field_camera = known.camera;
  if (sync->focal_is_trusted && !(known.focal_is_known && known.lens_is_known)) {
    field_camera = sync->camera;
    known.camera.fx = field_camera.fx;
    known.camera.fy = field_camera.fy;
  }
  const double readout_s = readout_given              ? *known.camera.readout_s
                           : sync->readout_is_trusted ? sync->readout_s
                                                      : 0.0;
  auto track = igf::IntegrateGyro(*inputs.gyro, {.bias_rad_s = sync->bias_rad_s});
  if (!track) {
    return Propagate(std::move(track.error()), inputs.gyro_origin);
  }
  known.camera.readout_s = readout_s;
  const igf::OrientationTrack in_step = track->WithOffset(sync->offset_s);
  auto source = igf::GyroMotionSource::Create(field_camera, readout_s, in_step);
  if (!source) {
    return Propagate(std::move(source.error()), inputs.gyro_origin);
  }
  RsSelection selection;
  selection.source = std::make_unique<igf::GyroMotionSource>(std::move(*source));
  selection.camera = known.camera;
  selection.readout_s = readout_s;
  selection.rotation_is_known = true;
  selection.gyro_offset_s = sync->offset_s;
  selection.covered_share = CoveredShare(in_step, readout_s, tracks);
  selection.calibration = CalibrationOf(*sync, known_before);
  selection.reason = fmt::format(
      "gyro log {} ({:.0f} Hz), offset {:.1f} ms{}, readout {:.1f} ms ({}), focal length {:.0f} px "
      "({})",
      inputs.gyro_origin, inputs.gyro->mean_rate_hz(), sync->offset_s * 1e3,
      options.gyro_offset_s && sync->offset_s != *options.gyro_offset_s
          ? fmt::format(" (given: {:.1f} ms, moved to where the tracks clearly are)",
                        *options.gyro_offset_s * 1e3)
          : "",
      readout_s * 1e3,
      readout_given              ? "given"
      : sync->readout_is_trusted ? "estimated"
                                 : "unknown: taken as a global shutter, give --readout",
      known.camera.fx,
      known.focal_is_known     ? "given"
      : sync->focal_is_trusted ? "estimated"
                               : "assumed: give --focal or --camera");
  return selection;
}

}  // namespace rsstab::pipeline
